"""Measure section IV of the paper on the samples: ``python tests/tools/results.py`` writes RESULTS.md.

Sweeps go on where an earlier run was stopped: their points are kept in out/results.
"""

from __future__ import annotations

import os
from string import Template
from time import perf_counter

import findings
from findings import Finding, Swept
from markdown_table import markdown
from repository import ROOT

from algorithms.files.atomic_write import write_files
from algorithms.files.case_folder import Case, read_case
from algorithms.methods.registry import METHODS
from algorithms.verdict.probability_model import shipped_model
from app.cli.executor_flags import executor_for
from app.cli.progress_bar import bar
from app.evaluation.comparison_files import case_files, contest_files, remarks, table_rows
from app.evaluation.method_comparison import ComparedRun, compare_methods, defaults_of, pairs_in, tally
from app.evaluation.sweep import sweep_axes as axes
from app.evaluation.sweep.checkpoint import Checkpoint
from app.evaluation.sweep.parameter_sweep import SweepPlan, in_order, point_keys, sweep
from app.evaluation.sweep.sweep_figure import sweep_figure
from app.evaluation.sweep.sweep_files import points_csv, runs_csv, times_csv
from app.jobs.executor import Executor
from app.model.settings import with_value
from app.system.hardware import machine

SAMPLES = ROOT / "sample_maps"
FIGURES = ROOT / "static" / "results"
SHOWN = ("office_r2_r1", "office_r3_r2")  # the paper, too, merges robot 2's map with 1's and 3's with 2's
SWEPT = (*SHOWN, "apartment_r2_r1", "warehouse_r3_r2")  # over particles; over the rest those shown alone
METHOD = "spectra-swarm"
PRINTED = "paper-argmax"
PAPERS_RIVALS = ("smm-only", "mse", "harris", "shi-tomasi", "surf")
SEED = 0


def main() -> None:
    """Run everything, then write everything: an interrupted run changes nothing but its journal."""
    began = perf_counter()
    executor = executor_for()
    files: dict[str, bytes] = {}
    good, rough = compared(executor, files, rough=False), compared(executor, files, rough=True)
    cases = {name: read_case(SAMPLES / name) for name in SWEPT}
    for name in SHOWN:
        pictures = case_files(name, cases[name], good)
        files |= {key: data for key, data in pictures.items() if key.endswith(".png")}
    journal = Checkpoint(ROOT / "out" / "results" / "journal.jsonl")
    planned = [(case, plan_13(case), "fig13") for case in cases.values() if case.name in SHOWN]
    planned += [(case, plan_14(case), "fig14") for case in cases.values()]
    before = sum(known_s(case, plan, journal) for case, plan, _ in planned)
    done = [swept(case, plan, executor, journal, files, figure) for case, plan, figure in planned]
    thirteen, fourteen = done[: len(SHOWN)], done[len(SHOWN) :]
    minutes = (perf_counter() - began + before / executor.jobs) / 60
    text = page(good, rough, thirteen, fourteen, minutes)
    write_files(
        {**{FIGURES / name: data for name, data in files.items()}, ROOT / "RESULTS.md": text.encode()}
    )
    print(f"written: RESULTS.md and {len(files)} files in static/results; {minutes:.1f} minutes")  # noqa: T201


def compared(executor: Executor, files: dict[str, bytes], rough: bool) -> list[ComparedRun]:
    """All methods on all samples."""
    configs = defaults_of(METHODS)
    n, pairs = pairs_in(SAMPLES, rough)
    told = compare_methods(pairs, configs, executor, SEED)
    scores = list(bar(iterable=told, total=n * len(configs), desc="rough" if rough else "good", unit="merge"))
    made = contest_files(scores, configs, SEED)
    if rough:
        made = {f"rough_{name}": data for name, data in made.items()}
    files |= {name: data for name, data in made.items() if not name.endswith(".json")}
    return scores


def plan_13(case: Case) -> SweepPlan:
    """Intensity and spread."""
    config = with_value(METHODS[METHOD].defaults, axes.PARTICLES, axes.PAPER_PARTICLES)
    return axes.intensity_and_spread(METHOD, config, case.ref.resolution)


def plan_14(case: Case) -> SweepPlan:
    """Particles."""
    config = with_value(METHODS[METHOD].defaults, axes.INTENSITY, axes.PAPER_INTENSITY)
    spread = axes.in_metres(axes.PAPER_SQUARED_CELLS, case.ref.resolution)
    return axes.particles(METHOD, with_value(config, axes.SPREAD, spread))


def known_s(case: Case, plan: SweepPlan, journal: Checkpoint) -> float:
    """What those points took that an interrupted run has left: seconds of all merges."""
    records = map(journal.get, point_keys(case, plan).values())
    return sum(trial["seconds"] for record in records if record for trial in record["trials"])


