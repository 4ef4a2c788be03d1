"""The fleet file: robots, their maps, and who saw whom."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from textwrap import indent

from algorithms.common.errors import InputFileError, SettingError
from algorithms.files import yaml_fields as fields
from algorithms.files.map_file import read_bytes, read_map
from algorithms.files.observation_file import SIGHTING, initial_pose, known_to_bytes, observation_of
from algorithms.files.yaml_fields import Fields, quoted, shown
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import (
    MOST_ROBOTS,
    MOST_SIGHTINGS,
    NAME_RULE,
    Fleet,
    FleetSighting,
    is_name,
)
from algorithms.observations.priors import InitialPose

FLEET_FILE = "fleet.yaml"
MOST_BYTES = 320_000  # of the file: a thousand sightings take less
OF_A_PAIR = r"  # [^\n]*\brobot [12]\b[^\n]*"  # remarks on two robots that have no names
EXAMPLE = "robots: {r1: {map: r1.yaml}, r2: {map: r2.yaml}}"


def read_fleet(path: Path | str) -> Fleet:
    """Read a fleet file, or fleet.yaml of a folder, and the maps that it names beside it.

    raises : InputFileError, TooLargeError
    """
    path = Path(path)
    if path.is_dir():
        path = path / FLEET_FILE
    content = read_bytes(path, "a fleet", MOST_BYTES)
    return fleet_from_bytes(str(path), content, lambda file: read_map(path.parent / file))


def fleet_from_bytes(source: str, content: bytes, read: Callable[[str], GridMap]) -> Fleet:
    """A fleet from the content of its file.

    source : what the file is called before a person
    read   : reads the map of a name in it
    raises : InputFileError, TooLargeError
    """
    f = fields.parse(source, content, "a fleet's YAML file", MOST_BYTES)
    f.refuse_unknown("anchor", "robots", "sightings")
    robots = f.section("robots", f"name the robots and their maps, as in {EXAMPLE}")
    if len(robots.values) > MOST_ROBOTS:
        raise f.error("robots", f"holds {len(robots.values):,} robots", f"give 2 to {MOST_ROBOTS}")
    files, known = _robots(robots)
    sightings = _sightings(f, list(files))
    anchor = f.text("anchor", "give a robot's name") if "anchor" in f.values else ""
    maps = {name: read(file) for name, file in files.items()}
    try:
        return Fleet(maps, sightings, known, anchor)
    except SettingError as error:
        raise InputFileError(source, str(error), "correct the name, or the list of robots") from error


def _robots(robots: Fields) -> tuple[dict[str, str], dict[str, InitialPose]]:
    """The map file of each robot, and what is roughly known of it, by name."""
    files, known = {}, {}
    for name in robots.values:
        if not is_name(name):
            raise robots.error(shown(name), "is no name for a robot", NAME_RULE)
        robot = robots.section(name, "give {map: FILE.yaml}")
        robot.refuse_unknown("map", "known")
        files[name] = robot.text("map", "give the map's YAML file")
        if "known" in robot.values:
            known[name] = initial_pose(robot.section("known", "give {pose: [x, y, yaw], sigma: [m, m, rad]}"))
    return files, known


def _sightings(f: Fields, names: list[str]) -> tuple[FleetSighting, ...]:
    entries = f.values.get("sightings", [])
    if entries == "":
        entries = []
    if not isinstance(entries, list) or len(entries) > MOST_SIGHTINGS:
        raise f.error("sightings", f"is {shown(entries)}", f"give a list of at most {MOST_SIGHTINGS:,}")
    sightings = []
    for number, entry in enumerate(entries, 1):
        if not isinstance(entry, dict):
            remedy = "give observer, observed and measurement, as in an observation file"
            raise f.error(f"sighting {number}", f"is {shown(entry)}, not a mapping", remedy)
        one = Fields(f.source, entry, f"sighting {number}: ")
        one.refuse_unknown(*SIGHTING)
        observer, observed = (_robot_of(one, role, names) for role in ("observer", "observed"))
        try:
            sightings.append(FleetSighting(observer, observed, observation_of(one, more=("robot",))))
        except SettingError as error:
            raise InputFileError(f.source, f"sighting {number}: {error}", "correct it") from error
    return tuple(sightings)


def _robot_of(sighting: Fields, role: str, names: list[str]) -> str:
    section = sighting.section(role, f"add {role}: {{robot: NAME, pose: [x, y, yaw]}}")
    name = section.text("robot", "give the robot's name")
    if name not in names:
        found, there = f"is {shown(name)}, which is none of the robots", ", ".join(names[:8])
        raise section.error("robot", found, f"there are {there}")
    return name


def fleet_to_bytes(fleet: Fleet, files: Mapping[str, str]) -> bytes:
    """The content of a fleet file; it reads back to equal values.

    files : of each robot the name of its map's YAML file
    """
    lines = [f"anchor: {quoted(fleet.anchor)}", "robots:"]
    for name in fleet.maps:
        known = ""
        if name in fleet.known:
            inside = known_to_bytes([fleet.known[name]]).decode().split("{", 1)[1].split("}")[0]
            known = f", known: {{{inside}}}"
        lines.append(f"  {quoted(name)}: {{map: {quoted(files[name])}{known}}}")
    lines.append("sightings:" if fleet.sightings else "sightings: []")
    for seen in fleet.sightings:
        entry = known_to_bytes([seen.observation]).decode()
        entry = re.sub(OF_A_PAIR, "", entry.replace("robot 1's heading", "the observer's heading"))
        for role, name in (("observer", seen.observer), ("observed", seen.observed)):
            entry = entry.replace(f"{role}: {{pose", f"{role}: {{robot: {quoted(name)}, pose", 1)
        lines.append(f"  - {indent(entry, '    ').strip()}")
    return ("\n".join(lines) + "\n").encode()
