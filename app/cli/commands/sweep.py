"""``mapmeld sweep``: what one or two settings do to the result, over several seeds."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from algorithms.files.atomic_write import check_folder, write_files
from algorithms.files.case_folder import Case, read_case
from app.cli.argument_parser import Parser, whole_number
from app.cli.executor_flags import add_workers, executor_for
from app.cli.map_arguments import case_folder
from app.cli.progress_bar import bar
from app.cli.setting_flags import add_method, config_from
from app.evaluation.sweep import sweep_axes as axes
from app.evaluation.sweep.checkpoint import Checkpoint
from app.evaluation.sweep.parameter_sweep import SweepPlan, SweepPoint, done_before, outdated, sweep
from app.evaluation.sweep.sweep_files import JOURNAL_FILE, name_of, sweep_files
from app.model.settings import with_value

SWARM = "spectra-swarm"  # the paper's method, whose settings the paper sweeps
SEEDS = 10

USAGE = "CASE [--x RANGE [--y RANGE]] [--out DIR] [--seeds N] [--jobs N | --scheduler ADDRESS] [options]"
DESCRIPTION = """\
Merge one pair again and again while a setting changes: Figs. 13 and 14 of the paper, or any other.
Without --x both of the paper's: eq. (23) over intensity and spread at 200 particles; eq. (23) and time
over the number of particles at intensity 100 and a spread of 105 squared cells.

Examples:
  mapmeld sweep office_r2_r1         the paper's two sweeps on a sample, into sweep_office_r2_r1/
  mapmeld sweep cases/lab --x augment.spread=1:8:8
  mapmeld sweep cases/lab --x swarm.particles=20:2000:9:log --y refine.optimiser=pso,mco --out swarm
  mapmeld sweep cases/lab --method spectra-proven --x verdict.accept_from=0.5,0.7,0.9

A range is NAME=LOW:HIGH:COUNT in equal steps, NAME=LOW:HIGH:COUNT:log by equal factors, or
NAME=V1,V2,…; names are those of the flags below. Each point is merged with --seeds seeds.

Left in --out, named by the settings: .csv a row per point, .runs.csv a row per merge, .times.csv what the
clock said, .json all settings and the machine, .png and .svg the figure. Every point done is kept in
journal.jsonl there: a sweep that was stopped goes on where it was, and ends with the same files, byte
for byte, but for the times (.times.csv, and the figure of a single setting, which shows them). The
journal knows maps, settings, seeds and versions: what no longer applies is done again.

Exit status: 0 done, 1 some point could not be run, 2 bad input, 130 interrupted."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("case", metavar="CASE", help="a sample's name, or the folder of a case")
    parser.add_argument("--x", metavar="RANGE", help="the setting that is swept")
    parser.add_argument("--y", metavar="RANGE", help="a second one: all of its values with all of the first")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where the files go (default: sweep_CASE)")
    parser.add_argument("--rough", action="store_true", help="take the case's observation_rough.yaml")
    hint = f"merges per point (default: {SEEDS})"
    parser.add_argument("--seeds", type=whole_number(1, 1000), default=SEEDS, metavar="N", help=hint)
    add_workers(parser, None)
    add_method(parser, words, SWARM)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Sweep, write, tell; the exit status."""
    if args.y is not None and args.x is None:
        parser.error("--y is a second setting; give --x, too")
    case = read_case(case_folder(args.case, parser), args.rough)
    out = args.out or Path(f"sweep_{case.name}")
    check_folder(out)
    plans = _plans(args, case)
    executor = executor_for(args.jobs, args.scheduler)
    journal = Checkpoint(out / JOURNAL_FILE)
    written: list[str] = []
    failed = 0
    for plan in plans:
        points = []
        total, done = len(plan.places()), done_before(case, plan, journal)
        if done:
            print(f"{name_of(plan)}: {done} of {total} points are known from before")
        if why := outdated(case, plan, journal):
            print(f"{name_of(plan)}: {why}")
        try:
            with bar(total=total, initial=done, unit="point") as shown:
                for point in sweep(case, plan, executor, journal):
                    points.append(point)
                    shown.update(len(points) > done)
        except KeyboardInterrupt:
            kept = done_before(case, plan, journal)
            print(f"{name_of(plan)}: {kept} of {total} points are kept; the same command goes on there")
            raise
        files = sweep_files(case, plan, points)
        write_files({out / name: data for name, data in files.items()})
        written += files
        failed += sum(bool(point.failed) for point in points)
        print(*_summary(plan, points), sep="\n")
    print(f"written to {out}: {', '.join(written)}")
    return 1 if failed else 0


def _plans(args: argparse.Namespace, case: Case) -> list[SweepPlan]:
    """What is asked for; the paper's two unless told otherwise."""
    config, seeds = config_from(args), tuple(range(args.seed, args.seed + args.seeds))
    if args.x is not None:
        x = axes.axis_from(args.x, config)
        y = None if args.y is None else axes.axis_from(args.y, config)
        return [SweepPlan(args.method, config, x, y, seeds)]
    cell = case.ref.resolution
    first = _fixed(args, config, {axes.PARTICLES: axes.PAPER_PARTICLES})
    spread = axes.in_metres(axes.PAPER_SQUARED_CELLS, cell)
    second = _fixed(args, config, {axes.INTENSITY: axes.PAPER_INTENSITY, axes.SPREAD: spread})
    return [
        axes.intensity_and_spread(args.method, first, cell, seeds),
        axes.particles(args.method, second, seeds),
    ]


def _fixed(args: argparse.Namespace, config: Any, paper: dict[tuple[str, ...], Any]) -> Any:
    """The settings with the paper's values, where the command line names no others."""
    for path, value in paper.items():
        name = ".".join(path)
        axes.setting_named(name, config)  # a method without it says so
        if getattr(args, name) is None:
            config = with_value(config, path, value)
    return config


def _summary(plan: SweepPlan, points: Sequence[SweepPoint]) -> list[str]:
    """What a person wants to know first: where it is best, and what went wrong."""
    found = [(point.index, point) for point in points if point.index is not None]
    lines = [f"{name_of(plan)}: {len(points)} points of {len(plan.seeds)} seeds"]
    for word, pick in (("most", max), ("least", min)) if found else ():
        index, point = pick(found, key=lambda each: each[0].mean)
        judged = "" if point.right is None else f", {point.right} of {len(point.trials)} right"
        lines.append(
            f"  {word:>5} agreement, eq. (23): {index.mean:.4f} ± {index.deviation:.4f} "
            f"at {_place(plan, point)}{judged}, {point.seconds.median:.2f} s a merge"
        )
    reasons = dict.fromkeys(point.failed for point in points if point.failed)
    return [*lines, *(f"  could not be run: {reason}" for reason in reasons)]


def _place(plan: SweepPlan, point: SweepPoint) -> str:
    values = zip(plan.swept, (point.x, point.y), strict=False)
    return ", ".join(
        f"{name} {value:g}" if isinstance(value, float) else f"{name} {value}" for name, value in values
    )
