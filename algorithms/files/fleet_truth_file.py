"""The known answer of a fleet, and reading and writing the file that holds it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import radians
from pathlib import Path

from algorithms.common.pose import Pose2
from algorithms.files import yaml_fields as fields
from algorithms.files.map_file import read_bytes
from algorithms.files.yaml_fields import Fields, number_text, positive_number, quoted, shown


@dataclass(frozen=True)
class FleetTruth:
    """What is true of a fleet.

    T_anchor_robot : by name; takes points of a robot's frame to the anchor's
    at             : of each robot a point of its own frame where it is asked how near it was placed; metres
    islands        : groups of robots that no true sighting ties to the anchor
    lies           : numbers of the false sightings, from 0
    tolerance_m, tolerance_rad : how near counts as right, at that point
    """

    T_anchor_robot: Mapping[str, Pose2]
    at: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    islands: tuple[tuple[str, ...], ...] = ()
    lies: tuple[int, ...] = ()
    tolerance_m: float = 0.5
    tolerance_rad: float = radians(3)

    @property
    def loose(self) -> frozenset[str]:
        """Names of the robots that nothing true ties to the anchor."""
        return frozenset(name for island in self.islands for name in island)


def read_fleet_truth(path: Path) -> FleetTruth:
    """Read a fleet's truth file; raises InputFileError. Keys that we do not know are passed over."""
    path = Path(path)
    f = fields.parse(str(path), read_bytes(path, "a fleet's truth"), "a truth's YAML file")
    poses = f.section("T_anchor_robot", "add T_anchor_robot: {r2: {x: m, y: m, theta: rad}}")
    T = {name: _pose(poses.section(name, "give {x: m, y: m, theta: rad}")) for name in poses.values}
    at: dict[str, tuple[float, float]] = {}
    if "at" in f.values:
        places = f.section("at", "give {r2: [x, y]}")
        for name in places.values:
            x, y = places.pose(name, (2,), "give [x, y]; m")
            at[name] = x, y
    tolerance = Fields(f.source, {}, "tolerance.")
    if "tolerance" in f.values:
        tolerance = f.section("tolerance", "give {x_m: m, theta_rad: rad}")
    return FleetTruth(
        T_anchor_robot=T,
        at=at,
        islands=tuple(tuple(island) for island in _list(f, "islands")),
        lies=tuple(int(str(number)) for number in _list(f, "lies")),
        tolerance_m=positive_number(tolerance, "x_m", "m", 0.5),
        tolerance_rad=positive_number(tolerance, "theta_rad", "rad", radians(3)),
    )


def fleet_truth_to_bytes(truth: FleetTruth) -> bytes:
    """The content of a fleet's truth file; it reads back to equal values."""
    n = number_text
    lines = ["T_anchor_robot:"]
    for name, T in truth.T_anchor_robot.items():
        lines.append(f"  {quoted(name)}: {{x: {n(T.x)}, y: {n(T.y)}, theta: {n(T.theta)}}}")
    lines.append("at:  # of each robot a point of its own frame, where it is asked how near it was placed")
    lines += [f"  {quoted(name)}: [{n(x)}, {n(y)}]" for name, (x, y) in truth.at.items()]
    islands = ", ".join(f"[{', '.join(map(quoted, island))}]" for island in truth.islands)
    lines += [f"islands: [{islands}]", f"lies: [{', '.join(map(str, truth.lies))}]"]
    lines.append(f"tolerance: {{x_m: {n(truth.tolerance_m)}, theta_rad: {n(truth.tolerance_rad)}}}")
    return ("\n".join(lines) + "\n").encode()


def _pose(f: Fields) -> Pose2:
    units = {"x": "metres", "y": "metres", "theta": "radians"}
    return Pose2(*(f.number(key, f"give {unit}") for key, unit in units.items()))


def _list(f: Fields, key: str) -> list[str] | list[list[str]]:
    """A list of texts, or of lists of them; () where the key is missing."""
    value = f.values.get(key, [])
    kind = list if key == "islands" else str
    plain = isinstance(value, list) and all(isinstance(item, kind) for item in value)
    if not plain or (key == "lies" and not all(str(item).isdecimal() for item in value)):
        raise f.error(key, f"is {shown(value)}", "give a list, as [[r5, r6]] of islands and [3, 7] of lies")
    return list(value)
