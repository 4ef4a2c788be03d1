"""The lesson's picture of three robots: the chain through the third, its error, and what closes it."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, sqrt
from weakref import WeakKeyDictionary

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.fleets.consistent_set import SLACK
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding
from algorithms.fleets.transform_chain import UncertainTransform
from algorithms.maps.grid_map import where
from app.drawing.draw_items import ellipse
from app.drawing.palette import Palette, Rgb, robot_colour
from app.drawing.scene_layout import Rect, known_corners, rect_of, union
from app.drawing.svg.map_plot import RasterView, around, draw_map, scale_bar, scene
from app.drawing.svg.svg_canvas import INK, SvgCanvas, SvgPlot
from app.model.verdict_text import likelihood
from app.page.lesson.chain_runs import BETWEEN, OPEN, Chain, chain_of, chain_runs, sample_fleet
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.side_runs import SideRun, SideRuns

NAME = "chain"
SIDE, APART, TOP = 185.0, 195.0, 18.0
LARGER = 20  # times: errors of centimetres cannot be seen beside a corridor
ROW = 17.0
ROOT, FAR = OPEN

_chains: WeakKeyDictionary[SideRuns, Chain] = WeakKeyDictionary()


def chain(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """The maps along the chain, the two answers of the open pair, and the numbers of both."""
    runs = runs_of(lesson)
    found = _chain(runs)
    waiting = [(one.title, _state(one)) for one in runs.each]
    rows = waiting if found is None else _rows(found)
    numbers = TOP + SIDE + 20
    sheet = SvgCanvas(numbers + ROW * len(rows) + 26)
    panels = f"along the chain by {BETWEEN}", f"{ROOT}'s sighting of {FAR}"
    for k, title in enumerate(panels):
        sheet.text(APART * k, 11, title, 11, bold=True)
    if found is None:
        for k in range(2):
            sheet.rect(APART * k, TOP, SIDE, SIDE, palette.unknown)
            x, y = APART * k + SIDE / 2, TOP + SIDE / 2
            sheet.text(x, y, "merging the pairs …", 11, "middle", palette.text)
    else:
        _draw(sheet, found, palette)
    for row, (label, words) in enumerate(rows):
        y = numbers + ROW * row
        sheet.text(0, y, label, 10.5, alpha=0.8)
        sheet.text(380, y, words, 10.5, "end")
    y = numbers + ROW * len(rows) + 8
    x = 0.0
    for number, name in enumerate(sample_fleet().maps):
        x = sheet.chip(x, y, robot_colour(number), name)
    sheet.chip(x, y, palette.margin, f"error of a map's middle, 1 σ, {LARGER} times as large", "line")
    return sheet.svg("Three robots: the chain through the third, and the loop that it closes")


def second_sighting(lesson: LessonRun, at: Sequence[int], palette: Palette) -> str:
    """Both answers of the open pair, and where either puts a place at which r1 could see r2 once more."""
    found = _chain(runs_of(lesson))
    if found is None:
        return chain(lesson, at, palette)
    fleet, sheet, wide = sample_fleet(), SvgCanvas(TOP + SIDE + 64), SIDE + APART
    answers = found.findings[-1].hypotheses[:2]
    grid, pivot = fleet.maps[FAR], found.findings[-1].pivot
    floor = grid.centres(*where(grid.free))
    again = floor[int(np.hypot(*(floor - pivot).T).argmax())]  # the farther off, the better it tells
    places = [(ROOT, Pose2()), *((FAR, answer.T_ref_mov) for answer in answers)]
    rect = union(*(rect_of(T.apply(known_corners(fleet.maps[name]))) for name, T in places))
    x0, y0, x1, y1 = rect
    middle = np.array([x0 + x1, y0 + y1]) / 2
    half = 0.53 * max(x1 - x0, (y1 - y0) * wide / SIDE)
    view = RasterView(around(middle, half, wide / SIDE), int(2 * wide), int(2 * SIDE))
    pixels = view.blank(palette)
    colours = (_colour(ROOT), _colour(FAR), palette.conflict)
    for (name, T), colour in reversed(list(zip(places, colours, strict=True))):
        pixels = draw_map(view, palette, fleet.maps[name], colour, T, pixels)
    sheet.text(0, 11, f"{ROOT} sees {FAR} once more, at the far end of {FAR}'s map", 11, bold=True)
    plot = scene(sheet, 0, TOP, wide, SIDE, view)
    plot.image(pixels)
    goes_to = [answer.T_ref_mov.apply(again) for answer in answers]
    for answer, place, colour in zip(answers, goes_to, colours[1:], strict=True):
        px, py = plot.one(*place.tolist())
        sheet.dot(px, py, 5, colour, "#fff")
        sheet.text(px, py - 9, _share(answer), 11, "middle", colour, True, halo=palette.free)
    sheet.rect(0, TOP, wide, SIDE, None, INK, 0.35)
    scale_bar(plot)
    y = TOP + SIDE + 20
    sheet.text(0, y, "by the first sighting the answers are this likely; by a second one", 10.5, alpha=0.8)
    sheet.text(0, y + 17, f"{FAR} would stand at one of two places, apart by", 10.5, alpha=0.8)
    sheet.text(wide, y + 17, f"{float(np.hypot(*(goes_to[0] - goes_to[1]))):.1f} m", 10.5, "end")
    x = sheet.chip(0, y + 38, _colour(ROOT), ROOT)
    x = sheet.chip(x, y + 38, _colour(FAR), f"{FAR}, likelier")
    sheet.chip(x, y + 38, palette.conflict, f"{FAR}, the other answer")
    return sheet.svg("Two answers, and where a second sighting would be under each")


def runs_of(lesson: LessonRun) -> SideRuns:
    """The merges, none of them begun where the lesson has not come to them."""
    return lesson.sides.get(NAME) or chain_runs(lesson.seed)


def _chain(runs: SideRuns) -> Chain | None:
    """Worked out once."""
    found = _chains.get(runs) or chain_of(runs)
    if found is not None:
        _chains[runs] = found
    return found


def _state(one: SideRun) -> str:
    return "no answer" if one.failed else "merged" if one.over else "merging …" if one.run else "waits …"


# --- what is drawn ------------------------------------------------------------------------------------


def _draw(sheet: SvgCanvas, found: Chain, palette: Palette) -> None:
    fleet = sample_fleet()
    near, far = _along(found)
    first, second, *_ = found.findings[-1].hypotheses
    places = [(ROOT, Pose2()), (BETWEEN, near.T), (FAR, far.T), (FAR, second.T_ref_mov)]
    rect = _square(union(*(rect_of(T.apply(known_corners(fleet.maps[name]))) for name, T in places)))
    view = RasterView(rect, int(2 * SIDE), int(2 * SIDE))
    for k, drawn in enumerate(
        (places[:3], [(FAR, second.T_ref_mov), (FAR, first.T_ref_mov), (ROOT, Pose2())])
    ):
        pixels = view.blank(palette)
        for number, (name, T) in enumerate(drawn):
            twin = k == 1 and number == 0
            colour = palette.conflict if twin else _colour(name)
            pixels = draw_map(view, palette, fleet.maps[name], colour, T, pixels)
        plot = scene(sheet, APART * k, TOP, SIDE, SIDE, view)
        plot.image(pixels)
        rings = [(BETWEEN, near), (FAR, far)] if k == 0 else [(FAR, far)]
        for name, transform in rings:
            _ring(plot, name, transform, palette.margin)
        for number, (name, T) in enumerate(drawn):
            words = name if k == 0 or name == ROOT else _share(first if number == 1 else second)
            px, py = plot.one(*T.apply(_middle(name)).tolist())
            colour = palette.conflict if k == 1 and number == 0 else _colour(name)
            sheet.text(px, py - 6, words, 11, "middle", colour, True, halo=palette.free)
        sheet.rect(APART * k, TOP, SIDE, SIDE, None, INK, 0.35)
        scale_bar(plot)


def _square(rect: Rect) -> Rect:
    x0, y0, x1, y1 = rect
    half = 0.53 * max(x1 - x0, y1 - y0)
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    return x - half, y - half, x + half, y + half


def _ring(plot: SvgPlot, name: str, transform: UncertainTransform, colour: Rgb) -> None:
    middle = _middle(name)
    ring = ellipse(transform.T.apply(middle), LARGER**2 * _spread(transform, middle), 1.0)
    plot.sheet.path(plot.at(ring), "#fff", 3.5, close=True)
    plot.sheet.path(plot.at(ring), colour, 1.6, close=True)


def _share(answer: Hypothesis) -> str:
    return likelihood(answer.probability)


def _colour(name: str) -> Rgb:
    return robot_colour(list(sample_fleet().maps).index(name))


def _middle(name: str) -> FloatArray:
    return np.asarray(known_corners(sample_fleet().maps[name]).mean(axis=0), dtype=np.float64)


# --- what is worked out -------------------------------------------------------------------------------


def _along(found: Chain) -> tuple[UncertainTransform, UncertainTransform]:
    """T_root_between, and with the next link T_root_far."""
    near = _link(found, ROOT, BETWEEN)
    return near, near.then(_link(found, BETWEEN, FAR))


def _link(found: Chain, ref: str, mov: str) -> UncertainTransform:
    """The likeliest answer between two robots, with the error that the graph gives it."""
    finding = next(each for each in found.findings if {each.order.ref, each.order.mov} == {ref, mov})
    link = _loosened(finding, finding.hypotheses[0])
    return link if finding.order.ref == ref else link.inverse()


def _loosened(finding: PairFinding, answer: Hypothesis) -> UncertainTransform:
    return UncertainTransform(answer.T_ref_mov, answer.covariance).loosened(finding.pivot, *SLACK)


def _spread(transform: UncertainTransform, point: FloatArray) -> FloatArray:
    """(2, 2) covariance of where it puts a point; m²."""
    x, y = (transform.T.apply(point) - transform.T.xy).tolist()
    jacobian = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
    return np.asarray(jacobian @ transform.covariance @ jacobian.T, dtype=np.float64)


def _told(transform: UncertainTransform, name: str) -> str:
    distance = sqrt(float(np.linalg.eigvalsh(_spread(transform, _middle(name)))[-1]))
    return f"± {distance:.2f} m, ± {degrees(sqrt(transform.covariance[2, 2])):.2f}°"


def _rows(found: Chain) -> list[tuple[str, str]]:
    near, far = _along(found)
    open_pair = found.findings[-1]
    island = found.result.islands[0]
    rows = [
        (f"{BETWEEN}'s map in {ROOT}'s frame", _told(near, BETWEEN)),
        (f"{FAR}'s map along the chain", _told(far, FAR)),
    ]
    for answer in open_pair.hypotheses[:2]:
        off, covariance = far.difference(_loosened(open_pair, answer))
        apart = sqrt(float(off @ np.linalg.solve(covariance, off)))
        label = f"answer of {likelihood(answer.probability)}: off the chain by"
        rows.append((label, f"{apart:.1f} deviations, {abs(degrees(off[2])):.1f}°"))
    if FAR in island.poses:
        closed = UncertainTransform(island.poses[FAR], island.covariances[FAR])
        rows.append((f"{FAR}'s map once the loop is closed", _told(closed, FAR)))
        number = found.result.findings.index(open_pair)
        likely = found.result.likely.get(number)
        if likely is not None:
            rows.append(("its answer is then right to", likelihood(likely)))
    return rows
