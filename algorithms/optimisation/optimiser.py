"""What every optimiser takes and yields: a value to maximise, a box, frozen snapshots."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.optimisation.search_box import SearchBox

Value = Callable[[FloatArray], FloatArray]  # (P, 3) poses -> (P,) values, the higher the better


@dataclass(frozen=True, eq=False)
class SearchState:
    """One iteration of an optimiser; its arrays are copies.

    poses, values         : (P, 3), (P,) of this iteration's particles or samples, in coordinates of
                            the box: where the pivot goes in metres, theta in radians, unwrapped
    own_poses, own_values : (P, 3), (P,) best that each particle has met; for samples, themselves
    best, best_value      : (3,) best met by anyone so far; never gets worse
    stopped               : why the search ended; None while it goes on
    pulls                 : (3, P, 3) what brought the particles here from where they stood one iteration
                            before: their own motion, the pull of the swarm's best, that of their own
                            best, each times ω, eq. (21); None before the first move, and for samples
    """

    iteration: int
    poses: FloatArray
    values: FloatArray
    own_poses: FloatArray
    own_values: FloatArray
    best: FloatArray
    best_value: float
    stopped: str | None = None
    pulls: FloatArray | None = None


Optimiser = Callable[..., Iterator[SearchState]]


def keep_inside(poses: FloatArray, box: SearchBox) -> FloatArray:
    """Put poses that left the box back on its border; a box of a whole turn has none in theta."""
    inside = np.clip(poses, box.low, box.high)
    if box.high[2] - box.low[2] >= 2 * pi:
        inside[:, 2] = box.low[2] + np.mod(poses[:, 2] - box.low[2], 2 * pi)
    return inside
