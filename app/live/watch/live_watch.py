"""Robots that run, and their merge, as a series of pictures: of how they do, and what stands."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from threading import Event
from time import monotonic

from algorithms.common.errors import MapMergeError
from algorithms.fleets.fleet_merge import FleetResult
from algorithms.fleets.live_answer import WITHDRAWN, LiveAnswer, LiveEvent
from algorithms.fleets.living_merge import UNSEARCHED
from algorithms.observations.fleet import Fleet
from app.live.live_run import LiveRun
from app.live.map_source import FileSource, MapSource, ReceivedMap
from app.live.search_thread import SearchThread
from app.live.watch.running_robots import RunningRobots
from app.model.fleet_state import FleetState
from app.model.live.robot_state import RobotState

PAUSE = 0.05  # seconds between two looks at what has come
EVERY = 1.0  # seconds between two pictures
RATED = 10.0  # seconds over which a rate is taken
MOST_RATED = 1000  # maps that are counted


@dataclass(frozen=True, eq=False)
class LivePicture:
    """seconds : since it began
    robots : how each does
    state  : what stands, as a fleet; None before two robots have a map
    anew   : whether that is another than in the picture before
    events : since the picture before
    lost   : robots that had a place, and why they have none any more
    """

    seconds: float
    robots: Mapping[str, RobotState]
    state: FleetState | None
    anew: bool
    events: tuple[LiveEvent, ...]
    lost: Mapping[str, str]


class LiveWatch:
    """Of one run; ``step`` as often as one likes."""

    def __init__(self, run: LiveRun, name: str) -> None:
        self._run, self._name = run, name
        self._began: float | None = None
        self._watched = {each: _Watched(source) for each, source in run.sources.items()}
        self._state: FleetState | None = None
        self._lost: dict[str, str] = {}
        self._events: list[LiveEvent] = []
        self._anew = False
        self._told = float("-inf")

    def step(self, now: float) -> LivePicture | None:
        """Take in what has come; a picture, where it is time for one."""
        began = self._began = now if self._began is None else self._began
        update = self._run.step(now)
        self._events += update.events
        for rate in self._watched.values():
            rate.count(now)
        if update.answer is not None:
            self._take(update.answer)
        if now - self._told < EVERY:
            return None
        self._told = now
        robots = {name: rate.state(now) for name, rate in self._watched.items()}
        picture = LivePicture(
            now - began, robots, self._state, self._anew, tuple(self._events), dict(self._lost)
        )
        self._anew, self._events = False, []
        return picture

    def _take(self, answer: LiveAnswer) -> None:
        self._events += answer.events
        for event in answer.events:
            if event.kind == WITHDRAWN:
                self._lost[event.robot] = event.said
        self._lost = {name: said for name, said in self._lost.items() if name not in answer.placed}
        self._state, self._anew = state_of(answer, self._name), True


def state_of(answer: LiveAnswer, name: str) -> FleetState | None:
    """An answer as a fleet that a person can go on with; None where there is none."""
    if answer.fleet is None or answer.result is None:
        return None
    return state_from(answer.fleet, answer.result, name)


def state_from(fleet: Fleet, result: FleetResult, name: str) -> FleetState:
    """The same of its two parts."""
    state = FleetState(fleet, name, result=result)
    known = {state.key(each.order): each for each in result.findings if each.said != UNSEARCHED.said}
    return replace(state, found=known)


def pictures(robots: RunningRobots, name: str, stop: Event) -> Iterator[LivePicture]:
    """Follow robots until ``stop`` is set; raises MapMergeError where that cannot begin."""
    with closing(SearchThread()) as search, closing(robots):
        search.warm_up()
        watch = LiveWatch(robots.begin(search), name)
        while not stop.wait(PAUSE):
            now = monotonic()
            robots.step(now)
            picture = watch.step(now)
            if picture is not None:
                yield picture


class _Watched:
    """A source, and how often its map is another one."""

    def __init__(self, source: MapSource) -> None:
        self._source = source
        self._last: ReceivedMap | None = None
        self._times: deque[float] = deque(maxlen=MOST_RATED)

    def count(self, now: float) -> None:
        newest = self._source.newest
        if newest is not None and newest is not self._last:
            self._last = newest
            self._times.append(now)
        while self._times and now - self._times[0] > RATED:
            self._times.popleft()

    def state(self, now: float) -> RobotState:
        if isinstance(self._source, FileSource):
            return RobotState("file")
        newest = self._source.newest
        span = max(1.0, now - self._times[0]) if self._times else RATED
        rate = max(0, len(self._times) - 1) / span
        age, pose = None if newest is None else now - newest.at, None
        with suppress(MapMergeError):
            pose = self._source.pose()
        return RobotState(self._source.state(now).value, rate, age, pose)
