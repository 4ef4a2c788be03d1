"""Fitting the model of the verdict: weights that make the right answers of many pairs likely."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # its parts are loaded where they are first used

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import BoolArray
from algorithms.verdict.probability_model import QUANTITIES, ModelKind, VerdictModel, probability

RIDGE = 1e-3  # keeps weights finite where right and wrong can be told apart without error
FOLDS = 10
QUANTITIES_OF: dict[ModelKind, tuple[str, ...]] = {
    "sighting": ("contradiction", "unbent", "across", "misfit"),
    "plane": ("contradiction", "unbent", "across", "misfit", "searched"),
}


@dataclass(frozen=True, eq=False)
class Example:
    """A pair of maps on which the method ran.

    quantities : (A, Q) of every answer, in the order of QUANTITIES
    right      : (A,) bool, which of the answers are right; several where they are near each other
    buildings  : whose maps these are; two for a wrong pair
    """

    quantities: FloatArray
    right: BoolArray
    buildings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Forecast:
    """What a model says of examples: for each the probability of the answer that it names.

    probabilities : (N,)
    right         : (N,) bool, whether that answer is
    """

    probabilities: FloatArray
    right: BoolArray


def fit(
    examples: Sequence[Example],
    kind: ModelKind = "sighting",
    accept_from: float = 0.5,
    made_of: Mapping[str, Any] | None = None,
) -> VerdictModel:
    """The weights of greatest likelihood, none of them against the meaning of its quantity.

    In each example one answer is right, or none is: a choice among them with a way out (McFadden's
    conditional logit). Right answers beside the best of them are left out.
    """
    names = list(QUANTITIES_OF[kind])
    size, columns = len(names), [list(QUANTITIES).index(name) for name in names]
    rows: list[FloatArray] = []
    owner: list[int] = []
    chosen: list[int] = []
    for number, example in enumerate(examples):
        first = int(np.argmax(example.right)) if example.right.any() else -1
        for answer, quantities in enumerate(example.quantities):
            if answer == first:
                chosen.append(len(rows))
            if answer == first or not example.right[answer]:
                rows.append(quantities[columns])
                owner.append(number)
    table, whose, right = np.array(rows), np.array(owner), np.array(chosen, dtype=np.intp)
    middle, spread = table.mean(axis=0), table.std(axis=0) + 1e-9
    unit = np.column_stack([(table - middle) / spread, np.ones(len(table))])
    ridge = np.append(np.full(size, RIDGE), 0.0)

    def loss(weights: FloatArray) -> tuple[float, FloatArray]:
        scores = unit @ weights
        top = np.zeros(len(examples))
        np.maximum.at(top, whose, scores)
        likely = np.exp(scores - top[whose])
        total = np.exp(-top)
        np.add.at(total, whose, likely)
        likelihood = scores[right].sum() - (top + np.log(total)).sum()
        slope = unit[right].sum(axis=0) - unit.T @ (likely / total[whose])
        n = len(examples)
        return float(-likelihood / n + (ridge * weights**2).sum()), -slope / n + 2 * ridge * weights

    signs = [(0.0, None) if QUANTITIES[name].rises else (None, 0.0) for name in names]
    found = scipy.optimize.minimize(
        loss, np.zeros(size + 1), jac=True, bounds=[*signs, (None, None)], method="L-BFGS-B"
    ).x
    weights = found[:size] / spread
    typical = np.median(table[right], axis=0) if len(right) else middle
    return VerdictModel(
        weights=dict(zip(names, weights.tolist(), strict=True)),
        bias=float(found[size] - weights @ middle),
        typical=dict(zip(names, typical.tolist(), strict=True)),
        accept_from=accept_from,
        made_of={} if made_of is None else made_of,
    )


def predict(model: VerdictModel, examples: Sequence[Example]) -> Forecast:
    weights = np.array([model.weights.get(name, 0.0) for name in QUANTITIES])
    probabilities, right = [], []
    for example in examples:
        scores = example.quantities @ weights + model.bias
        best = int(scores.argmax())
        same = example.right & example.right[best]  # one right answer, told twice
        others = [score for k, score in enumerate(scores.tolist()) if k != best and not same[k]]
        enough = model.enough(dict(zip(QUANTITIES, example.quantities[best].tolist(), strict=True)))
        probabilities.append(probability(float(scores[best]), others, enough))
        right.append(bool(example.right[best]))
    return Forecast(np.array(probabilities), np.array(right, dtype=np.bool_))


def cross_validated(
    examples: Sequence[Example], kind: ModelKind = "sighting", folds: int = FOLDS
) -> Forecast:
    """What models say of examples from buildings that they have not seen, a fold of buildings at a time; of a
    wrong pair neither building is known.
    """
    names = sorted({building for example in examples for building in example.buildings})
    fold_of = {name: number % folds for number, name in enumerate(names)}
    left_out = [frozenset(fold_of[building] for building in example.buildings) for example in examples]
    probabilities = np.zeros(len(examples))
    right = np.zeros(len(examples), dtype=np.bool_)
    for out in sorted(set(left_out), key=sorted):
        mine = [n for n, theirs in enumerate(left_out) if theirs == out]
        rest = [example for example, theirs in zip(examples, left_out, strict=True) if not theirs & out]
        forecast = predict(fit(rest, kind), [examples[n] for n in mine])
        probabilities[mine], right[mine] = forecast.probabilities, forecast.right
    return Forecast(probabilities, right)


def most_likely_wrong(forecast: Forecast) -> float:
    """The highest probability that was told of a wrong answer; 0 where there is none."""
    return float(forecast.probabilities[~forecast.right].max(initial=0.0))
