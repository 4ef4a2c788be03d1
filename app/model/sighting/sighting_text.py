"""What was found in an image and a scan, in words and as data: the same for command line and page."""

from __future__ import annotations

from math import degrees
from typing import Any

from algorithms.detection.range_bearing import RobotPosition
from algorithms.detection.robot_sighting import Sighted, SightedRobots
from app.model.verdict_text import likelihood

CLASSES = {"front_back": "front or back", "side": "side", "robot": "robot"}


def class_name(label: str) -> str:
    """A class of a detector as people read it."""
    return CLASSES.get(label, label.replace("_", " "))


def position_text(seen: RobotPosition) -> str:
    """Range and bearing with their standard deviations."""
    side = "left" if seen.bearing >= 0 else "right"
    return (
        f"{seen.range:.3f} m ± {seen.sigma_range * 1000:.0f} mm away, "
        f"{abs(degrees(seen.bearing)):.2f}° ± {degrees(seen.sigma_bearing):.2f}° to the {side}"
    )


def box_text(number: int, one: Sighted) -> str:
    """One box in a line; numbers begin with 1."""
    said = f"box {number}: {class_name(one.detection.label)}, {likelihood(one.detection.probability)}"
    return f"{said}: {position_text(one.position)}" if one.position else f"{said}: refused, {one.why_not}"


def outcome_text(seen: SightedRobots) -> str:
    """What came of it, in a sentence."""
    if seen.position is None:
        return f"No sighting: {seen.reason}."
    return f"The robot is {position_text(seen.position)}."


def as_data(seen: SightedRobots) -> dict[str, Any]:
    """The same for other programs; metres, radians, pixels."""
    return {
        "found": seen.position is not None,
        "reason": seen.reason or None,
        "chosen": None if seen.chosen is None else seen.chosen + 1,
        "measurement": _position(seen.position),
        "boxes": [
            {
                "box": [round(edge, 1) for edge in one.detection.box()],
                "probability": one.detection.probability,
                "class": one.detection.label,
                "measurement": _position(one.position),
                "refused": one.why_not or None,
            }
            for one in seen.sighted
        ],
    }


def _position(seen: RobotPosition | None) -> dict[str, float] | None:
    if seen is None:
        return None
    return {
        "range": seen.range,
        "bearing": seen.bearing,
        "sigma_range": seen.sigma_range,
        "sigma_bearing": seen.sigma_bearing,
    }
