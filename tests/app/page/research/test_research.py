"""Comparisons and sweeps beside the page: background work, words, numbers of curves, what fields ask for."""

import os
from collections.abc import Iterator
from dataclasses import replace
from threading import Event, RLock
from time import monotonic, sleep

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from sweep_plans import SMALL, trials

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.common.setting_bounds import Bounds
from algorithms.methods.registry import METHODS
from app.drawing.palette import DARK, LIGHT
from app.drawing.svg.thumbnail import thumbnail
from app.evaluation.comparison_files import contest_archive
from app.evaluation.method_run import MethodRun
from app.evaluation.sweep.parameter_sweep import SweepAxis, SweepPlan, SweepPoint
from app.jobs import background_job as background
from app.jobs.background_job import BackgroundJob, beside_the_page
from app.jobs.executor import Task
from app.jobs.fair_semaphore import FairSemaphore
from app.model.run_state import RunState
from app.model.settings import settings_of, with_value
from app.page.research import sweep_curves as curves
from app.page.research.comparison_panel import Card, card_html
from app.page.research.heatmap import heat_svg
from app.page.research.other_result import OtherResult, outcome_of
from app.page.research.sweep_request import MOST_POINTS, Wanted, labelled, planned, suggestion

METHOD = "spectra-swarm"
DEFAULTS = METHODS[METHOD].defaults
SPREAD, PARTICLES = ("augment", "spread"), ("swarm", "particles")
FOUND = MethodRun((1.0, 2.0, 0.1), True, "Merged: fine.", 0.9, 0.04, 0.01, True, True, 1.5)
APART = replace(FOUND, distance=None, angle=None)  # nobody knows, or nobody can, how far off


def settled(check, what):
    end = monotonic() + 30
    while not check():
        assert monotonic() < end, what
        sleep(0.005)


# ---- work in the background


class Listener:
    def __init__(self):
        self.heard = []

    def say(self, words, share):
        self.heard.append(words.partition(":")[0])

    def part_done(self, part):
        self.heard.append(part)

    def ended(self, why):
        self.heard.append(("over", why))


@pytest.fixture
def work():
    listener = Listener()
    found = BackgroundJob(listener, RLock(), "test", listener.say)
    yield found, listener.heard
    found.stop()


def test_work_is_told_part_by_part_and_then_that_it_is_over(work):
    found, heard = work
    found.start(lambda _: (n for n in (1, 2)))
    settled(lambda: not found.busy, "its end")
    assert heard == ["Starting.", 1, 2, ("over", "")]


def test_what_goes_wrong_is_told_as_the_reason(work):
    found, heard = work

    def broken(_: Event) -> Iterator[int]:
        yield 1
        raise SettingError("the spread is too small")

    found.start(broken)
    settled(lambda: not found.busy, "its end")
    assert heard[-1] == ("over", "the spread is too small")


def test_nothing_is_told_once_work_was_stopped_and_it_is_left_at_once(work):
    found, heard = work
    left, told = Event(), Event()

    def endless(stop: Event) -> Iterator[int]:
        try:
            yield 1
            told.set()
            stop.wait(30)
            yield 2
        finally:
            left.set()

    found.start(endless)
    assert told.wait(30)
    assert found.stop()
    seen = list(heard)
    assert left.wait(30)
    assert heard == seen == ["Starting.", 1]
    assert not found.stop()


def test_only_so_many_work_at_once_and_one_that_waits_can_be_stopped(work, monkeypatch):
    found, heard = work
    turns = FairSemaphore(1, patience=0.0)
    monkeypatch.setattr(background, "_turns", turns)
    with turns.get():
        found.start(lambda _: (n for n in (1,)))
        settled(lambda: heard == ["Waits"], "the word that it waits")
        found.stop()
        found.start(lambda _: (n for n in (2,)))
    settled(lambda: not found.busy, "its end")
    assert heard[-3:] == ["Starting.", 2, ("over", "")]


def niceness(_, order):
    return os.nice(0)


def test_work_beside_the_page_gives_way_to_it():
    ((_, nice),) = beside_the_page(1).run(niceness, [Task(0)])
    assert nice > os.nice(0)


# ---- what came of a method


