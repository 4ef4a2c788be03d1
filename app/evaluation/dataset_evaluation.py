"""Every case in a folder, merged and judged against its truth; how many came out right, and whether the
probabilities are what they say.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import permutations
from math import radians
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from algorithms.common.errors import InputFileError, MapMergeError, NoAnswerError
from algorithms.common.pose import pose_error
from algorithms.files.case_folder import Case, case_folders, read_case
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE
from algorithms.files.truth_file import TRUTH_FILE, Truth, read_truth
from algorithms.methods import registry as methods
from algorithms.methods.merge_result import MergeResult
from algorithms.simulator.wrong_pairs import crossed
from algorithms.verdict.calibration import brier_score, calibration_error, reliability
from app.jobs.executor import Executor, LostTask, SerialExecutor, Task
from app.report.result_files import plain, report_of

FINE_M = 0.15
FINE_RAD = radians(1)
OVERALL = "overall"

Entry = dict[str, Any]
"""What is told of one case: case, observation, report or no_answer or error, seconds, truth."""


@dataclass(frozen=True)
class Crossing:
    """A wrong pair: map 1 and the observer of one case, map 2 and the seen robot of another building's."""

    observer: Path
    observed: Path


@dataclass(frozen=True)
class EvaluationTask:
    """What is to be run on every case; travels to other processes.

    config : settings of the method
    rough  : take the badly measured observation of each case
    """

    root: Path
    method: str
    config: Any
    seed: int = 0
    rough: bool = False


def evaluate(
    order: EvaluationTask, executor: Executor | None = None, folders: Sequence[Path | Crossing] | None = None
) -> Iterator[Entry]:
    """Yield an entry per case folder, in the order of their completion.

    A case that fails has its "error", and the others go on.

    executor : who does it; the answers don't depend on it
    folders  : the cases; all under ``order.root`` unless given
    raises   : InputFileError where there is no case
    """
    executor = SerialExecutor() if executor is None else executor
    found: Sequence[Path | Crossing] = case_folders(order.root) if folders is None else folders
    unread: list[Entry] = []
    taken: list[Path | Crossing] = []

    def tasks() -> Iterator[Task]:
        for folder in found:
            read = folder if not executor.far else _read(folder, order)
            if isinstance(read, dict):
                unread.append(read)
            else:
                taken.append(folder)
                yield Task((read, order))

    for number, answer in executor.run(_work, tasks()):
        if isinstance(answer, LostTask):
            answer = _entry(taken[number], order) | {"error": answer.reason, "seconds": 0.0, "truth": None}
        yield answer
        while unread:
            yield unread.pop(0)
    yield from unread


def evaluate_both(order: EvaluationTask, executor: Executor | None = None) -> Iterator[Entry]:
    """Yield an entry per case with its observation, then one per case that also has a rough one."""
    yield from evaluate(replace(order, rough=False), executor)
    folders = rough_folders(order.root)
    if folders:
        yield from evaluate(replace(order, rough=True), executor, folders)


def crossings(root: Path, count: int, seed: int = 0) -> list[Crossing]:
    """So many wrong pairs of the cases in a folder, different ones, by chance; fewer where there are not so
    many pairs of different buildings.

    raises : InputFileError for a case that cannot be read, or where all are of one building
    """
    known: dict[Path, str] = {}
    for folder in case_folders(root):
        path = folder / TRUTH_FILE
        truth = read_truth(path) if path.exists() else None
        if truth is None or truth.expected == "merge":
            known[folder] = building_of(group_of(name_in(root, folder)), truth)
    pairs = [Crossing(a, b) for a, b in permutations(known, 2) if known[a] != known[b]]
    if not pairs:
        raise InputFileError(
            root, "holds cases of one building only", "wrong pairs need two buildings or more"
        )
    return random.Random(seed).sample(pairs, min(count, len(pairs)))


def building_of(group: str, truth: Truth | None) -> str:
    """Which building a case is of: what its truth names as source, without the numbers of surveys (HIH_01);
    the group of its name where nothing is named.
    """
    words = [] if truth is None else truth.source.split()
    kept = [word for word in words if word != "+" and not re.fullmatch(r"\w+_\d+", word)]
    return " ".join(kept) or group


def rough_folders(root: Path) -> list[Path]:
    """The case folders that hold a badly measured observation, too."""
    return [folder for folder in case_folders(root) if (folder / ROUGH_OBSERVATION_FILE).exists()]


@dataclass(frozen=True, eq=False)
class LoadedCase:
    """A case that was read for somebody who can't read our files.

    entry   : what its entry begins with
    seconds : what reading it took
    """

    entry: Entry
    case: Case
    seconds: float


def _work(_: None, given: tuple[Path | Crossing | LoadedCase, EvaluationTask]) -> Entry:
    return run_case(*given)


def run_case(what: Path | Crossing | LoadedCase, order: EvaluationTask) -> Entry:
    """Merge one case and judge it. A case that fails says why; it raises nothing but an interrupt."""
    read = what if isinstance(what, LoadedCase) else _read(what, order)
    if not isinstance(read, LoadedCase):
        return read
    case, entry, began = read.case, dict(read.entry), perf_counter()
    try:
        result = methods.merge(case.ref, case.mov, case.observations, order.method, order.config, order.seed)
        entry |= {"report": report_of(result, order.config, read.seconds), "truth": judge_case(case, result)}
    except NoAnswerError as refusal:
        entry |= {"no_answer": str(refusal), "truth": judge_case(case, None)}
    except Exception as error:
        entry |= _failed(error)
    entry["seconds"] = read.seconds + perf_counter() - began
    return entry


