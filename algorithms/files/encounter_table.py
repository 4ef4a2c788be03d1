"""The table of encounters: a picture and a laser scan each, and where the two robots were."""

from __future__ import annotations

import csv
import difflib
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi, radians
from pathlib import Path

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files.foreign_files import check_foreign
from algorithms.files.map_file import read_bytes
from algorithms.files.observation_file import MOST_OBSERVATIONS
from algorithms.files.yaml_fields import as_number, shown
from algorithms.maps.grid_map import FARTHEST

ENCOUNTER_TABLE = "encounters.csv"
MOST_BYTES = 200_000  # 64 lines of long paths
NUMBERS = ("observer_x", "observer_y", "observer_yaw", "observed_x", "observed_y")
PATHS = ("image", "scan")
COLUMNS = (*PATHS, *NUMBERS, "observed_yaw")
MOST_COLUMNS = 100  # others' among them
HEADER = f"the first line must be {','.join(COLUMNS)}, the last of which may be left out"
SEPARATORS = ",;\t"
NAMED_SEPARATOR = re.compile(r"\Asep=([,;\t])\n", flags=re.I)  # which Excel writes, and nobody else reads
CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]")
SAVE_AS = "save it as CSV, UTF-8"
CSV = f"{SAVE_AS}; {HEADER}"


@dataclass(frozen=True)
class EncounterRow:
    """Robot 1, which has the camera and the scanner, saw robot 2 once.

    image, scan : files of the picture and of the scan, relative to the table's folder
    observer    : robot 1 in map 1; metres, radians
    observed_x, observed_y : robot 2 in map 2; metres
    observed_heading : robot 2's in map 2; radians, None where it is not known
    """

    image: str
    scan: str
    observer: Pose2
    observed_x: float
    observed_y: float
    observed_heading: float | None = None


def read_encounters(path: Path | str) -> tuple[EncounterRow, ...]:
    """Read a table of encounters; raises InputFileError. The files that it names are not looked for."""
    path = Path(path)
    data = read_bytes(path, "the encounters", MOST_BYTES, "CSV file", CSV)
    return encounters_from_bytes(str(path), data)


def encounters_from_bytes(name: str, data: bytes) -> tuple[EncounterRow, ...]:
    """The rows of a table, from the content of its file: CSV as programs and spreadsheets write it.

    The first line names the columns, in any order. They are separated by commas, semicolons or tabs; with
    semicolons 1,5 is a number. Columns that resemble none of ours are passed over, and so are empty lines.

    name   : of the file, as the user knows it
    raises : InputFileError, which names the line
    """
    check_foreign(name, data, CSV)
    if len(data) > MOST_BYTES:
        found = f"has more than {MOST_BYTES:,} bytes"
        raise InputFileError(name, found, f"give a table of at most {MOST_OBSERVATIONS} encounters")
    text, separator = _separated(_text(name, data))
    rows = _cells(name, text, separator)
    line, header = next(rows, (1, []))
    if not header:
        raise InputFileError(name, "is empty", HEADER)
    columns = _columns(name, line, header)
    encounters = []
    for line, cells in rows:
        if any(cells[len(header) :]):
            found = f"line {line} has {len(cells)} cells, and the first line {len(header)}"
            raise InputFileError(name, found, "put a path that holds the separator in quotes, and write 1.5")
        cells += [""] * (len(header) - len(cells))
        ours = {key: cells[k] for key, k in columns.items()}
        if separator != ",":
            ours.update({key: cell.replace(",", ".") for key, cell in ours.items() if key not in PATHS})
        encounters.append(_encounter(name, line, ours))
        if len(encounters) > MOST_OBSERVATIONS:
            found = f"holds more than {MOST_OBSERVATIONS} encounters"
            raise InputFileError(name, found, "give those in which the robots were near each other")
    if not encounters:
        raise InputFileError(name, "holds no encounter", "give a line for each below the first")
    return tuple(encounters)


