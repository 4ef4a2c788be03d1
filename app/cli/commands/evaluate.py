"""``mapmeld evaluate``: how many of many cases come out right."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

from algorithms.common.errors import OutputError
from algorithms.files.atomic_write import check_file, write_file
from algorithms.files.case_folder import FIRST_MAP_FILE, case_folders
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, PLANE_METHOD
from algorithms.simulator.rough_priors import Knowledge
from app.cli.argument_parser import Parser, did_you_mean, whole_number
from app.cli.evaluated_fleets import run_fleets
from app.cli.executor_flags import add_workers, executor_for
from app.cli.progress_bar import bar
from app.cli.setting_flags import add_method, configs_from
from app.evaluation.crossed_pairs import Pair, crossings
from app.evaluation.dataset_evaluation import (
    EvaluatedCase,
    EvaluationTask,
    calibration_of,
    evaluate,
    rough_folders,
    totals_of,
)
from app.evaluation.fleet_evaluation import fleet_folders
from app.evaluation.table_files import aligned, apart_text, json_bytes, text_rows

USAGE = (
    "DIR [--knowledge K,…] [--rough | --both] [--wrong-pairs N] [--json FILE] "
    "[--jobs N | --scheduler ADDRESS] [options]"
)
DESCRIPTION = """\
Run a method on every case folder under DIR and hold it against the truth.

Examples:
  mapmeld evaluate cases --jobs 4
  mapmeld evaluate cases --both --jobs 4 --json results.json
  mapmeld evaluate cases --rough --method paper-argmax
  mapmeld evaluate cases --knowledge sighting,initial,turn,none --wrong-pairs 700
  mapmeld evaluate cases --knowledge none --method sift

A case is a folder of map1.yaml, map2.yaml, observation.yaml and, where the answer is known,
truth.yaml; without it the case is run and not judged.
  right           within the case's tolerance (0.5 m and 3° where it names none), at the seen
                  robot; for a case with expected: refuse, refused
  fine            within 0.15 m and 1°
  first           the same of maps that share a place alone: the answer that is named is right
  first five      likewise one of the best five answers, where the method has several
  right accepted  right, and accepted: what the operator gets
  wrong accepted  accepted and not right: the number that must be 0
Below stands how true the probabilities are: of the merges told to be right with such a probability,
how many are. ECE is the mean distance of the two, Brier the mean squared error of the probability.
With --wrong-pairs the cases are crossed, too: map 1 and its observer of one, map 2 and the seen robot
of one of another building, all of which are to be refused.

With --knowledge the method is told this and nothing else, with a table for each kind:
  sighting        what the observation file says; --rough and --both choose the file
  initial         a rough initial pose: the true one with errors of 2 m and 10°, one standard deviation
  turn            a rough turn: the true one with an error of 10°
  none            nothing: there are the walls alone
The errors depend on the case's name alone: they are the same every time. Where maps share no place, they
are drawn around a pose that puts robot 2 where it was seen, turned by chance.

Folders with a fleet.yaml and its truth.yaml are merged as mapmeld fleet does it, and robots are counted:
  right           placed in the anchor's map where they truly lie
  refused, loose  not placed, though true sightings tie them to the anchor; and since none does
  wrong           placed anywhere else: the number that must be 0
  lies used, truths left out   sightings

Exit status: 0 all cases ran, 1 some case failed with an error or a robot was placed wrong, 2 bad input,
130 interrupted."""

COUNTS = (
    *("group", "n", "right", "fine", "right_first", "right_among_five", "right_accepted"),
    *("refused", "wrong_accepted", "errors"),
)
COLUMNS = {**dict.fromkeys(COUNTS, "{}"), "median_seconds": "{:.2f}"}
TITLES = {"right_first": "first", "right_among_five": "first five"}
SIGHTING: Knowledge = "sighting"
KINDS: tuple[Knowledge, ...] = get_args(Knowledge)


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of cases, or one case")
    _add_knowledge(parser)
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
    ahead = Parser(prog=parser.prog, add_help=False, strict=False)
    _add_knowledge(ahead)
    seen = SIGHTING in ahead.parse_known_args(words)[0].knowledge
    add_method(parser, words, DEFAULT_METHOD if seen else PLANE_METHOD, suits=True)


def _add_knowledge(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--knowledge",
        type=_kinds,
        default=(SIGHTING,),
        metavar="K,…",
        help=f"what the method is told, one or several of {', '.join(KINDS)} (default: {SIGHTING})",
    )


def _kinds(text: str) -> tuple[str, ...]:
    names = tuple(dict.fromkeys(name.strip() for name in text.split(",")))
    for name in names:
        if name not in KINDS:
            near = did_you_mean(name, KINDS) or f"; known are {', '.join(KINDS)}"
            raise argparse.ArgumentTypeError(f"there is no knowledge {name or 'without a name'}{near}")
    return names


@dataclass(frozen=True)
class Evaluated:
    """What came of all cases, and of the wrong pairs, with knowledge of one kind."""

    knowledge: Knowledge
    cases: list[EvaluatedCase]
    crossed: list[EvaluatedCase]

    @cached_property
    def calibration(self) -> dict[str, Any]:
        return calibration_of([*self.cases, *self.crossed])

    @cached_property
    def by_file(self) -> dict[str, list[EvaluatedCase]]:
        """The cases by the observation file that they were run with."""
        files = dict.fromkeys(case.observation for case in self.cases)
        return {file: [case for case in self.cases if case.observation == file] for file in files}


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Run all cases and fleets, print the tables; 1 where one could not be run."""
    fleets = fleet_folders(args.folder) if args.folder.is_dir() else []
    pairs = [] if fleets and not _holds_cases(args.folder) else case_folders(args.folder)
    if args.json is not None:
        check_file(args.json)
        if args.json.resolve().parent in {folder.resolve() for folder in (*pairs, *fleets)}:
            raise OutputError(args.json, "lies in the folder of a case", "choose another place for --json")
    status, answer = _run_pairs(args, parser, pairs) if pairs else (0, {})
    if fleets:
        done = run_fleets(args, fleets)
        print(*([""] if pairs else []), *done.lines(), sep="\n")
        status = max(status, int(done.failed))
        answer = {**answer, "by_fleet": done.plain()} if pairs else done.plain()
    if args.json is not None:
        write_file(args.json, json_bytes(answer))
    return status


