"""Probabilities are what they say; fitting finds the weights that made the answers, with no sign turned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from model_fit import Example, Forecast, cross_validated, fit, most_likely_wrong, predict

from algorithms.verdict.calibration import brier_score, calibration_error, reliability
from algorithms.verdict.probability_model import QUANTITIES

NAMES = list(QUANTITIES)
SIGNS = np.array([1.0 if quantity.rises else -1.0 for quantity in QUANTITIES.values()])
WEIGHTS = SIGNS * np.array([0.9, 2.0, 1.2, 0.3, 0.6])
NEAR = len(NAMES) - 1  # quantities of answers near a sighting: all but the places searched
BIAS = -1.0


def made_up(count: int, seed: int = 0, answers: int = 3) -> list[Example]:
    """Pairs whose answers are right by the very rule that is fitted: one of them, or none."""
    rng = np.random.default_rng(seed)
    out = []
    for number in range(count):
        quantities = rng.normal(size=(answers, len(NAMES)))
        likely = np.exp(np.append(quantities @ WEIGHTS + BIAS, 0.0))
        chosen = rng.choice(answers + 1, p=likely / likely.sum())
        out.append(Example(quantities, np.arange(answers) == chosen, (str(number % 40),)))
    return out


def test_the_weights_that_made_the_answers_are_found_again():
    model = fit(made_up(4000), "plane")
    assert np.array([model.weights[name] for name in NAMES]) == pytest.approx(WEIGHTS, rel=0.15)
    assert model.bias == pytest.approx(BIAS, abs=0.15)


def test_a_model_of_answers_near_a_sighting_knows_nothing_of_the_places_searched():
    examples = made_up(400)
    model = fit(examples)
    assert list(model.weights) == NAMES[:NEAR]
    wider = [
        Example(each.quantities + np.eye(len(NAMES))[NEAR], each.right, each.buildings) for each in examples
    ]
    assert np.array_equal(predict(model, wider).probabilities, predict(model, examples).probabilities)


def test_what_is_told_of_buildings_left_out_is_calibrated():
    told = cross_validated(made_up(3000), "plane")
    assert calibration_error(told.probabilities, told.right) < 0.04


def test_no_weight_goes_against_its_meaning_even_where_the_examples_do():
    backwards = [Example(-each.quantities, each.right, each.buildings) for each in made_up(400)]
    weights = np.array([fit(backwards, "plane").weights[name] for name in NAMES])
    assert (weights * SIGNS >= 0).all()


def test_the_order_of_the_examples_does_not_matter():
    examples = made_up(300)
    there, back = fit(examples), fit(examples[::-1])
    assert there.weights == pytest.approx(back.weights, rel=1e-3)


def test_buildings_of_a_wrong_pair_are_both_left_out():
    """Examples of one building that contradict all others are told wrong only if they were left out."""
    examples = made_up(400)
    odd = [Example(each.quantities, ~each.right, ("odd", each.buildings[0])) for each in examples[:40]]
    told = cross_validated([*examples, *odd], folds=41)
    assert len(told.probabilities) == len(examples) + len(odd)


def test_right_answers_beside_each_other_do_not_compete():
    twice = np.ones((2, len(NAMES))) * SIGNS * 3
    model = fit(made_up(500))
    both = predict(model, [Example(twice, np.array([True, True]), ("a",))])
    one = predict(model, [Example(twice[:1], np.array([True]), ("a",))])
    rival = predict(model, [Example(twice, np.array([True, False]), ("a",))])
    assert both.probabilities == pytest.approx(one.probabilities)
    assert rival.probabilities[0] <= 0.5


def test_above_the_most_likely_wrong_answer_nothing_wrong_is_accepted():
    told = Forecast(np.array([0.2, 0.7, 0.9, 0.95]), np.array([False, False, True, True]))
    assert most_likely_wrong(told) == 0.7
    assert most_likely_wrong(Forecast(np.array([0.9]), np.array([True]))) == 0.0


probabilities = st.lists(st.floats(0, 1), min_size=1, max_size=60)


@given(probabilities, st.data())
def test_every_merge_is_in_one_bin_of_the_reliability_table(values, data):
    told = np.array(values)
    right = np.array(data.draw(st.lists(st.booleans(), min_size=len(values), max_size=len(values))))
    bins = reliability(told, right)
    assert sum(each.n for each in bins) == len(values)
    for each in bins:
        if each.n:
            assert each.low <= each.probability <= each.high
            assert 0 <= each.right <= 1
    assert 0 <= calibration_error(told, right) <= 1
    assert 0 <= brier_score(told, right) <= 1


def test_certainty_that_is_right_has_no_error_and_certainty_that_is_wrong_all_of_it():
    told = np.array([0.0, 1.0, 1.0])
    assert calibration_error(told, told > 0.5) == brier_score(told, told > 0.5) == 0
    assert calibration_error(told, told < 0.5) == brier_score(told, told < 0.5) == 1


def test_a_coin_that_is_called_a_coin_has_no_calibration_error():
    told, right = np.full(10, 0.5), np.arange(10) % 2 == 0
    assert calibration_error(told, right) == pytest.approx(0)
    assert brier_score(told, right) == pytest.approx(0.25)


def test_of_no_merges_nothing_is_told():
    nothing = np.zeros(0)
    assert np.isnan(calibration_error(nothing, nothing > 0))
    assert np.isnan(brier_score(nothing, nothing > 0))
