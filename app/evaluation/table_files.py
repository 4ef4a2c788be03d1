"""Tables and numbers as files and people have them: the same digits wherever they were computed."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from math import degrees
from typing import Any

from app.evaluation.method_run import MethodRun
from app.report.json_report import plain


def json_bytes(value: Any) -> bytes:
    """A JSON file; settings and arrays in it are written as JSON can hold them."""
    return (json.dumps(plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def csv_bytes(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> bytes:
    """A CSV file: None is left empty, a bool is yes or no."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(map(_csv_cell, row) for row in rows)
    return text.getvalue().encode()


def _csv_cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "" if value is None else value


def fixed(value: float | None, digits: int) -> str | None:
    """A number with so many decimals."""
    return None if value is None else f"{value:.{digits}f}"


JUDGED = ("right", "fine", "accepted")
"""Columns of what is to be said of a run."""

PLACED = ("distance_m", "angle_deg", "x_m", "y_m", "theta_deg")
"""Columns of a run's transform: how far off it is, and what it is."""


def judged_cells(run: MethodRun) -> list[bool | None]:
    return [run.right, run.fine, run.accepted]


def placed_cells(run: MethodRun) -> list[str | None]:
    x, y, theta = run.T_ref_mov or (None, None, None)
    angle, turn = (None if each is None else degrees(each) for each in (run.angle, theta))
    return [fixed(value, 4) for value in (run.distance, angle, x, y, turn)]


def apart_text(distance: float | None, angle: float | None) -> str:
    """How far a wrong transform is from the true one; metres, radians."""
    if distance is None or angle is None:
        return "the maps share no place"
    return f"{distance:.2f} m and {degrees(angle):.1f}° off"


def text_rows(
    columns: Mapping[str, str], rows: Iterable[Mapping[str, Any]], titles: Mapping[str, str] | None = None
) -> list[list[str]]:
    """Header and rows as a person reads them.

    columns : how the values of a column are written, by its name
    titles  : of columns that are not called by their names
    """
    header = [(titles or {}).get(name, name.replace("_", " ")) for name in columns]
    cells = (
        ["–" if row[name] is None else form.format(row[name]) for name, form in columns.items()]
        for row in rows
    )
    return [header, *cells]


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """A table for a terminal: the first column to the left, numbers to the right."""
    first, *widths = (max(map(len, column)) for column in zip(*rows, strict=True))
    lines = ([row[0].ljust(first), *map(str.rjust, row[1:], widths)] for row in rows)
    return ["  ".join(cells) for cells in lines]
