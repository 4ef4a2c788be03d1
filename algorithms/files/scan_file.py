"""The file of a laser scan: a LaserScan message as ROS 1 and ROS 2 print it.

A scan may have 100,000 ranges, for which a YAML parser would take seconds. So its long lists are taken out of
the text first, and what is left, a dozen lines, is parsed as any other file.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import inf, isfinite, nan, pi, radians
from pathlib import Path

import numpy as np

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import FloatArray
from algorithms.files import yaml_fields as fields
from algorithms.files.map_file import read_bytes
from algorithms.files.yaml_fields import Fields, mounting, mounting_text, number_text, shown
from algorithms.sensors.laser_scan import LEAST_BEAMS, MOST_BEAMS, LaserScan

SCAN_FILE = "scan.yaml"
WHAT = "a laser scan's YAML file"
COMMAND = "ros2 topic echo --once --full-length /scan"
PRINTED = f"give one LaserScan message, as {COMMAND} prints it"
MOST_BYTES = 6_000_000  # of one message: 100,000 ranges and as many intensities
MOST_OTHER_BYTES = 8_192  # without its lists; it has less than 1,000
WHOLE_TURN = 2 * pi + 0.1  # radians; some scanners overlap by a beam or two, and some round
FARTHEST_WALL = 1000.0  # metres; further than any scanner of robots sees
CUT_OFF = "..."  # stands in the place of what ros2 leaves out of a list

END = re.compile(rb"^(?:---|\.\.\.)(?=[ \t\r\n]|\Z)", flags=re.M)  # of a document
CONTENT = re.compile(rb"^[ \t]*[^\s#%]", flags=re.M)
ITEM = rb"[ ]*-(?:[ \t][^\n]*)?(?:\n|\Z)"
LISTS = re.compile(
    rb"^(ranges|intensities)[ \t]*:[ \t]*(?:\[([^\[\]{}#]*)\]|(?:#[^\n]*|\r)?\n((?:" + ITEM + rb")+))",
    flags=re.M,
)
WORDS = {"inf": inf, "infinity": inf, "nan": nan, "null": nan, "~": nan, "": nan}
ROS_KEYS = frozenset(
    ("header", "angle_min", "angle_max", "angle_increment", "time_increment", "scan_time")
    + ("range_min", "range_max", "ranges", "intensities")
)


def read_scan(path: Path | str) -> LaserScan:
    """Read a scan's file; of a longer recording the first message. Raises InputFileError."""
    path = Path(path)
    return scan_from_bytes(str(path), read_bytes(path, "a laser scan", MOST_BYTES, instead=PRINTED))


def scan_from_bytes(name: str, data: bytes) -> LaserScan:
    """A scan from the content of its file, the first message in it.

    Beside ROS's keys there may be ``mounting: {x: m, y: m, yaw: rad}``, T_robot_laser. A beam that met
    nothing is inf, as ROS says it, or anything outside range_min … range_max, as some drivers do:
    ``LaserScan.valid`` tells. Intensities are passed over.

    name   : of the file, as the user knows it
    raises : InputFileError
    """
    f, lists = _message(name, data)
    ours = {key: value for key, value in f.values.items() if key not in ROS_KEYS}
    Fields(name, ours).refuse_unknown("mounting", near_only=True)
    start, step = (_angle(f, key, WHOLE_TURN) for key in ("angle_min", "angle_increment"))
    ranges = _ranges(f, lists)
    _check_angles(f, start, step, len(ranges))
    nearest, farthest = _limit(f, "range_min", 0.0), _limit(f, "range_max", inf)
    if not 0 <= nearest < farthest:
        found = f"is {nearest:g} m and range_max {farthest:g} m"
        raise f.error("range_min", found, "give what the scanner can measure, the smaller one first; metres")
    try:
        scan = LaserScan(start, step, ranges, nearest, farthest, mounting(f))
    except SettingError as error:
        raise InputFileError(name, str(error), PRINTED) from error
    seen = ranges[scan.valid]
    if len(seen) and np.median(seen) > FARTHEST_WALL:
        found = f"are {float(np.median(seen)):g} m in the middle, further than a scanner sees"
        raise f.error("ranges", found, "they look like millimetres: give metres")
    return scan