@given(trials)
def test_words_never_call_a_wrong_transform_right_and_always_tell_the_verdict(trial):
    told = outcome_of(trial)
    assert ("Wrong" in told.says) <= (trial.right is False)
    assert ("Right" in told.says) <= (trial.right is True)
    assert (told.mood == "plain") == (trial.failed or trial.T_ref_mov is None)
    assert trial.reason[1:] in told.verdict


@pytest.mark.parametrize(
    ("trial", "says"),
    [
        (FOUND, "✓ Right to 0.04 m, 0.6°"),
        (replace(FOUND, right=False, distance=18.11, angle=3.0), "✗ Wrong by 18.1 m, 172°"),
        (replace(APART, right=None), "Accepted."),
        (replace(APART, right=None, accepted=False), "Refused."),
        (replace(APART, right=None, bent=True), "Accepted, bent."),
        (replace(APART, right=False), "✗ Wrong: they share no place."),
        (replace(FOUND, T_ref_mov=None, right=False), "No transform found."),
        (replace(FOUND, T_ref_mov=None, right=None, failed=True), "Could not be run."),
    ],
)  # fmt: skip
def test_what_came_of_a_method_in_words(trial, says):
    assert outcome_of(trial).says == says


def test_only_a_card_with_a_merge_can_be_pressed_and_its_words_are_no_html():
    told = outcome_of(replace(FOUND, reason="Refused: <b>bent</b>."))
    merged = card_html(METHOD, Card(True, "done", told, picture="data:,"))
    assert "data-mm-show" in merged
    assert "<b>bent" not in merged
    for card in (
        Card(True),
        Card(True, "waits"),
        Card(True, "done", outcome_of(replace(FOUND, T_ref_mov=None))),
    ):
        assert "data-mm-show" not in card_html(METHOD, card)


def test_a_guest_lies_where_its_method_put_it_and_says_the_verdict(small_case):
    trial = replace(FOUND, right=False, accepted=False, reason="Refused: it does not fit.")
    guest = OtherResult(METHOD, DEFAULTS, 0, trial)
    story = guest.run(small_case.ref, small_case.mov, small_case.observations, RunState())
    assert story.answer == Pose2(1.0, 2.0, 0.1)
    for words in (guest.sentence(), guest.html()):
        assert "Wrong" in words
        assert "it does not fit" in words


def test_a_thumbnail_is_mostly_agreement_where_the_maps_fit_and_not_where_they_do_not(small_case):
    ref, mov, T = small_case.ref, small_case.mov, small_case.truth.T_ref_mov

    def share(pose, palette):
        pixels = thumbnail(ref, mov, pose, palette)
        assert pixels.shape == (156, 208, 3)
        agreed, conflict = (
            np.all(pixels == colour, axis=2).sum() for colour in (palette.agreed, palette.conflict)
        )
        return agreed / (agreed + conflict)

    for palette in (LIGHT, DARK):
        assert share(T, palette) > 0.9
        assert share(T @ Pose2(0.7, 0.4, 0.5), palette) < 0.5


def test_what_is_taken_away_is_what_the_command_leaves(small_case):
    from app.evaluation.method_comparison import ComparedRun

    packed = contest_archive(small_case, [ComparedRun("flat_1", METHOD, FOUND)], {METHOD: DEFAULTS}, 0)
    for name in (b"methods.csv", b"scores.csv", b"compare.json", b"maps_flat_1.png"):
        assert name in packed


# ---- what is asked for


SETTINGS = labelled(list(settings_of(DEFAULTS)))
LABEL = {setting.path: label for label, setting in SETTINGS.items()}


def wanted(path, low=1.0, high=4.0, count=3, by_factor=True):
    return Wanted(LABEL[path], low, high, count, by_factor)


@pytest.mark.parametrize("method", METHODS)
def test_every_setting_of_every_method_has_a_label_of_its_own_and_a_range_that_can_be_swept(method):
    config = METHODS[method].defaults
    settings = list(settings_of(config))
    named = labelled(settings)
    assert sorted(setting.path for setting in named.values()) == sorted(setting.path for setting in settings)
    for label, setting in named.items():
        low, high, by_factor = suggestion(setting, config)
        asked = planned(method, config, named, Wanted(label, low, high, 5, by_factor), None, (0,))
        assert len(asked.places()) >= 2


