"""The fleet file: robots, their maps, who saw whom, and what else is known of two of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from textwrap import indent

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.robot_names import NAME_RULE, RobotNames, is_name
from algorithms.files import yaml_fields as fields
from algorithms.files.foreign_files import check_foreign
from algorithms.files.map_file import read_bytes, read_map
from algorithms.files.observation_file import (
    PRIORS,
    SIGHTING,
    known_to_bytes,
    observation_of,
    prior_text,
    priors_of,
)
from algorithms.files.yaml_fields import Fields, quoted, shown
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import (
    MOST_PRIORS,
    MOST_ROBOTS,
    MOST_SIGHTINGS,
    Fleet,
    FleetPrior,
    FleetSighting,
)

FLEET_FILE = "fleet.yaml"
MOST_BYTES = 750_000  # of the file: the largest fleet, with the longest names, takes less
OF_A_PAIR = r"  # [^\n]*\brobot [12]\b[^\n]*"  # remarks on two robots that have no names
EXAMPLE = "robots: {r1: {map: r1.yaml}, r2: {map: r2.yaml}}"
PLACES = "in", "of"  # keys of a place in either map, as of the two robots


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
    parts = fleet_parts(source, content)
    files = {}
    for name, robot in parts.robots.items():
        robot.refuse_unknown("map")
        files[name] = robot.text("map", "give the map's YAML file")
    maps = {name: read(file) for name, file in files.items()}
    try:
        return Fleet(maps, parts.sightings, parts.priors, parts.anchor)
    except SettingError as error:
        raise InputFileError(source, str(error), "correct the name, or the list of robots") from error


@dataclass(frozen=True)
class FleetParts:
    """A fleet file taken apart; the fields of each robot by its name, anchor "" where none is told."""

    robots: Mapping[str, Fields]
    sightings: tuple[FleetSighting, ...]
    priors: tuple[FleetPrior, ...]
    anchor: str


def fleet_parts(source: str, content: bytes) -> FleetParts:
    """What a fleet file says, before any map is read; raises InputFileError."""
    check_foreign(source, content)
    if len(content) > fields.MAX_YAML_BYTES and b"robots" not in content:  # before seconds are spent on it
        raise InputFileError(source, "is long, and names no robots", "give a fleet's YAML file")
    f = fields.parse(source, content, "a fleet's YAML file", MOST_BYTES)
    f.refuse_unknown("anchor", "robots", "sightings", "known")
    listed = f.section("robots", f"name the robots and their maps, as in {EXAMPLE}")
    if len(listed.values) > MOST_ROBOTS:
        raise f.error("robots", f"holds {len(listed.values):,} robots", f"give 2 to {MOST_ROBOTS}")
    robots = {}
    for name in listed.values:
        if not is_name(name):
            raise listed.error(shown(name), "is no name for a robot", NAME_RULE)
        robots[name] = listed.section(name, "give {map: FILE.yaml}")
    names = list(robots)
    anchor = f.text("anchor", "give a robot's name") if "anchor" in f.values else ""
    return FleetParts(robots, _sightings(f, names), _priors(f, names), anchor)


def _sightings(f: Fields, names: list[str]) -> tuple[FleetSighting, ...]:
    sightings = []
    remedy = "give observer, observed and measurement, as in an observation file"
    for one in _entries(f, "sightings", "sighting", MOST_SIGHTINGS, remedy):
        one.refuse_unknown(*SIGHTING)
        observer, observed = (
            _robot(one.section(role, f"add {role}: {{robot: NAME, pose: [x, y, yaw]}}"), "robot", names)
            for role in ("observer", "observed")
        )
        with _told_by_name(one, RobotNames(observer, observed)):
            sightings.append(FleetSighting(observer, observed, observation_of(one, more=("robot",))))
    return tuple(sightings)


def _priors(f: Fields, names: list[str]) -> tuple[FleetPrior, ...]:
    priors = []
    remedy = f"give {{of: r2, in: r1}} and {', '.join(PRIORS)}, or any of them"
    for one in _entries(f, "known", "known", MOST_PRIORS, remedy):
        one.refuse_unknown("of", "in", *PRIORS)
        mov, ref = (_robot(one, role, names) for role in ("of", "in"))
        with _told_by_name(one, RobotNames(ref, mov)):
            told = [FleetPrior(ref, mov, prior) for prior in priors_of(one, PLACES)]
        if not told:
            raise one.error(" or ".join(PRIORS), "is missing", remedy)
        priors += told
    return tuple(priors)


@contextmanager
def _told_by_name(entry: Fields, names: RobotNames) -> Iterator[None]:
    """What is wrong with an entry on two robots is told with their names."""
    try:
        yield
    except SettingError as error:
        raise InputFileError(entry.source, names.told(f"{entry.prefix}{error}"), "correct it") from error
    except InputFileError as error:
        raise InputFileError(error.source, names.told(error.found), names.told(error.remedy)) from error


def _entries(f: Fields, key: str, each: str, most: int, remedy: str) -> Iterator[Fields]:
    """The mappings of a list, each called so and by its number."""
    entries = f.values.get(key, [])
    if entries == "":
        entries = []
    if not isinstance(entries, list) or len(entries) > most:
        raise f.error(key, f"is {shown(entries)}", f"give a list of at most {most:,}")
    for number, entry in enumerate(entries, 1):
        if not isinstance(entry, dict):
            raise f.error(f"{each} {number}", f"is {shown(entry)}, not a mapping", remedy)
        yield Fields(f.source, entry, f"{each} {number}: ")


def _robot(section: Fields, key: str, names: list[str]) -> str:
    name = section.text(key, "give the robot's name")
    if name not in names:
        found, there = f"is {shown(name)}, which is none of the robots", ", ".join(names[:8])
        raise section.error(key, found, f"there are {there}")
    return name


def fleet_to_bytes(fleet: Fleet, files: Mapping[str, str]) -> bytes:
    """The content of a fleet file; it reads back to equal values.

    files : of each robot the name of its map's YAML file
    """
    lines = [f"anchor: {quoted(fleet.anchor)}", "robots:"]
    lines += [f"  {quoted(name)}: {{map: {quoted(files[name])}}}" for name in fleet.maps]
    lines.append("sightings:" if fleet.sightings else "sightings: []")
    for seen in fleet.sightings:
        entry = known_to_bytes([seen.observation]).decode()
        entry = re.sub(OF_A_PAIR, "", entry.replace("robot 1's heading", "the observer's heading"))
        for role, name in (("observer", seen.observer), ("observed", seen.observed)):
            entry = entry.replace(f"{role}: {{pose", f"{role}: {{robot: {quoted(name)}, pose", 1)
        lines.append(f"  - {indent(entry, '    ').strip()}")
    lines += ["known:"] * bool(fleet.priors)
    for told in fleet.priors:
        of = f"of: {quoted(told.mov)}, in: {quoted(told.ref)}"
        lines.append(f"  - {{{of}, {prior_text(told.prior, PLACES)}}}")
    return ("\n".join(lines) + "\n").encode()
