"""Why a merge was refused, where the cause is simple: a map read wrongly, mirrored, or of another scale.

Each simple change is made to map 2, and the method that suits is asked whether the maps agree then: near a
sighting the default one, without one the search over the plane. It is named only where the verdict accepts
the changed maps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import ceil, sqrt
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.maps.coarse_grid import pooled
from algorithms.maps.grid_map import GridMap, remarks_on
from algorithms.methods import plane_method, spectra_method
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.plane_method import PlaneMethodConfig
from algorithms.methods.shared_stages import Search, run_search
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.steps import CauseDetail, TriedDetail
from algorithms.observations import observation
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import PairProblem
from algorithms.optimisation.particle_swarm import SwarmConfig
from algorithms.verdict.decision import Verdict

SCALES = (0.5, 2.0, 0.8, 1.25, 0.4, 2.5)  # between cells of 0.02, 0.025, 0.04, 0.05 and 0.1 m
PATIENCE = 2  # of the proof, in 10⁵ nodes: how long each change is tried
MOST_CELLS = 2_000_000  # of a map; a larger one is tried in coarser cells
FEW_PLACES, FEW_ANSWERS = 30, 3  # of the search over the plane
SURE = 0.9  # how likely it is at least: of seven changes that are tried on the whole plane one fits by chance
NO_SWARM = SwarmConfig(particles=10, iterations=1)  # what it finds has no influence on a proven answer


@dataclass(frozen=True)
class Cause:
    """One thing that may have been wrong with map 2.

    clause : how it is named, as in "mirrored, map 2 agrees"
    cure   : what to do
    grid   : makes right of the map
    seen   : of what robot 2 knows of itself
    """

    clause: str
    cure: str
    grid: Callable[[GridMap], GridMap]
    seen: Callable[[Observation], Observation] = lambda o: o


def _flipped(axis: int) -> Callable[[GridMap], GridMap]:
    """The image alone is turned over; its corner and the robots stay where they are."""
    return lambda grid: replace(grid, cells=np.ascontiguousarray(np.flip(grid.cells, axis)))


def _scaled(factor: float) -> Callable[[GridMap], GridMap]:
    """Cells of another size; the map's corner stays where it is."""
    return lambda grid: replace(grid, resolution=grid.resolution * factor)


def _scaled_frame(factor: float) -> Callable[[GridMap], GridMap]:
    """The same, and the map's corner is scaled, too."""

    def change(grid: GridMap) -> GridMap:
        origin = Pose2(grid.origin.x * factor, grid.origin.y * factor, grid.origin.theta)
        return replace(grid, resolution=grid.resolution * factor, origin=origin)

    return change


def _scaled_place(factor: float) -> Callable[[Observation], Observation]:
    """Where robot 2 stood, scaled."""
    return lambda o: replace(o, observed_x=o.observed_x * factor, observed_y=o.observed_y * factor)


def _causes(mov: GridMap) -> list[list[Cause]]:
    """Simple changes. Those of one list differ little: the likeliest of them is told. Without a sighting
    they do not differ at all.
    """
    over = "turn its image over in a picture editor, or save the map anew"
    mirrored = [
        Cause(
            "mirrored, map 2 agrees",
            "is its lidar mounted upside down, or was its image flipped? Put that right, and merge again",
            lambda grid: grid.mirrored(),
            observation.mirrored,
        ),
        Cause("with its image flipped left to right, map 2 agrees", over, _flipped(1)),
        Cause("with its image flipped top to bottom, map 2 agrees", over, _flipped(0)),
    ]
    causes = [mirrored]
    for factor in SCALES:
        cell = f"{mov.resolution * factor:.3g}"
        clause = f"with cells of {cell} m in place of {mov.resolution:.3g} m, map 2 agrees"
        cure = f"set resolution: {cell} in its YAML file"
        more = f"{cure}, and multiply its origin and where robot 2 stood by {factor:g}"
        causes.append(
            [
                Cause(clause, cure, _scaled(factor)),
                Cause(clause, more, _scaled_frame(factor), _scaled_place(factor)),
            ]
        )
    return causes


def find_cause(
    problem: PairProblem, near: PipelineConfig, wide: PlaneMethodConfig
) -> Iterator[TriedDetail | CauseDetail]:
    """Yield what is being tried, and at the end the cause, if one was found.

    near, wide : of the method near a sighting, and of the one without
    """
    remarks = " ".join(remarks_on((problem.ref, problem.mov)))
    causes = _causes(problem.mov)
    if not problem.observations:
        causes = [alike[:1] for alike in causes]
    ref, mov = (pooled(grid, ceil(sqrt(grid.cells.size / MOST_CELLS))) for grid in (problem.ref, problem.mov))
    coarse = replace(problem, ref=ref, mov=mov)
    total, number = sum(map(len, causes)), 0
    for alike in causes:
        agreeing: list[tuple[Verdict, Cause]] = []
        for cause in alike:
            yield TriedDetail(cause.clause, number, total)
            number += 1
            found = _try(coarse, cause, near, wide)
            least = 0.0 if problem.observations else SURE
            if found is not None and found.verdict.accepted and found.verdict.probability >= least:
                agreeing.append((found.verdict, cause))
        if agreeing:
            verdict, cause = max(agreeing, key=lambda each: each[0].probability)
            clause = cause.clause[:1].upper() + cause.clause[1:]
            share, wall = 1 - verdict.contradiction, verdict.shared_wall
            yield CauseDetail(f"{clause} on {share:.0%} of {wall:.0f} m of wall: {cause.cure}.")
            return
    yield CauseDetail(f"How the maps were read may be the cause. {remarks}" if remarks else "")


def _try(
    problem: PairProblem, cause: Cause, near: PipelineConfig, wide: PlaneMethodConfig
) -> MergeResult | None:
    """What the method makes of the maps after a change; None where that cannot be."""
    quick: Any = replace(near, swarm=NO_SWARM, proof=replace(near.proof, patience=PATIENCE))
    search: Search = spectra_method.search
    if not problem.observations:
        quick, search = replace(wide, places=FEW_PLACES, answers=FEW_ANSWERS), plane_method.search
    try:
        seen = tuple(map(cause.seen, problem.observations))
        right = PairProblem(problem.ref, cause.grid(problem.mov), seen)  # a prior may be wrong
        *_, last = run_search(search, right, quick)
    except MapMergeError:  # a robot off its map, or cells too fine: this was not the cause
        return None
    assert isinstance(last.detail, MergeResult)
    return last.detail
