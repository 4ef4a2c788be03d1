"""A transform that a person has made: weighed like any other, and improved from where it is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, radians
from typing import Any

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.map_fusion import Fusion
from algorithms.methods import plane_method
from algorithms.methods.baselines.base import model_kind, whole_maps
from algorithms.methods.merge_result import BY_HAND, Answer, MergeResult
from algorithms.methods.plane_method import PlaneMethodConfig
from algorithms.methods.shared_stages import Found, finish_merge, fuse_pair
from algorithms.methods.spectra_answer import covariance_at, whole_maps_of
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import OPTIMISERS, augment_both, objective_of
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, ObservationDetail, RefineDetail, Step
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import Lookup, Objective
from algorithms.optimisation.particle_swarm import settled_within
from algorithms.optimisation.plane_correlation import searched_area
from algorithms.optimisation.search_box import SearchBox, pose_about
from algorithms.optimisation.subcell_peak import climb_to_peak, peak_at
from algorithms.verdict.probability_model import ModelKind, shipped_model
from algorithms.verdict.ranking import Weighed, better_beside, elsewhere, weigh
from algorithms.verdict.whole_maps import WholeMaps

ELSEWHERE = 0.5, radians(3)  # metres, radians: from here on another answer is another one
UNSURE = np.diag([1.0, 1.0, radians(5)]) ** 2  # (3, 3) of a method without an objective; m², rad²


@dataclass(frozen=True, eq=False)
class ManualMerge:
    """A problem on which any transform can be weighed.

    config : of a method of the table
    others : answers that a method has found; a hand-made one is held against those that lie elsewhere
    """

    problem: PairProblem
    config: Any
    others: tuple[Weighed, ...] = ()

    def __reduce__(self) -> tuple[type[ManualMerge], tuple[Any, ...]]:
        """What travels to another process: nothing that was worked out here."""
        return ManualMerge, (self.problem, self.config, self.others)

    @cached_property
    def objective(self) -> Objective | None:
        """What the method maximises; None for one that maximises nothing."""
        if isinstance(self.config, PlaneMethodConfig):
            return self.whole.crisp
        if not isinstance(self.config, PipelineConfig):
            return None
        return objective_of(self.problem, augment_both(self.problem, self.config.augment), self.config)

    def value(self, T_ref_mov: Pose2) -> float | None:
        """What the method's objective says of a transform."""
        return None if self.objective is None else self.objective.value_at(T_ref_mov)

    def weigh(self, T_ref_mov: Pose2, seed: int = 0, method: str = BY_HAND) -> MergeResult:
        """The result that a transform makes, by what a person did: BY_HAND or CHOSEN.

        raises : TooLargeError where the merged map would be over the bound
        """
        fusion = fuse_pair(self.problem, T_ref_mov, self.config)
        return self.finish(T_ref_mov, fusion, (), seed, {}, method)

    def finish(
        self,
        T: Pose2,
        fusion: Fusion,
        answers: tuple[Answer, ...],
        seed: int,
        timings_s: Mapping[str, float],
        method: str = BY_HAND,
    ) -> MergeResult:
        """The same of a transform under which the maps are merged already."""
        value, model = self.value(T), shipped_model(self.kind)
        named = weigh(self.whole, T, model)
        rivals = elsewhere(self.whole, named, self.others, *ELSEWHERE)
        answers = answers or (Answer(T, -inf if value is None else value, BY_HAND),)
        others = (*better_beside(self.whole, named, model), *rivals)
        found = Found(named, others, self.covariance(named), answers, value, kind=self.kind)
        return finish_merge(self.problem, found, fusion, self.config, method, seed, timings_s)

    @cached_property
    def whole(self) -> WholeMaps:
        problem, config = self.problem, self.config
        if isinstance(config, PipelineConfig):
            return whole_maps_of(problem, config)
        if isinstance(config, PlaneMethodConfig):
            window = problem.window(config.window, curved=True)
            searched = searched_area(problem.ref, problem.mov, config.plane, window)
            return plane_method.whole_maps_of(problem, searched, config)
        return whole_maps(problem, config.verdict.robot_size)

    @property
    def kind(self) -> ModelKind:
        """Of the model that weighs: a transform may come from anywhere where nothing is known near it."""
        return "plane" if isinstance(self.config, PlaneMethodConfig) else model_kind(self.problem)

    def covariance(self, named: Weighed) -> FloatArray:
        """(3, 3) of x, y, theta of an answer; metres and radians."""
        if isinstance(self.config, PlaneMethodConfig):
            return plane_method.covariance_at(self.whole, named, self.problem.pivot, self.config)
        if self.objective is None:
            return np.asarray(UNSURE, dtype=np.float64)
        config, smooth = self.config, replace(self.objective, lookup=Lookup.BILINEAR)
        peak = peak_at(smooth, named.T_ref_mov, self.window.pivot, config.augment.spread)
        return covariance_at(named, self.objective, peak, self.window, self.problem, config)

    @property
    def window(self) -> CoupledWindow:
        """The coupled window, but without an end: a person may know better than the sighting."""
        return replace(self.problem.window(self.config.window), k=inf)

    def box(self, T_ref_mov: Pose2) -> SearchBox:
        """The optimiser's box around a transform, eqs. (18)–(20), not cut to any window."""
        margins = self.config.box
        half = np.array([margins.sigma_x, margins.sigma_y, radians(margins.sigma_theta)])
        pivot = self.problem.pivot
        centre = pose_about(pivot, T_ref_mov)
        return SearchBox(centre - half, centre + half, pivot)


