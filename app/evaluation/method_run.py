"""One method on one pair, once: its transform held against the truth, eq. (23), and what it took."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import radians
from time import perf_counter
from typing import Any, Literal

import numpy as np

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.common.pose import Pose2, pose_error
from algorithms.files.case_folder import Case
from algorithms.maps.map_fusion import Fusion, fuse
from algorithms.methods import registry as methods
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.stage_runner import StageCache
from algorithms.observations.pair_problem import Known
from algorithms.verdict.decision import Outcome
from algorithms.verdict.performance_index import performance_index
from app.jobs.warm_up import small_merge
from app.model.settings import settings_of, value_at

FINE_M = 0.15
FINE_RAD = radians(1)
FIRST_ANSWERS = 5  # as many as a person looks through


@dataclass(frozen=True)
class MethodRun:
    """What came of one run; everything in it can be written as JSON.

    T_ref_mov : (x, y, theta); metres, metres, radians; None where the method found no transform
    accepted  : mapmeld's verdict on it
    bent      : whether it was accepted although no one transform lays the maps on each other everywhere
    reason    : that verdict in words; why there is no transform; or why the method could not run
    index     : eq. (23), 0 … 1, over the true overlap where the truth is known and over that of the
                estimate where it isn't. 0 where there is no transform: nothing was merged. None where
                the method could not run, or the maps share no place
    distance, angle : from the truth, at the seen robot; metres, radians; None without one, or without a
                transform
    right, fine : the transform alone, whatever the verdict says; None where no truth is known. Of maps
                that share no place every transform is wrong
    seconds   : of the merge alone: files read and code loaded before
    failed    : whether the method could not be run
    """

    T_ref_mov: tuple[float, float, float] | None = None
    accepted: bool = False
    reason: str = ""
    index: float | None = None
    distance: float | None = None
    angle: float | None = None
    right: bool | None = None
    fine: bool | None = None
    seconds: float = 0.0
    failed: bool = False
    bent: bool = False

    @property
    def pose(self) -> Pose2 | None:
        return None if self.T_ref_mov is None else Pose2(*self.T_ref_mov)

    @property
    def wrong(self) -> bool:
        """Whether it gave a transform that is not right."""
        return self.T_ref_mov is not None and self.right is False

    @staticmethod
    def of(plain: Mapping[str, Any]) -> MethodRun:
        T = plain["T_ref_mov"]
        return MethodRun(**{**plain, "T_ref_mov": None if T is None else tuple(T)})

    @staticmethod
    def failure(reason: str) -> MethodRun:
        return MethodRun(reason=reason, failed=True)


@dataclass(frozen=True)
class Judgement:
    """A merge held against the truth.

    distance, angle : from the truth, at the seen robot; metres, radians; None without a transform
    right, fine     : within the case's tolerance, within FINE_M and FINE_RAD. Two maps that share no place
                      have no right transform: there, right means refused
    among_five      : whether the merge, or one of the first answers that were weighed beside it, is within
                      the tolerance; of maps that share no place none is
    """

    distance: float | None
    angle: float | None
    right: bool
    fine: bool
    expected: Literal["merge", "refuse"]
    among_five: bool = False


def true_fusion(case: Case) -> Fusion | None:
    """Both maps merged as they really lie; None where nobody knows, or they share no place."""
    truth = case.truth
    if truth is None or truth.T_ref_mov is None or truth.expected == "refuse":
        return None
    return fuse((case.ref, case.mov), (Pose2(), truth.T_ref_mov))


def run_method(
    case: Case,
    method: str,
    config: Any,
    seed: int,
    true: Fusion | None,
    memo: StageCache | None = None,
    known: Sequence[Known] | None = None,
) -> MethodRun:
    """Run a method and judge it; what goes wrong with it is in the answer.

    config : its settings; None: its defaults
    true   : ``true_fusion(case)``, made once for many runs
    memo   : as in ``methods.run``. The seconds of a stage that is remembered count as if it had run
    known  : what it is told of the case; all that is known unless given
    """
    config = methods.METHODS[method].defaults if config is None else config
    known = case.known if known is None else known
    _load_code(method, config, bool(known))
    began = perf_counter()
    result = merge_or_reason(case, method, config, seed, memo, known)
    elapsed = perf_counter() - began
    if isinstance(result, str):
        return MethodRun.failure(result)
    merged = result if isinstance(result, MergeResult) else None
    found: dict[str, Any] = {"reason": str(result), "index": 0.0, "seconds": elapsed}
    if merged is not None:
        T, verdict = merged.T_ref_mov, merged.verdict
        found = {
            "T_ref_mov": (T.x, T.y, T.theta),
            "accepted": verdict.accepted,
            "reason": verdict.reason,
            "index": performance_index(merged.fusion, true) or 0.0,
            "seconds": sum(merged.timings_s.values()),
            "bent": verdict.outcome is Outcome.BENT,
        }
    if (judged := judge_case(case, merged)) is not None:
        found |= {name: getattr(judged, name) for name in ("distance", "angle", "right", "fine")}
        if judged.expected == "refuse":
            found |= {"index": None, "right": merged is None}
    return MethodRun(**found)


def merge_or_reason(
    case: Case,
    method: str,
    config: Any,
    seed: int,
    memo: StageCache | None = None,
    known: Sequence[Known] | None = None,
) -> MergeResult | NoAnswerError | str:
    """The result of a method, its refusal, or why it could not be run: a bug in one must not cost others.

    known : what it is told of the case; all that is known unless given
    """
    known = case.known if known is None else known
    try:
        *_, last = methods.run(method, case.ref, case.mov, known, config, seed, memo)
    except NoAnswerError as refusal:
        return refusal
    except Exception as error:
        return reason_of(error)
    assert isinstance(last.detail, MergeResult)
    return last.detail


def reason_of(error: Exception) -> str:
    """What went wrong, and whether it is a bug."""
    return str(error) if isinstance(error, MapMergeError) else f"bug: {type(error).__name__}: {error}"


def judge_case(case: Case, result: MergeResult | None) -> Judgement | None:
    """How far a merge, or None where a method found no transform, is from the truth; None without one.

    The distance is taken where robot 2 was first seen, also of a merge that was not told so.
    """
    truth = case.truth
    if truth is None:
        return None
    distance = angle = None
    right = fine = among_five = False
    if truth.T_ref_mov is not None and result is not None:
        at, seen = result.pivot, case.observations[:1]
        if seen:
            at = np.array([seen[0].observed_x, seen[0].observed_y])
        distance, angle = pose_error(result.T_ref_mov, truth.T_ref_mov, at)
        right, fine = truth.allows(distance, angle), distance <= FINE_M and angle <= FINE_RAD
        first = (each.T_ref_mov for each in result.weighed[:FIRST_ANSWERS])
        among_five = right or any(truth.allows(*pose_error(T, truth.T_ref_mov, at)) for T in first)
    if truth.expected == "refuse":
        right, fine, among_five = result is None or not result.verdict.accepted, False, False
    return Judgement(distance, angle, right, fine, truth.expected, among_five)


# ---- the first run of a method loads its code: seconds that are not the method's

_loaded: set[tuple[Any, ...]] = set()


def _load_code(method: str, config: Any, informed: bool) -> None:
    """Merge a room with itself, once per process and method: numbers don't choose code, words do, and whether
    anything is known.
    """
    words = tuple(value_at(config, at.path) for at in settings_of(config) if at.bounds is None)
    if (method, words, informed) in _loaded:
        return
    _loaded.add((method, words, informed))
    room = small_merge()
    with suppress(Exception):  # a room so small may be beyond a method; the real maps tell what matters
        list(methods.run(method, room.ref, room.mov, room.observations if informed else (), config))
