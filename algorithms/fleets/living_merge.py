"""A merge that goes on while the robots' maps grow: what stands is held against every newer map, and what no
longer stands is taken back.

Nothing here waits: pairs are searched by whoever ``PairSearch`` gives them to, on the maps of that moment,
and what is found is held against the newest ones before anything rests on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import degrees
from typing import Protocol

import numpy as np

from algorithms.common.errors import SettingError, TooLargeError
from algorithms.common.pose import Pose2, pose_error
from algorithms.fleets.fleet_merge import FleetResult, joined
from algorithms.fleets.live_answer import (
    CORRECTED,
    RESTARTED,
    WITHDRAWN,
    LiveAnswer,
    LiveEvent,
    changes,
)
from algorithms.fleets.live_sightings import LiveSightings
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, known_of, pair_orders
from algorithms.fleets.pair_recheck import correction_between, denied_share, recheck
from algorithms.maps.grid_map import GridMap
from algorithms.methods.suggestions import MOST
from algorithms.observations.fleet import Fleet, FleetPrior, FleetSighting
from algorithms.observations.pair_problem import Known

MOST_OFTEN = 1.0  # seconds between two maps of one robot that are looked at
GROWN = 1.15  # times as many known cells: from then on a pair that was not accepted is searched again
CORRECTED_FROM = 0.03  # share of a map's walls that the next one denies: SLAM may have moved them
ANOTHER_FROM = (
    0.1  # of walls that are denied however the map is moved: nothing of the last one can be relied on
)
SHRUNK = 0.5  # of the known cells: a map that has fewer, and is another, was begun anew
UNSEARCHED = PairFinding(PairOrder("", "", ()), np.zeros(2), (), "it is still being searched")
Pair = tuple[str, str]
Key = tuple[str, str, tuple[Known, ...]]


class PairSearch(Protocol):
    """Searches pairs, somewhere else; one set of them at a time."""

    def start(self, fleet: Fleet, orders: Sequence[PairOrder]) -> None: ...

    def finished(self) -> list[PairFinding] | None:
        """What was found, once; None while it goes on, and where nothing was asked."""
        ...


class LivingMerge:
    """names : of all robots, in their order
    anchor : whose frame the answer is in; "" for the first
    known  : what is known of two robots beside sightings
    """

    def __init__(
        self,
        names: Sequence[str],
        search: PairSearch,
        anchor: str = "",
        sightings: Iterable[FleetSighting] = (),
        known: Sequence[FleetPrior] = (),
    ) -> None:
        self.names, self.anchor = tuple(names), anchor or names[0]
        self._search, self._priors = search, tuple(known)
        self._sightings = LiveSightings(sightings)
        self._maps: dict[str, GridMap] = {}
        self._waiting: dict[str, GridMap] = {}
        self._looked: dict[str, float] = {}
        self._found: dict[Key, PairFinding] = {}
        self._beginnings: dict[Key, tuple[Pose2, ...]] = {}  # of a search, not yet held against newer maps
        self._answers: dict[Pair, tuple[Pose2, ...]] = {}  # of all that is found of a pair, for what comes
        self._tried: dict[Key, int] = {}
        self._searched: tuple[Fleet, Mapping[str, int]] | None = None
        self._frames = dict.fromkeys(names, 0)  # how often each robot's frame has become another
        self._last = LiveAnswer(None, None, ())
        self._events: list[LiveEvent] = []
        self._changed = False

    # --- what comes -----------------------------------------------------------------------------------

    def take(self, name: str, grid: GridMap) -> None:
        """A robot's newest map; one that still waits is skipped."""
        self._waiting[name] = grid

    def see(self, sighting: FleetSighting) -> None:
        """One robot saw another; raises SettingError where one of them is none of ours."""
        for name in (sighting.observer, sighting.observed):
            if name not in self.names:
                raise SettingError(f"a sighting names {name!r}, which is no robot; there are {self.names}")
        self._changed |= self._sightings.add(sighting)

    def restart(self, name: str, said: str = "its SLAM has begun anew") -> None:
        """A robot's frame is another from now on: nothing that was known of it holds."""
        self._maps.pop(name, None)
        self._drop(name)
        self._sightings.forget(name)
        self._events.append(LiveEvent(name, RESTARTED, f"{said}; what was known of it is given up"))
        self._changed = True

    # --- what comes of it -----------------------------------------------------------------------------

    def step(self, now: float) -> LiveAnswer | None:
        """Look at what has come; None where that is nothing. ``now`` in seconds of any clock."""
        changed = {name for name in tuple(self._waiting) if self._is_due(name, now)}
        for name in sorted(changed):
            self._looked[name] = now
            self._renew(name, self._waiting.pop(name))
        found = self._collect()
        if not (changed or found or self._changed):
            return None
        self._changed = False
        if self.anchor not in self._maps or len(self._maps) < 2:
            return self._told(None, None)
        maps = {name: self._maps[name] for name in self.names if name in self._maps}
        seen = self._sightings.among(maps)
        priors = tuple(each for each in self._priors if {each.ref, each.mov} <= set(maps))
        fleet = Fleet(maps, seen, priors, self.anchor)
        orders = pair_orders(fleet)
        keys = [_key(fleet, order) for order in orders]
        findings = [
            self._finding(fleet, order, key, changed) for order, key in zip(orders, keys, strict=True)
        ]
        self._found = dict(zip(keys, findings, strict=True))
        for pair in {key[:2] for key in keys}:
            of_pair = [each for each in findings if (each.order.ref, each.order.mov) == pair]
            self._answers[pair] = _transforms(of_pair) or self._answers.get(pair, ())
        self._tried = {key: cells for key, cells in self._tried.items() if key in keys}
        try:
            answer = self._told(fleet, joined(fleet, findings))
        except TooLargeError as error:
            self._events.append(LiveEvent(self.anchor, WITHDRAWN, str(error)))
            answer = self._told(None, None)
        self._ask(fleet, orders, keys)
        return answer

    def _is_due(self, name: str, now: float) -> bool:
        return name not in self._looked or now - self._looked[name] >= MOST_OFTEN

    def _renew(self, name: str, grid: GridMap) -> None:
        """A robot's next map in the place of its last, and what SLAM has corrected between them."""
        old = self._maps.get(name)
        self._maps[name] = grid
        denied = 0.0 if old is None else denied_share(old, grid)
        if old is None or denied < CORRECTED_FROM:
            return
        T = correction_between(old, grid)
        if T is not None:
            moved = {pair: _moved(each, pair, name, T) for pair, each in self._answers.items()}
            self._drop(name)
            self._answers = moved
            self._sightings.move(name, T)
            metres, turn = pose_error(T, Pose2(), old.points.mean(axis=0))
            said = f"SLAM has moved its map by {metres:.2f} m and {degrees(turn):.1f}°"
            self._events.append(LiveEvent(name, CORRECTED, said))
        elif _known_cells(grid) < SHRUNK * _known_cells(old):
            self.restart(name)
            self._maps[name] = grid
        elif denied > ANOTHER_FROM:
            self._drop(name)
            said = "SLAM has changed its map beyond recognition; it is searched anew"
            self._events.append(LiveEvent(name, CORRECTED, said))

    def _drop(self, name: str) -> None:
        """Nothing that was found of a robot holds any more."""
        self._frames[name] += 1
        self._answers = {pair: each for pair, each in self._answers.items() if name not in pair}
        self._beginnings = {key: each for key, each in self._beginnings.items() if name not in key[:2]}
        self._found = {key: each for key, each in self._found.items() if name not in key[:2]}
        self._tried = {key: each for key, each in self._tried.items() if name not in key[:2]}

    def _collect(self) -> bool:
        """Take in what a search has found, but for robots whose frames have become others meanwhile."""
        found = self._search.finished()
        if found is None or self._searched is None:
            return False
        (fleet, frames), self._searched = self._searched, None
        for finding in found:
            key = _key(fleet, finding.order)
            if any(frames[name] != self._frames[name] for name in key[:2]):
                self._tried.pop(key, None)
            elif finding.hypotheses:
                self._beginnings[key] = tuple(each.T_ref_mov for each in finding.hypotheses)
            elif key not in self._found or not self._found[key].hypotheses:
                self._found[key] = finding
        return True

    def _finding(self, fleet: Fleet, order: PairOrder, key: Key, changed: set[str]) -> PairFinding:
        """What there is to say of a pair now: as before, or held against the newest maps."""
        before, searched = self._found.get(key), self._beginnings.pop(key, ())
        if before is not None and not searched and not {order.ref, order.mov} & changed:
            return replace(before, order=order)
        answers = searched or (() if before is None else _transforms([before]))
        if before is None and not searched:  # something new is known of them: what was found before may stand
            answers = self._answers.get((order.ref, order.mov), ())
            answers = answers or tuple(T.inverse() for T in self._answers.get((order.mov, order.ref), ()))
        if not answers:
            return replace(before or UNSEARCHED, order=order)
        now = recheck(fleet, order, answers)
        if before is not None and before.accepted and not now.accepted:
            self._tried.pop(key, None)
        return now

    def _ask(self, fleet: Fleet, orders: Sequence[PairOrder], keys: Sequence[Key]) -> None:
        """Have those pairs searched of which more is known than when they were last, or that have fallen."""
        if self._searched is not None:
            return
        wanted = []
        for order, key in zip(orders, keys, strict=True):
            cells = sum(_known_cells(fleet.maps[name]) for name in (order.ref, order.mov))
            grown = cells >= GROWN * self._tried.get(key, 0)
            if key not in self._tried or (grown and not self._found[key].accepted):
                self._tried[key] = cells
                wanted.append(order)
        if wanted:
            self._searched = fleet, dict(self._frames)
            self._search.start(fleet, wanted)

    def _told(self, fleet: Fleet | None, result: FleetResult | None) -> LiveAnswer:
        """The answer, with what has changed since the last one."""
        answer = LiveAnswer(fleet, result, ())
        answer = replace(answer, events=(*self._events, *changes(self._last, answer)))
        self._events, self._last = [], answer
        return answer


def _key(fleet: Fleet, order: PairOrder) -> Key:
    return order.ref, order.mov, known_of(fleet, order)


def _transforms(findings: Sequence[PairFinding]) -> tuple[Pose2, ...]:
    """T_ref_mov of all answers, the likeliest first; not more than one merge gives."""
    answers = sorted((each for f in findings for each in f.hypotheses), key=lambda each: -each.probability)
    return tuple(each.T_ref_mov for each in answers[:MOST])


def _moved(answers: Sequence[Pose2], pair: Pair, name: str, T: Pose2) -> tuple[Pose2, ...]:
    """T_ref_mov of a pair in the frame that a robot has after a correction, T_new_old."""
    ref, mov = (T if each == name else Pose2() for each in pair)
    return tuple(ref @ each @ mov.inverse() for each in answers)


def _known_cells(grid: GridMap) -> int:
    return int(np.count_nonzero(grid.cells >= 0))
