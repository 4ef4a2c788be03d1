"""Reading and writing the file of one sighting or several."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from pathlib import Path
from textwrap import indent

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.files import yaml_fields as fields
from algorithms.files.atomic_write import write_file
from algorithms.files.map_file import read_bytes
from algorithms.files.yaml_fields import Fields, number_text, positive_number
from algorithms.observations.observation import (
    MOST_RANGE,
    SIGMA_BEARING,
    SIGMA_BEARINGS,
    SIGMA_RANGE,
    SIGMA_RANGES,
    Observation,
)

OBSERVATION_FILE = "observation.yaml"
ROUGH_OBSERVATION_FILE = "observation_rough.yaml"

MOST_OBSERVATIONS = 64  # of one pair; their YAML stays far below what the parser takes


def read_observations(path: Path | str) -> tuple[Observation, ...]:
    """Read an observation file, of one sighting or a list of them; raises InputFileError."""
    path = Path(path)
    return observations_from_bytes(str(path), read_bytes(path, "an observation"))


def observations_from_bytes(name: str, data: bytes) -> tuple[Observation, ...]:
    """What a file or an upload holds: one observation, or a list of them.

    A key that is not known is an error: a misspelt sigma_bearing would change the answer unseen.

    name   : of the file, as the user knows it
    raises : InputFileError, which names the entry where the file is a list
    """
    entries = fields.parse_entries(name, data, "an observation's YAML file", "observation", MOST_OBSERVATIONS)
    return tuple(_observation(entry) for entry in entries)


def _observation(f: Fields) -> Observation:
    f.refuse_unknown("observer", "observed", "measurement")
    observer = f.section("observer", "add observer: {pose: [x, y, yaw]}, robot 1 in map 1")
    observer.refuse_unknown("pose")
    observed = f.section("observed", "add observed: {pose: [x, y, yaw]}, robot 2 in map 2")
    observed.refuse_unknown("pose")
    m = f.section("measurement", "add measurement: {range: m, bearing: rad}")
    m.refuse_unknown("range", "bearing", "sigma_range", "sigma_bearing", "bearing_back")
    seen_from = observer.pose("pose", (3,), "give [x, y, yaw] of robot 1 in map 1; m, m, rad")
    where = observed.pose("pose", (2, 3), "give [x, y] or [x, y, yaw] of robot 2 in map 2; m, m, rad")
    back = (
        _bearing(m, "bearing_back", "give radians, or leave it out") if "bearing_back" in m.values else None
    )
    distance = m.number("range", "give the distance of robot 2 from robot 1 in metres")
    if distance < 0:
        raise m.error("range", f"is {distance:g} m", "a distance cannot be negative")
    if distance > MOST_RANGE:
        raise m.error("range", f"is {distance:g} m", f"give metres; {MOST_RANGE:,.0f} m is the most")
    return Observation(
        observer=Pose2(*seen_from),
        observed_x=where[0],
        observed_y=where[1],
        observed_heading=where[2] if len(where) == 3 else None,
        range=distance,
        bearing=_bearing(m, "bearing", "give the direction of robot 2 from robot 1's heading in radians"),
        sigma_range=positive_number(m, "sigma_range", "m", SIGMA_RANGE, SIGMA_RANGES),
        sigma_bearing=positive_number(m, "sigma_bearing", "rad", SIGMA_BEARING, SIGMA_BEARINGS),
        bearing_back=back,
    )


def write_observations(path: Path | str, observations: Sequence[Observation]) -> None:
    """Write an observation file whole or not at all; raises OutputError, SettingError."""
    write_file(Path(path), observations_to_bytes(observations))


def observations_to_bytes(observations: Sequence[Observation]) -> bytes:
    """The content of an observation file; it reads back to equal Observations.

    A single one is written as it is, several as a list.

    raises : SettingError where there are none, or more than a file may hold
    """
    if not 1 <= len(observations) <= MOST_OBSERVATIONS:
        raise SettingError(f"a file holds 1 to {MOST_OBSERVATIONS} observations, not {len(observations)}")
    entries = ["\n".join(_lines(o)) for o in observations]
    if len(entries) > 1:
        entries = [f"- {indent(entry, '  ').lstrip()}" for entry in entries]
    return ("\n".join(entries) + "\n").encode()


def _lines(o: Observation) -> list[str]:
    where = [o.observed_x, o.observed_y]
    if o.observed_heading is not None:
        where.append(o.observed_heading)
    lines = [
        f"observer: {{pose: {_list(o.observer.array().tolist())}}}  # robot 1 in map 1: m, m, rad",
        f"observed: {{pose: {_list(where)}}}  # robot 2 in map 2",
        "measurement:  # of robot 2, as robot 1 saw it",
        f"  range: {number_text(o.range)}  # m",
        f"  bearing: {number_text(o.bearing)}  # rad, counter-clockwise from robot 1's heading",
        f"  sigma_range: {number_text(o.sigma_range)}  # m, one standard deviation",
        f"  sigma_bearing: {number_text(o.sigma_bearing)}  # rad",
    ]
    if o.bearing_back is not None:
        lines.append(f"  bearing_back: {number_text(o.bearing_back)}  # rad, robot 1 as robot 2 saw it")
    return lines


def _bearing(f: Fields, key: str, remedy: str) -> float:
    value = f.number(key, remedy)
    if abs(value) > 2 * pi:
        raise f.error(key, f"is {value:g} rad, more than a whole turn", "it looks like degrees: give radians")
    return value


def _list(numbers: list[float]) -> str:
    return f"[{', '.join(number_text(number) for number in numbers)}]"
