"""Every case in a folder, merged and judged against its truth; how many came out right, and whether the
probabilities are what they say.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.files.case_folder import Case, case_folders, group_of, name_in, read_case
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE
from algorithms.methods import registry as methods
from algorithms.verdict.calibration import brier_score, calibration_error, reliability
from app.evaluation.crossed_pairs import Crossing, crossed_case
from app.evaluation.method_run import judge_case
from app.jobs.executor import Executor, LostTask, SerialExecutor, Task
from app.report.result_files import plain, report_of

OVERALL = "overall"

Entry = dict[str, Any]
"""What is told of one case: case, observation, report or no_answer or error, seconds, truth."""


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
