"""A building as a camera sees it: faces of walls, solids of furniture, doors, what hangs on walls, shade."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy  # its parts are loaded where they are first used
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.simulator.buildings.floor_plan import AIR, DARK, WALL, Building, Piece
from algorithms.simulator.portable_random import TURN, chance, cosine, pick, sine, stream, uniform, whole
from algorithms.simulator.views.interiors.free_floor import free_floor
from algorithms.simulator.views.interiors.furnishings import LEAF_HEIGHT, SOLIDS, stands
from algorithms.simulator.views.interiors.style import Style, draw_style
from algorithms.simulator.views.interiors.wall_outlines import WallFaces, wall_faces
from algorithms.simulator.views.solids import BOX, DRUM, Solid, SolidTable
from algorithms.simulator.views.surfaces.materials import Material
from algorithms.simulator.views.surfaces.noise import Tones
from algorithms.simulator.views.surfaces.pictures import ON_WALLS, VARIANTS, painted_picture

LOOSE = 1.5  # metres; what is smaller than this each way and touches nothing is furniture
BESIDE = 0.2  # metres
FILLED = 0.82  # of the box around it, what is no drum fills at least
OUTER = 0.6  # metres from the edge of all that is solid, within which glass is a window
SHADE_REACH = 0.15  # metres; of each of three blurs


@dataclass(frozen=True, eq=False)
class Interior:
    """What a building looks like whoever is in it.

    walls     : faces from floor to ceiling
    materials : of floor and ceiling, then of the walls, as ``wall_material`` counts them
    solids    : furniture, doors, pictures
    shade     : (H, W) how much the surroundings of a cell of floor hide of the light, 0 … 1
    cell      : metres per cell of ``shade``
    """

    style: Style
    walls: WallFaces
    materials: tuple[Material, ...]
    wall_material: NDArray[np.int32]
    solids: SolidTable
    shade: Tones
    cell: float

    def shade_at(self, x: Tones, y: Tones) -> Tones:
        """(n,) shade of points; metres, world frame."""
        out = np.empty(len(x), dtype=np.float32)
        _between_cells(self.shade, self.cell, x, y, out)
        return out


@kernel
def _between_cells(raster: Tones, cell: float, x: Tones, y: Tones, out: Tones) -> None:
    """Values of a raster at points, straight between the middles of cells."""
    height, width = raster.shape
    for n in range(len(x)):
        col = min(max(x[n] / cell - 0.5, 0.0), width - 1.001)
        row = min(max(y[n] / cell - 0.5, 0.0), height - 1.001)
        i, j = int(col), int(row)
        s, t = col - i, row - j
        low = raster[j, i] * (1 - s) + raster[j, i + 1] * s
        out[n] = low * (1 - t) + (raster[j + 1, i] * (1 - s) + raster[j + 1, i + 1] * s) * t


@lru_cache(maxsize=4)
def interior_of(building: Building, seed: int) -> Interior:
    """What a building looks like; the seed draws its style and what its furniture is."""
    rng = stream(seed, building.name, "interior")
    style = draw_style(rng, building.name)
    bare, standing = _without_furniture(building)
    loose = _loose(bare, building, rng, style)
    walls = wall_faces(bare, building.resolution)
    solids = loose + [solid for piece in standing for solid in stands(piece, style, rng)]
    solids += [part for jambs in building.doors.tolist() for part in _door_case(bare, building, jambs, style)]
    solids += _on_walls(walls, building, rng)
    materials = (style.floor, style.ceiling, style.wall, style.window, style.glass)
    return Interior(
        style, walls, materials, _wall_materials(walls, bare, building.resolution), SolidTable.of(solids),
        _shade(building, standing), building.resolution,
    )  # fmt: skip


def _without_furniture(building: Building) -> tuple[NDArray[np.uint8], list[Piece]]:
    """The raster of the walls alone, and the pieces that are still there."""
    bare = building.surface.copy()
    standing = []
    for piece in building.pieces:
        window, within = _footprint(piece, building)
        if piece.kind == "recess" or building.surface[window][within].any():
            standing.append(piece)
        if piece.kind in SOLIDS:
            bare[window][within] = AIR
    return bare, standing


def _footprint(piece: Piece, building: Building) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """The window of the raster in which a piece stands, and which cells of it are the piece's."""
    cell = building.resolution
    spare = cell if piece.kind == "door leaf" else 0.0  # a line as thin as that is drawn thicker
    reach = (piece.depth + piece.width) / 2 + cell
    row, col = (max(0, int((at - reach) / cell)) for at in (piece.y, piece.x))
    last_row, last_col = (
        min(size, int((at + reach) / cell) + 1)
        for at, size in zip((piece.y, piece.x), building.surface.shape, strict=True)
    )
    y = ((np.arange(row, last_row) + 0.5) * cell - piece.y)[:, None]
    x = ((np.arange(col, last_col) + 0.5) * cell - piece.x)[None, :]
    c, s = float(cosine(piece.ticks)), float(sine(piece.ticks))
    along, across = np.abs(x * c + y * s), np.abs(y * c - x * s)
    deep = piece.depth / 2 + spare + 1e-9
    return (slice(row, last_row), slice(col, last_col)), (along <= deep) & (
        across <= piece.width / 2 + spare + 1e-9
    )