def _text(name: str, data: bytes) -> str:
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    try:
        text = data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputFileError(name, "is no text in UTF-8", SAVE_AS) from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _separated(text: str) -> tuple[str, str]:
    """A text, and what separates its cells: what it says, or what there is the most of in its first line."""
    named = NAMED_SEPARATOR.match(text)
    if named:
        return "\n" + text[named.end() :], named[1]  # so lines keep their numbers
    first = text.lstrip("\n").split("\n", 1)[0]
    return text, max(SEPARATORS, key=first.count)


def _cells(name: str, text: str, separator: str) -> Iterator[tuple[int, list[str]]]:
    """Every line that is not empty: its number, and its cells without blanks around them."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=True)
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells):
                yield reader.line_num, cells
    except csv.Error as error:
        raise InputFileError(name, f"line {reader.line_num} is not CSV ({error})", SAVE_AS) from error


def _columns(name: str, line: int, header: list[str]) -> dict[str, int]:
    """In which column each of ours stands."""
    if len(header) > MOST_COLUMNS:
        raise InputFileError(name, f"line {line} names {len(header):,} columns", HEADER)
    names = [cell.lower() for cell in header]
    columns = {key: names.index(key) for key in COLUMNS if key in names}
    for key, cell in zip(names, header, strict=True):
        if key in COLUMNS and names.count(key) > 1:
            raise InputFileError(name, f"line {line} names {key} twice", HEADER)
        near = difflib.get_close_matches(key[:60], COLUMNS, n=1, cutoff=0.8)
        if key not in COLUMNS and near and near[0] not in columns:
            found = f"line {line} names a column {shown(cell)}"
            raise InputFileError(name, found, f"did you mean {near[0]}?")
    missing = [key for key in COLUMNS[:-1] if key not in columns]
    if missing:
        raise InputFileError(name, f"line {line} names no column {', '.join(missing)}", HEADER)
    return columns


def _encounter(name: str, line: int, cells: dict[str, str]) -> EncounterRow:
    for key in PATHS:
        if not cells[key]:
            remedy = "give the name of its file, relative to the table's folder"
            raise InputFileError(name, f"line {line}: {key} is empty", remedy)
        if CONTROL.search(cells[key]):
            found = f"line {line}: {key} is {shown(cells[key])}"
            raise InputFileError(name, found, "a path has no line breaks and no control characters")
    x, y, yaw, seen_x, seen_y = (_number(name, line, key, cells[key]) for key in NUMBERS)
    heading = cells.get("observed_yaw", "")
    seen_yaw = _number(name, line, "observed_yaw", heading) if heading else None
    return EncounterRow(cells["image"], cells["scan"], Pose2(x, y, yaw), seen_x, seen_y, seen_yaw)


def _number(name: str, line: int, key: str, cell: str) -> float:
    """Metres, or radians where the column is a yaw."""
    place = f"line {line}: {key} is"
    unit = "radians" if key.endswith("yaw") else "metres"
    number = as_number(cell)
    if number is None:
        raise InputFileError(name, f"{place} {shown(cell)}, not a finite number", f"give {unit}")
    if unit == "metres" and abs(number) > FARTHEST:
        found = f"{place} {number:g} m, which is more than {FARTHEST / 1000:,.0f} km away"
        raise InputFileError(name, found, "give metres in the robot's own map")
    if unit == "radians" and abs(number) > 2 * pi:
        remedy = f"it looks like degrees: give radians, {radians(number):.4g}"
        raise InputFileError(name, f"{place} {number:g} rad, more than a whole turn", remedy)
    return number


def encounters_to_bytes(rows: Sequence[EncounterRow]) -> bytes:
    """The content of a table's file; it reads back to equal rows.

    raises : SettingError where there are none, or more than a file may hold
    """
    if not 1 <= len(rows) <= MOST_OBSERVATIONS:
        raise SettingError(f"a table holds 1 to {MOST_OBSERVATIONS} encounters, not {len(rows)}")
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        numbers = [*row.observer.array().tolist(), float(row.observed_x), float(row.observed_y)]
        heading = "" if row.observed_heading is None else repr(float(row.observed_heading))
        writer.writerow([row.image, row.scan, *map(repr, numbers), heading])
    return text.getvalue().encode()
