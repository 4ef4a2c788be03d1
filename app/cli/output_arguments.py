"""Arguments that say in which frame and in which cells the merged map is written."""

from __future__ import annotations

import argparse
from contextlib import suppress
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from algorithms.common.errors import OutputError
from app.cli.argument_parser import Parser

if TYPE_CHECKING:
    from app.report.export_frame import ExportFrame

OWNERS = ("ref", "mov")


def add_output(parser: Parser, **frame: Any) -> Any:
    """Add ``--frame``, as ``frame`` describes it, ``--no-yaw`` and ``--merged-resolution``; their group."""
    group = parser.add_argument_group("the merged map", "As it was merged, unless told otherwise.")
    group.add_argument("--frame", **frame)
    about = "resample it so that its origin has no yaw, as Nav2's costmap wants it"
    group.add_argument("--no-yaw", action="store_true", help=f"{about}; how many cells changed is told")
    about = "resample it to cells of M metres; no wall is lost, and how many cells changed is told"
    group.add_argument("--merged-resolution", type=_size, metavar="M", help=about)
    return group


def add_frame(parser: Parser) -> None:
    """The same for the map merged of two."""
    about = (
        "whose frame it is in: map 1's (ref, the default), map 2's (mov), or one whose origin lies at X, Y "
        "in map 1's and whose x-axis is turned by YAW there; metres, radians"
    )
    group = add_output(parser, type=_frame, default="ref", metavar="ref|mov|X,Y,YAW", help=about)
    about = "end the map where nothing more is known; it comes after what a project has corrected"
    group.add_argument("--crop", action="store_true", help=about)


def frame_of(args: argparse.Namespace) -> ExportFrame:
    """What is asked for; raises SettingError."""
    from algorithms.common.pose import Pose2
    from app.report.export_frame import ExportFrame

    frame = getattr(args, "frame", "ref")
    given = frame if frame in OWNERS else Pose2.from_array(frame)
    return ExportFrame(given, not args.no_yaw, args.merged_resolution)


def _frame(text: str) -> str | tuple[float, ...]:
    if text in OWNERS:
        return text
    with suppress(ValueError):
        numbers = tuple(float(part) for part in text.split(","))
        if len(numbers) == 3 and all(map(isfinite, numbers)):
            return numbers
    raise argparse.ArgumentTypeError(f"{text} is neither ref nor mov nor X,Y,YAW in metres and radians")


def _size(text: str) -> float:
    with suppress(ValueError):
        number = float(text)
        if 0 < number < float("inf"):
            return number
    raise argparse.ArgumentTypeError(f"{text} is no positive number of metres")


def check_apart(out: Path, fleet: Path) -> None:
    """Raise OutputError where a result would take the place of the fleet's own folder."""
    folder = fleet if fleet.is_dir() else fleet.parent
    if out.resolve() == folder.resolve():
        raise OutputError(out, "holds the fleet's own files", "choose another --out")
