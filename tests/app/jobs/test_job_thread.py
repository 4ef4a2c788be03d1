"""The worker of a tab: newest wins, Stop stops, every step is told, bugs don't end it."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event, Thread
from time import monotonic, sleep

import numpy as np
import pytest
from proofs import proof_state

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, GridMap
from algorithms.methods.steps import AnswersDetail, ObservationDetail, ProofDetail, RefineDetail, Step
from algorithms.observations.observation import Encounter, Observation
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation.optimiser import SearchState
from algorithms.optimisation.search_box import SearchBox
from app.jobs.job_thread import JobThread
from app.jobs.runner import Runner
from app.model.merge_job import MergeJob
from app.model.playback import DWELL, FRAME, InterruptibleWait, dwell

PATIENCE = 10.0  # seconds until a test gives up
ROOM = GridMap(np.full((4, 4), FREE, dtype=np.int8), 0.1)
SEEN = Observation(Pose2(), 0.1, 0.1, 0.1, 0.0)


def detail(number: float = 0.0) -> ObservationDetail:
    return ObservationDetail((Encounter(np.full(2, number), np.zeros(2), np.eye(2)),))


def job(config: object = None, **how) -> MergeJob:
    return MergeJob(ROOM, ROOM, (SEEN,), config, **how)


class Ear:
    """A listener that writes down what it hears."""

    def __init__(self) -> None:
        self.heard: list[tuple[str, object]] = []
        self.done = Event()
        self.shown = Event()

    def begun(self, job):
        self.heard.append(("begun", job.config))

    def show(self, job, story):
        self.heard.append(("show", story.last.detail.encounter.x_ref[0]))
        self.shown.set()

    def ending(self, job, story):
        self.heard.append(("ending", job.config))

    def ended(self, job, story):
        self.heard.append(("ended", job.config))
        self.done.set()

    def stopped(self, job, story):
        self.heard.append(("stopped", job.config))
        self.done.set()

    def failed(self, job, story, error):
        self.heard.append(("failed", error))
        self.done.set()


class Scripted(Runner):
    """Tells what it is given."""

    def __init__(self, run) -> None:
        self._run, self.closed = run, False

    def steps(self, job, asker, aside=False):
        yield from self._run(job)

    def close(self):
        self.closed = True


@pytest.fixture
def ear():
    return Ear()


@pytest.fixture
def start(ear):
    sessions = []

    def make(run, **more) -> JobThread:
        sessions.append(JobThread(ear, Scripted(run), **more))
        return sessions[-1]

    yield make
    for session in sessions:
        session.close()


def steps(*numbers: float):
    def run(_) -> Iterator[Step]:
        for number in numbers:
            yield Step("observe", detail(number), 0.0)

    return run


def test_a_run_is_told_from_begin_to_end(start, ear):
    start(steps(1.0)).request(job("a"))
    assert ear.done.wait(PATIENCE)
    assert ear.heard == [("begun", "a"), ("show", 1.0), ("ending", "a"), ("ended", "a")]


def test_at_no_pace_the_pictures_come_at_most_once_a_frame_and_the_newest_is_kept(start, ear):
    now = iter(np.arange(0, 1000, FRAME / 4))
    start(steps(*range(100)), clock=lambda: next(now)).request(job())
    assert ear.done.wait(PATIENCE)
    shown = [number for what, number in ear.heard if what == "show"]
    assert 1 < len(shown) < 60
    assert shown == sorted(shown)


def test_at_a_pace_every_step_that_is_meant_to_be_seen_is_shown(start, ear, monkeypatch):
    waited = []
    waiting = InterruptibleWait()
    monkeypatch.setattr(waiting, "wait", lambda seconds, mark: waited.append(seconds))
    start(steps(1, 2, 3), waiting=waiting, clock=lambda: 0.0).request(job(pace=2.0))
    assert ear.done.wait(PATIENCE)
    assert [number for what, number in ear.heard if what == "show"] == [1, 2, 3]
    assert waited == [2.0 * DWELL[ObservationDetail]] * 3


def test_a_newer_request_cuts_the_older_one_short_even_while_it_waits(start, ear):
    session = start(steps(*range(1000)))
    session.request(job("old", pace=100.0))  # fifty seconds on the first step
    assert ear.shown.wait(PATIENCE)
    session.request(job("new"))
    assert ear.done.wait(PATIENCE)
    assert ("ended", "old") not in ear.heard
    assert ear.heard[-1] == ("ended", "new")


def test_of_many_requests_the_newest_wins(start, ear):
    held, entered = Event(), Event()

    def run(job) -> Iterator[Step]:
        entered.set()
        held.wait(PATIENCE)
        yield Step("observe", detail(), 0.0)

    session = start(run)
    session.request(job(0))
    assert entered.wait(PATIENCE)
    for number in range(1, 50):
        session.request(job(number))
    held.set()
    assert ear.done.wait(PATIENCE)
    assert [config for what, config in ear.heard if what == "ended"] == [49]
    assert sum(what == "begun" for what, _ in ear.heard) == 2  # the first, and the newest


def test_nothing_of_a_run_is_told_once_stop_has_returned(start, ear):
    session = start(steps(*range(100_000)))
    session.request(job("a", pace=100.0))
    assert ear.shown.wait(PATIENCE)
    session.stop()
    heard = list(ear.heard)
    assert heard[-1] == ("stopped", "a")
    assert not session.busy
    session.request(job("b", pace=100.0))
    ear.shown.clear()
    assert ear.shown.wait(PATIENCE)
    assert [config for what, config in ear.heard[len(heard) :] if what == "begun"] == ["b"]


def test_what_is_worked_out_at_the_end_keeps_nobody_from_stopping(start, ear, monkeypatch):
    at_it, held = Event(), Event()

    def ending(job, story):
        at_it.set()
        held.wait(PATIENCE)

    monkeypatch.setattr(ear, "ending", ending)
    session = start(steps(1.0))
    session.request(job("a"))
    assert at_it.wait(PATIENCE)
    session.stop()  # returns at once
    assert ear.heard[-1] == ("stopped", "a")
    held.set()
    ear.done.clear()
    session.request(job("b"))
    assert ear.done.wait(PATIENCE)
    assert ("ended", "a") not in ear.heard


def test_an_end_that_is_being_told_is_not_unsaid_by_stop(start, ear, monkeypatch):
    stops, told = [], ear.ended

    def ended(job, story):
        stops.append(Thread(target=session.stop))
        stops[0].start()
        while session.busy:  # until Stop waits for the drawing to be done
            sleep(0.001)
        told(job, story)

    monkeypatch.setattr(ear, "ended", ended)
    session = start(steps(1.0))
    session.request(job("a"))
    assert ear.done.wait(PATIENCE)
    stops[0].join(PATIENCE)
    assert ear.heard[-1] == ("ended", "a")


def test_stop_without_a_run_says_nothing(start, ear):
    start(steps(1)).stop()
    assert ear.heard == []


@pytest.mark.parametrize("error", [MapMergeError("a.yaml: is empty; give a map"), ZeroDivisionError("bug")])
def test_an_error_is_told_and_the_session_lives_on(start, ear, error, caplog):
    def run(job) -> Iterator[Step]:
        if job.config == "bad":
            raise error
        yield Step("observe", detail(), 0.0)

    session = start(run)
    session.request(job("bad"))
    assert ear.done.wait(PATIENCE)
    assert ear.heard[-1] == ("failed", error)
    assert bool(caplog.records) == (not isinstance(error, MapMergeError))  # a bug leaves its traceback
    ear.done.clear()
    session.request(job("good"))
    assert ear.done.wait(PATIENCE)
    assert ear.heard[-1] == ("ended", "good")


def test_a_closed_session_ends_its_thread(start, ear):
    session = start(steps(*range(1000)))
    session.request(job(pace=100.0))
    assert ear.shown.wait(PATIENCE)
    session.close()
    session._worker.join(PATIENCE)
    assert not session._worker.is_alive()
    assert session.runner.closed


def test_known_steps_are_played_again_only_when_asked_for():
    known = Step("observe", detail(), 0.0, reused=True)
    assert dwell(known, 1.0, again=False) == 0
    assert dwell(known, 1.0, again=True) == DWELL[ObservationDetail]
    assert dwell(known, 0.0, again=True) == 0


def test_a_cut_before_the_wait_is_not_missed():
    waiting = InterruptibleWait()

    def waited(seconds: float, mark: int) -> float:
        begun = monotonic()
        waiting.wait(seconds, mark)
        return monotonic() - begun

    mark = waiting.mark
    assert waited(0.2, mark) >= 0.2
    waiting.cut()
    assert waited(PATIENCE, mark) < PATIENCE / 2
    assert waited(0.2, waiting.mark) >= 0.2  # a cut ends the waits that had begun, and no later one


def test_the_first_iterations_of_the_swarm_are_told_slowest():
    def stay(index: int, iteration: int) -> float:
        zero = np.zeros((1, 3))
        state = SearchState(iteration, zero, zero[0, :1], zero, zero[0, :1], zero[0], 0.0)
        box = SearchBox(zero[0], zero[0], np.zeros(2))
        return dwell(Step("refine", RefineDetail(index, 4, box, state), 0.0), 1.0, again=False)

    assert stay(0, 0) > stay(0, 5) > stay(0, 50) > stay(1, 0) > 0


@pytest.mark.parametrize("looks", [8, 15, 25, 50])
def test_a_proof_is_told_in_about_a_second_however_many_looks_it_takes(looks):
    def stay(nodes: int) -> float:
        step = Step("prove", ProofDetail(proof_state(nodes=nodes), coupled_window([], WindowConfig())), 0.0)
        return dwell(step, 1.0, again=False)

    told = [stay(1600 * (look + 1)) for look in range(looks)]
    assert told == sorted(told, reverse=True)
    assert 0.5 < sum(told) < 1.6


def test_a_new_speed_holds_from_the_step_at_hand_on(start, ear):
    session = start(steps(1, 2, 3))
    session.request(job("a", pace=1000.0))
    assert ear.shown.wait(PATIENCE)
    session.set_pace(1e-6)
    assert ear.done.wait(PATIENCE)
    assert ear.heard[-1] == ("ended", "a")


def test_before_the_first_merge_a_run_ends_at_the_candidates(start, ear):
    def run(_) -> Iterator[Step]:
        yield Step("observe", detail(), 0.0)
        yield Step("search", AnswersDetail(()), 0.0)
        raise AssertionError("nobody asked for more")

    start(run).request(job("a", goal="candidates"))
    assert ear.done.wait(PATIENCE)
    assert ear.heard[-1] == ("ended", "a")
