"""What a comparison leaves behind: tables, everything as JSON, and pictures."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from math import degrees
from typing import Any

from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS
from app.evaluation.csv_tables import JUDGED, PLACED, csv_bytes, judged_cells, placed_cells, share_text
from app.evaluation.method_comparison import ComparedRun, Configs, MethodTotals, tally
from app.report.result_files import plain
from app.system.hardware import machine

TABLE = {
    "method": "{}",
    "n": "{}",
    "right": "{}",
    "fine": "{}",
    "wrong": "{}",
    "no_answer": "{}",
    "refused": "{}",
    "wrong_accepted": "{}",
    "index": "{:.3f}",
    "seconds": "{:.2f}",
}
"""Columns of the table for people, with how their numbers are written."""

TITLES = {"no_answer": "none", "wrong_accepted": "wrong accepted", "index": "eq. (23)", "seconds": "median s"}

NOTES = (
    "right, fine, wrong, none (no transform found): the transform alone, held against the truth, whatever "
    "anyone says of it.",
    "refused, wrong accepted: mapmeld's verdict, laid on every method's transforms alike. It is no part of "
    "the rivals:",
    "by themselves they would hand out every wrong one.",
)


def sorted_scores(scores: Iterable[ComparedRun]) -> list[ComparedRun]:
    """By case, then in the order of the table of methods: however they came."""
    order = list(METHODS)
    return sorted(scores, key=lambda score: (score.case, order.index(score.method)))


def table_rows(scores: Sequence[ComparedRun]) -> list[list[str]]:
    """Header and a row per method, as a person reads them."""
    rows = [[TITLES.get(name, name) for name in TABLE]]
    for method, row in tally(scores).items():
        values: dict[str, Any] = {"method": method, **asdict(row)}
        if not row.judged:
            values |= dict.fromkeys(("right", "fine", "wrong", "no_answer", "wrong_accepted"))
        rows.append(
            ["–" if values[name] is None else form.format(values[name]) for name, form in TABLE.items()]
        )
    return rows


def contest_files(scores: Sequence[ComparedRun], configs: Configs, seed: int) -> dict[str, bytes]:
    """Tables, JSON and bars by name; the pictures of each case come from ``case_files``."""
    from app.evaluation.comparison_figure import bars_figure

    told = sorted_scores(scores)
    return {
        "methods.csv": _methods_csv(tally(told)),
        "scores.csv": _scores_csv(told),
        "compare.json": _json(told, configs, seed),
        **{f"bars{suffix}": data for suffix, data in bars_figure(told).items()},
    }


def case_files(name: str, case: Case, scores: Sequence[ComparedRun]) -> dict[str, bytes]:
    """The merged maps of one case side by side, by name."""
    from app.evaluation.comparison_figure import maps_figure

    mine = [score for score in scores if score.case == name]
    figure = maps_figure(case, mine, f"{name}, {case.observation_file}")
    return {f"maps_{name.replace('/', '_')}{suffix}": data for suffix, data in figure.items()}


def _methods_csv(rows: dict[str, MethodTotals]) -> bytes:
    names = list(MethodTotals.__dataclass_fields__)
    return csv_bytes(
        ("method", *names),
        (
            (method, *("" if value is None else value for value in asdict(row).values()))
            for method, row in rows.items()
        ),
    )


def _scores_csv(scores: Sequence[ComparedRun]) -> bytes:
    rows = [
        (score.case, score.method, *judged_cells(score.trial), share_text(score.trial.index))
        + placed_cells(score.trial)
        + ("" if score.trial.failed else f"{score.trial.seconds:.3f}", score.trial.reason)
        for score in scores
    ]
    return csv_bytes(("case", "method", *JUDGED, "index", *PLACED, "seconds", "said"), rows)


def _json(scores: Sequence[ComparedRun], configs: Configs, seed: int) -> bytes:
    told = {
        "scores": [{"case": s.case, "method": s.method, **s.trial.plain()} for s in scores],
        "methods": {name: asdict(row) for name, row in tally(scores).items()},
        "seed": seed,
        "settings": configs,
        "machine": machine(),
    }
    return (json.dumps(plain(told), indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def remarks(scores: Sequence[ComparedRun]) -> list[str]:
    """A line for each wrong merge that was accepted, and for each reason why something could not be run."""
    lines = []
    for score in sorted_scores(scores):
        trial = score.trial
        if trial.wrong and trial.accepted:
            apart = "the maps share no place"
            if trial.distance is not None and trial.angle is not None:
                apart = f"{trial.distance:.2f} m and {degrees(trial.angle):.1f}° off"
            lines.append(f"wrong merge accepted: {score.case}, {score.method}: {apart}")
    failed: dict[tuple[str, str], int] = {}
    for score in scores:
        if score.trial.failed:
            key = (score.method, score.trial.reason)
            failed[key] = failed.get(key, 0) + 1
    lines += [f"{method} could not be run on {n} of the cases: {why}" for (method, why), n in failed.items()]
    unjudged = {score.case for score in scores if score.trial.right is None and not score.trial.failed}
    if unjudged:
        lines.append(
            f"{len(unjudged)} of the cases have no truth.yaml: there, nothing is called right or wrong"
        )
    return lines
