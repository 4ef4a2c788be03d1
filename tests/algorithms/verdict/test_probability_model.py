"""How likely a merge is right: laws of the probability, whatever its weights are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.verdict.probability_model import (
    ENOUGH,
    OTHERS,
    QUANTITIES,
    Fit,
    log_odds,
    log_odds_over,
    misfit_of,
    probability,
    quantities_of,
    shipped_model,
)
from algorithms.verdict.wall_evidence import Evidence

MODEL, PLANE = shipped_model(), shipped_model("plane")
CLEAN = Evidence(100.0, 1.0, 98.0, 3.0, across=30.0, floor=60.0)
metres = st.floats(0, 500)
scores = st.floats(-40, 40)


@st.composite
def fits(draw: st.DrawFn) -> Fit:
    agreeing, contradicting = draw(metres), draw(metres)
    rigid = draw(st.floats(0, 1)) * agreeing
    found = Evidence(
        agreeing,
        contradicting,
        rigid,
        contradicting + draw(metres),
        across=draw(st.floats(0, 0.5)) * rigid,
        floor=draw(metres),
    )
    return Fit(found, draw(st.floats(0, 50)))


def likely(fit: Fit) -> float:
    return MODEL.score(quantities_of(fit))


def changed(fit: Fit, **evidence: float) -> Fit:
    return replace(fit, evidence=replace(fit.evidence, **evidence))


@given(fits(), st.floats(0, 100))
def test_more_contradiction_never_makes_a_merge_likelier(fit, more):
    e = fit.evidence
    assert likely(changed(fit, rigid_contradicting=e.rigid_contradicting + more)) <= likely(fit) + 1e-12
    assert likely(changed(fit, contradicting=e.contradicting + more)) <= likely(fit) + 1e-12


@given(fits(), st.floats(0, 100))
def test_more_agreement_more_floor_and_more_wall_across_never_make_it_less_likely(fit, more):
    e = fit.evidence
    assert likely(changed(fit, rigid_agreeing=e.rigid_agreeing + more)) >= likely(fit) - 1e-12
    assert likely(changed(fit, floor=e.floor + more)) >= likely(fit) - 1e-12
    assert likely(changed(fit, across=e.across + more)) >= likely(fit) - 1e-12


@given(fits(), st.floats(0, 50))
def test_lying_farther_from_the_sighting_never_makes_it_likelier(fit, more):
    assert likely(replace(fit, misfit=fit.misfit + more)) <= likely(fit) + 1e-12


@given(scores, st.lists(scores, max_size=5), scores)
def test_another_answer_never_makes_this_one_likelier(score, others, more):
    assert 0 <= probability(score, [*others, more]) <= probability(score, others) <= 1


@given(scores, scores)
def test_two_answers_are_never_certain_together(score, other):
    assert probability(score, [other]) + probability(other, [score]) <= 1 + 1e-9


@given(st.floats(ENOUGH, 40), st.floats(ENOUGH, 40))
def test_of_twins_that_both_fit_as_well_as_can_be_none_is_likelier_than_a_half(score, other):
    assert probability(score, [other]) <= 0.5


@given(fits(), fits(), metres, metres)
def test_how_wide_the_search_was_says_nothing_about_which_answer_fits(first, second, narrow, wide):
    told = []
    for searched in (narrow, wide):
        found = [quantities_of(replace(fit, searched=searched)) for fit in (first, second)]
        told.append(log_odds_over(*map(PLANE.score, found), PLANE.enough(found[0])))
    assert told[0] == pytest.approx(told[1], abs=1e-6)


@given(fits(), st.lists(fits(), max_size=3), metres, metres)
def test_a_wider_search_never_makes_a_merge_likelier_whatever_else_fits(fit, others, searched, more):
    def likely_among(searched: float) -> float:
        named, *rest = (quantities_of(replace(each, searched=searched)) for each in (fit, *others))
        return probability(PLANE.score(named), [PLANE.score(each) for each in rest], PLANE.enough(named))

    assert likely_among(searched + more) <= likely_among(searched) + 1e-9


@given(scores)
def test_without_others_it_is_the_logistic_function(score):
    assert probability(score) == pytest.approx(1 / (1 + np.exp(-score)), abs=1e-12)
    assert log_odds(score) == pytest.approx(score)


@given(fits(), st.lists(scores, max_size=4))
def test_the_contributions_add_up_to_the_log_odds(fit, others):
    quantities = quantities_of(fit)
    parts = MODEL.contributions(quantities, others)
    assert set(parts) == {*MODEL.weights, OTHERS}
    total = MODEL.typical_score + sum(parts.values())
    assert total == pytest.approx(log_odds(MODEL.score(quantities), others), abs=1e-6)


def test_a_typical_right_merge_is_likely_and_moves_nothing():
    assert probability(MODEL.typical_score) > 0.5
    assert all(abs(moved) < 1e-12 for moved in MODEL.contributions(MODEL.typical).values())


def test_a_clean_merge_is_nearly_certain_and_one_of_strangers_next_to_impossible():
    assert probability(likely(Fit(CLEAN, 1.0))) > 0.99
    strangers = Evidence(20.0, 15.0, 15.0, 25.0, across=4.0, floor=25.0)
    assert probability(likely(Fit(strangers, 3.0))) < 0.05


@given(st.lists(st.floats(0, 3.5), min_size=1, max_size=6), st.floats(0, 3.5))
def test_a_further_sighting_within_its_window_never_counts_against(deviations, another):
    assert misfit_of([*deviations, another], 3.5) <= misfit_of(deviations, 3.5) + 1e-9


@pytest.mark.parametrize("kind", ["sighting", "plane"])
def test_no_weight_goes_against_the_meaning_of_its_quantity(kind):
    for name, weight in shipped_model(kind).weights.items():
        assert weight * (1 if QUANTITIES[name].rises else -1) >= 0, name


def test_the_shipped_model_says_what_made_it_and_accepts_none_of_enough_wrong_pairs():
    made, accepted = MODEL.made_of["pairs"], MODEL.made_of["wrong_accepted_when_left_out"]
    assert made["other building"] >= 1000
    assert accepted["other building"] == 0
    assert "make verdict" in MODEL.made_of["command"]
    assert 0.5 <= MODEL.accept_from < 1


def test_every_quantity_is_told_in_one_sentence():
    for quantity in QUANTITIES.values():
        assert quantity.meaning.endswith(".")
        assert len(quantity.title) < 45


@given(st.floats(-1e6, 1e6), st.lists(st.floats(-1e6, 1e6), max_size=3))
def test_however_far_apart_answers_are_their_probability_is_a_number(score, others):
    assert 0 <= probability(score, others) <= 1


def test_a_metre_is_added_before_logarithms_so_that_a_few_cells_say_next_to_nothing():
    e = np.e
    bare = dict.fromkeys(QUANTITIES, 0.0)
    assert quantities_of(Fit(Evidence(0.0, 0.0, 0.0, 0.0), 0.0)) == bare
    found = Evidence(0.0, e**3 - 1, e - 1, e**2 - 1, across=e**4 - 1, floor=e - 1)
    told = quantities_of(Fit(found, 5.0, e**6 - 1))
    wanted = {"contradiction": 1.0, "unbent": 2.0, "across": 4.0, "misfit": 5.0, "searched": 6.0}
    assert told == pytest.approx(wanted)
