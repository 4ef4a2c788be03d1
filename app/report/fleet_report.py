"""A fleet's result as one page to read and print: the graph over the map; robots, sightings and pairs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from math import degrees, sqrt

import cv2
import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.fleets.fleet_merge import FleetResult
from algorithms.fleets.island import Island
from algorithms.maps.grid_map import FREE, OCCUPIED_FROM
from algorithms.observations.fleet import Fleet
from algorithms.observations.observation import encounter
from app.drawing.grid_pixels import Pixels
from app.drawing.palette import LIGHT, Rgb, robot_colour
from app.drawing.scene_layout import known_corners, rect_of
from app.drawing.svg.map_plot import RasterView, scale_bar, scene
from app.drawing.svg.svg_canvas import SvgCanvas
from app.model import verdict_text
from app.model.status_text import typeset
from app.system.clock import made_at
from app.system.data_paths import asset
from app.system.version import version, versions

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
ROBOT_COLUMNS = ("robot", "map", "x (m)", "y (m)", "turn", "likely", "")
WIDE, MOST_HIGH, FINE = 760.0, 760.0, 2.0


def fleet_page(fleet: Fleet, result: FleetResult, name: str) -> bytes:
    """The content of report.html: no script, nothing from elsewhere."""
    placed, total = len(result.placed), len(fleet.maps)
    mood = "accepted" if result.whole else "refused"
    parts = [
        f'<div class="verdict {mood}"><p>{escape(summary(result, total))}</p></div>',
        *(
            _map(fleet, result, number, island)
            for number, island in enumerate(result.islands, 1)
            if number == 1 or len(island.poses) > 1
        ),
        _section("Robots", _table(robot_rows(fleet, result), ROBOT_COLUMNS)),
        _section(
            "Sightings", _table(_sightings(fleet, result), ("", "observer", "observed", "used", "why not"))
        ),
        _section("Pairs", _table(_pairs(result), ("observer", "observed", "likely", "what the maps say"))),
    ]
    made = ", ".join(f"{package} {number}" for package, number in versions().items())
    made_by = f"{made_at()}, mapmeld {version()}"
    title = f"{placed} of {total} robots: {name}"
    html = (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        f"<title>{escape(title)}</title><style>{asset('report.css')}</style></head><body>"
        f"<header><b>mapmeld</b><span>Report of a fleet</span></header><h1>{escape(name)}</h1>"
        f'<p class="made">{escape(made_by)}</p>'
        f"{''.join(parts)}<footer>Made with {escape(made)}.</footer></body></html>\n"
    )
    return html.encode()


def summary(result: FleetResult, total: int) -> str:
    """What became of the fleet, in sentences."""
    placed = len(result.placed)
    said = [f"{placed} of {total} robots are in the map of {result.islands[0].root}."]
    alone = [island.root for island in result.islands[1:] if len(island.poses) == 1]
    groups = [" and ".join(island.poses) for island in result.islands[1:] if len(island.poses) > 1]
    if groups:
        of_them = "a map" if len(groups) == 1 else "maps"
        said.append(f"{'; '.join(groups)} have {of_them} of their own.")
    if alone:
        said.append(f"Nothing ties {', '.join(alone)} to the rest.")
    said += [f"{name} was taken out again: {why}." for name, why in result.refused.items()]
    if result.forced:
        said.append(f"By force, and not likely to be right: {', '.join(sorted(result.forced))}.")
    if result.left_out:
        count = len(result.left_out)
        said.append(f"{count} sighting{'s are' if count > 1 else ' is'} left out.")
    return " ".join(said)


def _map(fleet: Fleet, result: FleetResult, number: int, island: Island) -> str:
    title = "The map" if number == 1 else f"Island {number}"
    caption = (
        "Each robot's walls in its own colour, walls that several show dark. Lines go from where a robot "
        "stood to what it saw: green where the poses rest on it, dashed where it is left out."
    )
    return _section(
        title, f"<figure>{graph_svg(fleet, result, island)}<figcaption>{caption}</figcaption></figure>"
    )


def graph_svg(fleet: Fleet, result: FleetResult, island: Island) -> str:
    """The island's map with the sightings between its robots."""
    merged = island.fusion.merged
    x0, y0, x1, y1 = rect_of(known_corners(merged))
    pad = 0.03 * max(x1 - x0, y1 - y0)
    rect = x0 - pad, y0 - pad, x1 + pad, y1 + pad
    high = min(MOST_HIGH, WIDE * (rect[3] - rect[1]) / (rect[2] - rect[0]))
    wide = high * (rect[2] - rect[0]) / (rect[3] - rect[1])
    view = RasterView(rect, int(FINE * wide), int(FINE * high))
    sheet = SvgCanvas(high + 30, WIDE)
    plot = scene(sheet, (WIDE - wide) / 2, 0, wide, high, view)
    plot.image(_walls(fleet, island, view))
    left = {each.number for each in result.left_out}
    for k, seen in enumerate(fleet.sightings):
        if seen.observer not in island.poses or seen.observed not in island.poses:
            continue
        T, at = island.poses[seen.observer], encounter(seen.observation)
        ends = plot.at([T.apply(seen.observation.observer.xy), T.apply(at.x_ref)])
        sheet.path(ends, "#fff", 4.0)
        colour, dash = (LIGHT.conflict, "5 4") if k in left else (LIGHT.mov, "")
        sheet.path(ends, colour, 2.0, dash=dash)
        sheet.dot(*ends[1].tolist(), 4, None, colour, width=2)
    x = 0.0
    for name, T in island.poses.items():
        colour = _colour(fleet, name)
        px, py = plot.one(*_middle(fleet, name, T).tolist())
        sheet.text(px, py, name, 13, "middle", colour=colour, bold=True)
        x = sheet.chip(x, high + 14, colour, name)
    scale_bar(plot)
    return sheet.svg("Where the robots' maps lie, and who saw whom")