def _holds_cases(root: Path) -> bool:
    return next(root.rglob(FIRST_MAP_FILE), None) is not None


def _run_pairs(
    args: argparse.Namespace, parser: Parser, folders: Sequence[Path]
) -> tuple[int, dict[str, Any]]:
    """Run every case, print the tables; 1 where one could not be run, and what the JSON file holds."""
    configs = configs_from(args)
    _check(args, configs, parser)
    executor = executor_for(args.jobs, args.scheduler)
    wrong = crossings(args.folder, args.wrong_pairs, args.seed) if args.wrong_pairs else []

    def cases_of(order: EvaluationTask, pairs: Sequence[Pair], unit: str) -> list[EvaluatedCase]:
        done = evaluate(order, executor, pairs)
        shown = bar(iterable=done, total=len(pairs), unit=unit, desc=order.knowledge)
        return sorted(shown, key=lambda case: case.case)

    parts = []
    for knowledge in args.knowledge:
        seen = knowledge == SIGHTING
        order = EvaluationTask(args.folder, configs, args.seed, args.rough and seen, knowledge)
        cases = cases_of(order, folders, "case")
        if args.both and seen:
            cases += cases_of(replace(order, rough=True), rough_folders(args.folder), "case")
        parts.append(Evaluated(knowledge, cases, cases_of(order, wrong, "pair") if wrong else []))
    for number, part in enumerate(parts):
        title = part.knowledge if len(parts) > 1 else ""
        print(*([""] if number else []), *_lines(part, title, args.both), sep="\n")
    failed = any(case.error for part in parts for case in (*part.cases, *part.crossed))
    return int(failed), _plain(parts, args.both)


def _check(args: argparse.Namespace, configs: Mapping[str, Any], parser: Parser) -> None:
    """An error where no method that may run can do without the sighting that is left out."""
    left_out = [kind for kind in args.knowledge if kind != SIGHTING]
    if left_out and all(METHODS[name].needs_sighting for name in configs):
        others = ", ".join(name for name, method in METHODS.items() if not method.needs_sighting)
        parser.error(
            f"{next(iter(configs))} needs a sighting, and --knowledge {left_out[0]} leaves it out; "
            f"choose a --method that does without: {others}"
        )
    if (args.rough or args.both) and SIGHTING not in args.knowledge:
        parser.error(
            f"--rough and --both choose a sighting, and --knowledge {','.join(left_out)} leaves it out; "
            "leave one of the two options out"
        )


def _plain(parts: Sequence[Evaluated], both: bool) -> dict[str, Any]:
    """What --json holds."""
    cases = [case for part in parts for case in part.cases]
    crossed = [case for part in parts for case in part.crossed]
    answer: dict[str, Any] = {"cases": [case.plain() for case in cases], "totals": totals_of(cases)}
    answer["calibration"] = calibration_of([*cases, *crossed])
    if crossed:
        answer["wrong_pairs"] = [case.plain() for case in crossed]
    for part in parts:
        if both and part.knowledge == SIGHTING:
            files = part.by_file.items()
            answer["totals_by_observation"] = {file: totals_of(found) for file, found in files}
        if len(parts) > 1:
            told = {"totals": totals_of(part.cases), "calibration": part.calibration}
            answer.setdefault("by_knowledge", {})[part.knowledge] = told
    return answer


def _lines(part: Evaluated, title: str, both: bool) -> Iterator[str]:
    """The tables of one kind of knowledge, and what stands below them."""
    for number, (file, found) in enumerate(part.by_file.items()):
        named = [title, file if both and part.knowledge == SIGHTING else ""]
        yield from [""] if number else []
        yield from [", ".join(filter(None, named))] if any(named) else []
        rows = [{"group": group, **counts} for group, counts in totals_of(found).items()]
        yield from (*aligned(text_rows(COLUMNS, rows, TITLES)), *remarks(found))
    yield from ("", *calibration_lines(part.calibration))
    if part.crossed:
        accepted = sum(case.wrong_accepted for case in part.crossed)
        failed = sum(bool(case.error) for case in part.crossed)
        yield f"wrong pairs: {len(part.crossed)}, accepted {accepted}, failed {failed}"
        yield from remarks(part.crossed)


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
