"""What a merge of two maps begins with: the maps, and what is known of how they lie to each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import degrees, hypot, pi, sqrt

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, rotation, wrap_angle
from algorithms.maps.grid_map import GridMap, where
from algorithms.maps.robots import Robots
from algorithms.observations.observation import Encounter, Observation, encounters_of, name_of, robots_of
from algorithms.observations.priors import InitialPose, NearPlace, Prior, TurnPrior
from algorithms.observations.search_window import (
    LEAST_MARGIN,
    CoupledWindow,
    WindowConfig,
    WindowTerm,
    coupled_window,
)
from algorithms.observations.sighted_ring import SightedRing, is_curved

OFF_THE_MAP = 5.0  # metres
TOO_FAR = 5.0  # standard deviations of what two things say of one place, both together

Known = Observation | Prior
"""One thing that is known: a sighting, a rough initial pose, a rough turn, or a place that both maps show."""


@dataclass(frozen=True)
class PairProblem:
    """Two maps and what is known of how they lie; equal where the maps are the same objects and the
    knowledge is equal.

    ref, mov     : the observer's map, and that of the robot it saw
    observations : sightings between their makers; none, one or several
    priors       : what else is known
    raises       : SettingError where a robot stands far off the map it has made itself, or a place off the
                   map it is in, or where an initial pose contradicts what else is known. A map may have been
                   cropped, so some metres are let pass; more is a mix-up of files or of units
    """

    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...] = ()
    priors: tuple[Prior, ...] = ()

    @staticmethod
    def of(ref: GridMap, mov: GridMap, known: Known | Sequence[Known] = ()) -> PairProblem:
        """The same of a single thing that is known, or of any sequence of them."""
        each = tuple(known) if isinstance(known, Sequence) else (known,)
        seen = tuple(one for one in each if isinstance(one, Observation))
        return PairProblem(ref, mov, seen, tuple(one for one in each if not isinstance(one, Observation)))

    def __post_init__(self) -> None:
        for what, key, x, y, grid in self._places():
            col, row = grid.grid_coordinates(np.array([x, y])).tolist()
            beside, above = max(0.0, -col, col - grid.width), max(0.0, -row, row - grid.height)
            off = grid.resolution * hypot(beside, above)
            if off > OFF_THE_MAP:
                raise SettingError(
                    f"{what} at ({x:g}, {y:g}) m, {off:.1f} m outside its own map {grid.name!r}; "
                    f"check {key}, the map's origin and resolution, and whether the two maps are swapped"
                )

        self._check_consistency()

    def _check_consistency(self) -> None:
        """Raise SettingError where an initial pose contradicts a sighting, or a rough turn."""
        for prior in self.priors:
            if not isinstance(prior, InitialPose):
                continue
            T = prior.pose
            for number, at in enumerate(self.encounters, 1):
                off = T.apply(at.x_mov) - at.x_ref
                lever = rotation(T.theta + pi / 2) @ (at.x_mov - prior.about)
                spread = at.covariance + np.diag(prior.sigmas[:2] ** 2)
                spread += np.outer(lever, lever) * prior.sigma_yaw**2
                apart = sqrt(float(off @ np.linalg.solve(spread, off)))
                if apart > TOO_FAR:
                    raise SettingError(
                        f"the initial pose puts robot 2 {hypot(*off.tolist()):.1f} m from where "
                        f"{name_of(number, self.observations)} saw it, which is {apart:.0f} standard "
                        "deviations of both; correct one of them, or leave it out"
                    )
            for other in self.priors:
                if isinstance(other, TurnPrior):
                    turn = abs(wrap_angle(other.yaw - T.theta))
                    if turn > TOO_FAR * hypot(other.sigma, prior.sigma_yaw):
                        raise SettingError(
                            f"the initial pose is turned by {degrees(turn):.0f}° from the rough turn; "
                            "correct one of them, or leave it out"
                        )

    def _places(self) -> Iterator[tuple[str, str, float, float, GridMap]]:
        """What stands where, the key that says so, and the map it is in; metres."""
        for number, o in enumerate(self.observations, 1):
            name = name_of(number, self.observations)
            yield f"{name} puts robot 1", "observer.pose", o.observer.x, o.observer.y, self.ref
            yield f"{name} puts robot 2", "observed.pose", o.observed_x, o.observed_y, self.mov
        for prior in self.priors:
            if isinstance(prior, NearPlace):
                yield "near: a place lies", "near.map1", prior.ref_x, prior.ref_y, self.ref
                yield "near: a place lies", "near.map2", prior.mov_x, prior.mov_y, self.mov

    @cached_property
    def encounters(self) -> tuple[Encounter, ...]:
        """Where robot 2 was seen, in both maps; a place per sighting."""
        return encounters_of(self.observations, self.ref, self.mov)

    @cached_property
    def pivot(self) -> FloatArray:
        """(2,) where two answers are held against each other: where robot 2 was first seen; without a
        sighting the middle of map 2's walls; metres, mov frame.
        """
        return self.encounters[0].x_mov if self.encounters else self._middles[1]

    @cached_property
    def _middles(self) -> FloatArray:
        """(2, 2) of the walls of either map; metres, each in its own frame."""
        return np.array([_middle(self.ref), _middle(self.mov)])

    def window(self, config: WindowConfig, curved: bool = False) -> CoupledWindow:
        """All transforms that agree with what is known.

        curved : take vague sightings for the rings that they are; without it every sighting is an ellipse
        """
        seen, terms = list(self.encounters), list[WindowTerm](self.priors)
        if curved:
            rings = [is_curved(o, config.deviations) for o in self.observations]
            margin = max(config.margin, LEAST_MARGIN)
            terms += [
                SightedRing(o, margin, config.deviations)
                for o, ring in zip(self.observations, rings, strict=True)
                if ring
            ]
            seen = [at for at, ring in zip(self.encounters, rings, strict=True) if not ring]
        return coupled_window(seen, config, tuple(terms), None if seen else self._middles)

    def robots(self, size: float) -> Robots:
        """Where the robots stood; around them, within ``size`` metres, a map shows the robot and no wall."""
        return robots_of(self.encounters, size)


def _middle(grid: GridMap) -> FloatArray:
    """(2,) mean of the wall cells, of all cells where there is no wall; metres."""
    rows, cols = where(grid.occupied)
    middle = np.array([grid.width, grid.height]) / 2
    if len(rows):
        middle = np.array([cols.mean(), rows.mean()]) + 0.5
    return np.asarray(grid.origin.apply(middle * grid.resolution), dtype=np.float64)
