"""Every case in a folder, merged and judged against its truth; and how many came out right."""

from __future__ import annotations

import signal
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from math import radians
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from algorithms import methods
from algorithms.casefiles import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE, Case, case_folders, read_case
from algorithms.errors import MapMergeError, NoAnswerError
from algorithms.pose import pose_error
from algorithms.steps import MergeResult
from app.report import report_of

FINE_M = 0.15
FINE_RAD = radians(1)
OVERALL = "overall"

Entry = dict[str, Any]
"""What is told of one case: case, observation, report or no_answer or error, seconds, truth."""


@dataclass(frozen=True)
class Order:
    """What is to be run on every case; travels to other processes.

    config : settings of the method
    rough  : take the badly measured observation of each case
    """

    root: Path
    method: str
    config: Any
    seed: int = 0
    rough: bool = False


def evaluate(order: Order, jobs: int = 1, folders: Sequence[Path] | None = None) -> Iterator[Entry]:
    """Yield an entry per case folder, in the order of their completion.

    A case that fails has its "error", and the others go on.

    jobs    : processes at work; the answers don't depend on it
    folders : the cases; all under ``order.root`` unless given
    raises  : InputFileError where there is no case
    """
    folders = case_folders(order.root) if folders is None else folders
    if jobs == 1 or len(folders) == 1:
        for folder in folders:
            yield run_case(folder, order)
        return
    left = yield from _in_processes(folders, order, jobs)
    for folder in left:  # one of them takes its process down: each alone shows which
        if (yield from _in_processes([folder], order, 1)):
            message = "the process that ran it ended; was there too little memory?"
            yield _entry(folder, order) | {"error": message, "seconds": 0.0, "truth": None}


def evaluate_both(order: Order, jobs: int = 1) -> Iterator[Entry]:
    """Yield an entry per case with its observation, then one per case that also has a rough one."""
    yield from evaluate(replace(order, rough=False), jobs)
    folders = rough_folders(order.root)
    if folders:
        yield from evaluate(replace(order, rough=True), jobs, folders)


def rough_folders(root: Path) -> list[Path]:
    """The case folders that hold a badly measured observation, too."""
    return [folder for folder in case_folders(root) if (folder / ROUGH_OBSERVATION_FILE).exists()]


def _in_processes(folders: Sequence[Path], order: Order, jobs: int) -> Generator[Entry, None, list[Path]]:
    """Yield entries; return the folders that a broken pool left without one."""
    left = dict.fromkeys(folders)
    # "spawn": a copy of a process that already has threads can hang
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_leave_ctrl_c) as pool:
        running: dict[Future[Entry], Path] = {
            pool.submit(run_case, folder, order): folder for folder in folders
        }
        try:
            for future in as_completed(running):
                entry = future.result()
                del left[running[future]]
                yield entry
        except BrokenProcessPool:
            pass
        except BaseException:  # Ctrl-C, or the caller has left the loop
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return list(left)


def _leave_ctrl_c() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process hears it and ends the others


def run_case(folder: Path, order: Order) -> Entry:
    """Merge one case and judge it. A case that fails says why; it raises nothing but an interrupt."""
    entry = _entry(folder, order)
    began = perf_counter()
    try:
        case = read_case(folder, order.rough)
        load_s = perf_counter() - began
        try:
            result = methods.merge(
                case.ref, case.mov, case.observations, order.method, order.config, order.seed
            )
        except NoAnswerError as refusal:
            entry |= {"no_answer": str(refusal), "truth": judge_case(case, None)}
        else:
            entry |= {"report": report_of(result, order.config, load_s), "truth": judge_case(case, result)}
    except MapMergeError as error:
        entry |= {"error": str(error), "truth": None}
    except Exception as error:  # a bug in one case must not cost the others
        entry |= {"error": f"bug: {type(error).__name__}: {error}", "truth": None}
    entry["seconds"] = perf_counter() - began
    return entry


def _entry(folder: Path, order: Order) -> Entry:
    inside = folder.relative_to(order.root).as_posix()
    return {
        "case": folder.resolve().name if inside == "." else inside,
        "observation": ROUGH_OBSERVATION_FILE if order.rough else OBSERVATION_FILE,
    }


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
        right = distance <= truth.tolerance_m and angle <= truth.tolerance_rad
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
        "refused": sum(not _accepted(entry) for entry in ran),
        "wrong_accepted": sum(is_wrong_accepted(entry) for entry in judged),
        "errors": len(entries) - len(ran),
        "median_seconds": median(entry["seconds"] for entry in ran) if ran else None,
    }


def is_wrong_accepted(entry: Mapping[str, Any]) -> bool:
    """Whether the method stood by a wrong merge: what must not happen."""
    return entry["truth"] is not None and _accepted(entry) and not entry["truth"]["right"]


def _accepted(entry: Mapping[str, Any]) -> bool:
    return "report" in entry and bool(entry["report"]["verdict"]["accepted"])
