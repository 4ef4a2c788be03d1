"""A transform that a person has made: weighed like any other, and improved from where it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, radians
from typing import Any

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray, Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import Fusion, fuse
from algorithms.methods.merge_result import Answer, MergeResult, finish_merge
from algorithms.methods.spectra_answer import covariance_at, whole_maps_of
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import OPTIMISERS, augment_both, objective_of
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, Detail, ObservationDetail, RefineDetail, Step
from algorithms.observations.observation import (
    Encounter,
    Observation,
    check_standing,
    encounters_of,
    robots_of,
)
from algorithms.observations.search_window import CoupledWindow, WindowConfig, coupled_window
from algorithms.optimisation.likelihood_field import AgreementConfig
from algorithms.optimisation.objective import Lookup, Objective
from algorithms.optimisation.particle_swarm import settled_within
from algorithms.optimisation.search_box import SearchBox
from algorithms.optimisation.subcell_peak import climb_to_peak, peak_at
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import Weighed, better_beside, elsewhere, weigh
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps

BY_HAND = "by hand"
ELSEWHERE = 0.5, radians(3)  # metres, radians: from here on another answer is another one
UNSURE = np.diag([1.0, 1.0, radians(5)]) ** 2  # (3, 3) of a method without an objective; m², rad²


@dataclass(frozen=True, eq=False)
class ManualMerge:
    """Two maps and their sightings, on which any transform can be weighed.

    config : of a method of the table
    others : answers that a method has found; a hand-made one is held against those that lie elsewhere
    """

    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...]
    config: Any
    others: tuple[Weighed, ...] = ()

    def __reduce__(self) -> tuple[type[ManualMerge], tuple[Any, ...]]:
        """What travels to another process: nothing that was worked out here."""
        return ManualMerge, (self.ref, self.mov, self.observations, self.config, self.others)

    def __post_init__(self) -> None:
        if not self.observations:
            raise SettingError("there is no observation; give at least one")
        check_standing(self.observations, self.ref, self.mov)

    @cached_property
    def encounters(self) -> tuple[Encounter, ...]:
        """Where robot 2 was seen, in both maps."""
        return encounters_of(self.observations, self.ref, self.mov)

    @cached_property
    def objective(self) -> Objective | None:
        """What the method maximises; None for one that maximises nothing."""
        if not isinstance(self.config, PipelineConfig):
            return None
        augmented = augment_both(self.ref, self.mov, self.encounters[0], self.config.augment)
        return objective_of(self.ref, self.mov, self.encounters, augmented, self.config)

    def value(self, T_ref_mov: Pose2) -> float | None:
        """What the method's objective says of a transform."""
        return None if self.objective is None else float(self.objective(T_ref_mov.array()[None])[0])

    def weigh(self, T_ref_mov: Pose2, answers: tuple[Answer, ...] = (), seed: int = 0) -> MergeResult:
        """The result that a transform makes; its method is "by hand".

        raises : TooLargeError where the merged map would be over the bound
        """
        fusion = self.fused(T_ref_mov)
        return self._finish(T_ref_mov, fusion, answers, seed)

    def fused(self, T_ref_mov: Pose2) -> Fusion:
        """Both maps merged under a transform."""
        robots = robots_of(self.encounters, self.config.verdict.robot_size)
        return fuse((self.ref, self.mov), (Pose2(), T_ref_mov), self.config.conflict, robots)

    def _finish(self, T: Pose2, fusion: Fusion, answers: tuple[Answer, ...], seed: int) -> MergeResult:
        value, model = self.value(T), shipped_model()
        named = weigh(self.whole, T, model)
        rivals = elsewhere(self.whole, named, self.others, *ELSEWHERE)
        return finish_merge(
            named,
            (*better_beside(self.whole, named, model), *rivals),
            fusion,
            self.encounters,
            self._covariance(named),
            self.config.verdict,
            value=value,
            answers=answers or (Answer(T, -inf if value is None else value, BY_HAND),),
            method=BY_HAND,
            seed=seed,
        )

    @cached_property
    def whole(self) -> WholeMaps:
        """Both maps as a whole."""
        config = self.config
        if isinstance(config, PipelineConfig):
            return whole_maps_of(self.ref, self.mov, self.encounters, config)
        window, trust = coupled_window(self.encounters, WindowConfig()), AgreementConfig().evidence
        return make_whole_maps(self.ref, self.mov, self.encounters, window, trust, config.verdict.robot_size)

    def _covariance(self, named: Weighed) -> FloatArray:
        if self.objective is None:
            return np.asarray(UNSURE, dtype=np.float64)
        config, smooth = self.config, replace(self.objective, lookup=Lookup.BILINEAR)
        peak = peak_at(smooth, named.T_ref_mov, self.window.pivot, config.augment.spread)
        return covariance_at(named, self.objective, peak, self.window, self.encounters, config)

    @property
    def window(self) -> CoupledWindow:
        """The coupled window, but without an end: a person may know better than the sighting."""
        return replace(coupled_window(self.encounters, self.config.window), k=inf)

    def box(self, T_ref_mov: Pose2) -> SearchBox:
        """The optimiser's box around a transform, eqs. (18)–(20), not cut to any window."""
        margins = self.config.box
        half = np.array([margins.sigma_x, margins.sigma_y, radians(margins.sigma_theta)])
        pivot = self.encounters[0].x_mov
        centre = np.append(T_ref_mov.apply(pivot), T_ref_mov.theta)
        return SearchBox(centre - half, centre + half, pivot)


