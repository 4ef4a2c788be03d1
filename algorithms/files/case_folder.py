"""A case: the folder with two maps, the sightings between them and, where it is known, the truth."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, unreadable
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE, read_observations
from algorithms.files.truth_file import TRUTH_FILE, Truth, read_truth
from algorithms.maps.grid_map import GridMap
from algorithms.observations.observation import Observation

FIRST_MAP_FILE = "map1.yaml"
SECOND_MAP_FILE = "map2.yaml"


@dataclass(frozen=True, eq=False)
class Case:
    """A folder with two maps, one sighting or several, and, where it is known, the answer.

    ref, mov         : map1.yaml, the observer's, and map2.yaml, that of the robot it saw
    observation_file : name of the file that ``observations`` came from
    truth            : None where the folder holds no truth.yaml
    """

    name: str
    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...]
    observation_file: str
    truth: Truth | None


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
    where = observed.pose("pose", (2, 3), OBSERVED_POSE)
    distance = m.number("range", "give the distance of robot 2 from robot 1 in metres")
    if distance < 0:
        raise m.error("range", f"is {distance:g} m", "a distance cannot be negative")
    if distance > MOST_RANGE:
        raise m.error("range", f"is {distance:g} m", f"give metres; {MOST_RANGE:,.0f} m is the most")
    return Observation(
        observer=Pose2(*observer.pose("pose", (3,), OBSERVER_POSE)),
        observed_x=where[0],
        observed_y=where[1],
        observed_heading=where[2] if len(where) == 3 else None,
        range=distance,
        bearing=_bearing(m, "bearing", "give the direction of robot 2 from robot 1's heading in radians"),
        sigma_range=_positive(m, "sigma_range", "m", SIGMA_RANGE, SIGMA_RANGES),
        sigma_bearing=_positive(m, "sigma_bearing", "rad", SIGMA_BEARING, SIGMA_BEARINGS),
        bearing_back=(
            _bearing(m, "bearing_back", "give radians, or leave it out")
            if "bearing_back" in m.values
            else None
        ),
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
    lines: list[str] = []
    for o in observations:
        first, *rest = _lines(o)
        several = len(observations) > 1
        lines += [f"- {first}", *(f"  {line}" for line in rest)] if several else [first, *rest]
    return ("\n".join(lines) + "\n").encode()


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


def read_truth(path: Path) -> Truth:
    """Read a truth file; raises InputFileError.

    Keys that resemble none of ours are passed over: people note more about a case than we read.
    """
    path = Path(path)
    f = fields.parse(str(path), read_bytes(path, "a truth"), "a truth's YAML file")
    f.refuse_unknown(
        *("T_ref_mov", "tolerance", "expected", "overlap", "truth_rms", "source", "licence"),
        near_only=True,
    )
    expected: Literal["merge", "refuse"] = "merge"
    if f.values.get("expected") == "refuse":
        expected = "refuse"
    elif f.values.get("expected", "merge") != "merge":
        found = fields.shown(f.values["expected"])
        raise f.error("expected", f"is {found}", "give merge or refuse")
    T_ref_mov = None
    if expected == "merge" or "T_ref_mov" in f.values:
        t = f.section("T_ref_mov", "add T_ref_mov: {x: m, y: m, theta: rad}, or expected: refuse")
        t.refuse_unknown("x", "y", "theta")
        T_ref_mov = Pose2(
            t.number("x", "give metres"),
            t.number("y", "give metres"),
            t.number("theta", "give radians"),
        )
    usual = Truth(None, expected="refuse")
    tolerance = Fields(f.source, {}, "tolerance.")
    if "tolerance" in f.values:
        tolerance = f.section("tolerance", "give {distance: m, angle: rad}")
        tolerance.refuse_unknown("distance", "angle")
    return Truth(
        T_ref_mov=T_ref_mov,
        tolerance_m=_positive(tolerance, "distance", "m", usual.tolerance_m),
        tolerance_rad=_positive(tolerance, "angle", "rad", usual.tolerance_rad),
        expected=expected,
        overlap=_optional(f, "overlap", "give a share in [0, 1], or leave it out"),
        truth_rms=_optional(f, "truth_rms", "give metres, or leave it out"),
        source=str(f.values.get("source", "")),
        licence=str(f.values.get("licence", "")),
    )


def truth_to_bytes(truth: Truth) -> bytes:
    """The content of a truth file; it reads back to an equal Truth."""
    n = number_text
    lines = []
    if truth.T_ref_mov is not None:
        T = truth.T_ref_mov
        lines.append(f"T_ref_mov: {{x: {n(T.x)}, y: {n(T.y)}, theta: {n(T.theta)}}}")
    lines.append(f"tolerance: {{distance: {n(truth.tolerance_m)}, angle: {n(truth.tolerance_rad)}}}")
    if truth.overlap is not None:
        lines.append(f"overlap: {n(truth.overlap)}")
    if truth.truth_rms is not None:
        lines.append(f"truth_rms: {n(truth.truth_rms)}")
    lines.append(f"expected: {truth.expected}")
    if truth.source:
        lines.append(f"source: {quoted(truth.source)}")
    if truth.licence:
        lines.append(f"licence: {quoted(truth.licence)}")
    return ("\n".join(lines) + "\n").encode()


def read_case(folder: Path | str, rough: bool = False) -> Case:
    """Read the case in a folder: map1.yaml, map2.yaml, observation.yaml and, if it is there, truth.yaml.

    rough  : take the badly measured observations instead of the good ones
    raises : InputFileError, TooLargeError
    """
    folder = Path(folder)
    observation_file = ROUGH_OBSERVATION_FILE if rough else OBSERVATION_FILE
    truth_path = folder / TRUTH_FILE
    return Case(
        name=show_hidden(folder.resolve().name),
        ref=read_map(folder / FIRST_MAP_FILE),
        mov=read_map(folder / SECOND_MAP_FILE),
        observations=read_observations(folder / observation_file),
        observation_file=observation_file,
        truth=read_truth(truth_path) if truth_path.exists() else None,
    )


def case_folders(root: Path) -> list[Path]:
    """The folders under root, and root itself, that hold a map1.yaml; sorted.

    raises : InputFileError where there is none, or a folder that cannot be looked into
    """
    root = Path(root)
    if not root.is_dir():
        raise InputFileError(root, "is not a folder", "give a folder of cases, or one case")

    def closed(error: OSError) -> None:  # a case that is passed over would be missing in every count
        raise unreadable(error.filename, error, "see that you may read it, or move it away") from error

    folders = sorted(
        Path(folder) for folder, _, files in os.walk(root, onerror=closed) if FIRST_MAP_FILE in files
    )
    if not folders:
        raise InputFileError(
            root,
            f"no folder in it holds a {FIRST_MAP_FILE}",
            f"a case is a folder of {FIRST_MAP_FILE}, {SECOND_MAP_FILE} and {OBSERVATION_FILE}",
        )
    return folders
