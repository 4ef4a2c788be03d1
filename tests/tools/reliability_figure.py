"""Whether probabilities are what they say, as a diagram: how likely merges were told to be right, and how
many were.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot

from matplotlib.figure import Figure
from model_fit import Forecast

from algorithms.verdict.calibration import Bin, calibration_error, reliability
from app.drawing.palette import LIGHT, css
from app.evaluation.figure_style import COLOURS, MARKERS, figure_files

NEAR = 0.08  # bins nearer than that share a number's place


def reliability_figure(told: Mapping[str, Forecast]) -> dict[str, bytes]:
    """The files of the diagram by suffix.

    told : what a model says of several sets of merges, by their names
    """

    def draw(figure: Figure) -> None:
        figure.suptitle("How likely a merge is said to be right, and how many are", x=0.01, ha="left")
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1], color=css(LIGHT.margin), linewidth=1, linestyle="--")
        for number, (name, each) in enumerate(told.items()):
            bins = [one for one in reliability(each.probabilities, each.right) if one.n]
            ece = calibration_error(each.probabilities, each.right)
            axes.plot(
                [one.probability for one in bins],
                [one.right for one in bins],
                color=COLOURS[number],
                marker=MARKERS[number],
                label=f"{name}: {len(each.right):,} merges, ECE {ece:.3f}",
            )
            for first, *more in _beside(bins):
                axes.annotate(
                    " + ".join(f"{one.n:,}" for one in (first, *more)),
                    (first.probability, first.right),
                    xytext=(0, -12 + 18 * number),
                    textcoords="offset points",
                    ha="center",
                    fontsize=7,
                    color=COLOURS[number],
                )
        axes.set_xlabel("probability told (mean of the bin; the numbers count its merges)")
        axes.set_ylabel("share that is right")
        axes.set_xlim(-0.03, 1.06)
        axes.set_ylim(-0.04, 1.08)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), frameon=False)

    return figure_files(draw, 6.4, 5.4)


def _beside(bins: Sequence[Bin]) -> list[list[Bin]]:
    """The bins, those together whose numbers would be written over one another."""
    groups: list[list[Bin]] = []
    for one in bins:
        last = groups[-1][-1] if groups else None
        if last and hypot(one.probability - last.probability, one.right - last.right) < NEAR:
            groups[-1].append(one)
        else:
            groups.append([one])
    return groups
