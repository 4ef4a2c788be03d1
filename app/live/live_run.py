"""A fleet that runs: everything that its robots send, and what the merge makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from algorithms.fleets.live_answer import LiveAnswer, LiveEvent
from algorithms.fleets.living_merge import LivingMerge, PairSearch
from app.live.live_fleet_file import LiveFleet, LiveRobot
from app.live.live_frames import LiveFrames
from app.live.map_source import FileSource, MapSource, ReceivedMap, SourceState, TopicSource
from app.live.ros_link import RosLink
from app.live.sighting_sources import SightingFolder, SightingTopic
from app.report.ros_transform import frame_names

REFUSED, SIGHTING = "refused", "sighting"
LOOK_EVERY = 1.0  # seconds between two looks into the folder of sightings

Links = Callable[[str], RosLink]
"""The link to robots at an address; "" for DDS."""


@dataclass(frozen=True, eq=False)
class LiveUpdate:
    """answer : where it is another than before, else None
    events : of the robots' sources; those of the answer stand in it
    """

    answer: LiveAnswer | None
    events: tuple[LiveEvent, ...]


class LiveRun:
    """names, sources and the answer of a fleet; each ``step`` takes in what has come."""

    def __init__(
        self, fleet: LiveFleet, links: Links, search: PairSearch, folder: Path | None = None
    ) -> None:
        self.names, self.anchor = tuple(fleet.robots), fleet.anchor
        self.answer = LiveAnswer(None, None, ())
        self._usual = dict(zip(self.names, frame_names(self.names), strict=True))
        self._frames: dict[tuple[str, str], LiveFrames] = {}
        self.sources = {name: self._source(name, robot, links) for name, robot in fleet.robots.items()}
        self._topics = [
            SightingTopic(links(robot.bridge), topic, one, other)
            for name, robot in fleet.robots.items()
            for seen, topic in robot.sees.items()
            if isinstance(one := self.sources[name], TopicSource)
            and isinstance(other := self.sources[seen], TopicSource)
        ]
        self._folder = None if folder is None else SightingFolder(folder, self.names)
        self._merge = LivingMerge(self.names, search, fleet.anchor, fleet.sightings, fleet.priors)
        self._taken: dict[str, ReceivedMap] = {}
        self._states: dict[str, SourceState] = {}
        self._refused = dict.fromkeys(self.names, "")
        self._looked = float("-inf")

    def step(self, now: float) -> LiveUpdate:
        """Take in what has come; ``now`` in seconds of a clock that only goes forward."""
        events: list[LiveEvent] = []
        for frames in self._frames.values():
            frames.poll()
        for name, source in self.sources.items():
            events += self._heard(name, source, now)
        found, wrong = [], []
        for topic in self._topics:
            seen, said = topic.poll(now)
            found, wrong = found + seen, wrong + said
        if self._folder is not None and now - self._looked >= LOOK_EVERY:
            self._looked = now
            seen, said = self._folder.poll()
            found, wrong = found + seen, wrong + said
        for each in found:
            self._merge.see(each)
            said_of = f"saw {each.observed} at {each.observation.range:.2f} m"
            events.append(LiveEvent(each.observer, SIGHTING, said_of))
        events += [LiveEvent(self.anchor, REFUSED, each) for each in wrong]
        answer = self._merge.step(now)
        self.answer = answer or self.answer
        return LiveUpdate(answer, tuple(events))

    def frames(self) -> dict[str, str]:
        """What each robot's map frame is called where all are told together: as the robot calls it, or by its
        name where two call theirs alike.
        """
        own = {name: source.newest.frame for name, source in self.sources.items() if source.newest}
        told = list(own.values())
        return {name: frame if told.count(frame) == 1 else self._usual[name] for name, frame in own.items()}

    def _source(self, name: str, robot: LiveRobot, links: Links) -> MapSource:
        if robot.grid is not None:
            return FileSource(name, robot.grid, self._usual[name])
        link, key = links(robot.bridge), (robot.bridge, robot.tf)
        if key not in self._frames:
            self._frames[key] = LiveFrames(link, robot.tf)
        base = robot.base or f"{self._usual[name].rpartition('/')[0]}/base_link"
        return TopicSource(name, link, robot.topic, self._frames[key], base)

    def _heard(self, name: str, source: MapSource, now: float) -> list[LiveEvent]:
        """Hand a robot's newest map on; what there is to say of it."""
        events = []
        source.poll(now)
        state, newest, before = source.state(now), source.newest, self._taken.get(name)
        if state != self._states.get(name, SourceState.WAITING):
            events.append(LiveEvent(name, state.value, _SAID[state]))
        if source.refused and source.refused != self._refused[name]:
            events.append(LiveEvent(name, REFUSED, f"its map: {source.refused}"))
        self._states[name], self._refused[name] = state, source.refused
        if newest is not None and newest is not before:
            if before is not None and before.frame != newest.frame:
                self._merge.restart(name, f"its frame is {newest.frame} now, and was {before.frame}")
            self._taken[name] = newest
            self._merge.take(name, newest.grid)
        return events


_SAID = {
    SourceState.WAITING: "no map yet",
    SourceState.LIVE: "its maps come",
    SourceState.STALE: "no map has come for a while; the last one stays",
    SourceState.GONE: "nobody publishes its map any more; the last one stays",
}
