"""What is maximised: points of one map looked up in a table over the other, for many transforms at once.

Γ of eq. (17) is one such sum; the agreement of ``likelihood_field`` is two, one in each direction.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import fast_kernel, run_in_threads
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import Float32Array, GridMap
from algorithms.observations.search_window import CoupledWindow
from algorithms.spectra.augmented_map import AugmentedMap

# Rows and columns of zeros around the looked-up table. A coordinate outside is clamped into them,
# so the inner loop needs no bounds test and runs in vector registers.
PAD = 2

_LOOKUPS_WORTH_A_THREAD = 100_000  # about 0.2 ms of work


class Lookup(str, Enum):
    """How a level is read between cell centres."""

    BILINEAR = "bilinear"  # smooth in the pose
    NEAREST = "nearest"  # the paper's raster


@dataclass(frozen=True, eq=False)
class Side:
    """Points of one map with their weights, and a table over the other map in which they are looked up.

    grid     : the map that the table lies on
    table    : (H + 2·PAD, W + 2·PAD) float32; its outermost ``PAD`` rows and columns are zeros
    corner   : (2,) column and row, in the grid, of table cell (PAD, PAD)
    anchor   : (2,) what the points are relative to, where the encounter is; metres, the points' own frame
    points   : (N, 2) metres from the anchor, axes of the points' own frame
    weights  : (N,)
    backward : False: points of the mov map looked up in the ref map. True: the other way round
    """

    grid: GridMap
    table: Float32Array
    corner: FloatArray
    anchor: FloatArray
    points: FloatArray
    weights: FloatArray
    backward: bool = False

    @cached_property
    def _cells(self) -> tuple[Float32Array, Float32Array, Float32Array]:
        # relative to the encounter: small numbers, so that 32 bits hold them to 1/10,000 of a cell
        x, y = np.ascontiguousarray((self.points / self.grid.resolution).T, dtype=np.float32)
        return x, y, self.weights.astype(np.float32)

    def motions(self, poses: FloatArray) -> FloatArray:
        """(P, 4) per pose: cosine and sine of the turn, and the table column and row the anchor goes to.

        poses : (P, 3) x, y, theta of T_ref_mov
        A table cell (r, c) covers columns c … c + 1 and rows r … r + 1 of these coordinates.
        """
        grid, (x, y) = self.grid, self.anchor
        turn = -poses[:, 2] if self.backward else poses[:, 2]
        c, s = np.cos(turn), np.sin(turn)
        if self.backward:  # T⁻¹ p = C(−Δθ) (p − Δ)
            x, y = x - poses[:, 0], y - poses[:, 1]
        moved = np.stack([c * x - s * y, s * x + c * y], axis=1)
        if not self.backward:
            moved += poses[:, :2]
        shift = grid.grid_coordinates(moved) - self.corner + PAD
        turn = turn - grid.origin.theta
        return np.column_stack([np.cos(turn), np.sin(turn), shift])

    def __call__(self, poses: FloatArray, lookup: Lookup) -> FloatArray:
        """(P,) float64: Σ_n weight_n · table(point_n under the pose)."""
        motions = self.motions(poses)
        if lookup is Lookup.BILINEAR:
            motions[:, 2:] -= 0.5  # levels sit at cell centres
            return sum_in_table(_bilinear, self.table.ravel(), self.table.shape, self._cells, motions)
        return sum_in_table(nearest, self.table.ravel(), self.table.shape, self._cells, motions, None)


def sum_in_table(
    loop: Callable[..., None],
    flat: Float32Array,
    shape: tuple[int, ...],
    points: Sequence[Float32Array],
    motions: FloatArray,
    *offsets: NDArray[np.uint32] | None,
) -> FloatArray:
    """(P,) weighted sums of what points find in a table under each of (P, 4) motions, on all threads.

    loop   : ``_bilinear`` or ``nearest``
    shape  : rows and columns of the table; of each, where several stand one after another
    points : (N,) x, y in cells and weight
    offsets : for ``nearest``: (N,) where in ``flat`` the table of a point begins; None: at 0
    """
    single, values = motions.astype(np.float32), np.zeros(len(motions))

    def work(start: int, stop: int) -> None:
        loop(flat, shape, *points, single[start:stop], values[start:stop], *offsets)

    run_in_threads(work, len(motions), at_least=1 + _LOOKUPS_WORTH_A_THREAD // (1 + len(points[0])))
    return values


@dataclass(frozen=True, eq=False)
class Objective:
    """A sum of sides, less what a transform deviates from the sightings.

    sides   : one for Γ, eq. (17); two for the agreement
    lookup  : how the tables are read
    window  : the sightings; None: they don't count
    trust   : what half a squared standard deviation off a sighting costs, in units of the sides
    """

    sides: tuple[Side, ...]
    lookup: Lookup = Lookup.BILINEAR
    window: CoupledWindow | None = None
    trust: float = 0.0

    @property
    def cell(self) -> float:
        """Edge of a cell of the ref map; metres."""
        return self.sides[0].grid.resolution

    def __call__(self, poses: FloatArray) -> FloatArray:
        """The value of every pose.

        poses   : (P, 3) x, y, theta of T_ref_mov; metres, metres, radians
        returns : (P,) float64; the same on any number of threads
        """
        poses = np.asarray(poses, dtype=np.float64).reshape(-1, 3)
        values = np.zeros(len(poses))
        for side in self.sides:
            values += side(poses, self.lookup)
        if self.window is not None:
            values -= 0.5 * self.trust * (self.window.deviations(poses) ** 2).sum(axis=1)
        return values

    def value_at(self, T_ref_mov: Pose2) -> float:
        return float(self(T_ref_mov.array()[None])[0])


def make_objective(ref: AugmentedMap, mov: AugmentedMap, lookup: Lookup = Lookup.BILINEAR) -> Objective:
    """Γ(t) = Σ_n Aug2(m_n) · M1aug(T(t) m_n), the dual form of eq. (17).

    The augmented maps may differ in resolution, origin and size.
    """
    corner = np.zeros(2)
    table = np.zeros((2 * PAD + 1, 2 * PAD + 1), dtype=np.float32)
    if len(ref.levels):
        row, col = ref.rows - ref.rows.min() + PAD, ref.cols - ref.cols.min() + PAD
        corner = np.array([ref.cols.min(), ref.rows.min()], dtype=float)
        table = np.zeros((int(row.max()) + 1 + PAD, int(col.max()) + 1 + PAD), dtype=np.float32)
        table[row, col] = ref.levels
    side = Side(ref.grid, table, corner, mov.x_hat, mov.points - mov.x_hat, mov.levels)
    return Objective((side,), lookup)


@fast_kernel
def _bilinear(
    flat: Float32Array,
    shape: tuple[int, int],
    x: Float32Array,
    y: Float32Array,
    levels: Float32Array,
    motions: Float32Array,
    out: FloatArray,
) -> None:
    zero, (rows, cols) = np.float32(0), shape
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
def nearest(
    flat: Float32Array,
    shape: tuple[int, int],
    x: Float32Array,
    y: Float32Array,
    levels: Float32Array,
    motions: Float32Array,
    out: FloatArray,
    offsets: NDArray[np.uint32] | None,
) -> None:
    """Sum what the cell holds in which each point falls."""
    zero, (rows, cols) = np.float32(0), shape
    u_max, v_max = np.float32(cols - 1), np.float32(rows - 1)
    stride = np.int32(cols)
    for p in range(motions.shape[0]):
        c, s, tx, ty = motions[p, 0], motions[p, 1], motions[p, 2], motions[p, 3]
        total = zero
        for n in range(x.shape[0]):
            u = min(max(c * x[n] - s * y[n] + tx, zero), u_max)
            v = min(max(s * x[n] + c * y[n] + ty, zero), v_max)
            k = np.uint32(np.int32(v) * stride + np.int32(u))
            if offsets is not None:  # decided when it is compiled
                k += offsets[n]
            total += levels[n] * flat[k]
        out[p] = total
