"""Pictures of the maps themselves: the sighting, the levels, the list of walls, a turn, the merge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, exp, pi, sin

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import OCCUPIED_FROM, UNKNOWN, CellArray, GridMap
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.spectra_stages import augment_both
from algorithms.methods.steps import AugmentDetail, HoughDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.spectra.augmented_map import AugmentConfig
from app.drawing.draw_items import ellipse
from app.drawing.grid_pixels import is_free, upright, wall_masks
from app.drawing.grid_pixels import sheet as painted
from app.drawing.palette import Palette, Rgb, level_colours
from app.drawing.svg.map_plot import draw_levels, draw_map, map_panel, robot, under, view_of
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot, number, turn_label, worded
from app.drawing.svg.svg_grip import grip
from app.page.lesson.figures.figure_slider import FigureSlider, shown
from app.page.lesson.figures.search_figures import cut_out
from app.page.lesson.lesson_run import LessonRun

SPREAD = FigureSlider("σ_aug (m)", 79, 14, 0.5, 0.25)
RING_VIEW = 16.0  # metres to each side while σ_aug is dragged
HALF = 184.0  # width of one of two pictures side by side


def observation(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The sighting in map 1, and the same place in map 2."""
    i, o, met = lesson.inputs, lesson.inputs.observations[0], lesson.inputs.encounters[0]
    here, heading, sheet = o.observer.xy, o.observer.theta, SvgCanvas(226)
    half, reach = max(3.0, 0.75 * o.range + 1.5), 0.55 * o.range
    red, rim = palette.conflict, palette.free

    def about(x: float, grid: GridMap | None, centre: FloatArray, colour: Rgb, title: str) -> SvgPlot:
        view = view_of(centre, half, HALF, HALF)
        return map_panel(sheet, x, HALF, HALF, view, draw_map(view, palette, grid, colour), title)

    def ray(angle: float | FloatArray, length: float) -> FloatArray:
        """(…, 2) places so far from robot 1."""
        return here + length * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    middle = (here + met.x_ref) / 2
    plot = about(0.0, i.ref, middle, palette.ref, "map 1, as robot 1 drew it")
    x, y = plot.one(*met.x_ref.tolist())
    sheet.path(plot.at([here, ray(heading, 1.25 * reach)]), palette.margin, 1, dash="3 3")
    sheet.path(plot.at(ray(np.linspace(heading, heading + o.bearing, 24), reach)), red, 1.8)
    bow = plot.one(*ray(heading + o.bearing / 2, 1.25 * reach).tolist())
    sheet.text(*bow, "β", 13, "middle", red, True, halo=rim)
    sheet.path(plot.at([here, met.x_ref]), palette.text, 1.8, dash="5 4")
    away = heading + o.bearing - (0.5 if o.bearing < 0 else -0.5) * pi  # the arc's other side
    px, py = plot.one(*(middle + 0.1 * half * np.array([cos(away), sin(away)])).tolist())
    side = "start" if cos(away) > 0 else "end"
    sheet.text(px, py + 4, f"r = {o.range:.3f} m", 11, side, palette.text, halo=rim)
    robot(plot, here, heading, palette.ref)
    sheet.dot(x, y, 6, None, red, width=2)
    sheet.text(x + 9, y + 4, "x̂₁", 12, colour=red, bold=True, halo=rim)

    plot = about(196.0, i.mov, met.x_mov, palette.mov, "map 2, as robot 2 drew it")
    x, y = plot.one(*met.x_mov.tolist())
    robot(plot, met.x_mov, o.observed_heading, palette.mov)
    sheet.dot(x, y, 12, None, red, width=2)
    sheet.text(x + 15, y + 4, "x̂₂", 12, colour=red, bold=True, halo=rim)
    for left, name, place in ((0.0, "x̂₁", met.x_ref), (196.0, "x̂₂", met.x_mov)):
        sheet.text(left, 218, f"{name} = ({place[0]:.2f}, {place[1]:.2f}) m".replace("-", "−"), 11)
    return sheet.svg("Robot 1 and what it saw in map 1; the same place in map 2")


def level_scale(
    sheet: SvgCanvas, x: float, y: float, wide: float, peak: float, words: str, palette: Palette
) -> None:
    sheet.image(level_colours(np.linspace(0, 1, 256), palette.dark)[None], x, y, wide, 9, smooth=True)
    sheet.rect(x, y, wide, 9, None, INK, 0.35)
    for share in (0.0, 0.5, 1.0):
        anchor = {0.0: "start", 1.0: "end"}.get(share, "middle")
        sheet.text(x + share * wide, y + 20, number(float(f"{share * peak:.3g}")), 10, anchor)
    sheet.text(x + wide + 8, y + 9, words, 10.5)


