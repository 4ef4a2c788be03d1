"""Any knowledge or none: every turn and shift that it leaves, by correlation over the plane; then the best
places are climbed and held against the whole maps.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from math import pi, radians
from typing import Annotated

import numpy as np

from algorithms.common.errors import NoAnswerError
from algorithms.common.parallel_kernels import each_on_a_core
from algorithms.common.pose import FloatArray, Pose2
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.coarse_grid import trimmed
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.merge_result import Answer, PlaneScan
from algorithms.methods.plane_proof import prove_plane, with_proven
from algorithms.methods.shared_stages import Found
from algorithms.methods.spectra_answer import least_deviations
from algorithms.methods.stage_runner import StageRunner
from algorithms.methods.steps import AnswersDetail, PlaneDetail, ProofDetail, Step, WeighedDetail
from algorithms.observations.pair_problem import PairProblem
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.correlation_picture import picture_of
from algorithms.optimisation.covariance import covariance_of
from algorithms.optimisation.likelihood_field import AgreementConfig
from algorithms.optimisation.plane_correlation import PlaneConfig, PlaneCorrelation, places
from algorithms.optimisation.subcell_peak import peak_at
from algorithms.verdict.decision import VerdictConfig
from algorithms.verdict.probability_model import ModelKind, shipped_model
from algorithms.verdict.ranking import WINDOW_EDGE, Weighed, likeliest, ranked
from algorithms.verdict.whole_maps import WholeMaps, make_whole_maps

TOGETHER = 8  # turns between two steps: enough for every core, and soon stopped
HILLS = 10  # of each turn
BESIDE = 0.5, radians(5)  # metres, radians: hills so near each other are one place
ONE_TOP = 0.15, radians(1.5)  # likewise hilltops
ELSEWHERE = 0.7, radians(10)  # answers farther apart are two
PLANE: ModelKind = "plane"
TURN_REACH = 4.0  # metres at which a turn moves a wall by a cell
WIDEST = np.array([1.0, 1.0, radians(10)])  # of x, y, theta where the walls say nothing; metres, radians


@dataclass(frozen=True)
class PlaneMethodConfig(CheckedConfig):
    """Settings of the search over the plane."""

    plane: PlaneConfig = field(default_factory=PlaneConfig)
    window: WindowConfig = field(default_factory=lambda: WindowConfig(kind="coupled", deviations=WINDOW_EDGE))
    evidence: Annotated[float, Bounds(0.05, 5, 0.05, "m", "ℓ", "evidence")] = AgreementConfig().evidence
    """Metres of wall that say as much as one measurement: it weighs what is known against the walls."""
    places: Annotated[int, Bounds(1, 1000, 1, "", "", "places climbed")] = 100
    """How many of the best places of the plane are climbed."""
    answers: Annotated[int, Bounds(1, 100, 1, "", "", "answers weighed")] = 8
    """How many of the best hilltops are held against the whole maps, patches slipped."""
    prove: bool = False
    """Prove that nowhere on the plane the walls agree better than at the best place that was climbed, or find
    where they do. It takes from half as long as the search to twenty times as long."""
    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    conflict: ConflictRule = ConflictRule.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""


def search(
    problem: PairProblem, config: PlaneMethodConfig, seed: int, runner: StageRunner
) -> Generator[Step, None, Found]:
    """Yield the steps from the plane to the answers that the whole maps have weighed."""
    plane: PlaneDetail = yield from runner.stage(
        "correlate",
        (problem, config.plane, config.window, config.places),
        lambda: correlate(problem, config),
    )
    whole = cache(lambda: whole_maps_of(problem, plane.searched, config))  # made by the stage that needs it
    climbed: AnswersDetail = yield from runner.stage(
        "climb",
        (plane, config.evidence, config.answers, config.verdict.robot_size),
        lambda: [climb(whole(), plane, config)],
    )
    proof, found_it = None, None
    if config.prove:
        proven: ProofDetail = yield from runner.stage(
            "prove", (climbed,), lambda: prove_plane(whole(), climbed)
        )
        proof = proven.state
        climbed, found_it = with_proven(whole(), climbed, proof, *ELSEWHERE)
    weighed: WeighedDetail = yield from runner.stage("weigh", (climbed,), lambda: [weigh(whole(), climbed)])
    named, *others = weighed.answers
    value = whole().crisp.value_at(named.T_ref_mov)
    covariance = covariance_at(whole(), named, problem.pivot, config)
    return Found(
        named,
        others,
        covariance,
        climbed.answers,
        value,
        proof=proof,
        search_found_it=found_it,
        scan=PlaneScan(2 * pi / plane.total, plane.cell, len(plane.poses)),
        kind=PLANE,
    )


def correlate(problem: PairProblem, config: PlaneMethodConfig) -> Iterator[PlaneDetail]:
    """Every turn that the knowledge leaves; the best places so far after every few."""
    correlation = PlaneCorrelation(trimmed(problem.ref), trimmed(problem.mov), config.plane)
    window = problem.window(config.window, curved=True)
    poses, values, searched = np.zeros((0, 3)), np.zeros(0, dtype=np.float32), 0.0
    total = len(correlation.turns)
    tops: FloatArray = np.full(total, np.nan)
    for start in range(0, total, TOGETHER):
        turns = correlation.turns[start : start + TOGETHER].tolist()
        looks = each_on_a_core(lambda turn: correlation.look(turn, window, HILLS), turns)
        poses = np.concatenate([poses, *(look.poses for look in looks)])
        values = np.concatenate([values, *(look.values for look in looks)])
        kept = places(poses, values, problem.pivot, config.places, *BESIDE)
        poses, values = poses[kept], values[kept]
        searched += sum(look.shifts for look in looks) * correlation.cell**2 / total
        done, best = start + len(looks), max(looks, key=lambda look: look.top)
        tops[start:done] = [look.top if len(look.values) else np.nan for look in looks]
        picture = picture_of(correlation, best)
        so_far = poses, values, searched
        yield PlaneDetail(done, correlation.turns, tops.copy(), picture, correlation.cell, *so_far)


def climb(whole: WholeMaps, plane: PlaneDetail, config: PlaneMethodConfig) -> AnswersDetail:
    """The hilltops near the best places, those first for which the maps as they are speak most.

    raises : NoAnswerError where no place lets walls coincide
    """
    tops = whole.climb_all(plane.poses)
    tops = tops[whole.window.contains(tops)]
    values = whole.crisp(tops).astype(np.float32)
    kept = places(tops, values, whole.window.pivot, len(tops), *ONE_TOP)
    if not len(kept):
        raise NoAnswerError(
            "wherever map 2 is laid on map 1, no walls coincide where what is known lets them; "
            "maps that share more, or a sighting, would help"
        )
    by_pose = {Pose2.from_array(tops[k]): float(values[k]) for k in kept}
    best = likeliest(whole, list(by_pose), shipped_model(PLANE), config.answers)
    answers = tuple(Answer(T, by_pose[T], "the best places were climbed") for T in best)
    return AnswersDetail(answers, tops[kept])


def weigh(whole: WholeMaps, climbed: AnswersDetail) -> WeighedDetail:
    """The hilltops by the whole maps, patches slipped; the likeliest first, each on its hilltop."""
    tops = [answer.T_ref_mov for answer in climbed.answers]
    found = ranked(whole, tops, shipped_model(PLANE), *ELSEWHERE)
    return WeighedDetail(tuple(_on_top(whole, each) for each in found))


def _on_top(whole: WholeMaps, each: Weighed) -> Weighed:
    """An answer on its hilltop, which swapping the maps leaves where it is; where that is in the window."""
    top = whole.hilltop(each.T_ref_mov)
    if not whole.window.contains(top.array()[None])[0]:
        return each
    return replace(each, T_ref_mov=top, began=each.began if each.moved else top)


def covariance_at(
    whole: WholeMaps, named: Weighed, pivot: FloatArray, config: PlaneMethodConfig
) -> FloatArray:
    """(3, 3) of x, y, theta of an answer, by how sharp its hilltop is; metres and radians.

    pivot : (2,) about which map 2 is turned; metres, mov frame
    """
    peak = peak_at(whole.crisp, named.T_ref_mov, pivot, TURN_REACH)
    least = least_deviations(named, config.verdict)
    return covariance_of(peak, pivot, config.evidence, WIDEST, least)


def whole_maps_of(problem: PairProblem, searched: float, config: PlaneMethodConfig) -> WholeMaps:
    """Both maps as a whole; ``searched`` as in PlaneDetail."""
    window, robots = problem.window(config.window, curved=True), problem.robots(config.verdict.robot_size)
    return make_whole_maps(problem.ref, problem.mov, robots, window, config.evidence, searched)
