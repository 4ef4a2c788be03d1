"""How a robot that runs is doing, and what is said of it."""

from __future__ import annotations

from dataclasses import dataclass

from algorithms.common.pose import Pose2

MOODS = {"live": "accepted", "stale": "bent", "gone": "refused"}


@dataclass(frozen=True)
class RobotState:
    """state : waiting, live, stale or gone; of a map that stays as it is "file"
    rate  : maps a second
    age   : seconds since its newest map came; None before there is one
    pose  : T_map_robot; None where it is not known
    """

    state: str
    rate: float = 0.0
    age: float | None = None
    pose: Pose2 | None = None

    @property
    def mood(self) -> str:
        return MOODS.get(self.state, "idle")

    @property
    def told(self) -> str:
        """In a few words."""
        if self.state == "file":
            return "its map is from a file"
        if self.age is None:
            return "no map yet"
        if self.state == "live":
            return f"live, {self.rate:.1f} maps/s, the last {self.age:.0f} s ago"
        if self.state == "gone":
            return f"gone; its last map, {self.age:.0f} s old, stays"
        return f"{self.state} for {self.age:.0f} s; its last map stays"


def clock(seconds: float) -> str:
    """Minutes and seconds since the robots were first listened to: 1:05."""
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes}:{rest:02d}"
