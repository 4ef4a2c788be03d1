"""How unlike two maps are where both know something, at any transform; and the best one nearby."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.methods.baselines.distance_image import DistanceImage

MOST_POINTS = 5_000  # of map 2's pixels that are compared
UNLIKE = 1.0  # mean squared error of what is nowhere alike; also said where the overlap is too small


@dataclass(frozen=True, eq=False)
class OverlapError:
    """A picture of each map, to be compared pixel by pixel.

    ref    : picture of the ref map
    points : (N, 2) middles of pixels that the mov map knows; metres, mov frame
    values : (N,) its picture there
    least  : share of the points that the ref map must know, too
    """

    ref: DistanceImage
    points: FloatArray
    values: FloatArray
    least: float

    @staticmethod
    def of(ref: DistanceImage, mov: DistanceImage, least: float, seed: int) -> OverlapError:
        """Compare two pictures.

        least : share of the smaller map's known area that both must know
        seed  : of the choice of the pixels, where there are many
        """
        rows, cols = np.nonzero(mov.known)
        if len(rows) > MOST_POINTS:
            some = np.random.default_rng(seed).choice(len(rows), MOST_POINTS, replace=False)
            rows, cols = rows[some], cols[some]
        share = min(1.0, float(ref.known.sum()) / max(1, int(mov.known.sum())))
        points = mov.places(np.column_stack([cols, rows]).astype(np.float64))
        return OverlapError(ref, points, mov.far[rows, cols].astype(np.float64), least * share)

    def error(self, T_ref_mov: Pose2) -> float:
        """Mean squared difference of the two pictures where both know something; 0 … 1."""
        ref = self.ref
        to_grid = ref.grid.origin.inverse() @ T_ref_mov
        at = ((to_grid.apply(self.points) - ref.low) / ref.cell - 0.5).astype(np.float32)
        looked_up = cv2.remap(self._layers, at[None, :, 0], at[None, :, 1], cv2.INTER_LINEAR)[0]
        known = looked_up[:, 1] > 0.5
        share = float(known.mean())
        if share < self.least or share == 0.0:
            return UNLIKE + self.least - share  # the way back lies downhill
        return float(((looked_up[known, 0] - self.values[known]) ** 2).mean(dtype=np.float64))

    @cached_property
    def _layers(self) -> NDArray[np.float32]:
        """(H, W, 2) the ref map's picture, and where it is known."""
        return np.stack([self.ref.far, self.ref.known.astype(np.float32)], axis=-1)

    def best_near(self, T_ref_mov: Pose2, step: float) -> tuple[Pose2, float]:
        """The transform of the least error near another one (Nelder and Mead), and its error.

        step : how far the first tries lie apart; metres, of a turn at the rim of the mov map
        """
        from scipy.optimize import minimize  # slow to load, and no other method needs it

        if len(self.points) == 0:
            return T_ref_mov, UNLIKE
        middle = self.points.mean(axis=0)
        radius = max(float(np.linalg.norm(self.points - middle, axis=1).max()), step)

        def pose(at: FloatArray) -> Pose2:
            turn = Pose2(theta=T_ref_mov.theta + float(at[2]) / radius)
            x, y = (T_ref_mov.apply(middle) + at[:2] - turn.apply(middle)).tolist()
            return Pose2.from_array((x, y, turn.theta))

        simplex = np.vstack([np.zeros(3), np.eye(3)]) * step - step / 4
        end = minimize(
            lambda at: self.error(pose(at)),
            np.zeros(3),
            method="Nelder-Mead",
            options={"initial_simplex": simplex, "xatol": step / 100, "fatol": 1e-7, "maxiter": 200},
        )
        return pose(end.x), float(end.fun)


def extent(grid: GridMap) -> float:
    """Half a diagonal of the whole grid: metres that a turn of one radian moves its corner."""
    return float(np.hypot(grid.width, grid.height)) * grid.resolution / 2
