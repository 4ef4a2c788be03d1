"""Reading and writing the file of what is known of two maps: sightings, rough poses, turns and places."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import pi, radians
from pathlib import Path
from textwrap import indent

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files import yaml_fields as fields
from algorithms.files.atomic_write import write_file
from algorithms.files.map_file import read_bytes
from algorithms.files.yaml_fields import Fields, number_text, optional_number, positive_number
from algorithms.observations.observation import (
    MOST_RANGE,
    SIGMA_BEARING,
    SIGMA_BEARINGS,
    SIGMA_RANGE,
    SIGMA_RANGES,
    Observation,
)
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import (
    NEAR_RADIUS,
    SIGMA_XY,
    SIGMA_YAW,
    InitialPose,
    NearPlace,
    Prior,
    TurnPrior,
)

OBSERVATION_FILE = "observation.yaml"
ROUGH_OBSERVATION_FILE = "observation_rough.yaml"

MOST_OBSERVATIONS = 64  # of one pair; their YAML stays far below what the parser takes
PLACES = "map1", "map2"  # keys of a place in either map


def read_observations(path: Path | str) -> tuple[Observation, ...]:
    """Read a file of one sighting or a list of them; raises InputFileError."""
    path = Path(path)
    return observations_from_bytes(str(path), read_bytes(path, "an observation"))


def read_known(path: Path | str) -> tuple[Known, ...]:
    """Read a file of anything that is known: sightings, and what else ``known_from_bytes`` takes; raises
    InputFileError.
    """
    path = Path(path)
    return known_from_bytes(str(path), read_bytes(path, "an observation"))


def observations_from_bytes(name: str, data: bytes) -> tuple[Observation, ...]:
    """What a file or an upload holds: one observation, or a list of them.

    A key that is not known is an error: a misspelt sigma_bearing would change the answer unseen.

    name   : of the file, as the user knows it
    raises : InputFileError, which names the entry where the file is a list
    """
    entries = fields.parse_entries(name, data, "an observation's YAML file", "observation", MOST_OBSERVATIONS)
    return tuple(observation_of(entry) for entry in entries)


def known_from_bytes(name: str, data: bytes) -> tuple[Known, ...]:
    """What a file or an upload holds: each entry is a sighting, has keys initial, turn or near, or both.

    name   : of the file, as the user knows it
    raises : InputFileError, which names the entry where the file is a list
    """
    entries = fields.parse_entries(name, data, "an observation's YAML file", "observation", MOST_OBSERVATIONS)
    return tuple(known for entry in entries for known in _known(entry))


def _known(f: Fields) -> Iterator[Known]:
    f.refuse_unknown(*SIGHTING, *PRIORS)
    if any(key in f.values for key in SIGHTING) or not any(key in f.values for key in PRIORS):
        sighting = {key: value for key, value in f.values.items() if key in SIGHTING}
        yield observation_of(Fields(f.source, sighting, f.prefix))
    yield from priors_of(f)


def priors_of(f: Fields, places: tuple[str, str] = PLACES) -> Iterator[Prior]:
    """What an entry holds beside a sighting; raises InputFileError.

    places : keys of a place in either map
    """
    for key, read in PRIORS.items():
        if key in f.values:
            example = EXAMPLES[key].format(*places)
            part = f.section(key, f"give a mapping, as in {example}")
            try:
                yield read(part, places)
            except SettingError as error:  # "initial: sigma_x is −1 m; it must be …"
                raise InputFileError(f.source, f.prefix + str(error), f"as in {example}") from error


def _initial(f: Fields, _: tuple[str, str]) -> InitialPose:
    f.refuse_unknown("pose", "sigma", "about")
    pose = Pose2(*f.pose("pose", (3,), "give [x, y, yaw] of map 2's frame in map 1's; m, m, rad"))
    sigma, about = [SIGMA_XY, SIGMA_XY, SIGMA_YAW], [0.0, 0.0]
    if "sigma" in f.values:
        sigma = f.pose("sigma", (3,), "give [m, m, rad], or leave it out")
    if "about" in f.values:
        about = f.pose("about", (2,), "give [x, y] of a point of map 2; m; or leave it out")
    return InitialPose(pose, *sigma, *about)


def _turn(f: Fields, _: tuple[str, str]) -> TurnPrior:
    f.refuse_unknown("yaw", "sigma")
    yaw = f.number("yaw", "give how far map 2's frame is turned in map 1's; radians")
    sigma = optional_number(f, "sigma", "give radians, or leave it out")
    return TurnPrior(yaw) if sigma is None else TurnPrior(yaw, sigma)


def _near(f: Fields, places: tuple[str, str]) -> NearPlace:
    f.refuse_unknown(*places, "radius")
    ref = f.pose(places[0], (2,), "give [x, y] of the place in map 1; m")
    mov = f.pose(places[1], (2,), "give [x, y] of the same place in map 2; m")
    radius = optional_number(f, "radius", "give metres, or leave it out")
    return NearPlace(ref[0], ref[1], mov[0], mov[1], NEAR_RADIUS if radius is None else radius)


SIGHTING = ("observer", "observed", "measurement")
PRIORS: dict[str, Callable[[Fields, tuple[str, str]], Prior]] = {
    "initial": _initial,
    "turn": _turn,
    "near": _near,
}
EXAMPLES = {
    "initial": "initial: {{pose: [x, y, yaw], sigma: [m, m, rad]}}",
    "turn": "turn: {{yaw: rad, sigma: rad}}",
    "near": "near: {{{}: [x, y], {}: [x, y], radius: m}}",
}


def observation_of(f: Fields, more: tuple[str, ...] = ()) -> Observation:
    """A sighting; raises InputFileError.

    more : keys that observer and observed may have beside pose
    """
    f.refuse_unknown(*SIGHTING)
    observer = f.section("observer", "add observer: {pose: [x, y, yaw]}, robot 1 in map 1")
    observer.refuse_unknown("pose", *more)
    observed = f.section("observed", "add observed: {pose: [x, y, yaw]}, robot 2 in map 2")
    observed.refuse_unknown("pose", *more)
    m = f.section("measurement", "add measurement: {range: m, bearing: rad}")
    m.refuse_unknown("range", "bearing", "sigma_range", "sigma_bearing", "bearing_back")
    seen_from = observer.pose("pose", (3,), "give [x, y, yaw] of robot 1 in map 1; m, m, rad")
    where = observed.pose("pose", (2, 3), "give [x, y] or [x, y, yaw] of robot 2 in map 2; m, m, rad")
    for section, pose in ((observer, seen_from), (observed, where)):
        if any(abs(yaw) > 2 * pi for yaw in pose[2:]):
            found = f"turns by {pose[2]:g} rad, more than a whole turn"
            raise section.error("pose", found, f"it looks like degrees: give radians, {radians(pose[2]):.4g}")
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


def write_observations(path: Path | str, observations: Sequence[Known]) -> None:
    """Write an observation file whole or not at all; raises OutputError, SettingError."""
    write_file(Path(path), known_to_bytes(observations))


def known_to_bytes(known: Sequence[Known]) -> bytes:
    """The content of an observation file; it reads back to equal values.

    A single one is written as it is, several as a list.

    raises : SettingError where there are none, or more than a file may hold
    """
    if not 1 <= len(known) <= MOST_OBSERVATIONS:
        raise SettingError(f"a file holds 1 to {MOST_OBSERVATIONS} observations, not {len(known)}")
    entries = ["\n".join(_lines(one) if isinstance(one, Observation) else [_line(one)]) for one in known]
    if len(entries) > 1:
        entries = [f"- {indent(entry, '  ').lstrip()}" for entry in entries]
    return ("\n".join(entries) + "\n").encode()


def _line(prior: Prior) -> str:
    remark = {
        InitialPose: "map 2's frame in map 1's: m, m, rad",
        TurnPrior: "of map 2's frame in map 1's: rad",
        NearPlace: "one place: m",
    }
    return f"{prior_text(prior)}  # {remark[type(prior)]}"


def prior_text(prior: Prior, places: tuple[str, str] = PLACES) -> str:
    """As it stands in a file; ``places``: keys of a place in either map."""
    if isinstance(prior, InitialPose):
        pose, sigma = _list(prior.pose.array().tolist()), _list(prior.sigmas.tolist())
        about = f", about: {_list(prior.about.tolist())}" if prior.about.any() else ""
        return f"initial: {{pose: {pose}, sigma: {sigma}{about}}}"
    if isinstance(prior, TurnPrior):
        return f"turn: {{yaw: {number_text(prior.yaw)}, sigma: {number_text(prior.sigma)}}}"
    ref, mov = _list([prior.ref_x, prior.ref_y]), _list([prior.mov_x, prior.mov_y])
    return f"near: {{{places[0]}: {ref}, {places[1]}: {mov}, radius: {number_text(prior.radius)}}}"


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
