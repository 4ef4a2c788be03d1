"""Every way to merge two maps that mapmeld knows, in one table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import GridMap
from algorithms.methods import plane_method, refusal_causes, spectra_method
from algorithms.methods.baselines import (
    bilateral,
    carpin_spectra,
    feature_matching,
    mse_registration,
    phase_correlation,
)
from algorithms.methods.baselines.base import BaselineConfig
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
from algorithms.methods.shared_stages import Search, run_search
from algorithms.methods.spectra_config import PipelineConfig, RefineConfig
from algorithms.methods.stage_runner import StageCache
from algorithms.methods.steps import CauseDetail, Step
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.branch_and_bound import ProofConfig
from algorithms.spectra.augmented_map import AugmentConfig
from algorithms.spectra.candidates import CandidateConfig
from algorithms.verdict.decision import VerdictConfig
from algorithms.verdict.probability_model import shipped_model
from algorithms.verdict.ranking import WINDOW_EDGE

Family = Literal["ours", "paper", "rivals"]
"""Ours; the paper's own, and its parts; what the paper compares with, and what people would try today."""


@dataclass(frozen=True)
class Method:
    """A way to merge.

    search   : yields its own steps, and returns what it has found; ``run_search`` does the rest
    title    : what a person reads in a menu
    defaults : its frozen config; panel and flags are made from it
    family   : whose it is; methods of one family stand together in a menu
    uses_observation : whether a sighting helps it to its transform; the verdict weighs it in any case
    needs_sighting : whether it cannot do without one
    """

    search: Search
    title: str
    defaults: Any
    family: Family = "ours"
    uses_observation: bool = True
    needs_sighting: bool = True


DEFAULT_METHOD = "spectra-proven"
PLANE_METHOD = "whole-plane"
SHARP = 3.0  # metres; a wider window is searched faster over the plane than block by block


def _features(title: str, detector: DetectorConfig, reach: float) -> Method:
    config = FeatureConfig(picture=PictureConfig(reach=reach), detector=detector)
    return Method(feature_matching.search, title, config, "rivals", False, False)


METHODS: dict[str, Method] = {
    "spectra-proven": Method(
        spectra_method.search,
        "Spectra, swarm, proven optimum",
        PipelineConfig(
            augment=AugmentConfig(spread=4.0),
            window=WindowConfig(kind="coupled", deviations=WINDOW_EDGE),
            refine=RefineConfig(objective="agreement"),
            proof=ProofConfig(whole_circle=True),
            whole_maps=True,
        ),
    ),
    PLANE_METHOD: Method(
        plane_method.search,
        "Whole plane, any knowledge",
        plane_method.PlaneMethodConfig(verdict=VerdictConfig(accept_from=shipped_model("plane").accept_from)),
        needs_sighting=False,
    ),
    "spectra-swarm": Method(spectra_method.search, "Spectra, all candidates, swarm", PipelineConfig()),
    "spectra-montecarlo": Method(
        spectra_method.search,
        "Spectra, all candidates, Monte-Carlo",
        PipelineConfig(refine=RefineConfig(optimiser="mco")),
    ),
    "paper-argmax": Method(
        spectra_method.search,
        "The paper's bare argmax",
        PipelineConfig(
            candidates=CandidateConfig(peaks=1, twins=False),
            window=WindowConfig(kind="origin"),
            refine=RefineConfig(candidates=1),
        ),
        "paper",
    ),
    "bilateral": Method(bilateral.search, "Bilateral, eqs. (2), (3) alone", BaselineConfig(), "paper"),
    "smm-window": Method(
        spectra_method.search,
        "Spectra and window, no swarm",
        PipelineConfig(refine=RefineConfig(optimiser="none")),
        "paper",
    ),
    "smm-only": Method(
        carpin_spectra.search,
        "Spectra alone (Carpin)",
        carpin_spectra.CarpinConfig(),
        "rivals",
        False,
        False,
    ),
    "mse": Method(
        mse_registration.search,
        "Least squared error (MSE)",
        mse_registration.MseConfig(),
        "rivals",
        False,
        False,
    ),
    "harris": _features("Harris corners", HarrisConfig(), reach=1.0),
    "shi-tomasi": _features("Shi–Tomasi corners", ShiTomasiConfig(), reach=1.0),
    "surf": _features("SURF features", SurfConfig(), reach=0.4),
    "phase-correlation": Method(
        phase_correlation.search,
        "Phase correlation",
        phase_correlation.PhaseCorrelationConfig(),
        "rivals",
        False,
        False,
    ),
    "sift": _features("SIFT features", SiftConfig(), reach=0.4),
    "orb": _features("ORB features", OrbConfig(), reach=1.0),
}