def _read(what: Path | Crossing, order: EvaluationTask) -> LoadedCase | Entry:
    """The case in a folder, or the one that two make; its entry where it can't be read."""
    entry, began = _entry(what, order), perf_counter()
    try:
        if isinstance(what, Path):
            case = read_case(what, order.rough)
        else:
            case = crossed_case(read_case(what.observer, order.rough), read_case(what.observed, order.rough))
        return LoadedCase(entry, case, perf_counter() - began)
    except Exception as error:
        return entry | _failed(error) | {"seconds": perf_counter() - began}


def crossed_case(a: Case, b: Case) -> Case:
    """The wrong pair that two cases of different buildings make."""
    return Case(
        name=f"{a.name} x {b.name}",
        ref=a.ref,
        mov=b.mov,
        observations=tuple(map(crossed, a.observations, b.observations)),
        observation_file=a.observation_file,
        truth=Truth(None, expected="refuse"),
    )


def _failed(error: Exception) -> Entry:
    """What is told of a case that could not be run: a bug in one case must not cost the others."""
    known = isinstance(error, MapMergeError)
    return {"error": str(error) if known else f"bug: {type(error).__name__}: {error}", "truth": None}


def _entry(what: Path | Crossing, order: EvaluationTask) -> Entry:
    names = [what] if isinstance(what, Path) else [what.observer, what.observed]
    return {
        "case": " x ".join(name_in(order.root, folder) for folder in names),
        "observation": ROUGH_OBSERVATION_FILE if order.rough else OBSERVATION_FILE,
    }


def name_in(root: Path, folder: Path) -> str:
    """What a case is called: its place under the root; the root's own name where it is the case."""
    inside = folder.relative_to(root).as_posix()
    return folder.resolve().name if inside == "." else inside


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


def group_of(name: str) -> str:
    """Name of a case up to its first "_"."""
    return name.rsplit("/", 1)[-1].split("_", 1)[0]


def totals_of(entries: Sequence[Entry]) -> dict[str, dict[str, Any]]:
    """Counts per group, and overall.

    n, judged, errors : cases, those with a truth that ran, those that failed
    right, fine       : of the judged, whether accepted or refused
    right_accepted    : of the judged that should merge: right and accepted
    refused           : of all that ran; with those where the method found no transform at all
    wrong_accepted    : of the judged: accepted, and not right
    """
    groups: dict[str, list[Entry]] = {}
    for entry in entries:
        groups.setdefault(group_of(entry["case"]), []).append(entry)
    totals = {name: _totals(groups[name]) for name in sorted(groups)}
    return {**totals, OVERALL: _totals(entries)}


def _totals(entries: Sequence[Entry]) -> dict[str, Any]:
    ran = [entry for entry in entries if "error" not in entry]
    judged = [entry for entry in ran if entry["truth"] is not None]
    return {
        "n": len(entries),
        "judged": len(judged),
        "right": sum(entry["truth"]["right"] for entry in judged),
        "fine": sum(entry["truth"]["fine"] for entry in judged),
        "right_accepted": sum(is_right(entry) and _accepted(entry) for entry in judged),
        "refused": sum(not _accepted(entry) for entry in ran),
        "wrong_accepted": sum(is_wrong_accepted(entry) for entry in judged),
        "errors": len(entries) - len(ran),
        "median_seconds": median(entry["seconds"] for entry in ran) if ran else None,
    }


def is_right(entry: Mapping[str, Any]) -> bool:
    """Whether the transform is right; of maps that share no place none is."""
    truth = entry["truth"]
    return truth is not None and truth.get("expected") != "refuse" and bool(truth["right"])


def calibration_of(entries: Sequence[Entry]) -> dict[str, Any]:
    """How true the probabilities are, over all entries that ran and have a truth.

    bins  : n, mean probability and share that is right, by probability
    ece   : expected calibration error
    brier : mean squared error of the probability
    """
    judged = [entry for entry in entries if "error" not in entry and entry["truth"] is not None]
    told = np.array([_probability(entry) for entry in judged], dtype=np.float64)
    right = np.array([is_right(entry) for entry in judged], dtype=np.bool_)
    return {
        "n": len(judged),
        "bins": [plain(asdict(each)) for each in reliability(told, right)],
        "ece": plain(calibration_error(told, right)),
        "brier": plain(brier_score(told, right)),
    }


def _probability(entry: Mapping[str, Any]) -> float:
    return float(entry["report"]["verdict"]["probability"]) if "report" in entry else 0.0


def is_wrong_accepted(entry: Mapping[str, Any]) -> bool:
    """Whether the method stood by a wrong merge: what must not happen."""
    return entry["truth"] is not None and _accepted(entry) and not entry["truth"]["right"]


def _accepted(entry: Mapping[str, Any]) -> bool:
    return "report" in entry and bool(entry["report"]["verdict"]["accepted"])
