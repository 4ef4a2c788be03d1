"""The fleets among the cases of ``mapmeld evaluate``: merged, counted, printed as a table."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from algorithms.fleets.fleet_merge import FleetResult, run_fleet
from algorithms.observations.fleet import Fleet
from app.cli.executor_flags import executor_for
from app.cli.progress_bar import bar
from app.evaluation.fleet_evaluation import EvaluatedFleet, evaluate_fleets, fleet_totals
from app.evaluation.table_files import aligned, text_rows
from app.jobs.fleet_pairs import run_pairs

FLEET_COUNTS = (
    "group",
    "fleets",
    "right",
    "refused",
    "loose",
    "wrong",
    "lies_used",
    "truths_left_out",
    "errors",
)
FLEET_COLUMNS = {**dict.fromkeys(FLEET_COUNTS, "{}"), "median_seconds": "{:.2f}"}
FLEET_TITLES = {"lies_used": "lies used", "truths_left_out": "truths left out", "median_seconds": "median s"}


@dataclass(frozen=True, eq=False)
class EvaluatedFleets:
    """What came of every fleet."""

    fleets: tuple[EvaluatedFleet, ...]

    @property
    def failed(self) -> bool:
        """Whether one could not be run, or a robot was placed wrong."""
        return any(each.error or each.wrong for each in self.fleets)

    def plain(self) -> dict[str, Any]:
        """As JSON holds it."""
        return {"fleets": [each.plain() for each in self.fleets], "totals": fleet_totals(self.fleets)}

    def lines(self) -> Iterator[str]:
        """The table, and what went wrong below it."""
        rows = [{"group": group, **counts} for group, counts in fleet_totals(self.fleets).items()]
        yield from aligned(text_rows(FLEET_COLUMNS, rows, FLEET_TITLES))
        for each in self.fleets:
            if each.error:
                yield f"failed: {each.fleet}: {each.error}"
            elif each.wrong:
                yield f"placed wrong: {each.fleet}: {', '.join(each.wrong)}"


def run_fleets(args: argparse.Namespace, folders: Sequence[Path]) -> EvaluatedFleets:
    """Merge every fleet."""
    executor = executor_for(args.jobs, args.scheduler)

    def merged(fleet: Fleet) -> FleetResult:
        *_, last = run_fleet(fleet, partial(run_pairs, executor))
        assert isinstance(last, FleetResult)
        return last

    done = evaluate_fleets(args.folder, folders, merged)
    return EvaluatedFleets(tuple(bar(iterable=done, total=len(folders), unit="fleet")))
