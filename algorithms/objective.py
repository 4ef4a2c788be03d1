"""Γ: how well two augmented maps coincide under a transform, eq. (17), for many transforms at once."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from algorithms.augment import AugmentedMap
from algorithms.kernels import fast_kernel, spread
from algorithms.pose import FloatArray

Float32Array = NDArray[np.float32]

# Rows and columns of zeros around the looked-up table. A coordinate outside is clamped into them,
# so the inner loop needs no bounds test and runs in vector registers.
PAD = 2

_LOOKUPS_WORTH_A_THREAD = 100_000  # about 0.2 ms of work


class Lookup(str, Enum):
    """How a level is read between cell centres."""

    BILINEAR = "bilinear"  # smooth in the pose
    NEAREST = "nearest"  # the paper's raster


@dataclass(frozen=True, eq=False)
class Objective:
    """Γ(t) = Σ_n Aug2(m_n) · M1aug(T(t) m_n), the dual form of eq. (17).

    table     : (H + 2·PAD, W + 2·PAD) float32 levels of the ref map around its encounter, zeros
                around them
    corner    : (2,) column and row, in the ref grid, of table cell (PAD, PAD)
    """

    ref: AugmentedMap
    mov: AugmentedMap
    lookup: Lookup
    table: Float32Array
    corner: FloatArray
    _x: Float32Array
    _y: Float32Array
    _levels: Float32Array

    @property
    def evaluation_size(self) -> int:
        """Number of look-ups that one pose costs."""
        return len(self._x)

    def __call__(self, poses: FloatArray) -> FloatArray:
        """Γ of every pose.

        poses   : (P, 3) x, y, theta of T_ref_mov; metres, metres, radians
        returns : (P,) float64, >= 0; the same on any number of threads
        """
        grid = self.ref.grid
        poses = np.asarray(poses, dtype=np.float64).reshape(-1, 3)
        c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        x2, y2 = self.mov.x_hat
        moved = poses[:, :2] + np.stack([c * x2 - s * y2, s * x2 + c * y2], axis=1)
        shift = grid.grid_coordinates(moved) - self.corner + PAD
        if self.lookup is Lookup.BILINEAR:
            shift -= 0.5  # levels sit at cell centres
        turn = poses[:, 2] - grid.origin.theta
        motions = np.column_stack([np.cos(turn), np.sin(turn), shift]).astype(np.float32)
        values = np.zeros(len(poses))
        rows, cols = self.table.shape
        flat = self.table.ravel()
        loop = _bilinear if self.lookup is Lookup.BILINEAR else _nearest

        def work(start: int, stop: int) -> None:
            loop(
                flat,
                rows,
                cols,
                self._x,
                self._y,
                self._levels,
                motions[start:stop],
                values[start:stop],
            )

        spread(work, len(poses), at_least=1 + _LOOKUPS_WORTH_A_THREAD // (1 + len(self._x)))
        return values


def make_objective(ref: AugmentedMap, mov: AugmentedMap, lookup: Lookup = Lookup.BILINEAR) -> Objective:
    """The objective of two augmented maps; they may differ in resolution, origin and size."""
    corner = np.zeros(2)
    table = np.zeros((2 * PAD + 1, 2 * PAD + 1), dtype=np.float32)
    if len(ref.levels):
        low_row, low_col = int(ref.rows.min()), int(ref.cols.min())
        shape = (
            int(ref.rows.max()) - low_row + 1 + 2 * PAD,
            int(ref.cols.max()) - low_col + 1 + 2 * PAD,
        )
        corner = np.array([low_col, low_row], dtype=float)
        table = np.zeros(shape, dtype=np.float32)
        table[ref.rows - low_row + PAD, ref.cols - low_col + PAD] = ref.levels
    offset = (mov.points - mov.x_hat) / ref.grid.resolution
    return Objective(
        ref=ref,
        mov=mov,
        lookup=lookup,
        table=table,
        corner=corner,
        # relative to the encounter: small numbers, so that 32 bits hold them to 1/10,000 of a cell
        _x=np.ascontiguousarray(offset[:, 0], dtype=np.float32),
        _y=np.ascontiguousarray(offset[:, 1], dtype=np.float32),
        _levels=mov.levels.astype(np.float32),
    )


@fast_kernel
def _bilinear(
    flat: Float32Array,
    rows: int,
    cols: int,
    x: Float32Array,
    y: Float32Array,
    levels: Float32Array,
    motions: Float32Array,
    out: FloatArray,
) -> None:
    zero = np.float32(0)
    u_max, v_max = np.float32(cols - 2), np.float32(rows - 2)
    stride = np.int32(cols)
    right, up, both = np.uint32(1), np.uint32(cols), np.uint32(cols + 1)
    for p in range(motions.shape[0]):
        c, s, tx, ty = motions[p, 0], motions[p, 1], motions[p, 2], motions[p, 3]
        total = zero
        for n in range(x.shape[0]):
            u = min(max(c * x[n] - s * y[n] + tx, zero), u_max)
            v = min(max(s * x[n] + c * y[n] + ty, zero), v_max)
            column, row = np.int32(u), np.int32(v)
            du, dv = u - np.float32(column), v - np.float32(row)
            # unsigned: numba then leaves out the test for negative indices, and the loop vectorises
            k = np.uint32(row * stride + column)
            below = flat[k] + du * (flat[k + right] - flat[k])
            above = flat[k + up] + du * (flat[k + both] - flat[k + up])
            total += levels[n] * (below + dv * (above - below))
        out[p] = total


@fast_kernel
def _nearest(
    flat: Float32Array,
    rows: int,
    cols: int,
    x: Float32Array,
    y: Float32Array,
    levels: Float32Array,
    motions: Float32Array,
    out: FloatArray,
) -> None:
    zero = np.float32(0)
    u_max, v_max = np.float32(cols - 1), np.float32(rows - 1)
    stride = np.int32(cols)
    for p in range(motions.shape[0]):
        c, s, tx, ty = motions[p, 0], motions[p, 1], motions[p, 2], motions[p, 3]
        total = zero
        for n in range(x.shape[0]):
            u = min(max(c * x[n] - s * y[n] + tx, zero), u_max)
            v = min(max(s * x[n] + c * y[n] + ty, zero), v_max)
            k = np.uint32(np.int32(v) * stride + np.int32(u))
            total += levels[n] * flat[k]
        out[p] = total