def _message(name: str, data: bytes) -> tuple[Fields, dict[str, list[bytes]]]:
    """The fields of the first message, and its long lists by key, apart."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):  # so the shell of Windows writes what it is told to keep
        data = data.decode("utf-16", errors="replace").encode()
    first = _first_document(data)
    if len(first) > MOST_BYTES:
        raise InputFileError(name, f"has a message of more than {MOST_BYTES / 1e6:g} MB", PRINTED)
    lists: dict[str, list[bytes]] = {}
    lines_of_lists = 0

    def taken(found: re.Match[bytes]) -> bytes:
        nonlocal lines_of_lists
        key, items = found[1].decode(), _items(found)
        if key in lists:
            raise InputFileError(name, f"the key {key} stands there twice", PRINTED)
        if len(items) > MOST_BEAMS:
            raise InputFileError(
                name, f"{key} holds {len(items):,} numbers", f"{MOST_BEAMS:,} beams are the most"
            )
        lists[key] = items
        lines = found[0].count(b"\n")
        lines_of_lists += lines
        return found[1] + b": 0" + b"\n" * lines  # so those below keep their numbers

    rest = LISTS.sub(taken, first)
    if len(rest) - lines_of_lists > MOST_OTHER_BYTES:
        raise InputFileError(name, f"holds more than {MOST_OTHER_BYTES:,} bytes beside its ranges", PRINTED)
    most = max(len(rest), fields.MAX_YAML_BYTES)
    return fields.parse(name, rest, WHAT, most, instead=PRINTED), lists


def _items(found: re.Match[bytes]) -> list[bytes]:
    """The texts in a list that LISTS found."""
    _, in_line, in_lines = found.groups()
    if in_lines is not None:
        return [line.strip()[1:] for line in in_lines.strip().split(b"\n")]
    items: list[bytes] = in_line.split(b",")
    if not items[-1].strip():  # an empty list, or a comma at its end
        items.pop()
    return items


def _first_document(data: bytes) -> bytes:
    """What stands before the line that ends the first document which holds anything, below as many empty
    lines as stood above it.
    """
    began, ended = 0, len(data)
    for end in END.finditer(data):
        if CONTENT.search(data[began : end.start()]):
            ended = end.start()
            break
        began = end.end()
    return b"\n" * data.count(b"\n", 0, began) + data[began:ended]


def _angle(f: Fields, key: str, most: float) -> float:
    """An angle of at most so much; radians."""
    angle = f.number(key, "give radians" if key in f.values else PRINTED)
    if abs(angle) > most:
        degrees = f"it looks like degrees: give radians, {radians(angle):.4g}"
        remedy = degrees if abs(angle) <= 720 else "give radians"
        raise f.error(key, f"is {angle:g} rad, more than a whole turn", remedy)
    return angle


def _limit(f: Fields, key: str, default: float) -> float:
    """A number that may be infinite, or the default where the key is missing; metres."""
    value = f.values.get(key)
    number = default if value is None else _number(value) if isinstance(value, str) else None
    if number is None or number != number:
        raise f.error(key, f"is {shown(value)}, not a number", "give metres, or leave it out")
    return number


def _check_angles(f: Fields, start: float, step: float, beams: int) -> None:
    """Raise InputFileError where angle_min, angle_increment, angle_max and the number of beams disagree."""
    if step == 0:
        raise f.error("angle_increment", "is 0", "give radians from beam to beam")
    if abs(step) * (beams - 1) > 2 * pi + 2 * abs(step):
        found = f"is {step:g} rad, with which {beams:,} beams span more than a whole turn"
        meant = f"give radians from beam to beam; were it degrees, it would be {radians(step):.4g}"
        raise f.error("angle_increment", found, meant)
    if "angle_max" not in f.values:
        return
    end, told = start + step * (beams - 1), _angle(f, "angle_max", abs(start) + WHOLE_TURN + 2 * abs(step))
    if abs(told - end) > 2 * abs(step):
        found = f"is {told:.5g} rad, but {beams:,} beams from {start:.5g} rad on, {step:.4g} rad apart, "
        raise f.error("angle_max", f"{found}end at {end:.5g} rad", f"correct one of them; {PRINTED}")


def _ranges(f: Fields, lists: dict[str, list[bytes]]) -> FloatArray:
    """(N,) metres; NaN and inf as they stand there."""
    items: Sequence[object] = lists.get("ranges", ())
    if "ranges" not in lists:
        value = f.get("ranges", PRINTED)
        if not isinstance(value, list):
            raise f.error("ranges", f"is {shown(value)}, not a list of numbers", PRINTED)
        items = value
    ranges = np.empty(len(items))
    for k, item in enumerate(items):
        text = item.decode(errors="replace") if isinstance(item, bytes) else item
        number = _number(text) if isinstance(text, str) else None
        if number is None:
            raise _no_range(f, k, text)
        ranges[k] = number
    if not LEAST_BEAMS <= len(ranges) <= MOST_BEAMS:
        found = f"holds {len(ranges):,} number{'s' * (len(ranges) != 1)}"
        raise f.error("ranges", found, f"a scan has {LEAST_BEAMS} to {MOST_BEAMS:,} beams; {PRINTED}")
    return ranges


def _no_range(f: Fields, k: int, text: object) -> InputFileError:
    if isinstance(text, str) and _bare(text) == CUT_OFF:
        return f.error("ranges", f"is cut off after {k:,} numbers", f"print it with {COMMAND}")
    shown_text = shown(text.strip() if isinstance(text, str) else text)
    return f.error("ranges", f"has {shown_text} as number {k + 1:,}, which is no number", "give metres")


def _bare(text: str) -> str:
    """What a line of a list says, without quotes and a comment."""
    return text.split(" #")[0].strip().strip("'\"")


def _number(text: str) -> float | None:
    """The number that a text stands for, infinite and NaN among them, in ROS's and YAML's spellings."""
    try:
        return float(text) if "_" not in text else None
    except ValueError:
        bare = _bare(text).lower()
    sign = -1.0 if bare.startswith("-") else 1.0
    word = bare.removeprefix("-").removeprefix("+").removeprefix(".")
    if word in WORDS:
        return sign * WORDS[word]
    try:
        return float(bare) if "_" not in bare else None
    except ValueError:
        return None


def scan_to_bytes(scan: LaserScan) -> bytes:
    """The content of a scan's file, as ROS prints it; it reads back to an equal scan."""
    end = scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1)
    numbers = {
        "angle_min": scan.angle_min,
        "angle_max": end,
        "angle_increment": scan.angle_increment,
        "range_min": scan.range_min,
        "range_max": scan.range_max,
    }
    lines = [f"{key}: {_text(value)}" for key, value in numbers.items()]
    lines += [
        mounting_text(scan.mounting),
        "ranges:",
        *(f"- {_text(value)}" for value in scan.ranges.tolist()),
    ]
    return ("\n".join(lines) + "\n").encode()


def _text(value: float) -> str:
    """A number as YAML spells it, infinite and NaN among them."""
    if isfinite(value):
        return number_text(value)
    return ".nan" if value != value else ".inf" if value > 0 else "-.inf"
