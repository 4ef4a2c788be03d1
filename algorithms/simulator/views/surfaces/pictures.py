"""Flat things on walls: art, notices, boards, heaters. Painted by rule from a stream of random numbers."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from algorithms.simulator.portable_random import chance, pick, stream, uniform, whole
from algorithms.simulator.views.surfaces.materials import Colour, Picture
from algorithms.simulator.views.surfaces.noise import Tones, lattice, rough, whole_part

PIXEL = 0.004  # metres

Canvas = Tones  # (H, W, 3), 0 … 1


def canvas(width: float, height: float, colour: Colour) -> Canvas:
    """An empty sheet; metres."""
    shape = (max(8, round(height / PIXEL)), max(8, round(width / PIXEL)), 3)
    return np.asarray(np.broadcast_to(np.array(colour, dtype=np.float32), shape).copy())


def finished(sheet: Canvas) -> Picture:
    return np.asarray(np.rint(np.clip(sheet, 0.0, 1.0) * 255), dtype=np.uint8)


def _grid(sheet: Canvas) -> tuple[Tones, Tones]:
    """Columns and rows of its pixels, each (H, W)."""
    rows, cols = np.indices(sheet.shape[:2]).astype(np.float32)
    return np.asarray(cols), np.asarray(rows)


def _framed(sheet: Canvas, colour: Colour, metres: float) -> None:
    """Draw a frame along the edges."""
    wide = max(1, round(metres / PIXEL))
    for edge in (np.s_[:wide], np.s_[-wide:], np.s_[:, :wide], np.s_[:, -wide:]):
        sheet[edge] = colour


def _text(
    sheet: Canvas, rng: np.random.Generator, top: float, bottom: float, step: float, ink: Colour
) -> None:
    """Lines of words, as one sees them who is too far away to read; shares of the sheet, step in metres."""
    rows, cols = sheet.shape[:2]
    high, margin = max(1, round(step / PIXEL / 2.4)), cols // 9
    row = round(top * rows)
    while row + high < bottom * rows:
        at, end = margin, cols - margin - whole(rng, 0, cols // 3)
        while at < end:
            word = whole(rng, 3, 14)
            sheet[row : row + high, at : min(at + word, end)] = ink
            at += word + whole(rng, 2, 3)
        row += max(2, round(step / PIXEL))


def _colour(rng: np.random.Generator) -> Colour:
    grey, strong = uniform(rng, 0.2, 0.8), uniform(rng, 0.1, 0.5)
    r, g, b = (min(1.0, max(0.0, grey + strong * uniform(rng, -1.0, 1.0))) for _ in range(3))
    return r, g, b


def art(rng: np.random.Generator, width: float, height: float) -> Picture:
    """Discs, bars and washes of colour in a frame."""
    sheet = canvas(width, height, _colour(rng))
    x, y = _grid(sheet)
    rows, cols = sheet.shape[:2]
    wash = rough(x / 40, y / 40, whole(rng, 0, 99))[..., None]
    sheet[:] = sheet * (0.7 + 0.6 * wash)
    for _ in range(whole(rng, 3, 9)):
        colour, size = _colour(rng), uniform(rng, 0.05, 0.3) * min(rows, cols)
        cx, cy = uniform(rng, 0, cols), uniform(rng, 0, rows)
        across, up = np.abs(x - cx), np.abs(y - cy)
        kind = whole(rng, 0, 2)
        if kind == 0:
            inside = across * across + up * up < size * size
        elif kind == 1:
            inside = (across < size) & (up < size * uniform(rng, 0.1, 1.0))
        else:
            inside = np.abs(across * uniform(rng, -1, 1) + (y - cy)) < size * 0.2
        sheet[inside] = colour
    _framed(sheet, pick(rng, ((0.1, 0.1, 0.1), (0.9, 0.9, 0.88), (0.5, 0.36, 0.2))), 0.02)
    return finished(sheet)


def landscape(rng: np.random.Generator, width: float, height: float) -> Picture:
    """Sky over hills behind hills."""
    sheet = canvas(width, height, (0.6, 0.75, 0.92))
    x, y = _grid(sheet)
    rows, cols = sheet.shape[:2]
    sheet *= (0.75 + 0.4 * y / rows)[..., None]
    hue = _colour(rng)
    for n in range(4):
        ridge = rows * (0.35 + 0.15 * n) - rows * 0.25 * rough(x / cols * (2 + n), x * 0, whole(rng, 0, 99))
        far = 0.55 - 0.13 * n
        tone = (far + (1 - far) * 0.5 * np.array(hue)) * (0.9 - 0.12 * n)
        grain = 0.85 + 0.3 * rough(x / 9, y / 9, n)
        sheet[:] = np.where((y > ridge)[..., None], tone.astype(np.float32) * grain[..., None], sheet)
    _framed(sheet, pick(rng, ((0.1, 0.1, 0.1), (0.92, 0.92, 0.9))), 0.025)
    return finished(sheet)


def notice(rng: np.random.Generator, width: float, height: float) -> Picture:
    """A sheet with a heading, lines of words, sometimes a picture or a square code."""
    sheet = canvas(width, height, pick(rng, ((0.95, 0.95, 0.94), (0.95, 0.95, 0.94), (0.95, 0.92, 0.7))))
    rows, cols = sheet.shape[:2]
    ink = pick(rng, ((0.1, 0.1, 0.12), (0.1, 0.1, 0.12), (0.1, 0.2, 0.5), (0.7, 0.1, 0.1)))
    _text(sheet, rng, 0.08, 0.2, 0.04, ink)
    half = chance(rng, 0.5)
    _text(sheet, rng, 0.26, 0.6 if half else 0.92, 0.016, (0.25, 0.25, 0.27))
    if half:
        side = round(min(0.32 * rows, 0.6 * cols))
        top, left = round(0.63 * rows), (cols - side) // 2
        j, i = np.indices((side, side))
        if chance(rng, 0.4):
            modules = whole(rng, 8, 21)
            dark = lattice(i * modules // side, j * modules // side, whole(rng, 0, 99)) > 0.5
            sheet[top : top + side, left : left + side] = np.where(dark[..., None], 0.1, 0.95)
        else:
            sheet[top : top + side, left : left + side] = _colour(rng)
    return finished(sheet)


def sign(rng: np.random.Generator, width: float, height: float) -> Picture:
    """A plate with large shapes: warnings, ways out, numbers of rooms."""
    ground = pick(
        rng, ((0.95, 0.95, 0.95), (0.05, 0.5, 0.25), (0.95, 0.8, 0.1), (0.8, 0.1, 0.1), (0.1, 0.3, 0.65))
    )
    ink: Colour = (0.95, 0.95, 0.95) if sum(ground) < 1.6 else (0.08, 0.08, 0.08)
    sheet = canvas(width, height, ground)
    x, y = _grid(sheet)
    rows, cols = sheet.shape[:2]
    u, v = x / cols - 0.5, y / rows - 0.5
    kind = whole(rng, 0, 3)
    if kind == 0:
        sheet[(np.abs(u) < 0.3) & (np.abs(v) < 0.08) | (np.abs(u - 0.2) + np.abs(v) < 0.2)] = ink
    elif kind == 1:
        radius = u * u + v * v
        sheet[(radius < 0.14) & (radius > 0.08) | (np.abs(u) < 0.04) & (np.abs(v) < 0.2)] = ink
    elif kind == 2:
        sheet[(np.abs(u) < (v + 0.36) * 0.5) & (v < 0.3) & ~((np.abs(u) < (v + 0.2) * 0.4) & (v < 0.22))] = (
            ink
        )
    else:
        _text(sheet, rng, 0.3, 0.8, height * 0.3, ink)
    _framed(sheet, ink, 0.012)
    return finished(sheet)


def whiteboard(rng: np.random.Generator, width: float, height: float) -> Picture:
    """A white board with a grey frame and what is left of a meeting."""
    sheet = canvas(width, height, (0.93, 0.94, 0.94))
    x, y = _grid(sheet)
    rows, cols = sheet.shape[:2]
    for _ in range(whole(rng, 3, 7)):
        ink = pick(rng, ((0.1, 0.1, 0.15), (0.1, 0.2, 0.6), (0.75, 0.12, 0.12), (0.1, 0.45, 0.2)))
        cx, cy = uniform(rng, 0.15, 0.85) * cols, uniform(rng, 0.2, 0.8) * rows
        if chance(rng, 0.5):
            wave = cy + 12 * (rough((x - cx) / 12, y * 0, whole(rng, 0, 99)) - 0.5)
            sheet[(np.abs(y - wave) < 1.2) & (np.abs(x - cx) < cols * 0.12)] = ink
        else:
            square = np.maximum(np.abs(x - cx) / 1.6, np.abs(y - cy))
            sheet[np.abs(square - uniform(rng, 8, 24)) < 0.8] = ink
    _framed(sheet, (0.6, 0.61, 0.62), 0.02)
    return finished(sheet)


def pinboard(rng: np.random.Generator, width: float, height: float) -> Picture:
    """Cork with sheets of paper."""
    sheet = canvas(width, height, (0.68, 0.52, 0.35))
    x, y = _grid(sheet)
    sheet *= (0.85 + 0.3 * lattice(whole_part(x), whole_part(y), 3))[..., None]
    rows, cols = sheet.shape[:2]
    for _ in range(whole(rng, 4, 9)):
        wide, high = whole(rng, 20, 60), whole(rng, 25, 75)
        left, top = whole(rng, 4, max(5, cols - wide)), whole(rng, 4, max(5, rows - high))
        part = sheet[top : top + high, left : left + wide]
        part[:] = pick(rng, ((0.95, 0.95, 0.93), (0.95, 0.9, 0.5), (0.7, 0.85, 0.95), (0.95, 0.75, 0.75)))
        if min(part.shape[:2]) > 12:
            _text(part, rng, 0.15, 0.85, 0.02, (0.3, 0.3, 0.32))
    _framed(sheet, (0.45, 0.33, 0.2), 0.02)
    return finished(sheet)


def heater(rng: np.random.Generator, width: float, height: float) -> Picture:
    """The ribs of a radiator."""
    sheet = canvas(width, height, (0.9, 0.9, 0.88))
    x, y = _grid(sheet)
    rows = sheet.shape[0]
    rib = np.abs(x * PIXEL / 0.05 - np.floor(x * PIXEL / 0.05) - 0.5) * 2
    sheet *= (1 - 0.3 * rib * rib - 0.25 * (np.abs(y - rows / 2) > rows * 0.46))[..., None]
    return finished(sheet)


def cupboard_front(rng: np.random.Generator, width: float, height: float) -> Picture:
    """A metal door of pipes or wires in the wall."""
    sheet = canvas(width, height, pick(rng, ((0.75, 0.76, 0.76), (0.85, 0.84, 0.8), (0.8, 0.15, 0.12))))
    rows, cols = sheet.shape[:2]
    sheet[rows // 2 - 6 : rows // 2 + 6, cols - 14 : cols - 9] = (0.2, 0.2, 0.2)
    for row in range(rows // 8, rows // 4, 4):
        sheet[row : row + 2, cols // 4 : 3 * cols // 4] *= 0.6
    _framed(sheet, (0.45, 0.45, 0.45), 0.008)
    return finished(sheet)


Painter = Callable[[np.random.Generator, float, float], Picture]

# what: who paints it, width from … to, height from … to, lower edge above the floor from … to; metres
ON_WALLS: dict[str, tuple[Painter, tuple[float, float], tuple[float, float], tuple[float, float]]] = {
    "art": (art, (0.4, 1.2), (0.4, 0.9), (1.0, 1.4)),
    "landscape": (landscape, (0.6, 1.4), (0.4, 0.9), (0.9, 1.3)),
    "notice": (notice, (0.21, 0.45), (0.3, 0.6), (0.7, 1.5)),
    "low notice": (notice, (0.21, 0.5), (0.3, 0.6), (0.2, 0.6)),
    "sign": (sign, (0.15, 0.4), (0.15, 0.3), (0.4, 1.7)),
    "whiteboard": (whiteboard, (1.2, 2.0), (0.9, 1.2), (0.85, 1.0)),
    "pinboard": (pinboard, (0.6, 1.4), (0.6, 1.0), (0.9, 1.1)),
    "heater": (heater, (0.6, 1.6), (0.5, 0.6), (0.1, 0.15)),
    "front": (cupboard_front, (0.4, 0.7), (0.6, 1.0), (0.25, 0.7)),
}
"""What hangs on walls, and where."""

VARIANTS = 6  # of each; buildings share them


@cache
def painted_picture(kind: str, variant: int) -> tuple[Picture, float, float]:
    """One of the VARIANTS of a key of ON_WALLS; its picture, width and height, metres."""
    rng = stream(variant, "wall", kind)
    painter, widths, heights, _ = ON_WALLS[kind]
    width, height = uniform(rng, *widths), uniform(rng, *heights)
    return painter(rng, width, height), width, height
