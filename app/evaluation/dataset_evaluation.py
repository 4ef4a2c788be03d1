"""Every case in a folder, merged and judged against its truth: how many are right, how true are they told."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.files.case_folder import Case, case_folders, group_of
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE
from algorithms.methods.registry import default_method
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.simulator.rough_priors import Knowledge
from algorithms.verdict.calibration import brier_score, calibration_error, reliability
from app.evaluation.case_knowledge import known_of
from app.evaluation.crossed_pairs import Pair, name_of_pair, read_pair
from app.evaluation.method_run import Judgement, judge_case, merge_or_reason, reason_of
from app.jobs.executor import Executor, LostTask, SerialExecutor, Task
from app.report.json_report import plain, report_of

OVERALL = "overall"


@dataclass(frozen=True)
class EvaluationTask:
    """What is to be run on every case.

    configs   : settings by the name of their method; of several the one that suits what is known is run
    rough     : take the badly measured observation of each
    knowledge : what the method is told of each, as in ``known_of``
    """

    root: Path
    configs: Mapping[str, Any]
    seed: int = 0
    rough: bool = False
    knowledge: Knowledge = "sighting"


@dataclass(frozen=True)
class EvaluatedCase:
    """What came of one case.

    knowledge : what the method was told
    drawn     : a rough pose or a rough turn, where one was drawn for it
    report    : as in report.json; without one ``no_answer`` says that the method found no transform, or
                ``error`` why it could not be run
    truth     : None where none is known, or the method could not be run
    seconds   : reading included
    """

    case: str
    observation: str
    report: dict[str, Any] | None = None
    no_answer: str = ""
    error: str = ""
    truth: Judgement | None = None
    seconds: float = 0.0
    knowledge: Knowledge = "sighting"
    drawn: tuple[Known, ...] = ()

    @property
    def accepted(self) -> bool:
        """Whether the method stands by a merge."""
        return self.report is not None and bool(self.report["verdict"]["accepted"])

    @property
    def probability(self) -> float:
        """How likely its merge is said to be right."""
        return 0.0 if self.report is None else float(self.report["verdict"]["probability"])

    @property
    def transform_right(self) -> bool:
        """Whether the transform is right; of maps that share no place none is."""
        return self.truth is not None and self.truth.expected == "merge" and self.truth.right

    @property
    def wrong_accepted(self) -> bool:
        """Whether the method stands by a wrong merge: what must not happen."""
        return self.truth is not None and self.accepted and not self.truth.right

    def plain(self) -> dict[str, Any]:
        """As JSON holds it: of report, no_answer, error and drawn what there is."""
        outcome = ("report", "no_answer", "error", "drawn")
        return {name: value for name, value in asdict(self).items() if value or name not in outcome}


def evaluate(
    order: EvaluationTask, executor: Executor | None = None, pairs: Sequence[Pair] | None = None
) -> Iterator[EvaluatedCase]:
    """Yield what came of each case, in the order of completion. A case that fails costs no other.

    executor : who does it; the answers don't depend on it
    pairs    : the cases; all under ``order.root`` unless given
    raises   : InputFileError where there is no case
    """
    executor = SerialExecutor() if executor is None else executor
    found: Sequence[Pair] = case_folders(order.root) if pairs is None else pairs
    tasks = (Task((pair, order, _read(pair, order) if executor.far else None)) for pair in found)
    for number, answer in executor.run(_work, tasks):
        if isinstance(answer, LostTask):
            answer = _evaluated(name_of_pair(order.root, found[number]), order, error=answer.reason)
        yield answer


def rough_folders(root: Path) -> list[Path]:
    """The case folders that hold a badly measured observation, too."""
    return [folder for folder in case_folders(root) if (folder / ROUGH_OBSERVATION_FILE).exists()]


Loaded = tuple[Case, float]
"""A case, called by its place in the folder, and the seconds that reading it took."""


def _work(_: None, given: tuple[Pair, EvaluationTask, Loaded | EvaluatedCase | None]) -> EvaluatedCase:
    return run_case(*given)


def run_case(pair: Pair, order: EvaluationTask, read: Loaded | EvaluatedCase | None = None) -> EvaluatedCase:
    """Merge one case, which is ``read`` here unless given, and judge it; one that fails says why."""
    read = read or _read(pair, order)
    if isinstance(read, EvaluatedCase):
        return read
    (case, reading_s), began = read, perf_counter()
    try:
        known = known_of(case, order.knowledge)
        problem = PairProblem.of(case.ref, case.mov, known)
    except MapMergeError as error:
        return _evaluated(case.name, order, error=reason_of(error), seconds=reading_s)
    method = default_method(problem, tuple(order.configs))
    config = order.configs[method]
    result = merge_or_reason(case, method, config, order.seed, known=known)
    outcome: dict[str, Any] = {"error": result}
    if isinstance(result, NoAnswerError):
        outcome = {"no_answer": str(result), "truth": judge_case(case, None)}
    elif not isinstance(result, str):
        report = report_of(result, config, reading_s)
        del report["made"]  # the same cases give the same file
        outcome = {"report": report, "truth": judge_case(case, result)}
    outcome |= {"drawn": () if order.knowledge == "sighting" else known}
    return _evaluated(case.name, order, **outcome, seconds=reading_s + perf_counter() - began)


def _read(pair: Pair, order: EvaluationTask) -> Loaded | EvaluatedCase:
    """The case in a folder, or the one that two make; why not, where it can't be read."""
    name, began = name_of_pair(order.root, pair), perf_counter()
    try:
        return replace(read_pair(pair, order.rough), name=name), perf_counter() - began
    except Exception as error:
        return _evaluated(name, order, error=reason_of(error), seconds=perf_counter() - began)


