"""The lesson's picture of three robots: the chain through the third, its error, and what closes it."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi, sqrt
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
from app.drawing.svg.svg_grip import grip_in
from app.model.verdict_text import likelihood
from app.page.lesson.chain_runs import BETWEEN, OPEN, Chain, chain_of, chain_runs, sample_fleet
from app.page.lesson.figures.figure_slider import FigureSlider, shown
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.side_runs import SideRun, SideRuns

NAME = "chain"
SIDE, APART, TOP = 185.0, 195.0, 18.0
LARGER = 20  # times: errors of centimetres cannot be seen beside a corridor
ROW = 17.0
SEEN_X = FigureSlider("seen again, x (m)", 481, 240, -60, 0.25)
SEEN_Y = FigureSlider("seen again, y (m)", 481, 240, -60, 0.25)
AGAIN_SIGMA = 2.0  # metres; a vague sighting is enough
AREA = 60.0**2  # m², where robot 2 may be seen if neither answer is right
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
    """Both answers of the open pair, and what a second sighting leaves of each, where the handle puts it."""
    found = _chain(runs_of(lesson))
    if found is None:
        return chain(lesson, at, palette)
    fleet, sheet, wide = sample_fleet(), SvgCanvas(TOP + SIDE + 92), SIDE + APART
    answers, again = found.findings[-1].hypotheses[:2], far_end(found)
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
    sheet.text(0, 11, f"where does {ROOT} see {FAR} a second time?", 11, bold=True)
    plot = scene(sheet, 0, TOP, wide, SIDE, view)
    plot.image(pixels)
    goes_to = np.array([answer.T_ref_mov.apply(again) for answer in answers])
    zero = goes_to.mean(axis=0)
    seen = zero + (shown(SEEN_X, at[0]), shown(SEEN_Y, at[1]))
    shares = shares_after(found, seen)
    for place, colour, share in zip(goes_to, colours[1:], shares, strict=True):
        sheet.path(plot.at(ellipse(place, AGAIN_SIGMA**2 * np.eye(2), 3.0)), colour, 1.8, close=True)
        px, py = plot.one(*place.tolist())
        sheet.dot(px, py, 4, colour, "#fff")
        sheet.text(px, py - 12, likelihood(share), 11, "middle", colour, True, halo=palette.free)
    sheet.rect(0, TOP, wide, SIDE, None, INK, 0.35)
    scale_bar(plot)
    grip_in(plot, seen, _colour(ROOT), (0, 1), zero)
    y = TOP + SIDE + 18
    rows = (
        ("the likelier answer", _colour(FAR)),
        ("the other answer", palette.conflict),
        ("neither", palette.margin),
    )
    for row, ((name, colour), share) in enumerate(zip(rows, (*shares, 1 - sum(shares)), strict=True)):
        sheet.text(0, y + 17 * row + 9, name, 11)
        sheet.rect(112, y + 17 * row, 210, 11, palette.margin, None, 0.18)
        sheet.rect(112, y + 17 * row, 210 * share, 11, colour)
        sheet.text(wide, y + 17 * row + 9, likelihood(share), 11, "end", bold=True)
    words = f"Rings: where {FAR}, then at the far end of its map, would be seen, to 3 σ of {AGAIN_SIGMA:g} m."
    sheet.text(0, y + 66, words, 10, alpha=0.85)
    return sheet.svg("Two answers, and what a second sighting, placed by hand, leaves of each")


def shares_after(found: Chain, seen: FloatArray) -> tuple[float, float]:
    """How likely both answers of the open pair are after a second sighting at a (2,) place of the root's map.

    Where neither is right, it may be seen anywhere on a square of AREA.
    """
    answers, again = found.findings[-1].hypotheses[:2], far_end(found)
    off = np.array([seen - answer.T_ref_mov.apply(again) for answer in answers])
    density = np.exp(-0.5 * (off**2).sum(axis=1) / AGAIN_SIGMA**2) / (2 * pi * AGAIN_SIGMA**2)
    before = np.array([answer.probability for answer in answers])
    odds = before * density
    neither = max(1e-3, 1 - float(before.sum())) / AREA
    first, second = (odds / (odds.sum() + neither)).tolist()
    return first, second


def second_at(lesson: LessonRun, at: Sequence[int]) -> tuple[float, float] | None:
    """The same where the handle is; None while the pairs are merged."""
    found = _chain(runs_of(lesson))
    if found is None:
        return None
    places = [answer.T_ref_mov.apply(far_end(found)) for answer in found.findings[-1].hypotheses[:2]]
    return shares_after(found, np.mean(places, axis=0) + (shown(SEEN_X, at[0]), shown(SEEN_Y, at[1])))


def far_end(found: Chain) -> FloatArray:
    """The floor of the far robot's map that is farthest from the meeting: it tells best."""
    grid, pivot = sample_fleet().maps[FAR], found.findings[-1].pivot
    floor = grid.centres(*where(grid.free))
    return np.asarray(floor[int(np.hypot(*(floor - pivot).T).argmax())], dtype=np.float64)


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