def known_answers(result: MergeResult | None) -> tuple[Weighed, ...]:
    """What a method has found, as the whole maps weigh it; () without a result, or for a person's."""
    return () if result is None or result.by_person else result.weighed


def refine(manual: ManualMerge, T_ref_mov: Pose2, seed: int = 0) -> Iterator[Step]:
    """Yield the steps of the method's own optimiser in a box around a transform, then climb to the peak;
    of the search over the plane of the climb alone.

    The last step's detail is the MergeResult; its answer is worth no less than ``T_ref_mov``.

    raises : SettingError for a method without an objective
    """
    objective, runner = manual.objective, StageRunner({})
    if objective is None:
        raise SettingError("this method maximises nothing; choose one that does, then refine")
    yield from runner.stage("observe", (), lambda: [ObservationDetail(manual.problem.encounters)])
    climbs = isinstance(manual.config, PlaneMethodConfig)
    found: AnswersDetail = yield from runner.stage(
        "climb" if climbs else "refine",
        (),
        lambda: _climb(manual, T_ref_mov) if climbs else _search(manual, objective, T_ref_mov, seed),
    )
    best = found.answers[0].T_ref_mov
    fusion: Fusion = yield from runner.stage(
        "fuse", (), lambda: [fuse_pair(manual.problem, best, manual.config)]
    )
    yield from runner.stage(
        "verdict", (), lambda: [manual.finish(best, fusion, found.answers, seed, runner.timings_s)]
    )


def _climb(manual: ManualMerge, T: Pose2) -> Iterator[Detail]:
    """To the top of the hill that a transform lies on, as the whole maps see it."""
    value = manual.whole.crisp.value_at
    begun, top = Answer(T, value(T), BY_HAND), manual.whole.climb(T)
    climbed = Answer(top, value(top), "climbed to the top")
    yield AnswersDetail(tuple(sorted((climbed, begun), key=lambda answer: -answer.value)))


def _search(manual: ManualMerge, objective: Objective, T: Pose2, seed: int) -> Iterator[Detail]:
    config, box = manual.config, manual.box(T)
    rng = np.random.default_rng([seed, 2])

    def value(poses: FloatArray) -> FloatArray:
        return objective(box.transforms(poses))

    settled = settled_within(objective.cell)
    for state in OPTIMISERS[config.refine.optimiser](value, box, config.swarm, settled, rng):
        yield RefineDetail(0, 1, box, state)
    begun = Answer(T, objective.value_at(T), BY_HAND)
    searched = Answer(box.transform(state.best), state.best_value, state.stopped or "")
    start = max(searched, begun, key=lambda answer: answer.value)
    smooth = replace(objective, lookup=Lookup.BILINEAR)
    peak = climb_to_peak(smooth, start.T_ref_mov, manual.window, config.augment.spread)
    polished = Answer(peak.T_ref_mov, objective.value_at(peak.T_ref_mov), "polished")
    answers: Sequence[Answer] = sorted((polished, searched, begun), key=lambda answer: -answer.value)
    yield AnswersDetail(tuple(answers))