def default_method(problem: PairProblem, among: Sequence[str] = (DEFAULT_METHOD, PLANE_METHOD)) -> str:
    """The method that suits what is known: near a sighting that is sharp enough the proven one, else the one
    that searches the plane; where it is not among those to choose from, the first of them.
    """
    sharp = problem.observations and problem.window(WindowConfig()).disc <= SHARP
    suits = DEFAULT_METHOD if sharp else PLANE_METHOD
    return suits if suits in among else among[0]


def method_of(config: Any) -> str:
    """The first method of the table with settings of this kind; raises SettingError where there is none."""
    for name, method in METHODS.items():
        if type(method.defaults) is type(config):
            return name
    raise SettingError(f"no method has settings of the kind {type(config).__name__}; give those of METHODS")


def run(
    name: str | None,
    ref: GridMap,
    mov: GridMap,
    known: Known | Sequence[Known] = (),
    config: Any = None,
    seed: int = 0,
    memo: StageCache | None = None,
) -> Iterator[Step]:
    """Yield the steps of one method of the table; the last one's detail is the MergeResult.

    name     : a key of METHODS; None: ``default_method``, or with a config ``method_of`` that
    ref, mov : the observer's map, and that of the robot it saw; without a sighting, any two
    known    : sightings between the makers of these two maps, initial poses, rough turns, near places: one,
               several or none
    config   : the method's ``defaults``, or a changed copy of them
    seed     : of the random numbers; the same seed gives the same answer
    memo     : keep it between runs: stages before the first changed setting are then not run again
    raises   : SettingError, at once, where there is no such method, where it needs a sighting and there is
               none, where a robot stands far off its own map, or where what is known contradicts itself;
               while it runs NoAnswerError where the method finds no transform at all, and TooLargeError
               where the merged map would be
    """
    if name is not None and name not in METHODS:
        raise SettingError(f"there is no method {name!r}; known are {', '.join(METHODS)}")
    problem = PairProblem.of(ref, mov, known)
    if name is None:
        name = default_method(problem) if config is None else method_of(config)
    method = METHODS[name]
    if method.needs_sighting and not problem.observations:
        raise SettingError(
            f"the method {name} needs an observation; give at least one, or choose {PLANE_METHOD}"
        )
    return run_search(method.search, problem, method.defaults if config is None else config, seed, memo, name)


def run_explained(
    name: str | None,
    ref: GridMap,
    mov: GridMap,
    known: Known | Sequence[Known] = (),
    config: Any = None,
    seed: int = 0,
    memo: StageCache | None = None,
) -> Iterator[Step]:
    """``run``, and after a refusal the steps of ``find_cause``; the last one's detail is again the
    MergeResult, with a hint in its verdict where a cause was found.
    """
    last: Step | None = None
    for step in run(name, ref, mov, known, config, seed, memo):
        last = step
        yield step
    if last is None or not isinstance(last.detail, MergeResult) or last.detail.verdict.accepted:
        return
    for step in find_cause(ref, mov, known):
        if isinstance(step.detail, CauseDetail):
            yield Step(step.stage, last.detail.with_hint(step.detail.hint), step.seconds)
        else:
            yield step


def find_cause(ref: GridMap, mov: GridMap, known: Known | Sequence[Known] = ()) -> Iterator[Step]:
    """Yield a step for every simple change to map 2 under which two maps may agree that were refused; the
    last one's detail is a CauseDetail.
    """
    began = perf_counter()
    near, wide = (METHODS[name].defaults for name in (DEFAULT_METHOD, PLANE_METHOD))
    for detail in refusal_causes.find_cause(PairProblem.of(ref, mov, known), near, wide):
        yield Step("explain", detail, perf_counter() - began)
        began = perf_counter()


def merge(
    ref: GridMap,
    mov: GridMap,
    known: Known | Sequence[Known] = (),
    method: str | None = None,
    config: Any = None,
    seed: int = 0,
) -> MergeResult:
    """The end of ``run``: the transform, the merged map and the verdict on it.

    A refused merge has a transform and a map as well: ask ``verdict.accepted``. Arguments and errors are
    those of ``run``.
    """
    *_, last = run(method, ref, mov, known, config, seed)
    assert isinstance(last.detail, MergeResult)
    return last.detail