def _evaluated(name: str, order: EvaluationTask, **outcome: Any) -> EvaluatedCase:
    file = ROUGH_OBSERVATION_FILE if order.rough else OBSERVATION_FILE
    return EvaluatedCase(name, file, knowledge=order.knowledge, **outcome)


def totals_of(cases: Sequence[EvaluatedCase]) -> dict[str, dict[str, Any]]:
    """Counts per group, and overall.

    n, judged, errors : cases, those with a truth that ran, those that failed
    right, fine       : of the judged, whether accepted or refused
    right_first       : of the judged that should merge: the answer that is named is right
    right_among_five  : of the judged that should merge: one of the first five answers is
    right_accepted    : of the judged that should merge: right and accepted
    refused           : of all that ran; with those where the method found no transform at all
    wrong_accepted    : of the judged: accepted, and not right
    """
    groups: dict[str, list[EvaluatedCase]] = {}
    for case in cases:
        groups.setdefault(group_of(case.case), []).append(case)
    totals = {name: _totals(groups[name]) for name in sorted(groups)}
    return {**totals, OVERALL: _totals(cases)}


def _totals(cases: Sequence[EvaluatedCase]) -> dict[str, Any]:
    ran = [case for case in cases if not case.error]
    truths = [case.truth for case in ran if case.truth is not None]
    return {
        "n": len(cases),
        "judged": len(truths),
        "right": sum(truth.right for truth in truths),
        "fine": sum(truth.fine for truth in truths),
        "right_first": sum(case.transform_right for case in ran),
        "right_among_five": sum(truth.among_five for truth in truths),
        "right_accepted": sum(case.transform_right and case.accepted for case in ran),
        "refused": sum(not case.accepted for case in ran),
        "wrong_accepted": sum(case.wrong_accepted for case in ran),
        "errors": len(cases) - len(ran),
        "median_seconds": median(case.seconds for case in ran) if ran else None,
    }


def calibration_of(cases: Sequence[EvaluatedCase]) -> dict[str, Any]:
    """How true the probabilities are, over all cases that ran and have a truth.

    bins  : n, mean probability and share that is right, by probability
    ece   : expected calibration error
    brier : mean squared error of the probability
    """
    judged = [case for case in cases if case.truth is not None]
    stated = np.array([case.probability for case in judged], dtype=np.float64)
    right = np.array([case.transform_right for case in judged], dtype=np.bool_)
    scores = {"ece": calibration_error(stated, right), "brier": brier_score(stated, right)}
    return plain({"n": len(judged), "bins": reliability(stated, right), **scores})
