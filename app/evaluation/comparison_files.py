"""What a comparison leaves behind: tables, everything as JSON, and pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from algorithms.files.case_folder import Case
from app.evaluation.compared_methods import COMPARED
from app.evaluation.method_comparison import ComparedRun, Configs, MethodTotals, tally
from app.evaluation.table_files import (
    JUDGED,
    PLACED,
    apart_text,
    csv_bytes,
    fixed,
    json_bytes,
    judged_cells,
    placed_cells,
    text_rows,
)
from app.report.result_files import zip_bytes
from app.system.hardware import machine

COUNTS = ("method", "n", "right", "fine", "wrong", "no_answer", "refused", "wrong_accepted")
TABLE = {**dict.fromkeys(COUNTS, "{}"), "index": "{:.3f}", "seconds": "{:.2f}"}
"""Columns of the table for people, with how their numbers are written."""

TITLES = {"no_answer": "none", "wrong_accepted": "wrong accepted", "index": "eq. (23)", "seconds": "median s"}

NOTES = (
    "right, fine, wrong, none (no transform found): the transform alone, held against the truth, whatever "
    "anyone says of it.",
    "refused, wrong accepted: mapmeld's verdict, laid on every method's transforms alike. It is no part of "
    "the rivals:",
    "by themselves they would hand out every wrong one.",
)


def table_rows(scores: Sequence[ComparedRun]) -> list[list[str]]:
    """Header and a row per method, as a person reads them."""
    rows: list[dict[str, Any]] = [{"method": method, **asdict(row)} for method, row in tally(scores).items()]
    for row in rows:
        if not row["judged"]:
            row |= dict.fromkeys(("right", "fine", "wrong", "no_answer", "wrong_accepted"))
    return text_rows(TABLE, rows, TITLES)


def contest_files(scores: Sequence[ComparedRun], configs: Configs, seed: int) -> dict[str, bytes]:
    """Tables, JSON and bars by name; the pictures of each case come from ``case_files``."""
    from app.evaluation.comparison_figure import bars_figure

    scores, totals = _in_order(scores), tally(scores)
    about = {
        "scores": [{"case": s.case, "method": s.method, **asdict(s.trial)} for s in scores],
        "methods": totals,
        "seed": seed,
        "settings": configs,
        "machine": machine(),
    }
    header = ("method", *MethodTotals.__dataclass_fields__)
    rows = [(method, *asdict(row).values()) for method, row in totals.items()]
    return {
        "methods.csv": csv_bytes(header, rows),
        "scores.csv": _scores_csv(scores),
        "compare.json": json_bytes(about),
        **{f"bars{suffix}": data for suffix, data in bars_figure(scores).items()},
    }


def case_files(name: str, case: Case, scores: Sequence[ComparedRun]) -> dict[str, bytes]:
    """The merged maps of one case side by side, by name."""
    from app.evaluation.comparison_figure import maps_figure

    mine = [score for score in scores if score.case == name]
    figure = maps_figure(case, mine, f"{name}, {case.observation_file}")
    return {f"maps_{name.replace('/', '_')}{suffix}": data for suffix, data in figure.items()}


def contest_archive(case: Case, scores: Sequence[ComparedRun], configs: Configs, seed: int) -> bytes:
    """A zip of the tables, bars and merged maps of one pair."""
    return zip_bytes({**contest_files(scores, configs, seed), **case_files(case.name, case, scores)})


def _scores_csv(scores: Sequence[ComparedRun]) -> bytes:
    rows = [
        (
            *(score.case, score.method, *judged_cells(run), fixed(run.index, 6), *placed_cells(run)),
            *(None if run.failed else fixed(run.seconds, 3), run.reason),
        )
        for score in scores
        for run in [score.trial]
    ]
    return csv_bytes(("case", "method", *JUDGED, "index", *PLACED, "seconds", "said"), rows)


def _in_order(scores: Sequence[ComparedRun]) -> list[ComparedRun]:
    """By case, then in the order of the table of methods: however they came."""
    order = list(COMPARED)
    return sorted(scores, key=lambda score: (score.case, order.index(score.method)))


def remarks(scores: Sequence[ComparedRun]) -> list[str]:
    """A line for each wrong merge that was accepted, and for each reason why something could not be run."""
    lines = [
        f"wrong merge accepted: {score.case}, {score.method}: "
        f"{apart_text(score.trial.distance, score.trial.angle)}"
        for score in _in_order(scores)
        if score.trial.wrong and score.trial.accepted
    ]
    failed = Counter((score.method, score.trial.reason) for score in scores if score.trial.failed)
    lines += [f"{method} could not be run on {n} of the cases: {why}" for (method, why), n in failed.items()]
    unjudged = {score.case for score in scores if score.trial.right is None and not score.trial.failed}
    if unjudged:
        lines.append(
            f"{len(unjudged)} of the cases have no truth.yaml: there, nothing is called right or wrong"
        )
    return lines
