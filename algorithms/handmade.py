"""A transform that a person has made: weighed like any other, and improved from where it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from math import degrees, hypot, inf, radians
from typing import Any

import numpy as np

from algorithms.agreement import AgreementConfig, make_agreement
from algorithms.augment import AugmentConfig
from algorithms.chain import Chain
from algorithms.conclude import conclude
from algorithms.errors import SettingError
from algorithms.evidence import Evidence
from algorithms.fuse import Fusion, fuse
from algorithms.gridmap import GridMap
from algorithms.objective import Lookup, Objective
from algorithms.observation import Encounter, Observation, check_standing, encounter
from algorithms.pipeline import (
    OPTIMISERS,
    RIVAL_FLOOR,
    PipelineConfig,
    augment_both,
    covariance_at,
    objective_of,
)
from algorithms.polish import peak_at, polish
from algorithms.pose import FloatArray, Pose2, pose_error
from algorithms.steps import (
    Answer,
    AnswersDetail,
    Detail,
    MergeResult,
    ObservationDetail,
    RefineDetail,
    Step,
)
from algorithms.swarm import settled_within
from algorithms.window import Box, CoupledWindow, coupled_window

BY_HAND = "by hand"
ELSEWHERE = 0.5, radians(3)  # metres, radians: from here on another answer is another one
AS_GOOD = 0.8  # of the best value nearby; less is not the top of the hill: some 5 cm or 1° off it
FAR_BETTER = 100.0  # share of a rival of what is worth nothing, or next to nothing
UNSURE = np.diag([1.0, 1.0, radians(5)]) ** 2  # (3, 3) of a method without an objective; m², rad²


def _nearby() -> FloatArray:
    """(N, 3) steps in x, y, theta to the surroundings of a place, the place itself first; m, rad."""
    wide, fine = np.arange(-4, 5) * 0.15, np.arange(-2, 3) * 0.05
    steps = [(0.0, 0.0, 0.0)]
    steps += product(wide.tolist(), wide.tolist(), np.radians([-4, -2, 0, 2, 4]).tolist())
    steps += product(fine.tolist(), fine.tolist(), np.radians([-1, 0, 1]).tolist())
    return np.array(steps)


NEARBY = _nearby()


@dataclass(frozen=True, eq=False)
class Scales:
    """Two maps and their sightings, on which any transform can be weighed.

    config : of a method of the table
    others : answers that a method has found, with their values, best first; a hand-made one is held
             against those that lie elsewhere
    """

    ref: GridMap
    mov: GridMap
    observations: tuple[Observation, ...]
    config: Any
    others: tuple[tuple[Pose2, float], ...] = ()

    def __post_init__(self) -> None:
        if not self.observations:
            raise SettingError("there is no observation; give at least one")
        check_standing(self.observations, self.ref, self.mov)

    @cached_property
    def encounters(self) -> tuple[Encounter, ...]:
        """Where robot 2 was seen, in both maps."""
        return tuple(encounter(observation) for observation in self.observations)

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
        fusion = fuse(self.ref, self.mov, T_ref_mov, self.config.conflict)
        return self._conclude(T_ref_mov, fusion, answers, seed)

    def _conclude(self, T: Pose2, fusion: Fusion, answers: tuple[Answer, ...], seed: int) -> MergeResult:
        value, config = self.value(T), self.config
        return conclude(
            self.ref,
            self.mov,
            T,
            fusion,
            self.encounters,
            lambda weighed: self._covariance(T, weighed),
            config.verdict,
            value=value,
            answers=answers or (Answer(T, -inf if value is None else value, BY_HAND),),
            method=BY_HAND,
            seed=seed,
            rivals=self._rivals(T, value),
            doubts=self._doubts(T),
            margin=config.window.margin if isinstance(config, PipelineConfig) else 0.0,
        )

    def _rivals(self, T: Pose2, value: float | None) -> list[tuple[Pose2, float]] | None:
        """The method's answers that lie elsewhere, with their share of this one's value."""
        if value is None or not self.others:
            return None
        told = []
        for other, worth in self.others:
            distance, turn = pose_error(T, other, self.encounters[0].x_mov)
            share = min(worth / value, FAR_BETTER) if value > 0 else FAR_BETTER
            if (distance > ELSEWHERE[0] or turn > ELSEWHERE[1]) and worth > 0 and share > RIVAL_FLOOR:
                told.append((other, share))
        return told

    @cached_property
    def _yardstick(self) -> Objective:
        """What a place is held against its surroundings with, also for a method that maximises nothing."""
        if self.objective is not None:
            return self.objective
        return make_agreement(self.ref, self.mov, self.encounters, AugmentConfig(), AgreementConfig())

    def _doubts(self, T: Pose2) -> list[str]:
        """What speaks against a transform that no search has taken to the top of its hill.

        The verdict lets patches of bent maps slip by half a metre, so by itself it would take a right
        answer that is half a metre off for a right one.
        """
        at = np.append(T.apply(self.encounters[0].x_mov), T.theta)
        near = Box(at, at, self.encounters[0].x_mov).transforms(at + NEARBY)
        here, *values = self._yardstick(near).tolist()
        if here <= 0:
            return ["near the encounter more wall contradicts than agrees"]
        best = int(np.argmax(values)) + 1
        if here >= AS_GOOD * values[best - 1]:
            return []
        x, y, turn = NEARBY[best].tolist()
        return [
            f"the walls fit better {hypot(x, y):.2f} m and {abs(degrees(turn)):.0f}° from there: refine it"
        ]

    def _covariance(self, T: Pose2, weighed: Evidence) -> FloatArray:
        if self.objective is None:
            return np.asarray(UNSURE, dtype=np.float64)
        config, smooth = self.config, replace(self.objective, lookup=Lookup.BILINEAR)
        peak = peak_at(smooth, T, self.window.pivot, config.augment.spread)
        return covariance_at(T, self.objective, peak, self.box(T), self.encounters, weighed, config)

    @property
    def window(self) -> CoupledWindow:
        """The coupled window, but without an end: a person may know better than the sighting."""
        return replace(coupled_window(self.encounters, self.config.window), k=inf)

    def box(self, T_ref_mov: Pose2) -> Box:
        """The optimiser's box around a transform, eqs. (18)–(20), not cut to any window."""
        margins = self.config.box
        half = np.array([margins.sigma_x, margins.sigma_y, radians(margins.sigma_theta)])
        pivot = self.encounters[0].x_mov
        centre = np.append(T_ref_mov.apply(pivot), T_ref_mov.theta)
        return Box(centre - half, centre + half, pivot)


