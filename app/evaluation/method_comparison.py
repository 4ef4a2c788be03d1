"""Several methods on the same pairs, and what came of each: the comparison of section IV-C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, median
from threading import Event
from typing import Any

from algorithms.common.errors import MapMergeError
from algorithms.files.case_folder import Case, case_folders, name_in, read_case
from app.evaluation.compared_methods import COMPARED
from app.evaluation.method_run import MethodRun, run_method, true_fusion
from app.jobs.executor import Executor, LostTask, Shared, Task

Configs = Mapping[str, Any]
"""Settings by the names of COMPARED, in the order they are to be shown."""


@dataclass(frozen=True)
class ComparedRun:
    """What came of one method, called by its name in COMPARED, on one pair."""

    case: str
    method: str
    trial: MethodRun


Pairs = Iterable[tuple[str, Case | str]]
"""Pairs by a name that is theirs alone; a text says why one cannot be read."""


def defaults_of(names: Iterable[str]) -> dict[str, Any]:
    """What is compared under these names, at its defaults, in the order of the table."""
    wanted = set(names)
    return {name: each.defaults for name, each in COMPARED.items() if name in wanted}


def compare_methods(
    pairs: Pairs, configs: Configs, executor: Executor, seed: int = 0, stop: Event | None = None
) -> Iterator[ComparedRun]:
    """Yield a score per pair and method, as they are done. Close the generator to stop, or set ``stop``
    in another thread.

    A method that can't be run on a pair, and a pair that can't be read, cost no other.
    """
    asked: list[tuple[str, str]] = []

    def tasks() -> Iterator[Task]:
        for name, case in pairs:
            shared = Shared.of(case)
            for method, config in configs.items():
                asked.append((name, method))
                yield Task((method, config, seed), shared)

    for number, answer in executor.run(_work, tasks(), stop):
        run = MethodRun.failure(answer.reason) if isinstance(answer, LostTask) else answer
        yield ComparedRun(*asked[number], run)


def pairs_in(root: Path, rough: bool = False) -> tuple[int, Pairs]:
    """How many cases a folder holds, and the cases, each read when it is its turn.

    rough  : take the badly measured observation of each
    raises : InputFileError where there is none
    """
    folders = case_folders(root)

    def read() -> Iterator[tuple[str, Case | str]]:
        for folder in folders:
            try:
                yield name_in(root, folder), read_case(folder, rough)
            except MapMergeError as error:
                yield name_in(root, folder), str(error)

    return len(folders), read()


def _work(case: Case | str, order: tuple[str, Any, int]) -> MethodRun:
    if isinstance(case, str):
        return MethodRun.failure(case)
    name, config, seed = order
    compared = COMPARED[name]
    try:
        true = true_fusion(case)
    except MapMergeError as error:
        return MethodRun.failure(str(error))
    known = case.known if compared.informed else ()
    return run_method(case, compared.method, config, seed, true, known=known)


@dataclass(frozen=True)
class MethodTotals:
    """A method's row in the table.

    n         : pairs that it could be run on
    failed    : pairs that it could not be run on
    judged    : of n, those whose truth is known. right + wrong + no_answer = judged
    right, fine, wrong : its transform alone, whatever anyone says of it
    no_answer : it found no transform
    refused   : by mapmeld's verdict, which is laid on the transforms of all methods alike
    wrong_accepted : wrong transforms that the verdict lets pass
    index     : mean of eq. (23) over the true overlap, 0 where there is no transform; None where no
                truth is known
    seconds   : median time of a merge; None where nothing ran
    """

    n: int
    failed: int
    judged: int
    right: int
    fine: int
    wrong: int
    no_answer: int
    refused: int
    wrong_accepted: int
    index: float | None
    seconds: float | None


def tally(scores: Sequence[ComparedRun]) -> dict[str, MethodTotals]:
    """A row per method, in the order of the table of methods."""
    trials: dict[str, list[MethodRun]] = {}
    for score in scores:
        trials.setdefault(score.method, []).append(score.trial)
    return {name: _totals(trials[name]) for name in COMPARED if name in trials}


def _totals(trials: Sequence[MethodRun]) -> MethodTotals:
    ran = [trial for trial in trials if not trial.failed]
    judged = [trial for trial in ran if trial.right is not None]
    indices = [trial.index for trial in judged if trial.index is not None]
    return MethodTotals(
        n=len(ran),
        failed=len(trials) - len(ran),
        judged=len(judged),
        right=sum(trial.right is True and trial.T_ref_mov is not None for trial in judged),
        fine=sum(trial.fine is True for trial in judged),
        wrong=sum(trial.wrong for trial in judged),
        no_answer=sum(trial.T_ref_mov is None for trial in judged),
        refused=sum(not trial.accepted for trial in ran),
        wrong_accepted=sum(trial.wrong and trial.accepted for trial in judged),
        index=fmean(indices) if indices else None,
        seconds=median(trial.seconds for trial in ran) if ran else None,
    )
