"""Undo goes back to what was, redo to what was undone, and a reload finds both."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from gc import collect
from threading import enumerate as enumerate_threads
from weakref import ref

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.common.source_file import SourceFile
from algorithms.maps.grid_map import FREE, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from algorithms.methods.steps import Step
from algorithms.observations.observation import Observation
from app.model.merge_inputs import Files, MergeInputs, OtherFile, Upload
from app.model.run_state import RunState
from app.model.settings import with_value
from app.page.undo.history_panel import history_html, steps_html
from app.page.undo.page_snapshot import PageSnapshot, change
from app.page.undo.undo_history import MOST, PAUSE, SavedTab, UndoHistory
from app.web.session_store import SessionStore

ROOM = GridMap(np.full((40, 40), FREE, dtype=np.int8), 0.1)
SEEN = Observation(Pose2(), 0.1, 0.1, 0.1, 0.0)
START = PageSnapshot(
    MergeInputs.pair(ROOM, ROOM, (SEEN,), "rooms"),
    Files("rooms"),
    DEFAULT_METHOD,
    METHODS[DEFAULT_METHOD].defaults,
    0,
)


def seeded(seed: int) -> PageSnapshot:
    return replace(START, seed=seed)


def history(*desks: PageSnapshot, **how: int) -> UndoHistory:
    told = UndoHistory(**how)
    told.record("start", START, now=-1e9)
    for number, desk in enumerate(desks):
        told.record(f"{number}", desk, now=100.0 * number)
    return told


@given(st.lists(st.integers(-3, 3), max_size=30))
def test_undo_and_redo_walk_along_what_was_done_and_change_nothing(steps):
    desks = [START, *(seeded(k) for k in range(1, 6))]
    told, at = history(*desks[1:]), len(desks) - 1
    for by in steps:
        went = told.go(at + by)
        if went is not None:
            at += by
        assert (went is None) == (by == 0 or went is not desks[at])
        assert told.snapshot is desks[at]
    assert [step.snapshot for step in told.steps] == desks


def test_a_new_deed_forgets_what_was_undone():
    told = history(seeded(1), seeded(2))
    told.go(1)
    told.record("other", seeded(9))
    assert [step.snapshot.seed for step in told.steps] == [0, 1, 9]
    assert told.go(3) is None


def test_a_slider_that_moves_on_makes_one_entry_and_undo_goes_to_before_it():
    told = history()
    for k in range(1, 20):
        told.record(f"seed {k - 1} → {k}", seeded(k), "seed", now=10 + 0.3 * k)
    assert [step.label for step in told.steps] == ["start", "seed 0 → 19"]
    told.go(0)
    assert told.snapshot is START


@pytest.mark.parametrize("pause", [0.5 * PAUSE, 2 * PAUSE])
def test_a_pause_or_another_slider_begins_a_new_entry(pause):
    told = history()
    told.record("seed 0 → 1", seeded(1), "seed", now=10.0)
    told.record("seed 1 → 2", seeded(2), "seed", now=10.0 + pause)
    assert len(told.steps) == (2 if pause < PAUSE else 3)
    told.record("other", seeded(3), "other", now=10.0 + pause)
    assert len(told.steps) == (3 if pause < PAUSE else 4)


def test_what_was_gone_back_to_is_never_changed_by_moving_on():
    told = history()
    told.record("seed 0 → 1", seeded(1), "seed", now=10.0)
    told.record("x", seeded(5), "x", now=10.1)
    told.go(1)
    told.record("seed 1 → 2", seeded(2), "seed", now=10.2)
    assert [step.snapshot.seed for step in told.steps] == [0, 1, 2]


@given(st.integers(1, 3 * MOST), st.integers(2, 12))
@settings(max_examples=30)
def test_it_is_bounded_and_the_newest_stays(count, most):
    told = history(*(seeded(k) for k in range(1, count + 1)), most=most)
    assert len(told.steps) <= most
    assert told.snapshot.seed == count


@pytest.fixture
def outcome(result) -> RunState:
    """Of a merge of the room with itself."""
    story = RunState(START.config)
    story.add(Step("verdict", replace(result, fusion=fuse((ROOM, ROOM), (Pose2(), Pose2()))), 0.0))
    return story


def test_large_answers_of_long_ago_are_let_go_of_before_any_wish_is(outcome):
    desks = [replace(seeded(k), outcome=deepcopy(outcome)) for k in range(1, 6)]
    one = ROOM.cells.nbytes * 3  # of an answer; both maps come on top, once
    told = history(*desks, most_bytes=ROOM.cells.nbytes + 2 * one)
    assert len(told.steps) == 6
    assert [step.snapshot.result is not None for step in told.steps] == [False] * 4 + [True] * 2


def test_uploads_of_long_ago_are_let_go_of_where_they_are_too_many():
    files = [
        Files(
            "", {"yaml1": Upload("a", bytes(500))}, (OtherFile("b", "waits", upload=Upload("b", bytes(500))),)
        )
        for _ in range(5)
    ]
    told = history(*(replace(START, files=one) for one in files), most_bytes=ROOM.cells.nbytes + 2500)
    assert len(told.steps) == 2
    assert told.snapshot.files is files[-1]


def test_what_comes_out_belongs_to_the_entry_it_was_asked_at(outcome):
    told = history(seeded(1))
    told.amend(outcome)
    assert told.snapshot.result is not None
    told.go(0)
    assert told.snapshot.result is None
    told.go(1)
    assert told.snapshot.result is not None


def test_every_wish_has_a_name():
    config = with_value(START.config, ("augment", "spread"), 4.5)
    two = with_value(config, ("box", "sigma_x"), 2.0)
    other = MergeInputs.pair(ROOM, ROOM, (SEEN, SEEN), "rooms")
    grid = GridMap(ROOM.cells, 0.2)
    assert change(START, START)[0] == ""
    assert change(START, replace(START, config=config)) == (
        "σ_aug spread 4 → 4.5 m",
        ("augment", "spread"),
    )
    assert change(START, replace(START, config=two))[0] == "2 settings"
    assert change(START, seeded(3))[0] == "seed 0 → 3"
    assert change(START, replace(START, method="spectra-swarm"))[0].startswith("method: ")
    assert change(START, replace(START, inputs=other))[0] == "2 observations by hand"
    from_file = other.read_from(SourceFile.of("seen.yaml", b"x"))
    assert change(START, replace(START, inputs=from_file))[0] == "what is known from seen.yaml"
    assert change(START, replace(START, inputs=MergeInputs.pair(grid, ROOM, (), "b")))[0] == "load b"
    assert change(START, replace(START, inputs=MergeInputs()))[0] == "forget the files"
    assert change(START, replace(START, hand=Pose2(1, 2, 3)))[0] == "map 2 by hand"


def test_the_list_is_newest_first_marks_the_one_at_hand_and_escapes_names():
    told = history(seeded(1))
    told.record("load <script>", seeded(2))
    told.go(1)
    html = history_html(told)
    assert "<script>" not in html
    assert html.index('data-go="2"') < html.index('data-go="1"') < html.index('data-go="0"')
    assert html.count("aria-current") == 1
    assert html.index("aria-current") > html.index('data-go="1"')
    assert steps_html("", "merge").count("disabled") == 1
    assert "<b>" not in steps_html("<b>", "")


class Clock:
    now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def kept(seed: int = 0) -> SavedTab:
    return SavedTab(history(seeded(seed)).steps)


def test_a_tab_that_comes_back_in_time_finds_what_it_left(clock):
    keep = SessionStore(grace=10, clock=clock)
    left = kept()
    key, nothing = keep.enter("", False, lambda: left)
    assert nothing is None
    keep.leave(key)
    clock.now += 9
    fresh, found = keep.enter(key, False, kept)
    assert found is left
    assert fresh != key
    assert keep.enter(key, False, kept)[1] is None  # a key opens once


def test_a_tab_that_comes_back_too_late_begins_anew(clock):
    keep = SessionStore(grace=10, clock=clock)
    key, _ = keep.enter("", False, kept)
    keep.leave(key)
    clock.now += 10
    assert keep.enter(key, False, kept)[1] is None


def test_a_copy_of_a_tab_gets_nothing_while_the_tab_is_there(clock):
    keep = SessionStore(clock=clock)
    left = kept()
    key, _ = keep.enter("", False, lambda: left)
    assert keep.enter(key, False, kept)[1] is None
    keep.leave(key)
    assert keep.enter(key, False, kept)[1] is left


def test_a_page_that_connects_anew_takes_over_from_its_dead_connection(clock):
    keep = SessionStore(clock=clock)
    left = kept()
    key, _ = keep.enter("", False, lambda: left)
    fresh, found = keep.enter(key, True, kept)
    assert found is left
    keep.leave(key)  # the server notices at last that the old connection is dead
    assert keep.enter(key, False, kept)[1] is None
    keep.leave(fresh)
    assert keep.enter(fresh, False, kept)[1] is not None


def test_only_so_many_are_kept_and_the_longest_away_goes_first(clock):
    keep = SessionStore(most=3, clock=clock)
    keys = [keep.enter("", False, kept)[0] for _ in range(5)]
    for key in keys:
        keep.leave(key)
    assert [keep.enter(key, False, kept)[1] is not None for key in keys] == [False, False, True, True, True]


def test_what_nobody_came_back_for_is_let_go_of_by_one_timer_for_all(clock):
    before = sum(thread.name == "mapmeld-keep" for thread in enumerate_threads())
    keep = SessionStore(grace=10_000, clock=clock)
    left = kept()
    gone = ref(left)
    key, _ = keep.enter("", False, lambda box=[left]: box.pop())
    del left
    for _ in range(5):
        keep.leave(keep.enter("", False, kept)[0])
    keep.leave(key)
    assert sum(thread.name == "mapmeld-keep" for thread in enumerate_threads()) == before + 1
    assert gone() is not None
    clock.now += 10_000
    keep.sweep()
    collect()
    assert gone() is None


def test_keys_are_long_and_never_the_same():
    keep = SessionStore()
    keys = {keep.enter("", False, kept)[0] for _ in range(100)}
    assert len(keys) == 100
    assert min(map(len, keys)) >= 32
