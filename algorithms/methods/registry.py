"""Every way to merge two maps that mapmeld knows, in one table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.methods import refusal_causes
from algorithms.methods import spectra_method as pipeline
from algorithms.methods.baselines import bilateral
from algorithms.methods.baselines import carpin_spectra as smm_only
from algorithms.methods.baselines import feature_matching as features
from algorithms.methods.baselines import mse_registration as mse
from algorithms.methods.baselines import phase_correlation as phase
from algorithms.methods.baselines.distance_image import PictureConfig
from algorithms.methods.baselines.feature_detectors import (
    DetectorConfig,
    HarrisConfig,
    OrbConfig,
    ShiTomasiConfig,
    SiftConfig,
    SurfConfig,
)
from algorithms.methods.baselines.feature_matching import FeatureConfig
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.spectra_config import PipelineConfig, RefineConfig
from algorithms.methods.stage_runner import StageCache
from algorithms.methods.steps import CauseDetail, Step
from algorithms.observations.observation import Observation, as_observations, check_standing
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.branch_and_bound import ProofConfig
from algorithms.spectra.augmented_map import AugmentConfig
from algorithms.spectra.candidates import CandidateConfig
from algorithms.verdict.ranking import WINDOW_EDGE

Run = Callable[..., Iterator[Step]]

Family = Literal["ours", "paper", "rivals"]
"""Ours; the paper's own, and its parts; what the paper compares with, and what people would try today."""


@dataclass(frozen=True)
class Method:
    """A way to merge: ``run(ref, mov, observations, config, seed, memo, method)`` yields its steps.

    title    : what a person reads in a menu
    defaults : its frozen config; panel and flags are made from it
    family   : whose it is; methods of one family stand together in a menu
    uses_observation : whether the sighting helps it to its transform; the verdict weighs it in any case
    """

    run: Run
    title: str
    defaults: Any
    family: Family = "ours"
    uses_observation: bool = True


DEFAULT_METHOD = "spectra-proven"


def _features(title: str, detector: DetectorConfig, reach: float) -> Method:
    config = FeatureConfig(picture=PictureConfig(reach=reach), detector=detector)
    return Method(features.run, title, config, "rivals", False)


METHODS: dict[str, Method] = {
    "spectra-proven": Method(
        pipeline.run,
        "Spectra, swarm, proven optimum",
        PipelineConfig(
            augment=AugmentConfig(spread=4.0),
            window=WindowConfig(kind="coupled", deviations=WINDOW_EDGE),
            refine=RefineConfig(objective="agreement"),
            proof=ProofConfig(whole_circle=True),
            whole_maps=True,
        ),
    ),
    "spectra-swarm": Method(pipeline.run, "Spectra, all candidates, swarm", PipelineConfig()),
    "spectra-montecarlo": Method(
        pipeline.run,
        "Spectra, all candidates, Monte-Carlo",
        PipelineConfig(refine=RefineConfig(optimiser="mco")),
    ),
    "paper-argmax": Method(
        pipeline.run,
        "The paper's bare argmax",
        PipelineConfig(
            candidates=CandidateConfig(peaks=1, twins=False),
            window=WindowConfig(kind="origin"),
            refine=RefineConfig(candidates=1),
        ),
        "paper",
    ),
    "bilateral": Method(
        bilateral.run, "Bilateral, eqs. (2), (3) alone", bilateral.BilateralConfig(), "paper"
    ),
    "smm-window": Method(
        pipeline.run,
        "Spectra and window, no swarm",
        PipelineConfig(refine=RefineConfig(optimiser="none")),
        "paper",
    ),
    "smm-only": Method(smm_only.run, "Spectra alone (Carpin)", smm_only.CarpinConfig(), "rivals", False),
    "mse": Method(mse.run, "Least squared error (MSE)", mse.MseConfig(), "rivals", False),
    "harris": _features("Harris corners", HarrisConfig(), reach=1.0),
    "shi-tomasi": _features("Shi–Tomasi corners", ShiTomasiConfig(), reach=1.0),
    "surf": _features("SURF features", SurfConfig(), reach=0.4),
    "phase-correlation": Method(
        phase.run, "Phase correlation", phase.PhaseCorrelationConfig(), "rivals", False
    ),
    "sift": _features("SIFT features", SiftConfig(), reach=0.4),
    "orb": _features("ORB features", OrbConfig(), reach=1.0),
}


def run(
    name: str,
    ref: GridMap,
    mov: GridMap,
    observations: Observation | Sequence[Observation],
    config: Any = None,
    seed: int = 0,
    memo: StageCache | None = None,
) -> Iterator[Step]:
    """Yield the steps of one method of the table; the last one's detail is the MergeResult.

    name         : a key of METHODS
    ref, mov     : the observer's map, and that of the robot it saw
    observations : one sighting, or several between the makers of these two maps
    config       : the method's ``defaults``, or a changed copy of them
    seed         : of the random numbers; the same seed gives the same answer
    memo         : keep it between runs: stages before the first changed setting are then not run again
    raises       : SettingError, at once, where there is no such method or observation, or a robot stands far
                   off its own map; while it runs NoAnswerError where the method finds no transform at
                   all, and TooLargeError where the merged map would be
    """
    if name not in METHODS:
        raise SettingError(f"there is no method {name!r}; known are {', '.join(METHODS)}")
    seen = as_observations(observations)
    check_standing(seen, ref, mov)
    method = METHODS[name]
    return method.run(ref, mov, seen, method.defaults if config is None else config, seed, memo, name)


def run_explained(
    name: str,
    ref: GridMap,
    mov: GridMap,
    observations: Observation | Sequence[Observation],
    config: Any = None,
    seed: int = 0,
    memo: StageCache | None = None,
) -> Iterator[Step]:
    """``run``, and after a refusal the steps of ``find_cause``; the last one's detail is again the
    MergeResult, with a hint in its verdict where a cause was found.
    """
    last: Step | None = None
    for step in run(name, ref, mov, observations, config, seed, memo):
        last = step
        yield step
    if last is None or not isinstance(last.detail, MergeResult) or last.detail.verdict.accepted:
        return
    for step in find_cause(ref, mov, observations):
        if isinstance(step.detail, CauseDetail):
            yield Step(step.stage, last.detail.with_hint(step.detail.hint), step.seconds)
        else:
            yield step


def find_cause(
    ref: GridMap, mov: GridMap, observations: Observation | Sequence[Observation]
) -> Iterator[Step]:
    """Yield a step for every simple change to map 2 under which two maps may agree that were refused; the
    last one's detail is a CauseDetail.
    """
    began = perf_counter()
    default = METHODS[DEFAULT_METHOD].defaults
    for detail in refusal_causes.find_cause(ref, mov, as_observations(observations), default):
        yield Step("explain", detail, perf_counter() - began)
        began = perf_counter()


def merge(
    ref: GridMap,
    mov: GridMap,
    observations: Observation | Sequence[Observation],
    method: str = DEFAULT_METHOD,
    config: Any = None,
    seed: int = 0,
) -> MergeResult:
    """The end of ``run``: the transform, the merged map and the verdict on it.

    A refused merge has a transform and a map as well: ask ``verdict.accepted``. Arguments and errors are
    those of ``run``.
    """
    *_, last = run(method, ref, mov, observations, config, seed)
    assert isinstance(last.detail, MergeResult)
    return last.detail