def _loose(
    bare: NDArray[np.uint8], building: Building, rng: np.random.Generator, style: Style
) -> list[Solid]:
    """What stands free of all walls and is no piece: low blocks. They are taken out of the raster."""
    cell, jambs = building.resolution, building.doors.reshape(-1, 2)
    labels, _ = scipy.ndimage.label(bare != AIR)
    solids = []
    for n, place in enumerate(scipy.ndimage.find_objects(labels), 1):
        rows, cols = place
        low, high = np.array([cols.start, rows.start]) * cell, np.array([cols.stop, rows.stop]) * cell
        wide, deep = (high - low).tolist()
        part = labels[place] == n
        at_door = ((jambs > low - BESIDE) & (jambs < high + BESIDE)).all(axis=1).any()
        if max(wide, deep) > LOOSE or at_door or part.mean() < FILLED / 1.3:
            continue  # a wall that ends at doors
        x, y = ((low + high) / 2).tolist()
        colour = pick(rng, (style.wood, style.other_wood, (0.7, 0.7, 0.68)))
        face = Material("cupboard", colour, style.metal, (0.6, 1.0), whole(rng, 0, 199))
        shape = BOX if part.mean() > FILLED else DRUM
        solids.append(Solid(x, y, wide, deep, 0.0, uniform(rng, 0.4, 1.2), (face,), shape=shape))
        bare[place][part] = AIR
    return solids


def _wall_materials(walls: WallFaces, bare: NDArray[np.uint8], cell: float) -> NDArray[np.int32]:
    """Rows of ``Interior.materials``: wall, or window at the outside of the building, or glass within it."""
    rows, cols = np.nonzero(bare)
    if not len(rows):
        return np.zeros(0, dtype=np.int32)
    low, high = np.array([cols.min(), rows.min()]) * cell, np.array([cols.max(), rows.max()]) * cell + cell
    middles = (walls.ends[:, :2] + walls.ends[:, 2:]) / 2
    outer = ((middles < low + OUTER) | (middles > high - OUTER)).any(axis=1)
    return np.where(walls.kind == DARK, np.where(outer, 3, 4), 2).astype(np.int32)


def _door_case(bare: NDArray[np.uint8], building: Building, jambs: list[float], style: Style) -> list[Solid]:
    """The wall above a door and the frame around it; jambs as in ``Building.doors``."""
    x0, y0, x1, y1 = jambs
    upright = abs(x1 - x0) < abs(y1 - y0)
    length = abs(x1 - x0) + abs(y1 - y0)
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    cell = building.resolution
    thick, off = 0.0, 0.0
    for side in (-1, 1):  # the wall goes on beside the door: how thick is it there?
        beside = side * (length / 2 + 0.08)
        bx, by = (x, y + beside) if upright else (x + beside, y)
        row, col = int(by / cell), int(bx / cell)
        reach = round(0.3 / cell)
        line = (
            bare[row, max(0, col - reach) : col + reach + 1]
            if upright
            else bare[max(0, row - reach) : row + reach + 1, col]
        )
        solid = np.flatnonzero(line)
        if 0 < len(solid) * cell < 0.5 and len(solid) * cell > thick:
            thick = len(solid) * cell
            off = (float(solid.mean()) - reach) * cell + (
                ((col if upright else row) + 0.5) * cell - (x if upright else y)
            )
    if thick == 0.0:
        return []
    x, y = (x + off, y) if upright else (x, y + off)
    ticks = 0 if upright else TURN // 4
    frame, plaster = (style.frame,), (style.plaster,)
    parts = [
        Solid(0, 0, thick, length + 0.02, LEAF_HEIGHT + 0.03, style.height, plaster),
        Solid(0, 0, thick + 0.03, length + 0.1, LEAF_HEIGHT, LEAF_HEIGHT + 0.06, frame),
    ]
    for side in (-1, 1):
        parts.append(Solid(0, side * (length / 2 + 0.015), thick + 0.03, 0.07, 0.0, LEAF_HEIGHT, frame))
    return [part.moved(x, y, ticks) for part in parts]


