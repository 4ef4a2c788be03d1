"""Grids in, pixels out: no server and no scene, so that every picture is tested without a browser.

Row 0 of every picture is the bottom, as in a GridMap: that is also how the scene lays an image down.
``upright`` turns a picture over for a screen, where row 0 is the top.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED_FROM, UNKNOWN, BoolArray, CellArray
from algorithms.maps.map_fusion import Fusion
from algorithms.spectra.augmented_map import AugmentedMap
from algorithms.verdict.cell_agreement import AGREES, CONTRADICTS, CellAgreement, WallLookup
from algorithms.verdict.contradictions import Contradictions
from app.drawing.palette import Palette, Rgb, level_colours

Pixels = NDArray[np.uint8]
Places = NDArray[np.intp]

FAINT = 70  # opacity of walls that are not the point of a picture; of 255
MOST_PIXELS = 2048  # a side of a picture that is sent; a finer map is pooled down to it

CellRegion = tuple[slice, slice]  # rows and columns of a grid
WHOLE: CellRegion = (slice(None), slice(None))


@dataclass(frozen=True)
class GridPixels:
    """Pixels and how many cells one of them stands for.

    pixels : (H, W, 4) uint8, row 0 at the bottom
    pooled : cells per pixel on each axis, 1 where nothing was pooled
    """

    pixels: Pixels
    pooled: int


def pooling(shape: tuple[int, ...], most: int = MOST_PIXELS) -> int:
    """Cells per pixel that keep both sides within ``most`` pixels."""
    return max(1, -(-max(shape[:2]) // most))


def pool(cells: CellArray, factor: int) -> CellArray:
    """Cells of ``factor`` x ``factor`` cells each; the highest value wins, so that no thin wall is lost."""
    if factor == 1:
        return cells
    rows, cols = -(-cells.shape[0] // factor), -(-cells.shape[1] // factor)
    low = np.full((rows, cells.shape[1]), UNKNOWN, dtype=np.int8)
    for part in (cells[row::factor] for row in range(factor)):  # whole rows first: they lie in memory so
        seen = low[: len(part)]
        np.maximum(seen, part, out=seen)
    pooled = np.full((rows, cols), UNKNOWN, dtype=np.int8)
    for part in (low[:, col::factor] for col in range(factor)):
        seen = pooled[:, : part.shape[1]]
        np.maximum(seen, part, out=seen)
    return pooled


def _tinted(mask: NDArray[np.bool_], colour: Rgb, alpha: int = 255) -> Pixels:
    """One colour everywhere and the shape in alpha alone: no dark fringe when a texture is averaged."""
    pixels = np.empty((*mask.shape, 4), dtype=np.uint8)
    pixels[..., :3] = colour
    pixels[..., 3] = np.where(mask, alpha, 0)
    return pixels


def walls(
    cells: CellArray, colour: Rgb, alpha: int = 255, most: int = MOST_PIXELS, part: CellRegion = WHOLE
) -> GridPixels:
    """The walls in one colour, everything else transparent.

    Here and below: at the most ``most`` pixels on a side, of the cells of ``part`` alone.
    """
    cells = cells[part]
    factor = pooling(cells.shape, most)
    return GridPixels(_tinted(pool(cells, factor) >= OCCUPIED_FROM, colour, alpha), factor)


def floor(
    cells: CellArray, palette: Palette, alpha: int = 255, most: int = MOST_PIXELS, part: CellRegion = WHOLE
) -> GridPixels:
    """What is known and no wall, in the colour of free space; unknown is transparent."""
    cells = cells[part]
    factor = pooling(cells.shape, most)
    return GridPixels(_tinted(pool(cells, factor) != UNKNOWN, palette.free, alpha), factor)


def sheet(cells: CellArray, colour: Rgb, palette: Palette, most: int = MOST_PIXELS) -> GridPixels:
    """A whole map by itself: walls in a colour, floor, and what is neither."""
    factor = pooling(cells.shape, most)
    pooled = pool(cells, factor)
    pixels = np.full((*pooled.shape, 4), 255, dtype=np.uint8)
    pixels[..., :3] = palette.unknown
    pixels[is_free(pooled), :3] = palette.free
    pixels[pooled >= OCCUPIED_FROM, :3] = colour
    return GridPixels(pixels, factor)


def touches(
    walls: WallLookup,
    agreement: CellAgreement,
    palette: Palette,
    most: int = MOST_PIXELS,
    part: CellRegion = WHOLE,
) -> GridPixels:
    """The walls that the other map agrees with or contradicts; ``agreement`` (N,) of a ``WallLookup``."""
    shape = walls.grid.cells[part].shape
    factor = pooling(shape, most)
    within, rows, cols = _within(part, walls.grid.cells.shape, *walls.cells)
    agreement = agreement[within]
    pixels = np.zeros((*(-(-side // factor) for side in shape), 4), dtype=np.uint8)
    for kind, colour in ((AGREES, palette.agreed), (CONTRADICTS, palette.conflict)):
        at = agreement == kind
        pixels[rows[at] // factor, cols[at] // factor] = (*colour, 255)
    return GridPixels(pixels, factor)


def levels(
    augmented: AugmentedMap, palette: Palette, most: int = MOST_PIXELS, part: CellRegion = WHOLE
) -> GridPixels:
    """The walls in the colours of their levels, eq. (4); walls too far to count keep a faint grey."""
    cells = augmented.grid.cells[part]
    factor = pooling(cells.shape, most)
    pixels = _tinted(pool(cells, factor) >= OCCUPIED_FROM, palette.margin, FAINT)
    within, rows, cols = _within(part, augmented.grid.cells.shape, augmented.rows, augmented.cols)
    if within.any():
        share = np.zeros(pixels.shape[:2])
        np.maximum.at(share, (rows // factor, cols // factor), augmented.levels[within] / augmented.peak)
        rows, cols = np.nonzero(share > 0.004)  # one step of the colour scale
        pixels[rows, cols, :3] = level_colours(share[rows, cols], palette.dark)
        pixels[rows, cols, 3] = 255
    return GridPixels(pixels, factor)


def is_free(cells: CellArray) -> BoolArray:
    """Where cells are known to be free."""
    return np.asarray((cells >= FREE) & (cells <= FREE_UP_TO))


def wall_masks(
    walls: tuple[BoolArray, BoolArray],
    free: tuple[BoolArray, BoolArray],
    palette: Palette,
    near: tuple[BoolArray, BoolArray] | None = None,
) -> tuple[tuple[BoolArray, Rgb], ...]:
    """Whose wall it is, where both maps have one, and where one denies the other's, each mask with its
    colour; to be painted in this order.

    walls, free : of map 1 and of map 2, on one raster
    near        : where a wall of the other map is the same wall; None: on it
    """
    (ref, mov), (ref_free, mov_free), (by_ref, by_mov) = walls, free, near or walls
    return (
        (ref, palette.ref),
        (mov, palette.mov),
        ((ref & by_mov) | (mov & by_ref), palette.agreed),
        ((ref & mov_free & ~by_mov) | (mov & ref_free & ~by_ref), palette.conflict),
    )


def merged_floor(
    fusion: Fusion, palette: Palette, most: int = MOST_PIXELS, part: CellRegion = WHOLE
) -> GridPixels:
    """What either map knows, in the colour of free space."""
    return floor(fusion.merged.cells, palette, most=most, part=part)


def merged_walls(
    fusion: Fusion,
    near: tuple[BoolArray, BoolArray],
    palette: Palette,
    most: int = MOST_PIXELS,
    part: CellRegion = WHOLE,
) -> GridPixels:
    """Whose wall it is, where both agree on a wall, and where they contradict; the rest transparent.

    near : ``contradictions.near_walls``: what is shown as contradicting is what counts as that
    """
    ref, mov = fusion.ref_cells[part], fusion.mov_cells[part]
    factor = pooling(ref.shape, most)
    walls, free = (ref >= OCCUPIED_FROM, mov >= OCCUPIED_FROM), (is_free(ref), is_free(mov))
    pixels = _tinted(np.maximum(pool(ref, factor), pool(mov, factor)) >= OCCUPIED_FROM, palette.margin)
    for mask, colour in wall_masks(walls, free, palette, (near[0][part], near[1][part])):
        pixels[pool(mask.astype(np.int8), factor) > 0, :3] = colour
    return GridPixels(pixels, factor)


def denied_walls(
    fusion: Fusion, found: Contradictions, palette: Palette, most: int = MOST_PIXELS, part: CellRegion = WHOLE
) -> GridPixels:
    """Walls that the other map denies, in the colour of the map they are of; all other walls faint."""
    ref, mov = fusion.ref_cells[part], fusion.mov_cells[part]
    factor = pooling(ref.shape, most)
    pixels = _tinted(np.maximum(pool(ref, factor), pool(mov, factor)) >= OCCUPIED_FROM, palette.margin, FAINT)
    for mask, colour in ((found.ref_only, palette.ref), (found.mov_only, palette.mov)):
        pixels[pool(mask[part].astype(np.int8), factor) > 0] = (*colour, 255)
    return GridPixels(pixels, factor)


def _within(
    part: CellRegion, shape: tuple[int, ...], rows: Places, cols: Places
) -> tuple[BoolArray, Places, Places]:
    """Which of these cells lie in a part of a grid; rows and columns of those, counted from its corner."""
    (top, bottom, _), (left, right, _) = (cut.indices(n) for cut, n in zip(part, shape, strict=True))
    within = (rows >= top) & (rows < bottom) & (cols >= left) & (cols < right)
    return within, rows[within] - top, cols[within] - left


def upright(pixels: Pixels) -> Pixels:
    """The picture for a screen: row 0 at the top."""
    return np.ascontiguousarray(pixels[::-1])
