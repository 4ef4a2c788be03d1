"""What a merge that goes on says, and what a person should know of how that has changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import degrees

from algorithms.common.pose import Pose2, pose_error
from algorithms.fleets.fleet_merge import FleetResult
from algorithms.observations.fleet import Fleet

SURE = 0.999  # more is not told: no model is as sure
MOVED, TURNED = 0.3, 0.02  # metres, radians (1.1°); by so much a robot's map moves without a word
PLACED, WITHDRAWN, CORRECTED, RESTARTED, SHIFTED = "placed", "withdrawn", "corrected", "restarted", "moved"


@dataclass(frozen=True)
class LiveEvent:
    """What a person should know: kind is one of those above."""

    robot: str
    kind: str
    said: str


@dataclass(frozen=True, eq=False)
class LiveAnswer:
    """What stands now.

    fleet, result : of the robots that have a map; None before there are two, the anchor one of them
    events : since the answer before
    """

    fleet: Fleet | None
    result: FleetResult | None
    events: tuple[LiveEvent, ...]

    @property
    def placed(self) -> Mapping[str, Pose2]:
        """T_anchor_robot of every robot that is placed, the anchor's included."""
        return {} if self.result is None else self.result.placed


def changes(before: LiveAnswer, now: LiveAnswer) -> Iterator[LiveEvent]:
    """How the places of robots have changed."""
    for name, T in before.placed.items():
        if name not in now.placed:
            yield LiveEvent(name, WITHDRAWN, _why(name, now.result))
        elif now.fleet is not None:
            middle = now.fleet.maps[name].corners().mean(axis=0)
            metres, turn = pose_error(T, now.placed[name], middle)
            if metres > MOVED or turn > TURNED:
                yield LiveEvent(name, SHIFTED, f"its map moves by {metres:.2f} m and {degrees(turn):.1f}°")
    for name in now.placed:
        if name not in before.placed and now.result is not None and name != now.result.islands[0].root:
            likely = now.result.islands[0].probability[name]
            yield LiveEvent(name, PLACED, f"its place is {min(likely, SURE):.1%} likely")


def _why(name: str, result: FleetResult | None) -> str:
    """Why a robot is no longer placed."""
    if result is None:
        return "there are no two maps, the anchor's one of them"
    if name in result.refused:
        return result.refused[name]
    reasons = [f.said for f in result.findings if name in (f.order.ref, f.order.mov) and not f.accepted]
    return reasons[0] if reasons else "nothing ties it to the anchor any more"
