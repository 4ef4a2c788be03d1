"""The fields of a small YAML file, taken out one by one; what does not fit is told by name.

Every scalar comes out of the parser as the text that stands in the file, and becomes a number only
where a number is asked for, as in Nav2's parser. So 1e-3, which YAML 1.1 takes for a string, is a
number here, and an image called 2024 is a name.
"""

from __future__ import annotations

import difflib
import math
import re
import reprlib
from dataclasses import dataclass, replace
from typing import Any

import yaml

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.foreign_files import check_foreign
from algorithms.files.text_loader import MAX_VALUES, TextLoader, goes_on
from algorithms.maps.grid_map import FARTHEST, MOST_TURN

MAX_YAML_BYTES = 32 * 1024  # ours have 400 bytes, and 64 sightings less than 30,000
MOUNTING = "mounting: {x: m, y: m, yaw: rad}"
WIDEST_ROBOT = 100.0  # metres
TRUE = ("true", "yes", "on", "y")
HEADER = re.compile(rb"\A(\xef\xbb\xbf)?%YAML:[^\r\n]*")  # of OpenCV's FileStorage
FALSE = ("false", "no", "off", "n")
TEXT = "tag:yaml.org,2002:str"  # how the parser calls what is neither a number nor a word of YAML's own


@dataclass(frozen=True)
class Fields:
    """A mapping of a YAML file.

    source : name of the file as the user knows it
    values : texts, lists and mappings by key
    prefix : way to this mapping inside the file, as it stands before a key: "tolerance.",
             "observation 2: "; empty for the file itself
    further : whether more documents follow, which are passed over
    """

    source: str
    values: dict[str, Any]
    prefix: str = ""
    further: bool = False

    def error(self, key: str, found: str, remedy: str) -> InputFileError:
        return InputFileError(self.source, f"{self.prefix}{key} {found}", remedy)

    def get(self, key: str, remedy: str) -> Any:
        """The value as it stands; raises InputFileError where the key is missing."""
        if key not in self.values:
            raise self.error(key, "is missing", remedy)
        return self.values[key]

    def text(self, key: str, remedy: str) -> str:
        """A text that is not empty."""
        value = self.get(key, remedy)
        if not isinstance(value, str) or not value.strip():
            raise self.error(key, f"is {shown(value)}", remedy)
        return value

    def number(self, key: str, remedy: str) -> float:
        value = self.get(key, remedy)
        number = as_number(value)
        if number is None:
            raise self.error(key, f"is {shown(value)}, not a finite number", remedy)
        return number

    def pose(self, key: str, lengths: tuple[int, ...], remedy: str) -> list[float]:
        """[x, y] or [x, y, yaw] within FARTHEST and MOST_TURN, as lengths allow; metres, metres, radians."""
        value = self.get(key, remedy)
        numbers = [as_number(item) for item in value] if isinstance(value, list) else []
        pose, fault = [number for number in numbers if number is not None], ""
        if len(pose) != len(numbers) or len(pose) not in lengths:
            fault = f"not {' or '.join(map(str, lengths))} finite numbers"
        elif any(abs(metres) > FARTHEST for metres in pose[:2]):
            fault = f"which is more than {FARTHEST / 1000:,.0f} km away"
        elif any(abs(yaw) > MOST_TURN for yaw in pose[2:]):
            fault = f"which turns by more than {MOST_TURN:,.0f} rad"
        if fault:
            raise self.error(key, f"is {shown(value)}, {fault}", remedy)
        return pose

    def flag(self, key: str, remedy: str) -> bool:
        """True or false; a whole number counts as in C, and 0 is false."""
        value = self.get(key, remedy)
        if isinstance(value, str):
            if value.lower() in TRUE + FALSE:
                return value.lower() in TRUE
            number = as_number(value)
            if number is not None and number.is_integer():
                return number != 0
        raise self.error(key, f"is {shown(value)}", remedy)

    def section(self, key: str, remedy: str) -> Fields:
        value = self.get(key, remedy)
        if not isinstance(value, dict):
            raise self.error(key, f"is {shown(value)}, not a mapping", remedy)
        return Fields(self.source, value, f"{self.prefix}{key}.")

    def refuse_unknown(self, *known: str, near_only: bool = False) -> None:
        """Raise InputFileError for a key not among the known ones.

        near_only : pass over keys that look like none of the known ones
        """
        for key in self.values:
            if key in known:
                continue
            near = difflib.get_close_matches(key, known, n=1)
            if near:
                remedy = f"did you mean {near[0]}? Known are {', '.join(known)}"
            elif near_only:
                continue
            else:
                remedy = f"take it out; known are {', '.join(known)}"
            raise self.error(shown(key).strip("'"), "is not a known key", remedy)


def parse(
    source: str,
    data: bytes,
    what: str,
    most: int = MAX_YAML_BYTES,
    first_only: bool = False,
    instead: str = "",
) -> Fields:
    """The fields of a YAML file.

    source     : name of the file as the user knows it
    what       : what the file should be, with its article: "a map's YAML file"
    most       : bytes of it
    first_only : further documents are passed over; they are an error otherwise
    instead    : how to come by such a file; needed where it is none of a map's
    raises     : InputFileError where it is too long, not YAML, not a mapping, or another tool's file
    """
    values, further = _load(source, data, what, most, first_only, instead)
    return replace(_mapping(source, values, what), further=further)