def hung(
    left: tuple[float, float],
    right: tuple[float, float],
    bottom: float,
    top: float,
    face: Material,
    thick: float,
) -> Solid:
    """A flat thing on a wall between two points, left and right as one sees who looks at it; metres."""
    dx, dy = right[0] - left[0], right[1] - left[1]
    length = float(np.sqrt(dx * dx + dy * dy))
    ticks = round(float(np.arctan2(-dx, dy)) * TURN / (2 * np.pi)) % TURN  # of (dy, −dx), into the air
    x, y = (
        (left[0] + right[0]) / 2 + dy / length * thick / 2,
        (left[1] + right[1]) / 2 - dx / length * thick / 2,
    )
    rim = Material("plain", (0.6, 0.6, 0.58))
    return Solid(x, y, thick, length, bottom, top, (face, rim, rim, rim, rim, rim), ticks)


def _on_walls(walls: WallFaces, building: Building, rng: np.random.Generator) -> list[Solid]:
    """Pictures, boards, notices and heaters here and there."""
    floor, hanging = free_floor(building), []
    kinds: tuple[str, ...] = (
        "art",
        "landscape",
        "notice",
        "low notice",
        "sign",
        "pinboard",
        "heater",
        "front",
        "notice",
    )
    if building.name not in ("apartment", "home"):
        kinds = (*kinds, "whiteboard", "sign")
    normals, lengths = walls.normals(), walls.lengths()
    for n in np.flatnonzero((walls.kind == WALL) & (lengths > 0.6)).tolist():
        x0, y0, x1, y1 = walls.ends[n].tolist()
        (nx, ny), length = normals[n].tolist(), float(lengths[n])
        if not floor.is_indoors((x0 + x1) / 2 + 0.1 * nx, (y0 + y1) / 2 + 0.1 * ny):
            continue
        at = uniform(rng, 0.15, 1.2)
        while at < length - 0.4:
            kind = pick(rng, kinds)
            picture, width, height = painted_picture(kind, whole(rng, 0, VARIANTS - 1))
            bottom = uniform(rng, *ON_WALLS[kind][3])
            if at + width < length - 0.1:
                ends = [(x0 + (x1 - x0) * u / length, y0 + (y1 - y0) * u / length) for u in (at, at + width)]
                face = Material("picture", picture=picture, fine=True)
                hanging.append(hung(ends[0], ends[1], bottom, bottom + height, face, 0.012))
            at += width + uniform(rng, 0.3, 3.0)
            if chance(rng, 0.2):
                at += 2.0
    return hanging


def _shade(building: Building, standing: list[Piece]) -> Tones:
    """How much light is kept from each cell of floor by what stands around it, and by table tops above."""
    kept = np.where(building.solid, 100, 0).astype(np.int64)
    for piece in standing:
        if piece.kind in ("desk", "table", "chair", "office chair"):
            window, within = _footprint(piece, building)
            part = kept[window]
            part[within] = np.maximum(part[within], 60)
    reach = max(1, round(SHADE_REACH / building.resolution))
    for _ in range(3):
        kept = _box_sum(_box_sum(kept, reach).T, reach).T
    return np.asarray(kept / (100.0 * (2 * reach + 1) ** 6), dtype=np.float32)


def _box_sum(values: NDArray[np.int64], reach: int) -> NDArray[np.int64]:
    """Sums over 2 reach + 1 neighbours along the first axis, the edges repeated; whole numbers, so exact."""
    padded = np.pad(values, ((reach + 1, reach), (0, 0)), mode="edge")
    total = np.cumsum(padded, axis=0)
    return np.asarray(total[2 * reach + 1 :] - total[: -2 * reach - 1])
