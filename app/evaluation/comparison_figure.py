"""A comparison as figures: the merged maps side by side, Figs. 15 and 16, and bars of eq. (23), Fig. 17."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from algorithms.common.errors import TooLargeError
from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.maps.map_fusion import fuse
from app.drawing.grid_pixels import Pixels
from app.drawing.palette import LIGHT, css
from app.evaluation.compared_methods import COMPARED
from app.evaluation.figure_style import figure_files
from app.evaluation.method_comparison import ComparedRun, tally
from app.evaluation.method_run import MethodRun
from app.evaluation.table_files import apart_text
from app.report.result_files import overlay

COLUMNS = 4
MOST_PIXELS = 320  # a side of a panel: walls of one pixel are then seen
MARGIN = 10  # pixels around it
MOST_CASES = 8  # with bars of their own

RIGHT, WRONG, NOTHING = css(LIGHT.ref), css(LIGHT.conflict), css(LIGHT.margin)
RIGHT_AND_WRONG = (
    Patch(facecolor=RIGHT, edgecolor=RIGHT, label="right transform"),
    Patch(facecolor="white", edgecolor=WRONG, label="wrong transform"),
)


def maps_figure(case: Case, scores: Sequence[ComparedRun], title: str) -> dict[str, bytes]:
    """The files of the merged maps of one case, a panel per method, by suffix."""
    in_order = [score for name in COMPARED for score in scores if score.method == name]
    rows, columns = _grid(len(in_order))

    def draw(figure: Figure) -> None:
        figure.suptitle(title, x=0.01, ha="left")
        figure.get_layout_engine().set(w_pad=0.08, h_pad=0.12, hspace=0.03)  # type: ignore[union-attr]
        panels = _panels(figure, len(in_order))
        for panel, score in zip(panels.ravel(), in_order, strict=False):
            _panel(panel, case, score)
        keys = {
            "wall of map 1": LIGHT.ref,
            "wall of map 2": LIGHT.mov,
            "wall of both": LIGHT.agreed,
            "wall that the other denies": LIGHT.conflict,
        }
        _legend(figure, [Patch(color=css(rgb), label=label) for label, rgb in keys.items()])

    return figure_files(draw, 2.6 * columns, 2.9 * rows + 0.6)


def _grid(count: int) -> tuple[int, int]:
    """Rows and columns of so many panels."""
    columns = min(COLUMNS, count)
    return ceil(count / columns), columns


def _panels(figure: Figure, count: int, **shared: bool) -> Any:
    """Rows of axes; those that are too many are not drawn."""
    panels = figure.subplots(*_grid(count), squeeze=False, **shared)
    for panel in panels.ravel()[count:]:
        panel.set_axis_off()
    return panels


def _legend(figure: Figure, patches: Sequence[Patch]) -> None:
    figure.legend(handles=patches, loc="outside lower center", ncols=len(patches))


def _panel(axes: Axes, case: Case, score: ComparedRun) -> None:
    axes.set_box_aspect(1)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(visible=False)
    for spine in axes.spines.values():
        spine.set(visible=True, color=css(LIGHT.unknown))
    outcome, hue = _outcome(score.trial)
    axes.set_title("\n".join(textwrap.wrap(COMPARED[score.method].title, 30)), fontsize=8.5)
    axes.set_xlabel(outcome, color=hue, fontsize=8)
    pose = score.trial.pose
    in_the_middle: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "fontsize": 7}
    if pose is None:
        why = textwrap.fill(score.trial.reason.removeprefix("Refused: "), 34, max_lines=7)
        axes.text(0.5, 0.5, why, va="center", color=NOTHING, **in_the_middle)
        return
    try:
        pixels = overlay(fuse((case.ref, case.mov), (Pose2(), pose)), MOST_PIXELS)
    except TooLargeError:
        axes.text(0.5, 0.5, "too far apart to be drawn", **in_the_middle)
        return
    axes.imshow(_square(pixels), interpolation="antialiased")


def _square(pixels: Pixels) -> Pixels:
    """What is known of a picture in the middle of a square."""
    known = np.any(pixels != np.array(LIGHT.unknown, dtype=np.uint8), axis=2)
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if len(rows):
        pixels = pixels[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]
    height, width = pixels.shape[:2]
    side = max(height, width) + 2 * MARGIN
    square = np.full((side, side, 3), LIGHT.unknown, dtype=np.uint8)
    top, left = (side - height) // 2, (side - width) // 2
    square[top : top + height, left : left + width] = pixels
    return square


def _outcome(trial: MethodRun) -> tuple[str, str]:
    """What became of it, and the colour of that."""
    if trial.failed:
        return "could not be run", NOTHING
    if trial.T_ref_mov is None:
        return "no transform found", NOTHING
    index = "" if trial.index is None else f"\neq. (23): {trial.index:.3f}"
    verdict = ("accepted, bent" if trial.bent else "accepted") if trial.accepted else "refused"
    if trial.right is None:
        return f"{verdict}{index}", css(LIGHT.text)
    word, hue = ("right", RIGHT) if trial.right else ("WRONG", WRONG)
    off = "" if trial.distance is None else f", {apart_text(trial.distance, trial.angle)}"
    return f"{word}{off}\n{verdict}{index.replace(chr(10), ' · ')}", hue


def bars_figure(scores: Sequence[ComparedRun]) -> dict[str, bytes]:
    """The files of the bars of eq. (23), by suffix: a group per case, or the means of many cases."""
    cases = list(dict.fromkeys(score.case for score in sorted(scores, key=lambda score: score.case)))
    methods = [name for name in COMPARED if any(score.method == name for score in scores)]
    if len(cases) > MOST_CASES:
        return figure_files(lambda figure: _means(figure, scores, methods), 8, 1.2 + 0.32 * len(methods))
    rows, columns = _grid(len(cases))

    def draw(figure: Figure) -> None:
        panels = _panels(figure, len(cases), sharey=True, sharex=True)
        for panel, case in zip(panels.ravel(), cases, strict=False):
            mine = {score.method: score.trial for score in scores if score.case == case}
            _bars(panel, [mine.get(name) for name in methods], case)
        first = panels[0, 0]
        first.set_yticks(range(len(methods)), methods)
        first.invert_yaxis()
        for panel in panels[-1]:
            panel.set_xlabel("eq. (23)")
        _legend(figure, RIGHT_AND_WRONG)

    return figure_files(draw, 2.0 + 2.1 * columns, 0.9 + rows * (0.5 + 0.2 * len(methods)))


def _bars(axes: Axes, trials: Sequence[MethodRun | None], title: str) -> None:
    axes.set(xlim=(0, 1.14), title=title)
    axes.set_xticks([0, 0.5, 1])
    axes.grid(visible=False, axis="y")
    for row, trial in enumerate(trials):
        if trial is None or trial.failed or trial.T_ref_mov is None:
            text = "not run" if trial is None or trial.failed else "no transform"
            axes.text(0.02, row, text, va="center", fontsize=7, color=NOTHING)
        elif trial.index is not None:
            hue = {True: RIGHT, False: WRONG, None: NOTHING}[trial.right]
            fill = "white" if trial.right is False else hue
            axes.barh(row, trial.index, height=0.7, color=fill, edgecolor=hue, linewidth=1.2)
            axes.text(trial.index + 0.015, row, f"{trial.index:.2f}", va="center", fontsize=7)


def _means(figure: Figure, scores: Sequence[ComparedRun], methods: Sequence[str]) -> None:
    axes = figure.subplots()
    rows = tally(scores)
    for row, name in enumerate(methods):
        mean = rows[name].index
        if mean is not None:
            axes.barh(row, mean, height=0.75, color=css(LIGHT.unknown), zorder=1)
            axes.text(1.03, row, f"{mean:.3f}", va="center", fontsize=8)
        trials = [score.trial for score in scores if score.method == name and score.trial.index is not None]
        for right, hue, fill in ((True, RIGHT, RIGHT), (False, WRONG, "white")):
            values = [trial.index for trial in trials if trial.right is right]
            at = [row] * len(values)
            axes.scatter(values, at, s=16, color=fill, edgecolor=hue, linewidth=0.9, zorder=2)
    title = "Eq. (23): bars are means, a dot is a case"
    axes.set(xlim=(0, 1.12), title=title, xlabel="eq. (23) over the true overlap")
    axes.set_yticks(range(len(methods)), methods)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    _legend(figure, RIGHT_AND_WRONG)