def augmentation(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Both maps with their levels, the rings of Σ_aug around x̂, and the scale."""
    config, sheet = lesson.config.augment, SvgCanvas(240)
    half = 2.35 * config.spread * max(config.aspect, 1 / config.aspect) ** 0.5
    detail = lesson.get(AugmentDetail)
    _augmented(sheet, detail, config, half, palette)
    level_scale(sheet, 0, 212, 250, detail.ref.peak, "level (1/m²)", palette)
    return sheet.svg("Both maps, their walls coloured by level around the meeting place")


def ring(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The same with another σ_aug, by the handle on its ring, in maps that keep their size."""
    i, sheet, spread = lesson.inputs, SvgCanvas(252), shown(SPREAD, at[0])
    config = replace(lesson.config.augment, spread=spread)
    detail = augment_both(PairProblem.of(i.ref, i.mov, i.known), config)
    plot = _augmented(sheet, detail, config, RING_VIEW, palette)
    x_hat = detail.ref.x_hat
    (px, py), at_rim = plot.at([x_hat, x_hat + (spread, 0.0)]).tolist()
    grip(sheet, *at_rim, palette.conflict, r=(0, px, py, 2 * RING_VIEW / HALF))
    counts = float(detail.ref.levels.sum() / detail.ref.peak) * detail.ref.grid.resolution
    far = exp(-0.5 * (5.0 / spread) ** 2)
    sheet.text(0, 220, f"σ_aug = {spread:g} m: a wall 5 m away counts {far:.1%} of one at x̂.", 11, bold=True)
    sheet.text(0, 237, f"Together the walls of map 1 count as much as {counts:.0f} m at x̂ would.", 11)
    return sheet.svg("Both maps, their walls coloured by level; the ring of Σ_aug can be dragged")


def _augmented(
    sheet: SvgCanvas, detail: AugmentDetail, config: AugmentConfig, half: float, palette: Palette
) -> SvgPlot:
    """Both maps with their levels, so many metres to each side, and their rings; the plot of map 1."""
    plots = []
    for x, lifted, title in ((0.0, detail.ref, "map 1"), (196.0, detail.mov, "map 2")):
        view = view_of(lifted.x_hat, half, HALF, HALF)
        pixels = draw_levels(view, palette, lifted)
        plot = map_panel(sheet, x, HALF, HALF, view, pixels, f"{title}, augmented")
        for k, name in ((1, "σ_aug"), (2, "2 σ_aug")):
            ring = plot.at(ellipse(lifted.x_hat, config.covariance(), k))
            sheet.path(ring, palette.text, 1.2, dash="4 3", close=True, alpha=0.75)
            x_top, y_top = ring[int(ring[:, 1].argmin())]
            halo = palette.free if k == 1 else None
            sheet.text(x_top, y_top - 3, name, 10, "middle", palette.text, halo=halo)
        sheet.dot(*plot.one(*lifted.x_hat.tolist()), 4, palette.conflict, "#fff")
        plots.append(plot)
    return plots[0]


def dual(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Some cells of map 1 from near by, their centres, and the first columns of the list."""
    grid, met = lesson.inputs.ref, lesson.inputs.encounters[0]
    sheet, side, across, points = SvgCanvas(226), 200.0, 13, grid.points
    if not len(points):
        sheet.text(0, 20, "Map 1 has no wall at all.")
        return sheet.svg("No walls")
    centre = points[int(np.hypot(*(points - met.x_ref).T).argmin())]
    col, row = np.floor(grid.grid_coordinates(centre)).astype(int).tolist()
    low = np.array([col - across // 2, row - across // 2])
    plot = SvgPlot(sheet, 0, 18, side, side, (low[0], low[0] + across), (low[1], low[1] + across))
    sheet.text(0, 11, f"{across} × {across} cells of map 1", 11, bold=True)
    patch = cut_out(grid.cells, (low[1], low[0]), across, np.int8(UNKNOWN))
    plot.image(upright(painted(patch, palette.ref, palette).pixels))
    for k in range(across + 1):
        at_ = k / across * side
        sheet.path([(at_, 18), (at_, 18 + side)], palette.margin, 0.5, alpha=0.5)
        sheet.path([(0, 18 + at_), (side, 18 + at_)], palette.margin, 0.5, alpha=0.5)
    rows, cols = np.nonzero(patch >= OCCUPIED_FROM)
    order = np.argsort(np.hypot(rows - across // 2, cols - across // 2), kind="stable")[:9]
    order = order[np.lexsort((cols[order], -rows[order]))]
    for r, c in zip(rows, cols, strict=True):
        sheet.dot(*plot.one(low[0] + c + 0.5, low[1] + r + 0.5), 1.8, "#fff")
    x, stops = 216.0, (12, 66, 122, 150)
    sheet.text(x, 11, "the list, a column each", 11, bold=True)
    for stop, words in zip(stops, ("n", "x (m)", "y (m)", "1"), strict=True):
        sheet.text(x + stop, 32, words, 10.5, "end", alpha=0.7)
    for line, n in enumerate(order.tolist()):
        place = grid.centres(rows[n : n + 1] + low[1], cols[n : n + 1] + low[0])[0]
        px, py = plot.one(low[0] + cols[n] + 0.5, low[1] + rows[n] + 0.5)
        sheet.dot(px, py, 6, palette.conflict)
        sheet.text(px, py + 3.5, str(line + 1), 9, "middle", "#fff", True)
        cells = (str(line + 1), f"{place[0]:.3f}", f"{place[1]:.3f}", "1")
        for stop, words in zip(stops, cells, strict=True):
            sheet.text(x + stop, 50 + 17 * line, words.replace("-", "−"), 11, "end")
    sheet.text(x, 50 + 17 * len(order), f"… {len(points):,} in all", 11, alpha=0.8)
    sheet.text(x + 164, 218, f"a cell: {grid.resolution:g} m", 10.5, "end", alpha=0.8)
    return sheet.svg("Cells of map 1 and the list of their centres")


def turned(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Map 1 around x̂₁ beside map 2 around x̂₂, turned by the chosen candidate."""
    match, detail = lesson.get(HoughDetail).match, lesson.get(AugmentDetail)
    k = min(at[0], len(match.turns) - 1)
    sheet = SvgCanvas(232)
    half = 2.0 * lesson.config.augment.spread
    about = Pose2(0.0, 0.0, match.turns[k]) @ Pose2(*(-detail.mov.x_hat).tolist())
    how = f"map 2, turned by {turn_label(match.turns[k])}"
    places = (
        (0.0, detail.ref, detail.ref.x_hat, None, "map 1, as it is"),
        (196.0, detail.mov, np.zeros(2), about, how),
    )
    for x, lifted, centre, T, title in places:
        view = view_of(centre, half, HALF, HALF)
        plot = map_panel(sheet, x, HALF, HALF, view, draw_levels(view, palette, lifted, T), title)
        sheet.dot(*plot.one(*centre.tolist()), 5, None, palette.conflict, width=2)
    kind = "the twin of a peak" if match.twins[k] else "a peak"
    words = f"Candidate {k + 1} of {len(match.turns)}: {kind}, correlation"
    sheet.text(0, 222, f"{words} {match.strengths[k]:.0%} of the best.", 11)
    return sheet.svg("Map 1 beside map 2, turned")


def _class(cells: CellArray) -> np.ndarray:
    """0 wall, 1 free, 2 unknown, of every cell."""
    return np.where(cells >= OCCUPIED_FROM, 0, np.where(is_free(cells), 1, 2))


def merged(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The merged map around the meeting, what each map says of every cell, and what the merged one does."""
    fusion, result = lesson.get(Fusion), lesson.get(MergeResult)
    first, second = _class(fusion.ref_cells), _class(fusion.mov_cells)
    merged_class = _class(fusion.merged.cells)
    counts = np.bincount((3 * first + second).ravel(), minlength=9).reshape(3, 3)
    sheet = SvgCanvas(224)
    view = view_of(result.encounters[0].x_ref, 2.0 * lesson.config.augment.spread, HALF, HALF)
    pixels = view.blank(palette)
    a, b = (under(part, fusion.merged, view, None, 2) for part in (first, second))
    pixels[(a == 1) | (b == 1)] = palette.free
    for mask, colour in wall_masks((a == 0, b == 0), (a == 1, b == 1), palette):
        pixels[mask] = colour
    map_panel(sheet, 0, HALF, HALF, view, pixels, "around the meeting place")
    x, y, wide, high = 242.0, 62.0, 45.0, 38.0
    sheet.text(x + 1.5 * wide, 30, "map 2 says", 11, "middle", worded(palette.mov, palette), True)
    sheet.text(x - 44, 51, "map 1", 11, colour=worded(palette.ref, palette), bold=True)
    names = ("wall", "free", "unknown")
    colours = {(0, 0): palette.agreed, (0, 1): palette.conflict, (1, 0): palette.conflict}
    colours |= {(0, 2): palette.ref, (2, 0): palette.mov}
    for r, name in enumerate(names):
        sheet.text(x + (r + 0.5) * wide, 51, name, 10, "middle")
        sheet.text(x - 4, y + (r + 0.5) * high + 4, name, 10, "end")
        for c in range(3):
            colour, left, top = colours.get((r, c)), x + c * wide, y + r * high
            how = (colour, None, 1) if colour else (palette.margin, None, 0.15)
            sheet.rect(left + 1, top + 1, wide - 2, high - 2, *how)
            light = palette.dark and (r, c) == (0, 0)
            ink = "#111827" if light else "#fff" if colour else INK
            share = "–" if (r, c) == (2, 2) else f"{counts[r, c]:,}"
            sheet.text(left + wide / 2, top + high / 2 + 4, share, 10, "middle", ink)
            if colours.get((r, c)) == palette.conflict and counts[r, c]:
                becomes = names[np.bincount(merged_class[(first == r) & (second == c)], minlength=3).argmax()]
                sheet.text(left + wide / 2, top + high - 6, f"→ {becomes}", 9, "middle", ink)
    for line, name in enumerate(("Δθ", "Δx", "Δy")):
        sheet.text(x - 44, y + 3 * high + 14 + 14 * line, f"{name} = {lesson.rows[f'T: {name}']}", 11)
    return sheet.svg("The merged map, and the cells by what each map says of them")
