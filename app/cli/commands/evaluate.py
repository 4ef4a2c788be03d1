"""``mapmeld evaluate``: how many of many cases come out right."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import Any

from algorithms.common.errors import OutputError
from app.cli.argument_parser import Parser

USAGE = "DIR [--rough | --both] [--wrong-pairs N] [--json FILE] [--jobs N | --scheduler ADDRESS] [options]"
DESCRIPTION = """\
Run a method on every case folder under DIR and hold it against the truth.

Examples:
  mapmeld evaluate cases --jobs 4
  mapmeld evaluate cases --both --jobs 4 --json results.json
  mapmeld evaluate cases --rough --method paper-argmax
  mapmeld evaluate cases --wrong-pairs 700

A case is a folder of map1.yaml, map2.yaml, observation.yaml and, where the answer is known,
truth.yaml; without it the case is run and not judged.
  right           within the case's tolerance (0.5 m and 3° where it names none), at the seen
                  robot; for a case with expected: refuse, refused
  fine            within 0.15 m and 1°
  right accepted  right, and accepted: what the operator gets
  wrong accepted  accepted and not right: the number that must be 0
Below stands how true the probabilities are: of the merges told to be right with such a probability,
how many are. ECE is the mean distance of the two, Brier the mean squared error of the probability.
With --wrong-pairs the cases are crossed, too: map 1 and its observer of one, map 2 and the seen robot
of one of another building, all of which are to be refused.

Exit status: 0 all cases ran, 1 some case failed with an error, 2 bad input, 130 interrupted."""

COLUMNS = {
    "group": "{}",
    "n": "{}",
    "right": "{}",
    "fine": "{}",
    "right_accepted": "{}",
    "refused": "{}",
    "wrong_accepted": "{}",
    "errors": "{}",
    "median_seconds": "{:.2f}",
}


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    """Tell the parser what the command takes; flags of the settings depend on the method in ``words``."""
    from app.cli.executor_flags import add_workers
    from app.cli.setting_flags import add_method

    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of cases, or one case")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--rough", action="store_true", help="take observation_rough.yaml of each case")
    which.add_argument(
        "--both", action="store_true", help="run each case with either file, and print a table for each"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every report and the totals there")
    parser.add_argument(
        "--wrong-pairs",
        type=_count,
        default=0,
        metavar="N",
        help="cross the cases into N pairs of different buildings, too, with made-up sightings",
    )
    add_workers(parser, 1)
    add_method(parser, words)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Run all cases, print the table; 1 where a case could not be run."""
    from algorithms.files.atomic_write import check_file, write_file
    from algorithms.files.case_folder import case_folders
    from app.cli.executor_flags import executor_for
    from app.cli.progress_bar import bar
    from app.cli.setting_flags import config_from
    from app.evaluation.crossed_pairs import crossings
    from app.evaluation.dataset_evaluation import (
        OVERALL,
        EvaluationTask,
        calibration_of,
        evaluate,
        evaluate_both,
        is_wrong_accepted,
        rough_folders,
        totals_of,
    )

    if args.json is not None:
        check_file(args.json)
        if args.json.resolve().parent in {folder.resolve() for folder in case_folders(args.folder)}:
            raise OutputError(args.json, "lies in the folder of a case", "choose another place for --json")
    executor = executor_for(args.jobs, args.scheduler)
    order = EvaluationTask(args.folder, args.method, config_from(args), args.seed, args.rough)
    total = len(case_folders(args.folder)) + (len(rough_folders(args.folder)) if args.both else 0)
    wrong = crossings(args.folder, args.wrong_pairs, args.seed) if args.wrong_pairs else []
    told = evaluate_both(order, executor) if args.both else evaluate(order, executor)
    entries = list(bar(iterable=told, total=total, unit="case"))
    entries.sort(key=lambda entry: (str(entry["observation"]), str(entry["case"])))
    crossed: list[Any] = []
    if wrong:
        told = evaluate(order, executor, wrong)
        crossed = sorted(
            bar(iterable=told, total=len(wrong), unit="pair"), key=lambda entry: str(entry["case"])
        )
    calibration = calibration_of([*entries, *crossed])
    totals = totals_of(entries)
    by_observation = {
        file: totals_of([entry for entry in entries if entry["observation"] == file])
        for file in dict.fromkeys(entry["observation"] for entry in entries)
    }
    if args.json is not None:
        answer = {"cases": entries, "totals": totals, "calibration": calibration}
        if wrong:
            answer["wrong_pairs"] = crossed
        if args.both:
            answer["totals_by_observation"] = by_observation
        text = json.dumps(answer, indent=1, ensure_ascii=False, allow_nan=False)
        write_file(args.json, (text + "\n").encode())
    for number, (file, counts) in enumerate(by_observation.items()):
        if args.both:
            print(f"{chr(10) if number else ''}{file}")
        for line in (*table(counts), *remarks([e for e in entries if e["observation"] == file])):
            print(line)
    print()
    for line in calibration_lines(calibration):
        print(line)
    if wrong:
        accepted = [entry for entry in crossed if is_wrong_accepted(entry)]
        failed = sum("error" in entry for entry in crossed)
        print(f"wrong pairs: {len(crossed)}, accepted {len(accepted)}, failed {failed}")
        for line in remarks(crossed):
            print(line)
    return 1 if totals[OVERALL]["errors"] or any("error" in entry for entry in crossed) else 0


def table(totals: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """Lines of a table for people, a row per group."""
    from app.evaluation.csv_tables import aligned

    rows = [[name.replace("_", " ") for name in COLUMNS]]
    for group, counts in totals.items():
        values = {"group": group, **counts}
        rows.append(
            ["–" if values[name] is None else form.format(values[name]) for name, form in COLUMNS.items()]
        )
    yield from aligned(rows)


def calibration_lines(calibration: Mapping[str, Any]) -> Iterator[str]:
    """Lines of the reliability table, and what it comes to."""
    from app.evaluation.csv_tables import aligned

    rows = [["probability", "n", "mean", "right"]]
    for each in calibration["bins"]:
        numbers = ["–", "–"] if not each["n"] else [f"{each['probability']:.3f}", f"{each['right']:.3f}"]
        rows.append([f"{each['low']:g} … {each['high']:g}", str(each["n"]), *numbers])
    yield from aligned(rows)
    if calibration["n"]:
        yield f"ECE {calibration['ece']:.3f}, Brier {calibration['brier']:.3f} over {calibration['n']} merges"


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} is no whole number from 1 up")
    return int(text)


def remarks(entries: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A line for every case that a person must look at."""
    from app.evaluation.dataset_evaluation import is_wrong_accepted

    for entry in entries:
        if "error" in entry:
            yield f"failed: {entry['case']}: {entry['error']}"
        elif is_wrong_accepted(entry):
            truth = entry["truth"]
            apart = "the maps share no place"
            if truth["expected"] == "merge":
                apart = f"{truth['distance']:.2f} m and {degrees(truth['angle']):.1f}° off"
            yield f"wrong merge accepted: {entry['case']}: {apart}"