def known_answers(result: MergeResult | None) -> tuple[Weighed, ...]:
    """What a method has found, as the whole maps weigh it; () without a result, or for one made by hand."""
    return () if result is None or result.method == BY_HAND else result.weighed


def refine(scales: ManualMerge, T_ref_mov: Pose2, seed: int = 0) -> Iterator[Step]:
    """Yield the steps of the method's own optimiser in a box around a transform, then climb to the peak.

    The last step's detail is the MergeResult; its answer is worth no less than ``T_ref_mov``.

    raises : SettingError for a method without an objective
    """
    objective = scales.objective
    if objective is None:
        raise SettingError("this method maximises nothing; choose one that does, then refine")
    runner = StageRunner({})
    yield from runner.stage("observe", (), lambda: [ObservationDetail(scales.encounters)])
    found: AnswersDetail = yield from runner.stage(
        "refine", (), lambda: _search(scales, objective, T_ref_mov, seed)
    )
    best = found.answers[0].T_ref_mov
    fusion: Fusion = yield from runner.stage("fuse", (), lambda: [scales.fused(best)])
    yield from runner.stage(
        "verdict", (), lambda: [_timed(scales._finish(best, fusion, found.answers, seed), runner)]
    )


def _timed(result: MergeResult, runner: StageRunner) -> MergeResult:
    return replace(result, timings_s=runner.timings_s)


def _search(scales: ManualMerge, objective: Objective, T: Pose2, seed: int) -> Iterator[Detail]:
    config, box = scales.config, scales.box(T)
    rng = np.random.default_rng([seed, 2])

    def value(poses: FloatArray) -> FloatArray:
        return objective(box.transforms(poses))

    settled = settled_within(objective.cell)
    for state in OPTIMISERS[config.refine.optimiser](value, box, config.swarm, settled, rng):
        yield RefineDetail(0, 1, box, state)
    begun = Answer(T, float(objective(T.array()[None])[0]), BY_HAND)
    searched = Answer(box.transform(state.best), state.best_value, state.stopped or "")
    start = max(searched, begun, key=lambda answer: answer.value)
    smooth = replace(objective, lookup=Lookup.BILINEAR)
    peak = climb_to_peak(smooth, start.T_ref_mov, scales.window, config.augment.spread)
    polished = Answer(peak.T_ref_mov, float(objective(peak.T_ref_mov.array()[None])[0]), "polished")
    answers: Sequence[Answer] = sorted((polished, searched, begun), key=lambda answer: -answer.value)
    yield AnswersDetail(tuple(answers))
