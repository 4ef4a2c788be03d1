"""Whether probabilities are what they say: of a hundred merges at 0.9, are ninety right?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import BoolArray

EDGES = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 0.99, 1.0)  # narrow where most merges lie


@dataclass(frozen=True)
class Bin:
    """Merges of about one probability.

    low, high   : its bounds
    n           : merges in it
    probability : their mean; NaN without any
    right       : share of them that is right; NaN without any
    """

    low: float
    high: float
    n: int
    probability: float
    right: float


def reliability(
    probabilities: FloatArray, right: BoolArray, edges: Sequence[float] = EDGES
) -> tuple[Bin, ...]:
    """The merges by probability; the upper bound of a bin belongs to the next one, 1 to the last."""
    number = np.clip(np.searchsorted(edges, probabilities, side="right") - 1, 0, len(edges) - 2)
    bins = []
    for k, (low, high) in enumerate(pairwise(edges)):
        mine = number == k
        n = int(np.count_nonzero(mine))
        mean = float(probabilities[mine].mean()) if n else np.nan
        share = float(right[mine].mean()) if n else np.nan
        bins.append(Bin(low, high, n, mean, share))
    return tuple(bins)


def calibration_error(
    probabilities: FloatArray, right: BoolArray, edges: Sequence[float] = tuple(np.linspace(0, 1, 11))
) -> float:
    """Expected calibration error, ECE: how far the share that is right lies from the mean probability, over
    the bins, each by its number of merges. NaN without any.
    """
    if not len(probabilities):
        return np.nan
    bins = [each for each in reliability(probabilities, right, edges) if each.n]
    off = sum(each.n * abs(each.probability - each.right) for each in bins)
    return off / len(probabilities)


def brier_score(probabilities: FloatArray, right: BoolArray) -> float:
    """Mean squared distance of the probabilities from 1 for what is right, 0 for what is not; NaN of none."""
    return float(np.mean((probabilities - right) ** 2)) if len(probabilities) else np.nan
