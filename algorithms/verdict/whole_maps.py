"""Two whole maps on which a transform is weighed, and from which it is improved.

The search looks at the walls around the encounter. What lies there looks like many other places, and bent
maps fit there alone. So its best answers are held against everything that both robots saw before one of them
is named: each climbs to the top nearby, on crisp walls first; where much still contradicts, on blurred ones
and then on crisp ones again, by which bent maps come to lie in the middle of their bends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from algorithms.common.parallel_kernels import each_on_a_core
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.coarse_grid import pooled
from algorithms.maps.grid_map import GridMap
from algorithms.maps.robots import Robots
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.likelihood_field import clear, wall_field
from algorithms.optimisation.objective import Objective, Side
from algorithms.optimisation.search_box import pose_about, transforms_about
from algorithms.optimisation.subcell_peak import STENCIL, paraboloid
from algorithms.verdict.wall_evidence import Evidence, evidence, middle_of
from algorithms.verdict.wall_map import WallMap, make_wall_map

CRISP, BLURRED = 0.1, 0.4  # metres; standard deviation of the distance between two drawings of one wall
MOST_CELLS = 1_000_000  # of a table; a larger map is taken in coarser cells
BLURRED_CELL = 0.1  # metres; cells of the blurred tables
MOST_POINTS = 1_500  # of each map's walls while climbing
LEAST_STEP = 0.012  # metres; the climb ends below it
HILL = 0.025  # metres; half as wide is what a hilltop is fitted to
MOST_FITS = 6  # of hilltops, each one HILL from the last at most
REACH = 5.0  # metres at which a turn moves a wall by a step
MOST_LOOKS = 40  # at the 27 places around, per climb
CONTRADICTED = 0.1  # share of the walls; from here on maps may be bent
WORTH_MOVING = 2.0  # metres of wall: eight measurements, more than chance makes of where cells end

FLAT = 1e-6  # metres of wall; a hill that curves less is a ridge, and its top as far as may be
CLOSE = 0.02  # of HILL; a fit that moves it less is the last


@dataclass(frozen=True, eq=False)
class WholeMaps:
    """Both maps made ready.

    robots : around them, within their size, there is no wall to weigh
    window : the sightings; what a transform deviates from them is taken off its value
    trust  : what half a squared standard deviation off a sighting costs; metres of wall
    searched : shifts among which the answers were found, averaged over the whole circle of turns; m²
    """

    ref: WallMap
    mov: WallMap
    robots: Robots
    window: CoupledWindow
    trust: float
    searched: float = 0.0

    def weigh(self, T_ref_mov: Pose2) -> Evidence:
        """What the walls say of a transform, or of the hilltop within a few centimetres: where cells end is
        chance, and would count otherwise.
        """
        return evidence(self.ref, self.mov, self.hilltop(T_ref_mov), self.robots)

    @cached_property
    def crisp(self) -> Objective:
        """Metres of wall that agree less metres that contradict, over the whole maps."""
        return self._objective(CRISP, 0.0)

    @cached_property
    def _sparse(self) -> Objective:
        """The crisp objective from every second point of the walls."""
        sides = (
            replace(side, points=side.points[::2], weights=2 * side.weights[::2]) for side in self.crisp.sides
        )
        return replace(self.crisp, sides=tuple(sides))

    @cached_property
    def _blurred(self) -> Objective:
        return self._objective(BLURRED, BLURRED_CELL)

    def climb(self, T_ref_mov: Pose2) -> Pose2:
        """The best transform near one; that itself where none is better by much."""
        best = self._climb(self.crisp, T_ref_mov, CRISP / 2)
        if self.weigh_rigidly(best) > CONTRADICTED:
            rough = self._climb(self._blurred, T_ref_mov, BLURRED / 2)
            other = self._climb(self.crisp, rough, CRISP / 2)
            best = max(best, other, key=self.crisp.value_at)
        value = self.crisp.value_at
        return best if value(best) > value(T_ref_mov) + WORTH_MOVING else T_ref_mov

    def climb_all(self, poses: FloatArray) -> FloatArray:
        """(P, 3) x, y, theta of T_ref_mov of the hilltops on crisp walls that lie near (P, 3) others; from
        every second wall, for they are many.
        """
        pivot = self.window.pivot
        at = np.array([pose_about(pivot, Pose2.from_array(pose)) for pose in poses]).reshape(-1, 3)
        step = np.full(len(at), CRISP)
        live = np.arange(len(at))
        for _ in range(MOST_LOOKS if len(at) else 0):
            around = at[live, None] + STENCIL * (step[live, None] * (1.0, 1.0, 1 / REACH))[:, None]
            values = self._sparse(transforms_about(pivot, around.reshape(-1, 3))).reshape(
                len(live), len(STENCIL)
            )
            best = values.argmax(axis=1)
            at[live] = around[np.arange(len(live)), best]
            step[live[best == len(STENCIL) // 2]] /= 2
            live = live[step[live] >= 2 * LEAST_STEP]
            if not len(live):
                break
        return transforms_about(pivot, at)

    def rigid_evidence(self, answers: Sequence[Pose2]) -> list[Evidence]:
        """What the walls say of each transform with the maps as they are."""
        return each_on_a_core(lambda T: evidence(self.ref, self.mov, T, self.robots, slip=False), answers)

    def weigh_rigidly(self, T_ref_mov: Pose2) -> float:
        """Share of the walls that contradict with the maps as they are."""
        return evidence(self.ref, self.mov, T_ref_mov, self.robots, slip=False).rigid_contradiction

    def hilltop(self, T_ref_mov: Pose2) -> Pose2:
        """The top of the paraboloid that fits the crisp objective at the 27 places around, again and again.

        It is fitted about the middle of all robots, or of all walls, so that swapping the maps or turning a
        frame, by which other places are looked at, leaves it where it is to a millimetre or so.
        """
        pivot = T_ref_mov.inverse().apply(middle_of(self.ref, self.mov, T_ref_mov, self.robots))
        at = pose_about(pivot, T_ref_mov)
        for _ in range(MOST_FITS):
            slope, curvature = paraboloid(
                self.crisp(transforms_about(pivot, at + STENCIL * (HILL, HILL, HILL / REACH)))
            )
            bent, axes = np.linalg.eigh(curvature)
            # along each axis of the paraboloid one HILL at most: where it hardly curves, or upwards, its top
            # is nowhere, and a rounding error of the slope would decide how far to go
            move = -axes @ np.clip(axes.T @ slope / np.minimum(bent, -FLAT), -1, 1)
            at = at + move * (HILL, HILL, HILL / REACH)
            if abs(move).max() < CLOSE:
                break
        return Pose2.from_array(transforms_about(pivot, at[None])[0])

    def _climb(self, objective: Objective, T_ref_mov: Pose2, step: float) -> Pose2:
        """From place to place to the best of the 27 around; half the steps where that is the middle."""
        pivot = self.window.pivot
        at = pose_about(pivot, T_ref_mov)
        for _ in range(MOST_LOOKS):
            around = at + STENCIL * (step, step, step / REACH)
            best = int(objective(transforms_about(pivot, around)).argmax())
            at = around[best]
            if best == len(around) // 2:
                step /= 2
                if step < LEAST_STEP:
                    break
        return Pose2.from_array(transforms_about(pivot, at[None])[0])

    def _objective(self, blur: float, least_cell: float) -> Objective:
        """Of walls in cells of at least that many metres, and in ``MOST_CELLS`` at most."""
        pairs = (self.ref, self.mov, False), (self.mov, self.ref, True)
        sides = each_on_a_core(lambda pair: self._side(*pair, blur, least_cell), pairs)
        return Objective(tuple(sides), window=self.window, trust=self.trust)

    def _side(self, target: WallMap, source: WallMap, backward: bool, blur: float, least_cell: float) -> Side:
        grid = target.grid
        coarser = int(least_cell / grid.resolution + 1e-9), ceil((grid.cells.size / MOST_CELLS) ** 0.5)
        grid = pooled(grid, max(coarser))
        anchor = self.window.place if backward else self.window.pivot
        stride = max(1, ceil(len(source.points) / MOST_POINTS))
        points = source.grid.origin.apply(source.points[::stride])
        table = wall_field(grid.occupied, grid.free, grid.resolution, blur)
        stood = self.robots.in_mov if backward else self.robots.in_ref  # in the target's own frame
        clear(table, grid, np.zeros(2), stood, self.robots.size)
        return Side(
            grid=grid,
            table=table,
            corner=np.zeros(2),
            anchor=anchor,
            points=points - anchor,
            weights=np.full(len(points), source.metres * stride),
            backward=backward,
        )


def make_whole_maps(
    ref: GridMap,
    mov: GridMap,
    robots: Robots,
    window: CoupledWindow,
    trust: float,
    searched: float = 0.0,
) -> WholeMaps:
    """Make both maps ready, each on a core; the rest as in WholeMaps."""
    first, second = each_on_a_core(make_wall_map, (ref, mov))
    return WholeMaps(first, second, robots, window, trust, searched)
