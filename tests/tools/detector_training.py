"""The detector that ships, trained anew: ``make detector``.

Simulated robots with paper boards, in buildings that no test and no sample uses, by all kinds of light, from
one to six metres away; and the same rooms without them. The seed is fixed: the same file comes out.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rendered_views import ViewAsked, asked_views, each_view

from algorithms.detection.detection import Picture
from algorithms.detection.model_file import SHIPPED, model_to_bytes
from algorithms.detection.svm_training import Background, RobotExample, Training, train
from algorithms.files.atomic_write import write_file
from algorithms.simulator.views.camera_image import viewpoint
from algorithms.simulator.views.projection import box_of
from algorithms.simulator.views.robot_views import RobotView
from app.cli.progress_bar import bar
from app.evaluation.table_files import aligned

FIRST = 1_200_000  # seed of the first view; those of tests, samples and RESULTS.md are lower
ROBOTS, EMPTY = 540, 540  # views
WHOLE = 0.8  # share of a robot that is seen, from which it is an example

Boxes = list[tuple[tuple[float, float, float, float], str, float]]


def boxes_of(asked: ViewAsked, view: RobotView) -> tuple[Picture, Boxes]:
    """The picture, and box, class and visible share of every robot in it; also of what the image cuts off."""
    eye = viewpoint(view.observer, view.camera, view.camera_height)
    boxes: Boxes = []
    for one in view.robots:
        box = box_of(eye, view.camera, one.body, one.pose) or one.box
        inside = _area(one.box) / _area(box)
        boxes.append((box, one.face, one.share * inside))
    return view.image, boxes


def _area(box: tuple[float, float, float, float]) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=SHIPPED, metavar="FILE")
    parser.add_argument("--robots", type=int, default=ROBOTS, metavar="N", help="views with a robot")
    parser.add_argument("--empty", type=int, default=EMPTY, metavar="N", help="views without one")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    args = parser.parse_args()
    robots: list[RobotExample] = []
    backgrounds: list[Background] = []
    asked = asked_views(FIRST, args.robots, True) + asked_views(FIRST, args.empty, False)
    with bar(total=len(asked), unit="view") as shown:
        for number, (picture, boxes) in enumerate(each_view(asked, args.jobs, boxes_of)):
            robots += _examples(picture, boxes)
            # half of the views with a robot tell what lies around it: parts of a robot are no robot
            if not asked[number].robot or number % 2:
                backgrounds.append(Background(picture, np.array([box for box, *_ in boxes]).reshape(-1, 4)))
            shown.update()
    with bar(unit="picture") as shown:
        for step in train(robots, backgrounds):
            if isinstance(step, Training):
                result = step
                continue
            shown.total = step.total
            shown.update(step.done - shown.n)
    write_file(args.out, model_to_bytes(result.model))
    rows = [["class", "precision", "recall", "windows of robots", "of backgrounds"]]
    for score in result.scores:
        shares = f"{score.precision:.2%}", f"{score.recall:.2%}"
        rows.append([score.label, *shares, str(score.robots), str(score.windows)])
    print(*aligned(rows), sep="\n")


def _examples(picture: Picture, boxes: Boxes) -> Iterator[RobotExample]:
    """The robots that are nearly whole in a picture."""
    for box, face, share in boxes:
        if share >= WHOLE:
            yield RobotExample(picture, np.array(box), face)


if __name__ == "__main__":
    main()
