"""Pictures of a result for its report: both maps with the sighting, the merge, what contradicts, the proof.

All of them are drawn light: a report is printed, and read by people who never saw the page.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED_FROM, UNKNOWN, BoolArray, GridMap, where
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.observations.observation import Encounter, Observation
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.contradictions import Contradictions
from app.drawing.palette import LIGHT, Rgb
from app.drawing.scene_layout import Rect, known_corners, rect_of
from app.drawing.svg.chart_plot import draw_chart
from app.drawing.svg.map_plot import robot, scale_bar, scene
from app.drawing.svg.map_raster import Pixels, RasterView, draw_map
from app.drawing.svg.svg_canvas import SvgCanvas, SvgPlot, ticks
from app.model import chart_data as charts
from app.model.contradiction_text import MOST_PLACES
from app.model.objective_label import ObjectiveLabel

FULL = 760.0  # width of a picture of the report; two stand side by side in it
PAIR, BETWEEN = 372.0, 16.0
FINE = 1.75  # pixels of a map to one of its sheet: crisp in print
FAINT: Rgb = (203, 209, 217)  # walls that are not the point


def sources(ref: GridMap, mov: GridMap, seen: Sequence[Observation], met: Sequence[Encounter]) -> str:
    """Both maps as they came, with the sightings in them."""
    views = []
    for grid, more in (
        (ref, [o.observer.xy for o in seen] + [at.x_ref for at in met]),
        (mov, [at.x_mov for at in met]),
    ):
        views.append(_fitted(np.vstack([known_corners(grid), *more]), PAIR, 170.0, 420.0))
    high = max(high for _, high in views)
    sheet = SvgCanvas(high + 22, FULL)
    colours, names = (
        (LIGHT.ref, LIGHT.mov),
        ("map 1, of the robot that saw", "map 2, of the robot that was seen"),
    )
    for k, grid in enumerate((ref, mov)):
        x = k * (PAIR + BETWEEN)
        rect = _widened(views[k][0], PAIR / high)
        view = RasterView(rect, int(FINE * PAIR), int(FINE * high))
        plot = scene(sheet, x, 20, PAIR, high, view)
        sheet.text(x, 12, names[k], 12, colour=colours[k], bold=True)
        plot.image(draw_map(view, LIGHT, grid, colours[k]))
        for number, (o, at) in enumerate(zip(seen, met, strict=True), 1):
            label = "" if len(seen) == 1 else f" {number}"
            if k == 0:
                ends = plot.at([o.observer.xy, at.x_ref])
                sheet.path(ends, "#fff", 3.5)
                sheet.path(ends, LIGHT.text, 1.6, dash="5 4")
                sheet.dot(*ends[1].tolist(), 6, None, LIGHT.conflict, width=2)
                robot(plot, o.observer.xy, o.observer.theta, LIGHT.ref)
                _name(plot, o.observer.xy, f"robot 1{label}", LIGHT.ref)
            else:
                robot(plot, at.x_mov, o.observed_heading, LIGHT.mov)
                _name(plot, at.x_mov, f"robot 2{label}", LIGHT.mov)
        sheet.rect(x, 20, PAIR, high, None, LIGHT.margin, 0.4)
        scale_bar(plot)
    return sheet.svg(
        "Both maps as they came: robot 1 and the place where it saw robot 2, robot 2 in its own map"
    )


def overlay(result: MergeResult, seen: Sequence[Observation]) -> str:
    """Both maps under the transform: whose wall it is, where they agree, where they contradict."""
    fusion = result.fusion
    plot, raster = _merged_plot(fusion)
    ref_wall, mov_wall = fusion.ref_cells >= OCCUPIED_FROM, fusion.mov_cells >= OCCUPIED_FROM
    against = (ref_wall & _free(fusion.mov_cells)) | (mov_wall & _free(fusion.ref_cells))
    for mask, colour in (
        (ref_wall, LIGHT.ref),
        (mov_wall, LIGHT.mov),
        (ref_wall & mov_wall, LIGHT.agreed),
        (against, LIGHT.conflict),
    ):
        raster.paint(mask, colour)
    plot.image(raster.pixels)
    o, at = seen[0], result.encounters[0]
    robot(plot, o.observer.xy, o.observer.theta, LIGHT.ref)
    there = result.T_ref_mov.apply(at.x_mov)
    heading = None if o.observed_heading is None else o.observed_heading + result.T_ref_mov.theta
    robot(plot, there, heading, LIGHT.mov)
    _name(plot, o.observer.xy, "robot 1", LIGHT.ref)
    _name(plot, there, "robot 2", LIGHT.mov)
    chips = (("map 1", LIGHT.ref), ("map 2", LIGHT.mov), ("both", LIGHT.agreed))
    return _finish(plot, (*chips, ("contradiction", LIGHT.conflict)), "The merged map")


def difference(result: MergeResult, found: Contradictions) -> str:
    """Walls that the other map denies, in the colour of their map, and the numbered places they make."""
    fusion = result.fusion
    plot, raster = _merged_plot(fusion)
    raster.paint((fusion.ref_cells >= OCCUPIED_FROM) | (fusion.mov_cells >= OCCUPIED_FROM), FAINT)
    raster.paint(found.ref_only, LIGHT.ref)
    raster.paint(found.mov_only, LIGHT.mov)
    plot.image(raster.pixels)
    px = plot.wide / (plot.across[1] - plot.across[0])
    listed = list(enumerate(found.places[:MOST_PLACES], 1))
    for n, place in reversed(listed):  # the largest on top
        x, y = plot.one(place.x, place.y)
        r = max(10.0, (place.radius + 0.25) * px)
        plot.sheet.dot(x, y, r, None, "#fff", width=4)
        plot.sheet.dot(x, y, r, None, LIGHT.conflict, width=1.8)
        x, y = x + 0.707 * r, y - 0.707 * r
        plot.sheet.dot(x, y, 8, LIGHT.conflict)
        plot.sheet.text(x, y + 3.6, str(n), 10.5, "middle", "#fff", bold=True)
    chips = (
        ("map 1 alone, where map 2 saw floor", LIGHT.ref),
        ("map 2 alone, where map 1 saw floor", LIGHT.mov),
    )
    return _finish(plot, (*chips, ("other walls", FAINT)), "Where the maps contradict each other")


def proof(state: ProofState, measure: ObjectiveLabel) -> str:
    """What is known of every turn of the circle: no transform at that turn is better than its ceiling."""
    finite = state.ceilings[np.isfinite(state.ceilings)]
    chart = charts.proof(state, float(finite.max()) if len(finite) else 0.0, measure)
    assert chart.up is not None
    sheet = SvgCanvas(252, FULL)
    plot = SvgPlot(sheet, 50, 8, FULL - 66, 180, (-180.0, 180.0), chart.up)
    draw_chart(plot, chart, LIGHT)
    plot.axes(
        "turn of map 2 (°), the whole circle", measure.row, (-180, -90, 0, 90, 180), ticks(*chart.up, 4)
    )
    entries = [
        ("ceiling: nothing is better", LIGHT.margin, "line"),
        ("best that was met", LIGHT.particle, "line"),
    ]
    entries += [("below this nothing was looked for", LIGHT.rival, "line"), ("rivals", LIGHT.rival, "dot")]
    entries.append(("optimum" if state.proven else "best so far", LIGHT.answer, "dot"))
    after = 50.0
    for words, colour, shape in entries:
        after = sheet.chip(after, 244, colour, words, shape)
    return sheet.svg("The best value at every turn, and the bound above it")


class _Raster:
    """Pixels of a view, painted by masks of a grid's cells; no cell is lost where a pixel holds many."""

    def __init__(self, view: RasterView, grid: GridMap) -> None:
        self._view, self._grid = view, grid
        at = np.floor(grid.grid_coordinates(view.places())).astype(np.intp)
        self._inside = np.all((at >= 0) & (at < (grid.width, grid.height)), axis=1)
        self._below = at[self._inside, 1] * grid.width + at[self._inside, 0]
        self.pixels: Pixels = view.blank(LIGHT)
        self.paint(grid.cells != UNKNOWN, LIGHT.free, forward=False)

    def paint(self, mask: BoolArray, colour: Rgb, forward: bool = True) -> None:
        """Give these cells a colour."""
        seen = np.zeros(len(self._inside), dtype=np.bool_)
        seen[self._inside] = mask.ravel()[self._below]
        self.pixels[seen.reshape(self.pixels.shape[:2])] = colour
        if forward:
            row, col, there = self._view.pixels_of(self._grid.centres(*where(mask)))
            self.pixels[row[there], col[there]] = colour


