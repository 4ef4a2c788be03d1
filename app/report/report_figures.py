"""Pictures of a result for its report: both maps with the sighting, the merge, what contradicts, the proof.

All of them are drawn light: a report is printed, and read by people who never saw the page.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.common.robot_names import RobotNames
from algorithms.maps.grid_map import OCCUPIED_FROM, UNKNOWN, BoolArray, GridMap
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.observations.observation import Encounter, Observation
from algorithms.optimisation.branch_and_bound import ProofState
from algorithms.verdict.contradictions import Contradictions, near_walls
from app.drawing.grid_pixels import is_free, wall_masks
from app.drawing.palette import LIGHT, Rgb
from app.drawing.scene_layout import Rect, known_corners, rect_of
from app.drawing.svg.map_plot import RasterView, cells_seen, draw_map, robot, scale_bar, scene, under
from app.drawing.svg.svg_canvas import SvgCanvas, SvgPlot, draw_chart, ticks
from app.model import chart_data as charts
from app.model.contradiction_text import MOST_PLACES
from app.model.objective_label import ObjectiveLabel

FULL = 760.0  # width of a picture of the report; two stand side by side in it
PAIR, BETWEEN = 372.0, 16.0
FINE = 1.75  # pixels of a map to one of its sheet: crisp in print
FAINT: Rgb = (203, 209, 217)  # walls that are not the point


def sources(
    ref: GridMap, mov: GridMap, seen: Sequence[Observation], met: Sequence[Encounter], names: RobotNames
) -> str:
    """Both maps as they came, with the sightings in them."""
    in_ref = [o.observer.xy for o in seen] + [at.x_ref for at in met]
    marks = ((ref, in_ref), (mov, [at.x_mov for at in met]))
    views = [_fitted(np.vstack([known_corners(grid), *at]), PAIR, 170.0, 420.0) for grid, at in marks]
    high = max(high for _, high in views)
    sheet = SvgCanvas(high + 22, FULL)
    colours = (LIGHT.ref, LIGHT.mov)
    roles = (", of the robot that saw", ", of the robot that was seen") if seen else ("", "")
    for k, grid in enumerate((ref, mov)):
        x = k * (PAIR + BETWEEN)
        rect = _widened(views[k][0], PAIR / high)
        view = RasterView(rect, int(FINE * PAIR), int(FINE * high))
        plot = scene(sheet, x, 20, PAIR, high, view)
        sheet.text(x, 12, names.told(f"map {k + 1}") + roles[k], 12, colour=colours[k], bold=True)
        plot.image(draw_map(view, LIGHT, grid, colours[k]))
        for number, (o, at) in enumerate(zip(seen, met, strict=True), 1):
            label = "" if len(seen) == 1 else f" {number}"
            if k == 0:
                ends = plot.at([o.observer.xy, at.x_ref])
                sheet.path(ends, "#fff", 3.5)
                sheet.path(ends, LIGHT.text, 1.6, dash="5 4")
                sheet.dot(*ends[1].tolist(), 6, None, LIGHT.conflict, width=2)
                robot(plot, o.observer.xy, o.observer.theta, LIGHT.ref)
                _name(plot, o.observer.xy, names.ref + label, LIGHT.ref)
            else:
                robot(plot, at.x_mov, o.observed_heading, LIGHT.mov)
                _name(plot, at.x_mov, names.mov + label, LIGHT.mov)
        sheet.rect(x, 20, PAIR, high, None, LIGHT.margin, 0.4)
        scale_bar(plot)
    how = ": robot 1 and the place where it saw robot 2, robot 2 in its own map" if seen else ""
    return sheet.svg(names.told(f"Both maps as they came{how}"))


def overlay(result: MergeResult, seen: Sequence[Observation], names: RobotNames) -> str:
    """Both maps under the transform: whose wall it is, where they agree, where they contradict."""
    ref, mov = result.fusion.ref_cells, result.fusion.mov_cells
    walls, free = (ref >= OCCUPIED_FROM, mov >= OCCUPIED_FROM), (is_free(ref), is_free(mov))
    plot = _merged_plot(result.fusion, *wall_masks(walls, free, LIGHT, near_walls(result.fusion)))
    for o in seen[:1]:
        robot(plot, o.observer.xy, o.observer.theta, LIGHT.ref)
        there = result.T_ref_mov.apply(result.pivot)
        heading = None if o.observed_heading is None else o.observed_heading + result.T_ref_mov.theta
        robot(plot, there, heading, LIGHT.mov)
        _name(plot, o.observer.xy, names.ref, LIGHT.ref)
        _name(plot, there, names.mov, LIGHT.mov)
    maps = (names.told("map 1"), LIGHT.ref), (names.told("map 2"), LIGHT.mov)
    chips = (*maps, ("both", LIGHT.agreed))
    return _finish(plot, (*chips, ("contradiction", LIGHT.conflict)), "The merged map")


def difference(result: MergeResult, found: Contradictions, names: RobotNames) -> str:
    """Walls that the other map denies, in the colour of their map, and the numbered places they make."""
    fusion = result.fusion
    walls = np.maximum(fusion.ref_cells, fusion.mov_cells) >= OCCUPIED_FROM
    plot = _merged_plot(fusion, (walls, FAINT), (found.ref_only, LIGHT.ref), (found.mov_only, LIGHT.mov))
    px = plot.wide / (plot.across[1] - plot.across[0])
    for n, place in reversed([*enumerate(found.places[:MOST_PLACES], 1)]):  # the largest on top
        x, y = plot.one(place.x, place.y)
        r = max(10.0, (place.radius + 0.25) * px)
        plot.sheet.dot(x, y, r, None, "#fff", width=4)
        plot.sheet.dot(x, y, r, None, LIGHT.conflict, width=1.8)
        x, y = x + 0.707 * r, y - 0.707 * r
        plot.sheet.dot(x, y, 8, LIGHT.conflict)
        plot.sheet.text(x, y + 3.6, str(n), 10.5, "middle", "#fff", bold=True)
    chips = (
        (names.told("map 1 alone, where map 2 saw floor"), LIGHT.ref),
        (names.told("map 2 alone, where map 1 saw floor"), LIGHT.mov),
        ("other walls", FAINT),
    )
    return _finish(plot, chips, "Where the maps contradict each other")


def proof(state: ProofState, measure: ObjectiveLabel, names: RobotNames) -> str:
    """What is known of every turn of the circle: no transform at that turn is better than its ceiling."""
    finite = state.ceilings[np.isfinite(state.ceilings)]
    chart = charts.proof(state, float(finite.max()) if len(finite) else 0.0, measure)
    assert chart.up is not None
    sheet = SvgCanvas(252, FULL)
    plot = SvgPlot(sheet, 50, 8, FULL - 66, 180, (-180.0, 180.0), chart.up)
    draw_chart(plot, chart, LIGHT)
    across = names.told("turn of map 2 (°), the whole circle")
    plot.axes(across, measure.row, (-180, -90, 0, 90, 180), ticks(*chart.up, 4))
    entries = (
        ("ceiling: nothing is better", LIGHT.margin, "line"),
        ("best that was met", LIGHT.particle, "line"),
        ("below this nothing was looked for", LIGHT.rival, "line"),
        ("rivals", LIGHT.rival, "dot"),
        ("optimum" if state.proven else "best so far", LIGHT.answer, "dot"),
    )
    after = 50.0
    for words, colour, shape in entries:
        after = sheet.chip(after, 244, colour, words, shape)
    return sheet.svg("The best value at every turn, and the bound above it")


def _merged_plot(fusion: Fusion, *masks: tuple[BoolArray, Rgb]) -> SvgPlot:
    """A plot of the merged map's floor and of masks of its cells, each in its colour."""
    grid = fusion.merged
    rect, high = _fitted(known_corners(grid), FULL, 260.0, 620.0)
    view = RasterView(_widened(rect, FULL / high), int(FINE * FULL), int(FINE * high))
    pixels = view.blank(LIGHT)
    pixels[under(grid.cells, grid, view, None, UNKNOWN) != UNKNOWN] = LIGHT.free
    for mask, colour in masks:
        pixels[cells_seen(mask, grid, view)] = colour
    plot = scene(SvgCanvas(high + 24, FULL), 0, 0, FULL, high, view)
    plot.image(pixels)
    return plot


def _finish(plot: SvgPlot, chips: Sequence[tuple[str, Rgb]], title: str) -> str:
    sheet = plot.sheet
    sheet.rect(0, 0, FULL, plot.high, None, LIGHT.margin, 0.4)
    scale_bar(plot)
    after = 0.0
    for words, colour in chips:
        after = sheet.chip(after, plot.high + 17, colour, words)
    return sheet.svg(title)


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