def _colour(fleet: Fleet, name: str) -> Rgb:
    return robot_colour(list(fleet.maps).index(name))


def _middle(fleet: Fleet, name: str, T: Pose2) -> FloatArray:
    return np.asarray(T.apply(known_corners(fleet.maps[name]).mean(axis=0)), dtype=np.float64)


def _walls(fleet: Fleet, island: Island, view: RasterView) -> Pixels:
    """(H, W, 3) floor white, each robot's walls in its colour, those of several dark."""
    fusion = island.fusion
    rows, cols, inside = view.cells(fusion.merged)
    pixels = view.blank(LIGHT)
    known = np.zeros(inside.shape, dtype=bool)
    count = np.zeros(inside.shape, dtype=np.uint8)
    scale = fusion.merged.resolution * view.wide / (view.rect[2] - view.rect[0])
    thick = np.ones((max(1, round(1.2 / max(scale, 0.05))),) * 2, dtype=np.uint8)
    paint = []
    for name, layer in zip(island.poses, fusion.layers, strict=True):
        wall = cv2.dilate((layer >= OCCUPIED_FROM).astype(np.uint8), thick)
        seen = np.zeros(inside.shape, dtype=bool)
        seen[inside] = wall[rows[inside], cols[inside]] > 0
        known[inside] |= layer[rows[inside], cols[inside]] >= FREE
        count += seen
        paint.append((seen, _colour(fleet, name)))
    pixels[known] = LIGHT.free
    for seen, colour in paint:
        pixels[seen] = colour
    pixels[count > 1] = LIGHT.agreed
    return pixels


def robot_rows(fleet: Fleet, result: FleetResult) -> Iterable[tuple[str, ...]]:
    """Where every robot lies, in the frame of its map's root, and how sure that is."""
    for number, island in enumerate(result.islands, 1):
        for name in (each for each in fleet.maps if each in island.poses):
            T = island.poses[name]
            where = "root" if name == island.root else f"± {_deviation(fleet, island, name):.2f} m"
            alone = number > 1 and len(island.poses) == 1
            yield (
                name,
                "the anchor's" if number == 1 else "alone" if alone else f"island {number}",
                f"{T.x:.3f}",
                f"{T.y:.3f}",
                f"{degrees(T.theta):.2f}°",
                "–" if alone else verdict_text.likelihood(island.probability[name]),
                result.refused.get(name, where),
            )


def _deviation(fleet: Fleet, island: Island, name: str) -> float:
    """Standard deviation of where the middle of a robot's map lies; metres."""
    x, y = (_middle(fleet, name, island.poses[name]) - island.poses[name].xy).tolist()
    jacobian = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
    return sqrt(float(np.linalg.eigvalsh(jacobian @ island.covariances[name] @ jacobian.T)[-1]))


def _sightings(fleet: Fleet, result: FleetResult) -> Iterable[Sequence[str]]:
    left = {each.number: each.reason for each in result.left_out}
    for number, seen in enumerate(fleet.sightings):
        used = "no" if number in left else "yes"
        yield str(number + 1), seen.observer, seen.observed, used, left.get(number, "")


def _pairs(result: FleetResult) -> Iterable[Sequence[str]]:
    for number, finding in enumerate(result.findings):
        likely = result.likely.get(number)
        shown = "–" if likely is None else verdict_text.likelihood(likely).replace(" ", "\u00a0")
        yield finding.order.ref, finding.order.mov, shown, finding.said


def _section(title: str, *parts: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{''.join(parts)}</section>"


def _table(rows: Iterable[Sequence[str]], head: Sequence[str]) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(typeset(cell))}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(row(cells, "td") for cells in rows)
    return f'<div class="words"><table>{row(head, "th")}{body}</table></div>'