def parse_entries(source: str, data: bytes, what: str, entry: str, most: int) -> list[Fields]:
    """The fields of a YAML file that holds one mapping or a list of them, 1 … ``most``.

    entry  : what one of them is called; errors in a list then begin with "ENTRY 2: "
    raises : InputFileError as ``parse`` does, and for a list that is empty, too long, or holds
             anything but mappings
    """
    values, _ = _load(source, data, what)
    if not isinstance(values, list):
        return [_mapping(source, values, what)]
    if not 1 <= len(values) <= most:
        found = f"holds {len(values)} {entry}s" if values else "is an empty list"
        raise InputFileError(source, found, f"give 1 to {most} {entry}s")
    for number, value in enumerate(values, 1):
        if not isinstance(value, dict):
            found = f"{entry} {number} is {shown(value)}, not a mapping"
            raise InputFileError(source, found, "give lines of the form key: value")
    return [Fields(source, value, f"{entry} {number}: ") for number, value in enumerate(values, 1)]


def _load(
    source: str,
    data: bytes,
    what: str,
    most: int = MAX_YAML_BYTES,
    first_only: bool = False,
    instead: str = "",
) -> tuple[Any, bool]:
    """The first document, and whether there are more; arguments as of ``parse``."""
    check_foreign(source, data, instead)
    if len(data) > most:
        found = f"has {len(data):,} bytes, which is too long for {what}"
        raise InputFileError(source, found, instead or "give the small YAML file, not the image")
    try:
        loader = TextLoader(HEADER.sub(b"", data))
        loader.most_values = MAX_VALUES * most // MAX_YAML_BYTES
        try:
            if not first_only:
                return loader.get_single_data(), False
            there = loader.check_data()  # type: ignore[no-untyped-call]
            return (loader.get_data() if there else None), goes_on(loader)
        finally:
            loader.dispose()
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        found = f"is not YAML ({_cause(error)})"
        raise InputFileError(source, found, f"give {what}, or mend the line") from error


def _mapping(source: str, values: Any, what: str) -> Fields:
    if not isinstance(values, dict):
        found = "is empty" if values in (None, "") else "holds no keys"
        raise InputFileError(source, found, f"give {what}, with lines of the form key: value")
    return Fields(source, values)


def optional_number(f: Fields, key: str, remedy: str) -> float | None:
    """A finite number, or None where the key is missing."""
    return f.number(key, remedy) if key in f.values else None


def positive_number(
    f: Fields, key: str, unit: str, default: float, limits: tuple[float, float] = (0.0, math.inf)
) -> float:
    """A number above 0 and within the limits, or the default where the key is missing.

    unit : of the number, as an error message names it
    """
    value = optional_number(f, key, f"give a positive number of {unit}, or leave it out")
    if value is None:
        return default
    if value <= 0:
        raise f.error(key, f"is {value:g} {unit}", "it must be positive; or leave it out")
    low, high = limits
    if not low <= value <= high:
        remedy = f"it must be {low:g} to {high:.5g} {unit}; or leave it out"
        raise f.error(key, f"is {value:g} {unit}", remedy)
    return value


def mounting(f: Fields) -> Pose2:
    """T_robot_sensor of a key ``mounting: {x: m, y: m, yaw: rad}``; what it leaves out is 0. Raises
    InputFileError.
    """
    if "mounting" not in f.values:
        return Pose2()
    part = f.section("mounting", f"give {MOUNTING}, where the sensor is on its robot")
    part.refuse_unknown("x", "y", "yaw")
    remedy = f"give a finite number, as in {MOUNTING}"
    x, y, yaw = (optional_number(part, key, remedy) or 0.0 for key in ("x", "y", "yaw"))
    for key, metres in (("x", x), ("y", y)):
        if abs(metres) > WIDEST_ROBOT:
            raise part.error(key, f"is {metres:g} m, which is beside any robot", "give metres")
    if abs(yaw) > 2 * math.pi:
        remedy = f"it looks like degrees: give radians, {math.radians(yaw):.4g}"
        raise part.error("yaw", f"is {yaw:g} rad, more than a whole turn", remedy)
    return Pose2(x, y, yaw)


def mounting_text(pose: Pose2) -> str:
    """The line of a file that ``mounting`` reads back to this pose."""
    x, y, yaw = (number_text(value) for value in pose.array().tolist())
    return f"mounting: {{x: {x}, y: {y}, yaw: {yaw}}}  # on the robot: m, m, rad"


def as_number(value: Any) -> float | None:
    """The finite number that a text stands for, or None."""
    if not isinstance(value, str) or "_" in value:  # Python reads 1_0 as 10; Nav2 does not
        return None
    try:
        number = float(value)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def shown(value: Any) -> str:
    """A value of a file as an error message shows it: one line, however deep it is."""
    if value == "":
        return "empty"
    short = reprlib.Repr()
    short.maxlevel, short.maxlist, short.maxdict, short.maxstring = 2, 6, 4, 60
    return short.repr(value).replace("'", "") if isinstance(value, list) else short.repr(value)


def number_text(value: float) -> str:
    """A number that reads back to the same bits, in YAML 1.1 and 1.2 alike."""
    text = repr(float(value))
    # YAML 1.1 takes 1e-05 for a string; with a point it is a number everywhere.
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


def quoted(text: str) -> str:
    """A text as it stands in a YAML file: plain where every parser takes that for the text."""
    if re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", text) and as_number(text) is None:
        kind = yaml.resolver.Resolver().resolve(yaml.ScalarNode, text, (True, False))  # type: ignore[no-untyped-call]
        if kind == TEXT:  # not null, no, 2024-01-01
            return text
    whole = yaml.safe_dump(text, default_style='"', allow_unicode=True, width=float("inf"))
    return str(whole).rstrip("\n")


def _cause(error: Exception) -> str:
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    if isinstance(error, yaml.MarkedYAMLError) and error.problem:
        mark = error.problem_mark
        return error.problem[:120] + (f", line {mark.line + 1}" if mark else "")
    return (str(error) or type(error).__name__).splitlines()[0][:120]