def swept(
    case: Case, plan: SweepPlan, executor: Executor, journal: Checkpoint, files: dict[str, bytes], figure: str
) -> Swept:
    """A sweep of one pair, its tables and its figure."""
    told = sweep(case, plan, executor, journal)
    points = list(bar(iterable=told, total=len(plan.places()), desc=f"{figure} {case.name}", unit="point"))
    points = in_order(plan, points)
    drawn = sweep_figure(plan, points, f"{case.name}: {METHODS[METHOD].title}", case.ref.resolution)
    files |= {f"{figure}_{case.name}{suffix}": data for suffix, data in drawn.items()}
    files[f"{figure}_{case.name}.csv"] = points_csv(plan, points)
    files[f"{figure}_{case.name}.runs.csv"] = runs_csv(plan, points)
    files[f"{figure}_{case.name}.times.csv"] = times_csv(plan, points)
    return Swept(case.name, case.ref.resolution, plan, tuple(points))


def page(
    good: list[ComparedRun],
    rough: list[ComparedRun],
    thirteen: list[Swept],
    fourteen: list[Swept],
    minutes: float,
) -> str:
    """RESULTS.md."""
    rows = tally(good)
    rivals = [name for name in PAPERS_RIVALS if name in rows]
    found = [
        findings.intensity(thirteen),
        findings.spread(thirteen),
        findings.enough_spread(thirteen),
        findings.particles(fourteen),
        findings.enough_particles(fourteen),
        findings.time(fourteen),
        findings.luck(fourteen),
        findings.best_index(rows, PRINTED, "as printed", rivals),
        findings.best_index(rows, METHOD, "with all candidates of the turn", rivals),
        findings.slower(rows, METHOD, rivals),
    ]
    return Template((ROOT / "tests" / "tools" / "results.in.md").read_text("utf-8")).substitute(
        command="make results",
        minutes=f"{minutes:.0f}",
        findings="\n".join(map(_row, found)),
        nothing=f"{findings.NEXT_TO_NOTHING:g}",
        n=len({score.case for score in good}),
        seed=SEED,
        table_good=markdown(table_rows(good)),
        table_rough=markdown(table_rows(rough)),
        ranking_good=findings.ranking(good),
        ranking_rough=findings.ranking(rough),
        passed_good=findings.let_pass(good),
        passed_rough=findings.let_pass(rough),
        deceptive=findings.deceptive(good),
        remarks="\n".join(f"- {line}." for line in remarks(good) if "could not be run" in line),
        maps="\n\n".join(
            f"![The merged maps of {name}, a panel per method](static/results/maps_{name}.png)"
            for name in SHOWN
        ),
        method=METHOD,
        particles=axes.PAPER_PARTICLES,
        blind=_blind(good, rough),
        load=_load(),
        seeds=len(thirteen[0].plan.seeds),
        thirteen="\n\n".join(_swept(sweep, "fig13", findings.spread_rows(sweep)) for sweep in thirteen),
        fourteen="\n\n".join(_swept(sweep, "fig14", findings.particle_rows(sweep)) for sweep in fourteen),
        intensity=f"{axes.PAPER_INTENSITY:g}",
        squared=axes.PAPER_SQUARED_CELLS,
        verdict=(FIGURES / "verdict.md").read_text("utf-8").strip(),
        accept_from=f"{shipped_model().accept_from:g}",
        verdict_command=shipped_model().made_of["command"],
        machine=markdown([["", ""], *([key, value] for key, value in machine().items())]).replace(
            "---:", "---"
        ),
    )


def _blind(good: list[ComparedRun], rough: list[ComparedRun]) -> str:
    """Which methods make nothing of the sighting; checked."""
    names = [name for name, method in METHODS.items() if not method.uses_observation]
    found = [
        {(score.case, score.method): score.trial.T_ref_mov for score in scores if score.method in names}
        for scores in (good, rough)
    ]
    same = "the same" if found[0] == found[1] else "NOT the same, which is a bug,"
    return f"The sighting is of no use to {', '.join(names)}: their transforms are {same} with either file."


def _load() -> str:
    """Whether the times can be trusted."""
    load, cores = os.getloadavg()[2], os.cpu_count() or 1
    if load < 1.3 * cores:
        return "Nothing else was running."
    return (
        f"Other work was running meanwhile (load {load:.1f} on {cores} cores): times are too long, and jump."
    )


def _row(finding: Finding) -> str:
    return f"| {finding.claim} | **{finding.holds}** | {finding.here} |"


def _swept(sweep: Swept, figure: str, rows: list[list[str]]) -> str:
    """A pair's figure, and its table: under a heading that opens it where the figure is shown."""
    picture = f"![{figure}, {sweep.name}](static/results/{figure}_{sweep.name}.png)\n\n"
    table = f"<details><summary>{sweep.name} as a table</summary>\n\n{markdown(rows)}\n\n</details>"
    return (picture if sweep.name in SHOWN else "") + table


if __name__ == "__main__":
    main()
