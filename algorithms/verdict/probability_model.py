"""How likely a merge is right: a few quantities, a weight each, and the answers that compete for being right.

Every answer gets a score s = b + Σ w_k q_k. Of the answers that the search knows, one is right, or none is:

    P(answer i is right) = exp(s_i) / (1 + Σ_j exp(s_j))

Without others this is plain logistic regression. Beyond a score of ``ENOUGH`` an answer fits as well as any,
and is not held to be likelier than another one of which that is true as well: a twin with less wall in common
halves the probability. How wide the search was raises or lowers all scores alike, and that score with them:
it says nothing about which of the answers fits. The weights are those of ``probability_model.json``, which
says what made them: ``make verdict`` fits them to simulated pairs (``tests/tools/model_fit.py``).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import exp, log
from pathlib import Path
from typing import Any, Literal

import numpy as np

from algorithms.verdict.wall_evidence import Evidence

ModelKind = Literal["sighting", "plane"]
"""Answers near a sighting, or those of a search over all that any knowledge, or none, leaves of the plane."""

MODEL_FILE = Path(__file__).with_name("probability_model.json")
ENOUGH = 4.0  # log-odds, 98 %
LITTLE = 1.0  # metres and m² added before logarithms: a few cells more or less say next to nothing


@dataclass(frozen=True)
class Fit:
    """What is known of an answer.

    evidence : what the walls of the whole maps say
    misfit   : squared standard deviations by which it misses the sightings, as ``misfit_of`` adds them up
    searched : shifts among which it was found, averaged over the whole circle of turns; m²
    """

    evidence: Evidence
    misfit: float
    searched: float = 0.0


@dataclass(frozen=True)
class Quantity:
    """One number that the probability rests on.

    title   : what a person reads beside its bar
    meaning : one sentence on it
    rises   : whether more of it speaks for the merge
    of      : takes it from what is known
    """

    title: str
    meaning: str
    rises: bool
    of: Callable[[Fit], float]


def _log(value: float) -> float:
    return log(value + LITTLE)


QUANTITIES: dict[str, Quantity] = {
    "contradiction": Quantity(
        "wall that contradicts",
        "Wall of one map on free floor of the other, against wall that both have in one place.",
        False,
        lambda fit: _log(fit.evidence.rigid_contradicting) - _log(fit.evidence.rigid_agreeing),
    ),
    "unbent": Quantity(
        "left when patches slip",
        "Contradicting wall that is left when every patch of 7 m may slip by 0.6 m to where it fits best, "
        "against the floor that both robots saw.",
        False,
        lambda fit: _log(fit.evidence.contradicting) - _log(fit.evidence.floor),
    ),
    "across": Quantity(
        "agreeing wall across the others",
        "Wall in one place that runs across the direction of most of it: along a corridor nothing else keeps "
        "map 2 from sliding.",
        True,
        lambda fit: _log(fit.evidence.across),
    ),
    "misfit": Quantity(
        "robot 2 from where it was seen",
        "Squared distance of robot 2 from where it was seen, in standard deviations of the sighting.",
        False,
        lambda fit: fit.misfit,
    ),
    "searched": Quantity(
        "places searched",
        "Shifts that what is known leaves open, averaged over the circle of turns: among more of them more "
        "wrong ones fit by chance.",
        False,
        lambda fit: _log(fit.searched),
    ),
}
"""Logarithms of metres and m², but for the misfit."""

WIDTH = "searched"  # the quantity that all answers of a search share
OTHERS = "others"  # beside the quantities: what other answers take away


def misfit_of(deviations: Sequence[float], k: float) -> float:
    """Squared deviations of an answer from its sightings, added up.

    Without any it is 0. Every sighting but one first gives k²: that an answer agrees with a second one at
    all, to k standard deviations, is worth as much as lying right on the first instead of at the edge of its
    window.
    """
    squares = sum(deviation**2 for deviation in deviations)
    return squares - max(0, len(deviations) - 1) * k**2


@dataclass(frozen=True)
class VerdictModel:
    """Weights of the quantities.

    weights     : log-odds per unit of each quantity
    bias        : log-odds where all are 0
    typical     : what each is in the middle of the right merges of the fit
    accept_from : probability from which on none of the wrong pairs of the fit was accepted
    made_of     : what it was fitted to
    """

    weights: Mapping[str, float]
    bias: float
    typical: Mapping[str, float]
    accept_from: float
    made_of: Mapping[str, Any]

    def score(self, quantities: Mapping[str, float]) -> float:
        """Log-odds of an answer that has no other beside it."""
        return self.bias + sum(weight * quantities[name] for name, weight in self.weights.items())

    def contributions(
        self, quantities: Mapping[str, float], others: Sequence[float] = ()
    ) -> dict[str, float]:
        """By how much each quantity moves the log-odds away from those of a typical right merge, and by how
        much other answers of these scores do; with ``typical_score`` they add up to the log-odds.
        """
        moved = {
            name: weight * (quantities[name] - self.typical[name]) for name, weight in self.weights.items()
        }
        score = self.score(quantities)
        return {**moved, OTHERS: log_odds(score, others, self.enough(quantities)) - score}

    def enough(self, quantities: Mapping[str, float]) -> float:
        """Score from which on an answer of such a search fits as well as any."""
        if WIDTH not in self.weights:
            return ENOUGH
        return ENOUGH + self.weights[WIDTH] * (quantities[WIDTH] - self.typical[WIDTH])

    @property
    def typical_score(self) -> float:
        """Log-odds of a typical right merge."""
        return self.score(self.typical)


def quantities_of(fit: Fit) -> dict[str, float]:
    return {name: quantity.of(fit) for name, quantity in QUANTITIES.items()}


def probability(score: float, others: Sequence[float] = (), enough: float = ENOUGH) -> float:
    """That the answer of this score is right, where others have these scores; ``enough``: VerdictModel's."""
    return 1 / (1 + exp(-max(-700.0, log_odds(score, others, enough))))


def log_odds(score: float, others: Sequence[float] = (), enough: float = ENOUGH) -> float:
    """The same as log-odds."""
    against = [-score, *(log_odds_over(other, score, enough) for other in others)]
    return -float(np.logaddexp.reduce(np.array(against)))


def log_odds_over(score: float, other: float, enough: float = ENOUGH) -> float:
    """Log-odds of one answer over another, by their scores; of the worse of two as far as it is worse."""
    return score - other if score >= other else min(score, enough) - min(other, enough)


def model_from(plain: Mapping[str, Any]) -> VerdictModel:
    return VerdictModel(
        weights={name: float(weight) for name, weight in plain["weights"].items()},
        bias=float(plain["bias"]),
        typical={name: float(value) for name, value in plain["typical"].items()},
        accept_from=float(plain["accept_from"]),
        made_of=plain["made_of"],
    )


@cache
def shipped_model(kind: ModelKind = "sighting") -> VerdictModel:
    """The model that comes with mapmeld for answers found so."""
    return model_from(json.loads(MODEL_FILE.read_text(encoding="utf-8"))[kind])