def _merged_plot(fusion: Fusion) -> tuple[SvgPlot, _Raster]:
    rect, high = _fitted(known_corners(fusion.merged), FULL, 260.0, 620.0)
    view = RasterView(_widened(rect, FULL / high), int(FINE * FULL), int(FINE * high))
    return scene(SvgCanvas(high + 24, FULL), 0, 0, FULL, high, view), _Raster(view, fusion.merged)


def _finish(plot: SvgPlot, chips: Sequence[tuple[str, Rgb]], title: str) -> str:
    sheet = plot.sheet
    sheet.rect(0, 0, FULL, plot.high, None, LIGHT.margin, 0.4)
    scale_bar(plot)
    after = 0.0
    for words, colour in chips:
        after = sheet.chip(after, plot.high + 17, colour, words)
    return sheet.svg(title)


def _free(cells: NDArray[np.int8]) -> BoolArray:
    return np.asarray((cells >= FREE) & (cells <= FREE_UP_TO))


def _name(plot: SvgPlot, at: FloatArray, words: str, colour: Rgb) -> None:
    """Words beside a place: to its left where there is no room to its right."""
    x, y = plot.one(*at.tolist())
    left = x > plot.x + plot.wide - 70
    plot.sheet.text(
        x - 12 if left else x + 12, y - 6, words, 12, "end" if left else "start", colour, True, halo="#fff"
    )


def _fitted(points: FloatArray, wide: float, least: float, most: float) -> tuple[Rect, float]:
    """A rectangle around points with a margin, and how high a picture of this width is to hold it."""
    x0, y0, x1, y1 = rect_of(points)
    margin = 0.03 * max(x1 - x0, y1 - y0, 1.0)
    x0, y0, x1, y1 = x0 - margin, y0 - margin, x1 + margin, y1 + margin
    return (x0, y0, x1, y1), float(np.clip(wide * (y1 - y0) / (x1 - x0), least, most))


def _widened(rect: Rect, aspect: float) -> Rect:
    """The smallest rectangle of this width over height around another one."""
    x0, y0, x1, y1 = rect
    wide = max(x1 - x0, aspect * (y1 - y0))
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    return x - wide / 2, y - wide / aspect / 2, x + wide / 2, y + wide / aspect / 2
