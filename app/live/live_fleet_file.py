"""The fleet file of robots that run: topics in the place of map files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from algorithms.common.errors import InputFileError
from algorithms.files.fleet_file import FLEET_FILE, MOST_BYTES, FleetParts, fleet_parts
from algorithms.files.map_file import read_bytes, read_map
from algorithms.files.yaml_fields import Fields, shown
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import FleetPrior, FleetSighting

LONGEST = 256  # letters of a topic, a frame or an address
KEYS = "topic", "base", "tf", "sees", "rosbridge"
EXAMPLE = "{topic: /r1/map}, or {map: FILE.yaml} of a robot that has done its work"


@dataclass(frozen=True, eq=False)
class LiveRobot:
    """topic : of its map; "" where it has done its work, and
    grid    : its map, from a file; None of one that runs
    base    : its own frame; "" for the usual one, NAME/base_link
    tf      : the topic of its transforms; that beside it, with _static, belongs to it
    sees    : of each robot that it sees, by name, the topic on which it says where
    bridge  : address of the rosbridge server by which it is reached; "" for DDS
    """

    topic: str = ""
    grid: GridMap | None = None
    base: str = ""
    tf: str = "/tf"
    sees: Mapping[str, str] = field(default_factory=dict)
    bridge: str = ""


@dataclass(frozen=True, eq=False)
class LiveFleet:
    """robots by name; what is known from the beginning; whose frame the result is in"""

    robots: Mapping[str, LiveRobot]
    sightings: tuple[FleetSighting, ...]
    priors: tuple[FleetPrior, ...]
    anchor: str


def read_live_fleet(path: Path | str) -> LiveFleet:
    """Read the fleet file, or fleet.yaml of a folder, and the maps that it names beside it.

    raises : InputFileError, TooLargeError
    """
    path = Path(path)
    if path.is_dir():
        path = path / FLEET_FILE
    parts = fleet_parts(str(path), read_bytes(path, "a fleet", MOST_BYTES))
    names = list(parts.robots)
    if not len(names) >= 2:
        raise InputFileError(path, f"names {len(names)} robots", "give at least 2")
    robots = {name: _robot(name, robot, names, path.parent) for name, robot in parts.robots.items()}
    return LiveFleet(robots, parts.sightings, parts.priors, _anchor(parts, names, path))


def _anchor(parts: FleetParts, names: list[str], path: Path) -> str:
    if parts.anchor and parts.anchor not in names:
        raise InputFileError(path, f"anchor names {parts.anchor!r}, which is no robot", "give one of them")
    return parts.anchor or names[0]


def _robot(name: str, robot: Fields, names: list[str], folder: Path) -> LiveRobot:
    if "map" in robot.values and "topic" not in robot.values:
        robot.refuse_unknown("map")
        return LiveRobot(grid=read_map(folder / robot.text("map", "give the map's YAML file")))
    robot.refuse_unknown(*KEYS)
    sees = {}
    if "sees" in robot.values:
        listed = robot.section("sees", "give {NAME: /topic} of robots that it sees")
        for other in listed.values:
            if other not in names or other == name:
                raise listed.error(
                    shown(other), "is none of the other robots", f"there are {', '.join(names[:8])}"
                )
            sees[other] = _short(listed, other, "give the topic of its sightings")
    return LiveRobot(
        topic=_short(robot, "topic", f"give {EXAMPLE}"),
        base=_short(robot, "base", "give the robot's own frame", ""),
        tf=_short(robot, "tf", "give the topic of its transforms", "/tf"),
        sees=sees,
        bridge=_short(robot, "rosbridge", "give ws://HOST:9090", ""),
    )


def _short(fields: Fields, key: str, remedy: str, usual: str | None = None) -> str:
    if usual is not None and key not in fields.values:
        return usual
    text = fields.text(key, remedy).strip()
    if len(text) > LONGEST or not text.isprintable() or " " in text:
        raise fields.error(key, "is no name that ROS knows", remedy)
    return text
