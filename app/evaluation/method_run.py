"""One method on one pair, once: its transform held against the truth, eq. (23), and what it took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import atan2, hypot, radians
from time import perf_counter
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.common.pose import Pose2, pose_error
from algorithms.files.case_folder import Case
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.maps.map_fusion import Fusion, fuse
from algorithms.methods import registry as methods
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.stage_runner import StageCache
from algorithms.observations.observation import Observation
from algorithms.verdict.decision import Outcome
from algorithms.verdict.performance_index import performance_index
from app.model.settings import settings_of, value_at

FINE_M = 0.15
FINE_RAD = radians(1)


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

    T_ref_mov: tuple[float, float, float] | None
    accepted: bool
    reason: str
    index: float | None
    distance: float | None
    angle: float | None
    right: bool | None
    fine: bool | None
    seconds: float
    failed: bool = False
    bent: bool = False

    @property
    def pose(self) -> Pose2 | None:
        """The transform."""
        return None if self.T_ref_mov is None else Pose2(*self.T_ref_mov)

    @property
    def wrong(self) -> bool:
        """Whether it gave a transform that is not right."""
        return self.T_ref_mov is not None and self.right is False

    def plain(self) -> dict[str, Any]:
        """As JSON holds it."""
        return asdict(self)

    @staticmethod
    def of(plain: Mapping[str, Any]) -> MethodRun:
        """The trial of ``plain``."""
        T = plain["T_ref_mov"]
        return MethodRun(**{**plain, "T_ref_mov": None if T is None else tuple(T)})


def true_fusion(case: Case) -> Fusion | None:
    """Both maps merged as they really lie; None where nobody knows, or they share no place."""
    truth = case.truth
    if truth is None or truth.T_ref_mov is None or truth.expected == "refuse":
        return None
    return fuse((case.ref, case.mov), (Pose2(), truth.T_ref_mov))


def run_method(
    case: Case, method: str, config: Any, seed: int, true: Fusion | None, memo: StageCache | None = None
) -> MethodRun:
    """Run a method and judge it; what goes wrong with it is in the answer.

    config : its settings; None: its defaults
    true   : ``true_fusion(case)``, made once for many attempts
    memo   : as in ``methods.run``. The seconds of a stage that is told again count as if it had run
    """
    config = methods.METHODS[method].defaults if config is None else config
    _load_code(method, config)
    began = perf_counter()
    try:
        *_, last = methods.run(method, case.ref, case.mov, case.observations, config, seed, memo)
    except NoAnswerError as refusal:
        return _judged(case, None, str(refusal), perf_counter() - began, true)
    except MapMergeError as error:
        return _failed(str(error))
    except Exception as error:  # a bug in one method must not cost the others
        return _failed(f"bug: {type(error).__name__}: {error}")
    assert isinstance(last.detail, MergeResult)
    result = last.detail
    return _judged(case, result, result.verdict.reason, sum(result.timings_s.values()), true)


def judge_case(case: Case, result: MergeResult | None) -> dict[str, Any] | None:
    """How far a merge is from the truth; None where no truth is known.

    Two maps that share no place have no right transform: there, right means refused.

    result : None for a method that found no transform, which refuses
    """
    truth = case.truth
    if truth is None:
        return None
    distance = angle = None
    if truth.T_ref_mov is not None and result is not None:
        distance, angle = pose_error(result.T_ref_mov, truth.T_ref_mov, result.encounter.x_mov)
    if truth.expected == "refuse":
        right, fine = result is None or not result.verdict.accepted, False
    elif result is None:
        right = fine = False
    else:
        assert distance is not None
        assert angle is not None
        right = truth.allows(distance, angle)
        fine = distance <= FINE_M and angle <= FINE_RAD
    return {
        "distance": distance,
        "angle": angle,
        "right": right,
        "fine": fine,
        "expected": truth.expected,
    }


def _judged(
    case: Case, result: MergeResult | None, reason: str, seconds: float, true: Fusion | None
) -> MethodRun:
    told = judge_case(case, result)
    lost = case.truth is not None and case.truth.expected == "refuse"  # maps that share no place
    right = fine = None
    if told is not None:
        right = result is None if lost else told["right"]
        fine = told["fine"]
    index = None if lost else 0.0
    if result is not None and not lost:
        index = performance_index(result.fusion, true) or 0.0
    return MethodRun(
        T_ref_mov=None
        if result is None
        else (result.T_ref_mov.x, result.T_ref_mov.y, result.T_ref_mov.theta),
        accepted=result is not None and result.verdict.accepted,
        reason=reason,
        index=index,
        distance=None if told is None else told["distance"],
        angle=None if told is None else told["angle"],
        right=right,
        fine=fine,
        seconds=seconds,
        bent=result is not None and result.verdict.outcome is Outcome.BENT,
    )


def _failed(reason: str) -> MethodRun:
    return MethodRun(None, False, reason, None, None, None, None, None, 0.0, failed=True)


# ---- the first run of a method loads its code: seconds that are not the method's

_loaded: set[tuple[Any, ...]] = set()


def _load_code(method: str, config: Any) -> None:
    """Merge a room with itself, once per process and method: numbers don't choose code, words do."""
    words = tuple(value_at(config, at.path) for at in settings_of(config) if at.bounds is None)
    if (method, words) in _loaded:
        return
    _loaded.add((method, words))
    room, seen = _room()
    try:
        list(methods.run(method, room, room, seen, config))
    except Exception:  # a room so small may be beyond a method; what matters is told of the real maps
        return


def _room() -> tuple[GridMap, Observation]:
    """A room of 4 x 3 m with a wall in it, and two robots there."""
    cells = np.full((60, 80), FREE, dtype=np.int8)
    for walls in (cells[:2], cells[-2:], cells[:, :2], cells[:, -2:], cells[20:22, 30:60], cells[40:, 50:52]):
        walls[:] = OCCUPIED
    observer, (x, y) = Pose2(1.0, 1.6, 0.3), (3.2, 1.9)
    seen = Observation(
        observer=observer,
        observed_x=x,
        observed_y=y,
        observed_heading=2.0,
        range=hypot(x - observer.x, y - observer.y),
        bearing=atan2(y - observer.y, x - observer.x) - observer.theta,
        bearing_back=atan2(observer.y - y, observer.x - x) - 2.0,
    )
    return GridMap(cells, 0.05, name="room"), seen
