"""The numbers of a look at a picture that a text of the lesson may hold."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot

from algorithms.detection.range_bearing import RobotPosition
from app.model.sighting.sighting_text import class_name
from app.model.verdict_text import likelihood
from app.page.lesson.figures.camera_figure import angle_text, box_of, half_width
from app.page.lesson.figures.laser_figure import mean_of
from app.page.lesson.sighting_look import CameraReading, SightingLook

NONE = "–"


def _whose(look: SightingLook) -> str:
    saw = f"what robot 1 of *{look.name}* saw when it had turned to robot 2."
    if look.own:
        return f"This is {saw}"
    return f"The loaded maps come without a camera's picture, so this is of another sample: {saw}"


def _bearing(look: SightingLook, reading: CameraReading) -> float:
    """Of the middle of the box; radians."""
    return reading.bearing(*box_of(look).detection.middle)


def _away(look: SightingLook) -> float:
    """Of the mean of the points; metres."""
    cluster = box_of(look).cluster
    return float("nan") if cluster is None else hypot(*mean_of(look, cluster))


def _things(look: SightingLook) -> str:
    count = len(look.things)
    return "one thing stands" if count == 1 else f"{count} things stand"


def _measured(words: Callable[[SightingLook, RobotPosition], str]) -> Callable[[SightingLook], str]:
    """Words about the centre; a dash where the laser has refused the box."""

    def told(look: SightingLook) -> str:
        seen = box_of(look).position
        return NONE if seen is None else words(look, seen)

    return told


def _beams(look: SightingLook) -> str:
    cluster = box_of(look).cluster
    return "no" if cluster is None else str(len(cluster.beams))


def _counted_off(look: SightingLook) -> str:
    return angle_text(abs(_bearing(look, look.counted) - _bearing(look, look.calibrated)))


def _class(look: SightingLook) -> str:
    name = class_name(box_of(look).detection.label)
    return "a robot" if name == "robot" else f"a robot's {name}"


SIGHTING_NUMBERS: dict[str, Callable[[SightingLook], str]] = {
    "whose_picture": _whose,
    "box_class": _class,
    "box_chance": lambda look: likelihood(box_of(look).detection.probability),
    "box_half": lambda look: angle_text(half_width(look)),
    "camera_bearing": lambda look: angle_text(_bearing(look, look.calibrated)),
    "counted_bearing": lambda look: angle_text(_bearing(look, look.counted)),
    "counted_off": _counted_off,
    "depth_things": _things,
    "robot_sized": lambda look: str(len(look.robot_sized)),
    "beams_on_it": _beams,
    "beam_spacing_cm": lambda look: f"{100 * _away(look) * abs(look.scan.angle_increment):.1f}",
    "range_noise_mm": lambda look: f"{1000 * look.scan.noise():.0f}",
    "mean_range_m": lambda look: f"{_away(look):.3f}",
    "centre_range_m": _measured(lambda look, seen: f"{seen.range:.3f}"),
    "centre_sigma_m": _measured(lambda look, seen: f"{seen.sigma_range:.3f}"),
    "centre_bearing": _measured(lambda look, seen: angle_text(seen.bearing)),
    "centre_bearing_sigma": _measured(lambda look, seen: angle_text(seen.sigma_bearing)),
    "behind_cm": _measured(lambda look, seen: f"{100 * (seen.range - _away(look)):.0f}"),
}
"""Of a look that has found a box."""
