"""What a sweep leaves behind: tables and figures. All but the times are the same bytes on every run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS
from app.evaluation.sweep.parameter_sweep import SweepPlan, SweepPoint, in_order
from app.evaluation.table_files import (
    JUDGED,
    PLACED,
    csv_bytes,
    fixed,
    json_bytes,
    judged_cells,
    placed_cells,
)
from app.report.json_report import plain
from app.system.hardware import machine

JOURNAL_FILE = "journal.jsonl"


def name_of(plan: SweepPlan) -> str:
    """What the files of a sweep are called: by the settings that are swept."""
    return plan.x.name if plan.y is None else f"{plan.y.name}_by_{plan.x.name}"


def sweep_files(case: Case, plan: SweepPlan, points: Sequence[SweepPoint]) -> dict[str, bytes]:
    """The files of a finished sweep by name.

    NAME.csv       a row per point: eq. (23) over the seeds, and how many were right and accepted
    NAME.runs.csv  a row per merge, with its transform
    NAME.times.csv a row per point: seconds of a merge. They were measured: no two runs agree on them
    NAME.json      maps, method, settings, seeds, machine and versions
    NAME.png, .svg the figure; of a single setting also with the times
    """
    from app.evaluation.sweep.sweep_figure import sweep_figure

    name, points = name_of(plan), in_order(plan, points)
    about = {
        "case": case.name,
        "observation": case.observation_file,
        "index_over": "true overlap" if case.truth is not None else "overlap of the estimate",
        "method": plan.method,
        "swept": {axis.name: axis.values for axis in (plan.x, plan.y) if axis is not None},
        "seeds": plan.seeds,
        "settings": plan.config,
        "machine": machine(),
    }
    title = f"{case.name}: {METHODS[plan.method].title}"
    figures = sweep_figure(plan, points, title, case.ref.resolution)
    return {
        f"{name}.csv": points_csv(plan, points),
        f"{name}.runs.csv": runs_csv(plan, points),
        f"{name}.times.csv": times_csv(plan, points),
        f"{name}.json": json_bytes(about),
        **{f"{name}{suffix}": data for suffix, data in figures.items()},
    }


def points_csv(plan: SweepPlan, points: Iterable[SweepPoint]) -> bytes:
    """A row per point, without anything that was measured with a clock."""
    rows = []
    for point in points:
        shares = [
            None if point.index is None else fixed(getattr(point.index, name), 6)
            for name in ("mean", "deviation", "low", "high")
        ]
        counts = (point.right, point.accepted, point.failed)
        rows.append((*_at(plan, point), len(point.trials), *shares, *counts))
    index_names = ("index_mean", "index_deviation", "index_min", "index_max")
    return csv_bytes((*plan.swept[::-1], "seeds", *index_names, "right", "accepted", "failed"), rows)


def runs_csv(plan: SweepPlan, points: Iterable[SweepPoint]) -> bytes:
    """A row per merge: metres and degrees."""
    rows = [
        (*_at(plan, point), seed, fixed(trial.index, 6), *judged_cells(trial), *placed_cells(trial))
        for point in points
        for seed, trial in zip(plan.seeds, point.trials, strict=False)
    ]
    return csv_bytes((*plan.swept[::-1], "seed", "index", *JUDGED, *PLACED), rows)


def times_csv(plan: SweepPlan, points: Iterable[SweepPoint]) -> bytes:
    """A row per point: seconds of a merge, over the seeds."""
    numbers = ("mean", "median", "low", "high")
    rows = [
        (*_at(plan, point), *(fixed(getattr(point.seconds, number), 4) for number in numbers))
        for point in points
        if not point.failed
    ]
    header = ("seconds_mean", "seconds_median", "seconds_min", "seconds_max")
    return csv_bytes((*plan.swept[::-1], *header), rows)


def _at(plan: SweepPlan, point: SweepPoint) -> tuple[str, ...]:
    values = (point.x,) if plan.y is None else (point.y, point.x)
    return tuple(str(plain(value)) for value in values)
