"""The verdict on numbers that a person chooses."""

from __future__ import annotations

from dataclasses import replace

import pytest
import viser
from hypothesis import given, settings
from hypothesis import strategies as st
from strangers import standing

from algorithms.methods.registry import merge
from algorithms.verdict.decision import Outcome, VerdictConfig
from algorithms.verdict.probability_model import OTHERS
from app.page.panels.what_if_panel import DEVIATION, DIALS, OTHER, WhatIfPanel, numbers_of, supposed

RULES = VerdictConfig()
AGAINST = ("rigid_contradicting", "contradicting", DEVIATION, OTHER)
FOR = ("rigid_agreeing", "floor", "across")


def likely(result, **changed):
    return supposed(result, RULES, changed).probability


@pytest.fixture(scope="module")
def refused(strangers):
    return merge(strangers.ref, strangers.mov, strangers.observations)


@pytest.mark.parametrize("of", ["result", "refused"])
def test_with_no_number_changed_it_is_the_verdict_of_the_merge(of, request):
    result = request.getfixturevalue(of)
    told = supposed(result, RULES, {})
    assert told.probability == result.verdict.probability
    assert told.contributions == result.verdict.contributions
    assert told.quantities == result.verdict.quantities


@pytest.mark.parametrize("name", [*AGAINST, *FOR])
@given(values=st.tuples(st.floats(0, 99), st.floats(0, 99)))
@settings(max_examples=20)
def test_what_speaks_against_never_raises_the_likelihood_and_what_speaks_for_it_never_lowers_it(
    name, values, result
):
    less, more = (likely(result, **{name: value}) for value in sorted(values))
    assert (more <= less + 1e-12) if name in AGAINST else (more >= less - 1e-12)


def test_an_answer_as_likely_as_this_one_leaves_it_one_half_and_is_named(result):
    told = supposed(result, RULES, {OTHER: 99.9})
    assert told.probability == pytest.approx(0.5, abs=0.01)
    assert told.outcome is Outcome.REFUSED
    assert "180° apart" in told.reason
    assert supposed(result, RULES, {OTHER: 0.0}).contributions[OTHERS] == pytest.approx(0.0, abs=1e-9)


def test_without_other_answers_nothing_is_taken_from_a_refused_merge(refused):
    assert likely(refused, **{OTHER: 0.0}) >= refused.verdict.probability


def test_several_sightings_count_but_for_the_one_that_is_moved(small_case):
    (seen,) = small_case.observations
    wide = replace(seen, range=seen.range + 0.04)
    both = merge(small_case.ref, small_case.mov, (seen, wide))
    told = supposed(both, RULES, {DEVIATION: 5.0})
    assert told.deviation == pytest.approx(5.0)
    assert told.probability < both.verdict.probability


@pytest.fixture
def panel():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    with standing(server):
        panel = WhatIfPanel(server.gui, lambda: RULES)
        panel.research(True)
        yield panel


def test_the_sliders_begin_with_the_numbers_of_the_merge_whatever_its_size(panel, result):
    large = replace(
        result,
        weighed=(
            replace(result.weighed[0], evidence=replace(result.weighed[0].evidence, rigid_agreeing=1234.56)),
        ),
    )
    for each in (result, large, result):
        panel.offer(each)
        for name, value in numbers_of(each).items():
            handle = panel._handles[name]
            assert handle.value == pytest.approx(value, abs=DIALS[name].step / 2 + 1e-9)
            assert handle.max >= handle.value
    assert result.verdict.reason.split(".")[0] in panel._says.content


def test_a_moved_slider_changes_what_is_said_and_reset_takes_it_back(panel, result):
    panel.offer(result)
    before = panel._says.content
    panel._handles["contradicting"].value = 40.0
    panel._handles["rigid_contradicting"].value = 40.0
    assert "Refused" in panel._says.content
    panel.offer(result)
    assert panel._says.content == before


def test_without_a_merge_there_is_nothing_to_ask(panel, result):
    panel.offer(result)
    assert panel._folder.visible
    panel.research(False)
    assert not panel._folder.visible
    panel.research(True)
    assert panel._folder.visible
    panel.offer(None)
    assert not panel._folder.visible
    panel._handles["floor"].value = 3.0
