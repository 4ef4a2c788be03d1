"""Tables and numbers as files and people have them: the same digits wherever they were computed."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from math import degrees
from typing import Any

from app.evaluation.method_run import MethodRun
from app.report.result_files import plain


def json_bytes(value: Any) -> bytes:
    """A JSON file; settings and arrays in it are written as JSON can hold them."""
    return (json.dumps(plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def csv_bytes(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue().encode()


def share_text(value: float | None) -> str:
    """A share of 1; empty where there is none, here and below."""
    return "" if value is None else f"{value:.6f}"


def metres_text(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"


def angle_text(value: float | None) -> str:
    """An angle, given in radians, told in degrees."""
    return "" if value is None else f"{degrees(value):.4f}"


def yes_text(value: bool | None) -> str:
    return "" if value is None else "yes" if value else "no"


JUDGED = ("right", "fine", "accepted")
"""Columns of what is to be said of a run."""


def judged_cells(trial: MethodRun) -> tuple[str, ...]:
    return tuple(map(yes_text, (trial.right, trial.fine, trial.accepted)))


PLACED = ("distance_m", "angle_deg", "x_m", "y_m", "theta_deg")
"""Columns of a run's transform: how far off it is, and what it is."""


def placed_cells(trial: MethodRun) -> tuple[str, ...]:
    x, y, theta = trial.T_ref_mov or (None, None, None)
    off = metres_text(trial.distance), angle_text(trial.angle)
    return (*off, metres_text(x), metres_text(y), angle_text(theta))


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
    return [
        header,
        *(
            ["–" if row[name] is None else form.format(row[name]) for name, form in columns.items()]
            for row in rows
        ),
    ]


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """A table for a terminal: the first column to the left, numbers to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return [
        "  ".join(
            [row[0].ljust(widths[0]), *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:], strict=True))]
        )
        for row in rows
    ]


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """A table for a Markdown page, its first row the header."""
    head, *body = (f"| {' | '.join(row)} |" for row in rows)
    return "\n".join([head, "|---" + "|---:" * (len(rows[0]) - 1) + "|", *body])