def known_answers(result: MergeResult | None) -> tuple[tuple[Pose2, float], ...]:
    """What a method has found with its value, best first; () for one without an objective."""
    if result is None or result.value is None:
        return ()
    best = (result.T_ref_mov, result.value)
    if result.proof is None:
        return tuple((answer.T_ref_mov, answer.value) for answer in result.answers)
    rivals = zip(result.proof.rivals, result.proof.rival_values.tolist(), strict=True)
    return (best, *((Pose2.from_array(pose), value) for pose, value in rivals))


def refine(scales: Scales, T_ref_mov: Pose2, seed: int = 0) -> Iterator[Step]:
    """Yield the steps of the method's own optimiser in a box around a transform, then of a polish.

    The last step's detail is the MergeResult; its answer is worth no less than ``T_ref_mov``.

    raises : SettingError for a method without an objective
    """
    objective, config = scales.objective, scales.config
    if objective is None:
        raise SettingError("this method maximises nothing; choose one that does, then refine")
    chain = Chain({})
    yield from chain.stage("observe", (), lambda: [ObservationDetail(scales.encounters)])
    found: AnswersDetail = yield from chain.stage(
        "refine", (), lambda: _search(scales, objective, T_ref_mov, seed)
    )
    best = found.answers[0].T_ref_mov
    fusion: Fusion = yield from chain.stage(
        "fuse", (), lambda: [fuse(scales.ref, scales.mov, best, config.conflict)]
    )
    yield from chain.stage(
        "verdict", (), lambda: [_timed(scales._conclude(best, fusion, found.answers, seed), chain)]
    )


def _timed(result: MergeResult, chain: Chain) -> MergeResult:
    return replace(result, timings_s=chain.timings_s)


def _search(scales: Scales, objective: Objective, T: Pose2, seed: int) -> Iterator[Detail]:
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
    peak = polish(smooth, start.T_ref_mov, scales.window, config.augment.spread)
    polished = Answer(peak.T_ref_mov, float(objective(peak.T_ref_mov.array()[None])[0]), "polished")
    answers: Sequence[Answer] = sorted((polished, searched, begun), key=lambda answer: -answer.value)
    yield AnswersDetail(tuple(answers))
