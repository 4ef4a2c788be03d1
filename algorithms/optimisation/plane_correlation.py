"""How well two maps agree at every shift of the plane, turn by turn: the agreement of ``likelihood_field`` by
fast Fourier transforms.

For one turn of the smaller map both sums, its walls looked up in the larger one's field and the other way
round, are correlations, so one inverse transform gives their sum for all shifts at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, cos, pi, sin
from typing import Annotated, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray, Pose2, wrap_angle, wrap_angles
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.coarse_grid import pooled, trimmed
from algorithms.maps.grid_map import UNKNOWN, BoolArray, Float32Array, GridMap, where
from algorithms.maps.wall_distance import surface
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.likelihood_field import wall_field
from algorithms.optimisation.objective import PAD

IntArray = NDArray[np.intp]

LOOK = 8  # cells between two places at which the window is asked


@dataclass(frozen=True)
class PlaneConfig(CheckedConfig):
    """The raster of turns and shifts on which two maps are laid on each other."""

    turn_step: Annotated[float, Bounds(0.5, 10, 0.5, "°", "", "turn step")] = 3.0
    """Turn between two neighbours."""
    edge: Annotated[int, Bounds(128, 2048, 64, "cells", "", "plane's edge")] = 448
    """Cells along an edge of the plane, about, with cells between the finest and the coarsest."""
    finest: Annotated[float, Bounds(0.02, 1, 0.01, "m", "", "finest cell")] = 0.05
    """Edge of the cells of small maps; their own where that is longer."""
    coarsest: Annotated[float, Bounds(0.05, 1, 0.01, "m", "", "coarsest cell")] = 0.2
    """Edge of the cells of large maps, and the plane has more of them: in longer ones doors are lost."""
    blur: Annotated[float, Bounds(0.05, 1, 0.05, "m", "", "plane's blur")] = 0.1
    """Standard deviation of the distance between two drawings of one wall; a cell at least."""


@dataclass(frozen=True, eq=False)
class TurnLook:
    """One turn of the plane, looked at.

    turn    : of T_ref_mov; radians
    surface : ``PlaneCorrelation.surface`` of it; None where the window leaves no shift
    poses, values : (P, 3), (P,) x, y, theta of T_ref_mov on the highest hills, and how high they are; metres
              of wall
    shifts  : how many shifts the window leaves
    within  : ``PlaneCorrelation.within`` of it
    """

    turn: float
    surface: Float32Array | None
    poses: FloatArray
    values: Float32Array
    shifts: int
    within: BoolArray | None

    @property
    def top(self) -> float:
        return float(self.values[0]) if len(self.values) else -np.inf


class PlaneCorrelation:
    """Two maps ready to be correlated; a shift is a row and a column of ``surface``.

    turns : (K,) turns of T_ref_mov that are tried; radians, rising from −π
    cell  : edge of a cell of the plane; metres
    shape : rows and columns of the plane
    """

    def __init__(self, ref: GridMap, mov: GridMap, config: PlaneConfig) -> None:
        self._config = config
        self._swapped = mov.cells.size * mov.resolution**2 > ref.cells.size * ref.resolution**2
        still, moved = (mov, ref) if self._swapped else (ref, mov)
        self._still, self._moved = still.origin, moved.origin
        size = max(_size(still)) + 2 * _reach(moved.cells != UNKNOWN) * moved.resolution
        fitting = min(size / config.edge, config.coarsest)
        self.cell = max(config.finest, ref.resolution, mov.resolution, fitting)
        self.blur = max(config.blur, self.cell)
        count = ceil(360 / config.turn_step)
        self.turns = np.asarray(np.arange(count) * (2 * pi / count) - pi, dtype=np.float64)
        field, points, weight = self._ready(still)
        self._field, at, self._weight = self._ready(moved)
        self._middle = np.array(self._field.shape[::-1]) / 2
        self._points = at - self._middle
        reach = max(float(np.linalg.norm(self._points, axis=1).max(initial=1.0)), _reach(self._field != 0))
        self._side = 2 * ceil(reach + 1)
        self._extent = field.shape
        rows, cols = (cv2.getOptimalDFTSize(n + self._side) for n in field.shape)
        self.shape = (rows, cols)
        walls = _raster(points, field.shape) * np.float32(weight)
        self._field_spectrum, self._wall_spectrum = self._spectrum(field), self._spectrum(walls)

    def look(self, turn: float, window: CoupledWindow, most: int) -> TurnLook:
        """The highest hills of a turn, so many at most."""
        within = self.within(turn, window)
        if within is not None and not within.any():
            return TurnLook(turn, None, np.zeros((0, 3)), np.zeros(0, dtype=np.float32), 0, within)
        surface_ = self.surface(turn)
        rows, cols, values = self.peaks(surface_, most, within)
        shifts = surface_.size if within is None else int(within.sum())
        return TurnLook(turn, surface_, self.poses(turn, rows, cols), values, shifts, within)

    def surface(self, turn: float) -> Float32Array:
        """``shape`` metres of wall that agree less metres that contradict, for every shift."""
        c, s = self._cos_sin(turn)
        side, turned = self._side, np.array([[c, -s], [s, c]])
        walls = _raster(self._points @ turned.T + side / 2, (side, side)) * np.float32(self._weight)
        warp = np.column_stack([turned, side / 2 - 0.5 - turned @ (self._middle - 0.5)])
        field: Any = cv2.warpAffine(self._field, warp, (side, side), flags=cv2.INTER_LINEAR)
        both: Any = cv2.mulSpectrums(self._field_spectrum, self._spectrum(walls), 0, conjB=True)
        both += cv2.mulSpectrums(self._wall_spectrum, self._spectrum(field), 0, conjB=True)
        return correlated(both)

    def poses(self, turn: float, rows: IntArray, cols: IntArray) -> FloatArray:
        """(P, 3) x, y, theta of T_ref_mov at so many places of the surface of a turn."""
        shifts = np.stack([cols, rows], axis=-1).astype(np.float64)
        for axis, (whole, extent) in enumerate(zip(self.shape[::-1], self._extent[::-1], strict=True)):
            shifts[:, axis] -= np.where(shifts[:, axis] >= extent, whole, 0)  # beyond the map it is wrapped
        return self.poses_at(turn, shifts)

    def unwrapped(self, surface_: NDArray[Any]) -> tuple[NDArray[Any], FloatArray]:
        """A surface with all its shifts in their order, and the (2,) shift, column and row, of its first."""
        first = np.subtract(self._extent, self.shape)
        return np.roll(surface_, -first, axis=(0, 1)), first[::-1].astype(np.float64)

    def poses_at(self, turn: float, shifts: FloatArray) -> FloatArray:
        """(P, 3) x, y, theta of T_ref_mov at (P, 2) shifts, columns and rows, of a turn; none is wrapped."""
        c, s = self._cos_sin(turn)
        turned = np.array([[c, -s], [s, c]])
        xy = (shifts + self._side / 2 - turned @ self._middle) * self.cell
        # from the axes of the grids to the frames of the maps
        still, angle = self._still, self._grid_turn(turn)
        out = np.empty((len(xy), 3))
        lever = Pose2(theta=angle) @ self._moved.inverse()
        out[:, :2] = still.apply(xy + lever.xy)
        out[:, 2] = wrap_angle(still.theta + lever.theta)
        return inverses(out) if self._swapped else out

    def peaks(
        self, surface_: Float32Array, most: int, within: BoolArray | None = None
    ) -> tuple[IntArray, IntArray, Float32Array]:
        """(P,) rows, columns and values of the highest hills of a surface above 0, the highest first.

        within : ``shape``; where to look
        """
        reach = max(1, round(self.blur / self.cell))
        hills = surface_ >= cv2.dilate(surface_, np.ones((2 * reach + 1,) * 2, dtype=np.uint8))
        hills &= surface_ > 0
        if within is not None:
            hills &= within
        flat = np.flatnonzero(hills)
        values = surface_.ravel()[flat]
        order = np.argsort(-values, kind="stable")[:most]
        rows, cols = np.unravel_index(flat[order], self.shape)
        return rows, cols, values[order]

    def within(self, turn: float, window: CoupledWindow) -> BoolArray | None:
        """``shape``: which shifts a window may hold, at a turn or up to half a step beside it; None: all."""
        if not len(window.x_ref) and not window.priors:
            return None
        rows, cols = (np.arange(LOOK // 2, n + LOOK, LOOK) for n in self.shape)
        rows, cols = np.minimum(rows, self.shape[0] - 1), np.minimum(cols, self.shape[1] - 1)
        poses = self.poses(turn, np.repeat(rows, len(cols)), np.tile(cols, len(rows)))
        slack = window.slack((LOOK + 1) * self.cell / 2**0.5, pi / len(self.turns))
        near = (window.deviations(poses) - slack <= window.k).all(axis=1).reshape(len(rows), len(cols))
        return np.repeat(np.repeat(near, LOOK, axis=0), LOOK, axis=1)[: self.shape[0], : self.shape[1]]

    def _grid_turn(self, turn: float) -> float:
        """Turn of the moved grid's axes in the still one's, of a turn of T_ref_mov; radians."""
        return (-turn if self._swapped else turn) + self._moved.theta - self._still.theta

    def _cos_sin(self, turn: float) -> tuple[float, float]:
        angle = self._grid_turn(turn)
        return cos(angle), sin(angle)

    def _ready(self, grid: GridMap) -> tuple[Float32Array, FloatArray, float]:
        """Field of a map in cells of the plane, its walls in such cells, and metres that each stands for."""
        coarse = pooled(grid, int(self.cell / grid.resolution + 1e-9))
        field: Any = wall_field(coarse.occupied, coarse.free, coarse.resolution, self.blur)[
            PAD:-PAD, PAD:-PAD
        ]
        if coarse.resolution != self.cell:
            height, width = (max(1, round(n * coarse.resolution / self.cell)) for n in field.shape)
            field = cv2.resize(field, (width, height), interpolation=cv2.INTER_AREA)
        rows, cols = where(surface(coarse.occupied, coarse.free))
        points = (np.stack([cols, rows], axis=-1) + 0.5) * (coarse.resolution / self.cell)
        return field, np.asarray(points, dtype=np.float64), coarse.resolution

    def _spectrum(self, raster: Float32Array) -> Float32Array:
        return spectrum(raster, self.shape)


def spectrum(raster: Float32Array, shape: tuple[int, int]) -> Float32Array:
    """``shape``: of a raster with zeros around it, as OpenCV packs it; half as long as scipy takes."""
    rows, cols = raster.shape
    out = np.zeros(shape, dtype=np.float32)
    out[:rows, :cols] = raster
    return np.asarray(cv2.dft(out, dst=out, nonzeroRows=rows), dtype=np.float32)


def correlated(both: Float32Array) -> Float32Array:
    """The correlation of two rasters from the product of their spectra, which is overwritten."""
    inverse = cv2.DFT_INVERSE | cv2.DFT_REAL_OUTPUT | cv2.DFT_SCALE
    return np.asarray(cv2.dft(both, dst=both, flags=inverse), dtype=np.float32)


def searched_area(ref: GridMap, mov: GridMap, config: PlaneConfig, window: CoupledWindow) -> float:
    """Shifts that a window leaves of the plane, averaged over the turns; m².

    For an answer that comes from elsewhere: among so many it is one.
    """
    plane = PlaneCorrelation(trimmed(ref), trimmed(mov), config)
    left = [plane.within(turn, window) for turn in plane.turns.tolist()]
    shifts = [plane.shape[0] * plane.shape[1] if within is None else int(within.sum()) for within in left]
    return sum(shifts) * plane.cell**2 / len(shifts)


def places(
    poses: FloatArray, values: Float32Array, pivot: FloatArray, most: int, distance: float, angle: float
) -> IntArray:
    """(K,) which of (P, 3) transforms are places of their own, the highest value first, so many at most.

    pivot    : (2,) metres, mov frame
    distance : metres at the pivot, and
    angle    : radians, within which a lower one is part of a higher one
    """
    at = moved_points(pivot, poses)
    kept = np.zeros(0, dtype=np.intp)
    for k in np.argsort(-values, kind="stable")[: len(values)]:
        near = np.hypot(*(at[kept] - at[k]).T) < distance
        near &= np.abs(wrap_angles(poses[kept, 2] - poses[k, 2])) < angle
        if not near.any():
            kept = np.append(kept, k)
            if len(kept) == most:
                break
    return kept


def moved_points(point: FloatArray, poses: FloatArray) -> FloatArray:
    """(P, 2) where (P, 3) transforms put a (2,) point."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = point
    return np.column_stack([c * x - s * y + poses[:, 0], s * x + c * y + poses[:, 1]])


def inverses(poses: FloatArray) -> FloatArray:
    """(P, 3) the inverses of (P, 3) transforms x, y, theta."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = poses[:, 0], poses[:, 1]
    return np.column_stack([-(c * x + s * y), s * x - c * y, -poses[:, 2]])


def _size(grid: GridMap) -> tuple[float, float]:
    return grid.width * grid.resolution, grid.height * grid.resolution


def _reach(known: BoolArray) -> float:
    """Distance of the farthest cell of a mask from its middle; cells."""
    rows, cols = np.nonzero(known)
    return float(np.hypot(rows + 0.5 - known.shape[0] / 2, cols + 0.5 - known.shape[1] / 2).max(initial=1.0))


def _raster(points: FloatArray, shape: tuple[int, ...]) -> Float32Array:
    """How many of (N, 2) x, y lie in each cell."""
    rows, cols = shape
    at = np.clip(points.astype(np.intp), 0, (cols - 1, rows - 1))
    count = np.bincount(at[:, 1] * cols + at[:, 0], minlength=rows * cols)
    return count.reshape(rows, cols).astype(np.float32)