def test_fields_make_a_plan_of_values_by_factor_and_of_all_choices():
    asked = planned(METHOD, DEFAULTS, SETTINGS, wanted(SPREAD), wanted(("window", "kind")), (3, 4))
    assert asked.x == SweepAxis(SPREAD, (1.0, 2.0, 4.0))
    assert set(asked.y.values) == {"coupled", "encounter", "origin"}
    assert asked.seeds == (3, 4)


@pytest.mark.parametrize(
    ("x", "y", "says"),
    [
        (None, None, "no setting is chosen"),
        (wanted(SPREAD), wanted(SPREAD), "both settings are the same"),
        (wanted(SPREAD, 4.0, 1.0), None, "let it go up"),
        (wanted(SPREAD, 0.0, 1.0), None, "above 0"),
        (wanted(SPREAD, 1.0, 5000.0), None, "spread"),
        (wanted(SPREAD, count=60), wanted(PARTICLES, 10, 900, 60), f"more than {MOST_POINTS}"),
    ],
)  # fmt: skip
def test_what_cannot_be_swept_is_said_before_it_begins(x, y, says):
    with pytest.raises(SettingError, match=says):
        planned(METHOD, DEFAULTS, SETTINGS, x, y, (0,))


# ---- curves and fields


def point(x, y=None, index=0.5, seconds=1.0):
    return SweepPoint(x, y, (replace(FOUND, index=index, seconds=seconds),))


def swept(values, y=None):
    return SweepPlan(METHOD, SMALL, SweepAxis(SPREAD, tuple(values)), y, (0,))


spreads = st.lists(st.floats(0.2, 20.0).map(lambda v: round(v, 2)), min_size=1, max_size=9, unique=True)


@given(spreads.map(sorted), st.data())
def test_a_press_where_a_point_stands_is_a_press_on_it(values, data):
    plan = swept(values)
    there = data.draw(st.sets(st.sampled_from(range(len(values))), min_size=1))
    points = {n: point(values[n]) for n in there}
    for n in there:
        share = curves.share_of(plan.x, values[n])
        assert 0 < share < 1
        assert curves.nearest(plan, points, share) == n


@given(spreads, st.data())
def test_a_curve_rises_along_its_axis_and_holds_every_point_that_is_there(values, data):
    plan = swept(values)
    there = data.draw(st.sets(st.sampled_from(range(len(values)))))
    points = {n: point(values[n], index=n / 10) for n in there}
    here = min(there, default=None)
    x, high, low, middle, mark = curves.columns(plan, points, curves.AGREEMENT, here)
    if not there:
        assert len(x) == 2
        assert np.isnan(middle).all()
        return
    assert x.tolist() == sorted(values[n] for n in there)
    assert (low <= middle).all()
    assert (middle <= high).all()
    assert np.isfinite(mark).sum() == 1
    bottom, top = curves.height(plan, points, curves.AGREEMENT)
    assert bottom <= low.min()
    assert high.max() <= top
    assert top - bottom > 0.049


@given(st.floats(0.5, 5), st.floats(1.4, 2.0), st.integers(3, 6))
def test_values_by_equal_factors_stand_at_equal_steps(first, factor, count):
    values = tuple(first * factor**k for k in range(count))
    assume(values[-1] <= 20)
    axis = SweepAxis(SPREAD, values)
    steps = np.diff([curves.share_of(axis, value) for value in values])
    assert steps == pytest.approx(steps[0])


def test_a_field_shows_what_is_there_and_each_cell_can_be_pressed():
    plan = swept((1.0, 2.0), SweepAxis(("refine", "optimiser"), ("pso", "mco")))
    points = {0: point(1.0, "pso"), 3: point(2.0, "mco", index=0.9)}
    told = curves.field(plan, points, curves.AGREEMENT)
    assert np.isfinite(told).tolist() == [[True, False], [False, True]]
    svg = heat_svg(plan, points, curves.AGREEMENT, judged=True, here=3, palette=LIGHT)
    assert 'data-mm-point="0"' in svg
    assert 'data-mm-point="3"' in svg
    assert 'data-mm-point="1"' not in svg
    assert "90.0%" in svg
    assert "MCO" in svg


def test_a_suggested_range_goes_about_the_value_and_stays_within_bounds():
    setting = SETTINGS[LABEL[SPREAD]]
    assert isinstance(setting.bounds, Bounds)
    low, high, by_factor = suggestion(setting, with_value(DEFAULTS, SPREAD, 18.0))
    assert (low, high, by_factor) == (4.5, setting.bounds.high, True)
