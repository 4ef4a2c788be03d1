"""Spectra-based map merging as Carpin published it (2008): no observation, the best acceptance index.

The shift's spectra are taken along the walls of map 1, not along its axes: of 28 pairs of real maps and 16
simulated ones 13 and 4 then come out right, in place of 13 and 0. Where the maps share a part only, the
highest peak of the spectra is often that of another shift; more peaks of the turn (8 in place of 4) and other
least overlaps (5 to 30 %) change nothing.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.grid_map import UNKNOWN, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.methods.baselines.base import BaselineConfig, weigh_best
from algorithms.methods.merge_result import Answer
from algorithms.methods.shared_stages import Found
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, HoughDetail, ShiftDetail, Step
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.search_window import Window
from algorithms.spectra.augmented_map import AugmentedMap
from algorithms.spectra.candidates import CandidateConfig, match_turns, shift_candidates
from algorithms.spectra.hough_spectra import SpectraConfig


@dataclass(frozen=True)
class RankConfig(CheckedConfig):
    """Which of the candidates wins."""

    overlap: Annotated[float, Bounds(0, 1, 0.01, "", "", "least overlap")] = 0.1
    """Share of the smaller map's known cells that both maps must know. Without it a candidate whose maps
    share a few cells of floor wins: they agree on all of it."""


@dataclass(frozen=True, kw_only=True)
class CarpinConfig(BaselineConfig):
    """Settings of spectra-based map merging alone."""

    spectra: SpectraConfig = field(default_factory=SpectraConfig)
    candidates: CandidateConfig = field(default_factory=CandidateConfig)
    rank: RankConfig = field(default_factory=RankConfig)


def search(
    problem: PairProblem, config: CarpinConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps of Carpin's merge.

    raises : NoAnswerError where a map has no walls
    """
    for grid in (problem.ref, problem.mov):
        if len(grid.points) == 0:
            raise NoAnswerError(f"{grid.name} has no walls, and a spectrum is made of walls")
    walls = plain(problem.ref), plain(problem.mov)
    hough: HoughDetail = yield from runner.stage(
        "spectra",
        (problem, config.spectra, config.candidates),
        lambda: [HoughDetail(match_turns(*walls, config.spectra, config.candidates))],
    )
    found: AnswersDetail = yield from runner.stage(
        "search", (hough, config.rank), lambda: _search(*walls, hough, config.rank)
    )
    step = max(problem.ref.resolution, problem.mov.resolution)
    # it says nothing of how sure it is: this is the raster it looks on
    covariance = np.diag([step, step, np.pi / config.spectra.directions]) ** 2
    return (yield from weigh_best(problem, config, runner, found, covariance))


def plain(grid: GridMap) -> AugmentedMap:
    """The map with nothing lifted: every wall counts as much as every other, wherever a robot was seen."""
    rows, cols = np.nonzero(grid.occupied)
    points = grid.points
    return AugmentedMap(grid, points, rows, cols, np.ones(len(points)), points.mean(axis=0), 1.0)


def everywhere(ref: FloatArray, mov: FloatArray) -> Window:
    """The window that shuts nothing out: wherever the walls of the two maps can touch.

    ref, mov : (N, 2), (M, 2) walls; metres, each in its own map's frame
    """
    pivot = mov.mean(axis=0)
    reach = float(np.linalg.norm(mov - pivot, axis=1).max())
    return Window(ref.min(axis=0) - reach, ref.max(axis=0) + reach, pivot)


def _search(
    ref_walls: AugmentedMap, mov_walls: AugmentedMap, hough: HoughDetail, config: RankConfig
) -> Iterator[Detail]:
    """A shift per turn, and the turn whose maps then agree best.

    The spectra are taken along the walls: a wall that runs askew to the axes leaves no peak in them.
    """
    match = hough.match
    along = Pose2(theta=float(match.angles[np.argmax(match.ref)]))
    ref_walls = replace(ref_walls, points=along.inverse().apply(ref_walls.points))
    match = replace(match, turns=tuple(turn - along.theta for turn in match.turns))
    window = everywhere(ref_walls.points, mov_walls.points)
    answers = []
    for index, candidate in enumerate(shift_candidates(ref_walls, mov_walls, match, window)):
        candidate = replace(candidate, T_ref_mov=along @ candidate.T_ref_mov)
        yield ShiftDetail(index, len(match.turns), candidate)
        merged = fuse((ref_walls.grid, mov_walls.grid), (Pose2(), candidate.T_ref_mov))
        known = min(int(np.count_nonzero(cells != UNKNOWN)) for cells in merged.layers)
        enough = merged.overlap >= config.overlap * known
        value = merged.acceptance_index if enough else 0.0
        answers.append(Answer(candidate.T_ref_mov, value, f"acceptance index {value:.1%}"))
    answers.sort(key=lambda answer: -answer.value)
    yield AnswersDetail(tuple(answers))
