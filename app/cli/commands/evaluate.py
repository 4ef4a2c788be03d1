"""``mapmeld evaluate``: how many of many cases come out right."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from algorithms.common.errors import OutputError
from algorithms.files.atomic_write import check_file, write_file
from algorithms.files.case_folder import case_folders
from app.cli.argument_parser import Parser, whole_number
from app.cli.executor_flags import add_workers, executor_for
from app.cli.progress_bar import bar
from app.cli.setting_flags import add_method, config_from
from app.evaluation.crossed_pairs import Pair, crossings
from app.evaluation.dataset_evaluation import (
    OVERALL,
    EvaluatedCase,
    EvaluationTask,
    calibration_of,
    evaluate,
    rough_folders,
    totals_of,
)
from app.evaluation.table_files import aligned, apart_text, json_bytes, text_rows

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

COUNTS = ("group", "n", "right", "fine", "right_accepted", "refused", "wrong_accepted", "errors")
COLUMNS = {**dict.fromkeys(COUNTS, "{}"), "median_seconds": "{:.2f}"}


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of cases, or one case")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--rough", action="store_true", help="take observation_rough.yaml of each case")
    which.add_argument(
        "--both", action="store_true", help="run each case with either file, and print a table for each"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every report and the totals there")
    parser.add_argument(
        "--wrong-pairs",
        type=whole_number(1),
        default=0,
        metavar="N",
        help="cross the cases into N pairs of different buildings, too, with made-up sightings",
    )
    add_workers(parser, 1)
    add_method(parser, words)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Run all cases, print the table; 1 where a case could not be run."""
    folders = case_folders(args.folder)
    if args.json is not None:
        check_file(args.json)
        if args.json.resolve().parent in {folder.resolve() for folder in folders}:
            raise OutputError(args.json, "lies in the folder of a case", "choose another place for --json")
    executor = executor_for(args.jobs, args.scheduler)
    order = EvaluationTask(args.folder, args.method, config_from(args), args.seed, args.rough)
    wrong = crossings(args.folder, args.wrong_pairs, args.seed) if args.wrong_pairs else []

    def cases_of(pairs: Sequence[Pair], rough: bool, unit: str) -> list[EvaluatedCase]:
        done = evaluate(replace(order, rough=rough), executor, pairs)
        return sorted(bar(iterable=done, total=len(pairs), unit=unit), key=lambda case: case.case)

    cases = cases_of(folders, args.rough, "case")
    if args.both:
        cases += cases_of(rough_folders(args.folder), True, "case")
    crossed = cases_of(wrong, args.rough, "pair") if wrong else []
    calibration = calibration_of([*cases, *crossed])
    by_observation: dict[str, list[EvaluatedCase]] = {}
    for case in cases:
        by_observation.setdefault(case.observation, []).append(case)
    totals = {file: totals_of(found) for file, found in by_observation.items()}
    overall = totals_of(cases)
    if args.json is not None:
        answer = {"cases": [case.plain() for case in cases], "totals": overall, "calibration": calibration}
        if wrong:
            answer["wrong_pairs"] = [case.plain() for case in crossed]
        if args.both:
            answer["totals_by_observation"] = totals
        write_file(args.json, json_bytes(answer))
    for number, (file, found) in enumerate(by_observation.items()):
        if args.both:
            print(f"{chr(10) if number else ''}{file}")
        rows = [{"group": group, **counts} for group, counts in totals[file].items()]
        print(*aligned(text_rows(COLUMNS, rows)), *remarks(found), sep="\n")
    print("", *calibration_lines(calibration), sep="\n")
    if wrong:
        accepted = sum(case.wrong_accepted for case in crossed)
        failed = sum(bool(case.error) for case in crossed)
        print(
            f"wrong pairs: {len(crossed)}, accepted {accepted}, failed {failed}", *remarks(crossed), sep="\n"
        )
    return 1 if overall[OVERALL]["errors"] or any(case.error for case in crossed) else 0


def calibration_lines(calibration: Mapping[str, Any]) -> Iterator[str]:
    """Lines of the reliability table, and what it comes to."""
    rows = [["probability", "n", "mean", "right"]]
    for each in calibration["bins"]:
        numbers = ["–", "–"] if not each["n"] else [f"{each['probability']:.3f}", f"{each['right']:.3f}"]
        rows.append([f"{each['low']:g} … {each['high']:g}", str(each["n"]), *numbers])
    yield from aligned(rows)
    if calibration["n"]:
        yield f"ECE {calibration['ece']:.3f}, Brier {calibration['brier']:.3f} over {calibration['n']} merges"


def remarks(cases: Sequence[EvaluatedCase]) -> Iterator[str]:
    """A line for every case that a person must look at."""
    for case in cases:
        if case.error:
            yield f"failed: {case.case}: {case.error}"
        elif case.wrong_accepted:
            assert case.truth is not None
            off = (case.truth.distance, case.truth.angle) if case.truth.expected == "merge" else (None, None)
            yield f"wrong merge accepted: {case.case}: {apart_text(*off)}"
