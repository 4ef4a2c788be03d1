"""How well robots are found in images and scans that the detector was never trained on: ``make sightings``.

Simulated views of other buildings and by other light: with a robot, without one, and with what breaks the
paper's assumptions. Counted are robots found, false boxes before and after the laser, errors, and how often
an error is within the bound that the stated deviations give it.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path

import numpy as np
from markdown_table import markdown
from rendered_views import ViewAsked, asked_views, each_view

from algorithms.common.pose import wrap_angle
from algorithms.detection.detection import Detector, overlaps
from algorithms.detection.footprint import Footprint
from algorithms.detection.model_file import shipped_model
from algorithms.detection.robot_sighting import SightedRobots, sight
from algorithms.detection.svm_detector import SvmDetector
from algorithms.files.atomic_write import write_file
from algorithms.simulator.views.hardships import HARDSHIPS
from algorithms.simulator.views.robot_views import RobotView
from app.cli.progress_bar import bar

FIRST = 600_000  # seed of the first view; the detector's training uses higher ones
CHI2_95 = 5.991  # of two degrees of freedom
SAME_BOX = 0.4  # shared over joint area, from which a box is the robot's
FAR_OFF = 0.5  # metres; a sighting that is so far from every robot is of none
NEAR = 5.0  # metres, within which a robot is to be found


@dataclass(frozen=True)
class Looked:
    """What became of one view.

    distance     : of its robot; metres, NaN without one
    boxed        : whether the detector's boxes hold one of the robot
    false_boxes  : boxes on no robot: of the detector alone, and those that the laser confirms
    found        : whether a sighting came out
    wrong        : whether that sighting is of no robot, or far off
    range_error, bearing_error : metres, radians; NaN without a sighting
    sigma_range, sigma_bearing : as the sighting states them
    reason       : of a refusal
    class_right  : whether front or back, and side, are told apart
    """

    distance: float
    boxed: bool
    false_boxes: tuple[int, int]
    found: bool
    wrong: bool
    range_error: float = nan
    bearing_error: float = nan
    sigma_range: float = nan
    sigma_bearing: float = nan
    reason: str = ""
    class_right: bool = False

    @property
    def chi2(self) -> float:
        return (self.range_error / self.sigma_range) ** 2 + (self.bearing_error / self.sigma_bearing) ** 2


def look(asked: ViewAsked, view: RobotView) -> Looked:
    """Find the robot of a view as ``mapmeld observe`` does, without a map."""
    detector: Detector = SvmDetector(shipped_model())
    seen = sight(detector.detect(view.image, view.camera), view.scan, view.camera, Footprint())
    return judged(view, seen)


def judged(view: RobotView, seen: SightedRobots) -> Looked:
    """A sighting against the truth of its view."""
    robots = [*view.robots, *view.reflections]
    boxes = np.array([one.box for one in robots]).reshape(-1, 4)
    on_robot = [
        bool(len(boxes)) and bool((overlaps(boxes, np.array(one.detection.box()))[0] > SAME_BOX).any())
        for one in seen.sighted
    ]
    false = [one for one, on in zip(seen.sighted, on_robot, strict=True) if not on]
    counts = len(false), sum(one.position is not None for one in false)
    distance = min((one.range for one in view.robots), default=nan)
    if seen.position is None:
        return Looked(distance, any(on_robot), counts, False, False, reason=seen.reason)
    position = seen.position
    places = [one.range * np.array([np.cos(one.bearing), np.sin(one.bearing)]) for one in view.robots]
    off = [float(np.hypot(*(place - position.point()))) for place in places]
    if not off or min(off) > FAR_OFF:
        return Looked(distance, any(on_robot), counts, True, True)
    true = view.robots[int(np.argmin(off))]
    return Looked(
        distance, any(on_robot), counts, True, False,
        position.range - true.range, wrap_angle(position.bearing - true.bearing),
        position.sigma_range, position.sigma_bearing,
        class_right=seen.sighted[seen.chosen].detection.label == true.face,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument(
        "--views", type=int, default=1000, metavar="N", help="with a robot, and as many without"
    )
    parser.add_argument("--hard", type=int, default=48, metavar="N", help="of every hardship")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    parser.add_argument("--out", type=Path, metavar="FILE", help="every view as JSON, too")
    args = parser.parse_args()
    asked = asked_views(FIRST, args.views, True) + asked_views(FIRST, args.views, False)
    for name in HARDSHIPS:
        asked += asked_views(FIRST, args.hard, True, name)
    looked: list[Looked] = []
    with bar(total=len(asked), unit="view") as shown:
        for one in each_view(asked, args.jobs, look):
            looked.append(one)
            shown.update()
    groups: dict[str, list[Looked]] = {}
    for which, one in zip(asked, looked, strict=True):
        groups.setdefault(which.hardship or ("a robot" if which.robot else "no robot"), []).append(one)
    print(*_tables(groups), sep="\n")
    if args.out is not None:
        rows = [{"seed": a.seed, "kind": a.kind, "hardship": a.hardship, **one.__dict__}
                for a, one in zip(asked, looked, strict=True)]  # fmt: skip
        write_file(args.out, json.dumps(rows, indent=1).encode())


def _tables(groups: dict[str, list[Looked]]) -> list[str]:
    seen = groups["a robot"]
    near = [one for one in seen if one.distance <= NEAR]
    rows = [["distance", "views", "in a box", "found", "range error, median", "bearing error, median",
             "within the 95 % bound", "class right"]]  # fmt: skip
    for low, high in ((1, 2), (2, 3), (3, 4), (4, 5), (5, 6)):
        part = [one for one in seen if low <= one.distance < high]
        rows.append([f"{low} – {high} m", *_row(part)])
    rows.append([f"up to {NEAR:g} m", *_row(near)])
    empty = groups["no robot"]
    boxes, kept = (sum(one.false_boxes[k] for one in empty) for k in (0, 1))
    lines = [markdown(rows)]
    lines += [
        "",
        f"Without a robot, {len(empty)} views: {boxes} boxes, {kept} of them confirmed by the laser.",
    ]
    rows = [["hardship", "views", "sighting", "right", "wrong", "within the 95 % bound", "refused"]]
    for name, part in groups.items():
        if name in HARDSHIPS:
            right = [one for one in part if one.found and not one.wrong]
            wrong = sum(one.wrong for one in part)
            rows.append([name, str(len(part)), str(len(right) + wrong), str(len(right)), str(wrong),
                         _share(sum(one.chi2 < CHI2_95 for one in right), len(right)),
                         str(len(part) - len(right) - wrong)])  # fmt: skip
    return [*lines, "", markdown(rows)]


def _row(part: Sequence[Looked]) -> list[str]:
    right = [one for one in part if one.found and not one.wrong]
    if not right:
        return [str(len(part)), *["–"] * 6]
    return [
        str(len(part)),
        _share(sum(one.boxed for one in part), len(part)),
        _share(len(right), len(part)),
        f"{1000 * np.median([abs(one.range_error) for one in right]):.0f} mm",
        f"{np.degrees(np.median([abs(one.bearing_error) for one in right])):.2f}°",
        _share(sum(one.chi2 < CHI2_95 for one in right), len(right)),
        _share(sum(one.class_right for one in right), len(right)),
    ]


def _share(count: int, of: int) -> str:
    return f"{count} ({count / of:.1%})" if of else "–"


if __name__ == "__main__":
    main()
