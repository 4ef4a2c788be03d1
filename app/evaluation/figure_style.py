"""What all figures share: fonts, colours, and files that are the same for the same numbers."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from threading import Lock
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from app.drawing.palette import LIGHT, css

DPI = 150  # of the PNG; a figure of 9 inches is then wider than a README shows it

STYLE = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same letters everywhere
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelcolor": css(LIGHT.text),
    "axes.edgecolor": css(LIGHT.margin),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": css(LIGHT.unknown),
    "xtick.color": css(LIGHT.rim),
    "ytick.color": css(LIGHT.rim),
    "text.color": css(LIGHT.text),
    "legend.frameon": False,
    "legend.fontsize": 8,
    "figure.titlesize": 11,
    "figure.titleweight": "bold",
    "svg.hashsalt": "mapmeld",  # the same ids in the same figure
    "svg.fonttype": "path",
}

# Okabe and Ito's, in an order in which neighbours differ also in lightness; and a sign for each
COLOURS = [css(c) for c in (LIGHT.ref, LIGHT.conflict, LIGHT.mov, LIGHT.best, LIGHT.particle, LIGHT.rim)]
MARKERS = ["o", "s", "^", "D", "v", "P"]

_DRAWING = Lock()  # matplotlib is told how to draw for the whole process


def figure_files(draw: Callable[[Figure], None], width: float, height: float) -> dict[str, bytes]:
    """The files of a figure by their suffix, ".png" and ".svg": the same bytes for the same drawing.

    draw          : fills the figure
    width, height : inches
    """
    with _DRAWING, mpl.rc_context(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        draw(figure)
        return {".png": _saved(figure, "png", Software=None), ".svg": _saved(figure, "svg", Date=None)}


def _saved(figure: Figure, kind: str, **metadata: Any) -> bytes:
    stream = BytesIO()
    figure.savefig(stream, format=kind, dpi=DPI, metadata=metadata, facecolor="white")
    return stream.getvalue()
