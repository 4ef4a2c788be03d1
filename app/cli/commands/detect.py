"""``mapmeld detect train``: pictures of a robot in, a detector of it out."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from algorithms.common.errors import InputFileError
from algorithms.detection.detection import Picture
from algorithms.detection.model_file import model_to_bytes
from algorithms.detection.svm_training import Background, RobotExample, Training, train
from algorithms.files.atomic_write import check_folder, write_file
from algorithms.files.camera_picture import PICTURE_SUFFIXES, read_picture
from app.cli.argument_parser import Parser, whole_number
from app.cli.progress_bar import bar
from app.evaluation.table_files import aligned

USAGE = "train --positive DIR --negative DIR --out FILE [--seed N]"
DESCRIPTION = """\
Train a detector on your own robot: a histogram of oriented gradients and a linear support vector machine.

Example:
  mapmeld detect train --positive crops --negative rooms --out model.npz
  mapmeld observe … --model model.npz

--positive holds pictures of the robot alone, cut out to its edges, 50 pixels or more a side: a few hundred,
by different light and from different sides. Views that look different go into folders of their own, as
crops/front_back and crops/side: each becomes a class. --negative holds whole pictures of where the robots
drive, without a robot in them: the more, the fewer false boxes. What they are mistaken in is learned in three
more rounds. Precision and recall are those of pictures that were kept from the training (cross-validation).

Exit status: 0 trained, 2 bad input, 130 interrupted."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("what", choices=["train"], metavar="train", help="the only thing there is to do")
    parser.add_argument("--positive", type=Path, required=True, metavar="DIR", help="pictures of the robot")
    parser.add_argument("--negative", type=Path, required=True, metavar="DIR", help="pictures without it")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="the model to write (.npz)")
    parser.add_argument("--seed", type=whole_number(0, 2**32 - 1), default=0, metavar="N", help="default: 0")


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Train, write and tell."""
    check_folder(args.out.parent)
    robots = [
        RobotExample(picture, _whole(picture), label)
        for label, folder in _classes(args.positive).items()
        for picture in _pictures(folder)
    ]
    backgrounds = [Background(picture) for picture in _pictures(args.negative)]
    with bar(unit="picture") as shown:
        for step in train(robots, backgrounds, args.seed):
            if isinstance(step, Training):
                result = step
                continue
            shown.total = step.total
            shown.set_description(step.doing)
            shown.update(step.done - shown.n)
    write_file(args.out, model_to_bytes(result.model))
    rows = [["class", "precision", "recall", "windows of robots", "of backgrounds"]]
    for score in result.scores:
        rows.append(
            [
                score.label,
                f"{score.precision:.1%}",
                f"{score.recall:.1%}",
                str(score.robots),
                str(score.windows),
            ]
        )
    print(*aligned(rows), sep="\n")
    print(f"written to {args.out}")
    return 0


def _classes(folder: Path) -> dict[str, Path]:
    """The folder of every class; the folder itself, "robot", where it has none."""
    if not folder.is_dir():
        raise InputFileError(folder, "is no folder", "give a folder of pictures")
    inside = {path.name: path for path in sorted(folder.iterdir()) if path.is_dir() and _files(path)}
    return inside or {"robot": folder}


def _files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in PICTURE_SUFFIXES)


def _pictures(folder: Path) -> list[Picture]:
    if not folder.is_dir():
        raise InputFileError(folder, "is no folder", "give a folder of pictures")
    files = _files(folder)
    if not files:
        raise InputFileError(folder, "holds no pictures", f"known are {', '.join(PICTURE_SUFFIXES)}")
    return [read_picture(file) for file in files]


def _whole(picture: Picture) -> np.ndarray:
    """The box of all of a picture."""
    height, width = picture.shape[:2]
    return np.array([-0.5, -0.5, width - 0.5, height - 0.5])
