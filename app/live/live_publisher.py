"""What is told to the robots: the merged map, where each placed robot's map lies, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees

from algorithms.files.bags.message_types import DIAGNOSTICS
from algorithms.fleets.live_answer import LiveAnswer
from app.live.live_run import LiveRun
from app.live.map_source import SourceState
from app.live.message_fields import (
    ERROR,
    OK,
    STALE,
    WARN,
    diagnostics_message,
    grid_message,
    transforms_message,
)
from app.live.ros_link import TF, RosLink, Topic, map_topic
from app.system.clock import stamp

MAP = "/mapmeld/map"
EVERY = 1.0  # seconds between two diagnostics, as ROS expects them


class LivePublisher:
    """Publishes for one fleet, from when it is made."""

    def __init__(self, link: RosLink, topic: str = MAP) -> None:
        self._map = link.advertise(map_topic(topic))
        self._static = link.advertise(Topic("/tf_static", TF, latched=True, depth=1))
        self._diagnostics = link.advertise(Topic("/diagnostics", DIAGNOSTICS))
        self._told = float("-inf")
        self._lost: dict[str, str] = {}

    def publish(self, run: LiveRun, answer: LiveAnswer | None, now: float) -> None:
        """Tell an answer that is new, and every second how all are."""
        if answer is not None:
            self._answer(run, answer)
        if answer is not None or now - self._told >= EVERY:
            self._told = now
            self._diagnostics.send(diagnostics_message(self._states(run, now), stamp()))

    def _answer(self, run: LiveRun, answer: LiveAnswer) -> None:
        frames, time, placed = run.frames(), stamp(), answer.placed
        self._lost = {name: said for name, said in self._lost.items() if name not in placed}
        for event in answer.events:
            if event.robot not in placed:
                self._lost[event.robot] = event.said
        anchor = frames.get(run.anchor, "")
        below = [(anchor, frames[name], T) for name, T in placed.items() if name != run.anchor]
        self._static.send(transforms_message(below, time))
        if answer.result is not None:
            self._map.send(grid_message(answer.result.islands[0].fusion.merged, anchor, time))

    def _states(self, run: LiveRun, now: float) -> list[tuple[str, int, str, Mapping[str, str]]]:
        listed = []
        placed, result = run.answer.placed, run.answer.result
        for name, source in run.sources.items():
            state = source.state(now)
            values = {"state": state.value}
            if source.newest is not None:
                values["age of its map (s)"] = f"{now - source.newest.at:.1f}"
            if name in placed and result is not None:
                T, likely = placed[name], result.islands[0].probability[name]
                values["probability"] = f"{likely:.4f}"
                values["x (m)"], values["y (m)"] = f"{T.x:.3f}", f"{T.y:.3f}"
                values["turn (deg)"] = f"{degrees(T.theta):.2f}"
                fine = state == SourceState.LIVE
                level, said = (OK, "placed") if fine else (WARN, f"placed, and {state.value}")
            elif name in self._lost:
                level, said = ERROR, f"not placed: {self._lost[name]}"
            else:
                waits = state == SourceState.WAITING
                level, said = (STALE, "no map yet") if waits else (WARN, "not placed yet")
            listed.append((f"mapmeld: {name}", level, said, values))
        return listed
