"""``mapmeld merge``: two maps and what is known of them in, a folder of files out."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import degrees
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from algorithms.common.errors import NoAnswerError, OutputError, SettingError
from algorithms.common.pose import Pose2
from algorithms.common.source_file import SourceFile
from algorithms.files.atomic_write import check_folder, write_files
from algorithms.files.map_file import YAML_SUFFIXES, parse_meta, read_bytes
from algorithms.maps.map_corrections import NO_CORRECTIONS, corrected
from algorithms.methods import registry as methods
from algorithms.methods.manual_merge import ManualMerge, known_answers
from algorithms.methods.merge_result import CHOSEN, MergeResult
from algorithms.methods.suggestions import MOST, are_wanted, suggestions_of
from app.cli.argument_parser import Parser, whole_number
from app.cli.map_arguments import add_known, add_names, add_reading, known_from, names_from, read_maps
from app.cli.output_arguments import add_frame, frame_of
from app.cli.progress_bar import result_of
from app.cli.project_argument import ALONE, opened_project, problem_of
from app.cli.setting_flags import add_method, config_from, configs_from
from app.evaluation.table_files import aligned
from app.model import verdict_text
from app.model.merge_inputs import MergeInputs
from app.model.objective_label import measure_of
from app.report.json_report import report_json, report_of, report_of_no_answer
from app.report.result_files import (
    MERGED_FILES,
    OVERLAY_FILE,
    PAGE_FILE,
    REPORT_FILE,
    TRANSFORM_FILE,
    result_files,
)
from app.report.suggestion_files import HEAD, SUGGESTION_FILES, suggestion_rows

if TYPE_CHECKING:
    from app.page.undo.page_snapshot import PageSnapshot

FILES = (*MERGED_FILES, TRANSFORM_FILE, OVERLAY_FILE, *SUGGESTION_FILES, PAGE_FILE, REPORT_FILE)

USAGE = (
    "PROJECT | MAP1 MAP2 [--observation FILE | what else is known] --out DIR [--names NAME1 NAME2] "
    "[--frame ref|mov|X,Y,YAW] [--no-yaw] [--crop] [--json] [--force] [--strict] [options]"
)
DESCRIPTION = """\
Merge two maps: from one sighting of robot 2 by robot 1 or several in one file, from a rough initial
pose, a rough turn, a place that both maps show, any of these together, or from the walls alone. A
project that was saved on the page has all of it, its settings too; what is given beside it counts more.

Examples:
  mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result
  mapmeld merge map1.yaml map2.yaml --initial 10.5 -54.8 -0.47 --sigma 1 0.17 --out result
  mapmeld merge map1.yaml map2.yaml --initial-yaw 1.57 --out result
  mapmeld merge map1.yaml map2.yaml --out result
  mapmeld merge map1.yaml map2.yaml --out result --take 2
  mapmeld merge map1.yaml map2.yaml --out result --names Bob Alice --frame mov --no-yaw
  mapmeld merge office.mapmeld --out result
  mapmeld merge left.pgm right.pgm --resolution 0.05 --observation o.yaml --out result
  mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result \\
          --augment.spread 4 --swarm.particles 800 --seed 7 --json | jq .T_ref_mov

Files in the folder of --out:
  merged.yaml, merged.pgm   the merged map, in map 1's frame or that of --frame
  transform.yaml            where map 2 lies in map 1, and the line that publishes it in ROS 2; with
                            --frame it has the merged map's frame for its parent
  report.html               all of it to read and print: verdict, pictures, numbers, settings, date
  report.json               transform, covariance, verdict, proof, times, settings; the files that
                            were read with their SHA-256, and the settings that are no defaults
  overlay.png               both maps under the transform: agreement and contradiction
A merge ends in one of three ways:
  merged         the maps lie on each other
  merged, bent   it is likely right, but no one transform lays the maps on each other everywhere: walls
                 will be double
  refused        it cannot be trusted; the reason says what speaks against it, and what would help
  suggestions.json          of a refused merge: up to five places to choose from with --take, and
                            suggestion_1.png, … what each looks like
A refused merge leaves the reports, suggestions and overlay.png alone, and where the method found no transform
at all only report.json; so does a bent one with --strict. What an earlier run left of the other files
is then removed, so that nobody takes it for this run's. How a map was read is warned of on stderr
where it looks wrong.

Exit status: 0 merged, bent or not, or taken with --take; 1 refused (with --force too), or bent with
--strict; 2 bad input; 130 interrupted."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    about = "map of robot 1, the observer: YAML or image; or a project alone"
    parser.add_argument("map1", type=Path, metavar="MAP1", help=about)
    about = "map of robot 2, the observed"
    parser.add_argument("map2", type=Path, metavar="MAP2", nargs="?", help=about)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the files")
    add_known(parser)
    add_names(parser)
    add_reading(parser)
    add_frame(parser)
    parser.add_argument("--json", action="store_true", help="print report.json and nothing else")
    about = "take answer N of those that a refused merge suggests: you know that it is right"
    parser.add_argument("--take", type=whole_number(1, MOST), metavar="N", help=about)
    parser.add_argument("--force", action="store_true", help="write the merged map of a refused merge, too")
    seen = "--observation" in [word.partition("=")[0] for word in words]
    usual = methods.DEFAULT_METHOD if seen else methods.PLANE_METHOD
    project = opened_project(words)
    add_method(parser, words, usual if project is None else project.method, suits=True)
    parser.set_defaults(project=project)
    if project is not None:
        names, frame = project.inputs.names, project.export
        place = frame.frame.array().tolist() if isinstance(frame.frame, Pose2) else frame.frame
        parser.set_defaults(seed=project.seed, names=(names.ref, names.mov))
        parser.set_defaults(frame=place, no_yaw=not frame.yaw, merged_resolution=frame.resolution)
        parser.set_defaults(crop=project.corrections.crop)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Merge, write and tell; the exit status."""
    began = perf_counter()
    names, frame = names_from(args), frame_of(args)
    if args.project is not None and args.map2 is not None:
        parser.error(ALONE)
    if args.project is None and args.map2 is None:
        parser.error("give MAP1 and MAP2, or a project alone")
    pair = replace(_pair(args), names=names)
    load_s = perf_counter() - began
    problem = problem_of(pair)
    project: PageSnapshot | None = args.project
    if project is None:
        configs = configs_from(args)
        method = methods.default_method(problem, tuple(configs))
        config = configs[method]
    else:
        method = args.method or project.method
        config = config_from(args, method, project.config if method == project.method else None)
    for warning in pair.readings():
        print(f"warning: {names.told(warning)}", file=sys.stderr)
    _check_folder(args)
    given = {"map1": args.map1, "map2": args.map2, "observation": args.observation}
    if project is not None:
        given["project"] = given.pop("map1")
    named = {key: str(path) for key, path in given.items() if path is not None}
    end, status = "", 1
    try:
        how = (problem.ref, problem.mov, pair.known, config, args.seed)
        result = result_of(methods.run_explained(method, *how))
    except NoAnswerError as refusal:
        report = report_of_no_answer(refusal, method, args.seed, config, load_s, named, pair)
        files, lines = {REPORT_FILE: report_json(report)}, [str(refusal)]
        if args.force:
            end = "--force: there is no transform to write a merged map with"
    else:
        manual = ManualMerge(problem, config, known_answers(result))
        if args.take is not None:
            result = _taken(result, manual, args.take)
        elif project is not None and project.taken and project.hand is not None:
            result = manual.weigh(project.hand, args.seed, project.taken)
        accepted = result.verdict.accepted or result.by_person
        corrections = NO_CORRECTIONS if project is None else project.corrections
        made = corrected(result.fusion, replace(corrections, crop=args.crop))
        exported = frame.given_corrected(made, result.T_ref_mov) if accepted or args.force else None
        report = report_of(result, config, load_s, named, pair, exported)
        files = result_files(result, pair, config, report, exported)
        lines, status = _summary(result, config), 0 if accepted else 1
        if exported is not None and not exported.as_merged:
            lines.append(exported.said)
        if not accepted:
            lines += _suggestions(result) if are_wanted(result) else []
            end = "no merged map was written; --force writes it all the same"
            if args.force:
                end = "--force: the merged map was written although the merge is refused"
    lines = list(map(names.told, lines))
    removed = _leave(args.out, files)
    if args.json:
        sys.stdout.write(files[REPORT_FILE].decode())
        return status
    lines.append(f"written to {args.out}: {', '.join(files)}")
    if removed:
        lines.append(f"removed from {args.out}, being of an earlier run: {', '.join(removed)}")
    print("\n".join([*lines, end] if end else lines))
    return status


def _pair(args: argparse.Namespace) -> MergeInputs:
    """The maps and what is known of them: of the project, or as the command line names them."""
    known = known_from(args)
    if args.project is not None:
        inputs: MergeInputs = args.project.inputs
        pair = inputs.knowing(known) if known else inputs
    else:
        ref, mov = read_maps(args)
        pair = MergeInputs.pair(ref, mov, name=f"{args.map1.stem} and {args.map2.stem}").knowing(known)
    return pair if args.observation is None else pair.read_from(SourceFile.at(args.observation))


def _taken(result: MergeResult, manual: ManualMerge, number: int) -> MergeResult:
    """The answer of that number, chosen by a person; raises SettingError where there is none."""
    choices = suggestions_of(result)
    if number > len(choices):
        there = "is only 1" if len(choices) == 1 else f"are only {len(choices)}"
        raise SettingError(f"--take {number}: there {there} to take; run without --take to see what there is")
    return manual.weigh(choices[number - 1].T_ref_mov, result.seed, CHOSEN)


def _suggestions(result: MergeResult) -> list[str]:
    """Lines of a table of the places to choose from."""
    rows = [list(HEAD), *suggestion_rows(suggestions_of(result))]
    return ["map 2 may lie so; --take N takes one on your word:", *aligned(rows)]


def _leave(folder: Path, files: Mapping[str, bytes]) -> list[str]:
    """Write the files, then remove those that an earlier run left; names of what was removed."""
    write_files({folder / name: data for name, data in files.items()})
    removed = []
    for name in reversed(FILES):  # what names another file goes before it
        if name in files:
            continue
        try:
            (folder / name).unlink()
        except FileNotFoundError:  # as it should be
            continue
        except OSError as error:
            raise OutputError(
                folder / name,
                f"is of an earlier run and cannot be removed ({error.strerror})",
                "this merge was refused: remove the file, do not use it",
            ) from error
        removed.append(name)
    return removed


def _check_folder(args: argparse.Namespace) -> None:
    """Raise OutputError where the result could not be left, or would take the place of an input."""
    check_folder(args.out)
    maps = [args.map1] if args.map2 is None else [args.map1, args.map2]
    inputs = [*maps, *([args.observation] if args.observation is not None else [])]
    for path in maps:
        if path.suffix.lower() in YAML_SUFFIXES:
            inputs.append(path.parent / parse_meta(str(path), read_bytes(path, "a map")).image)
    places = {os.path.realpath(args.out / name): args.out / name for name in FILES}
    for path in inputs:
        place = places.get(os.path.realpath(path))
        if place is not None:
            raise OutputError(place, "is an input of this merge", "choose another --out")


def _summary(result: MergeResult, config: Any) -> list[str]:
    """Lines for a person: the verdict, the transform, what was maximised, and what else is likely."""
    T, verdict, proof, measure = result.T_ref_mov, result.verdict, result.proof, measure_of(config)
    rival = verdict_text.rival(result)
    said = verdict_text.of_hand(result, taken=True) if result.by_person else verdict.reason
    lines = [said, *filter(None, [verdict_text.remedy(result)])]
    lines.append(f"map 2 in map 1: x {T.x:.3f} m, y {T.y:.3f} m, turned by {degrees(T.theta):.2f}°")
    if result.value is not None:
        ended = "" if proof is None else f", {verdict_text.optimum(proof)} ({proof.nodes:,} blocks bounded)"
        if result.scan is not None:
            bounded = "" if proof is None else f" ({proof.nodes:,} blocks bounded)"
            ended = f"; {verdict_text.searched(result)}{bounded}"
        elif proof is not None and result.weighed[0].moved:
            ended += ", then moved to where the whole maps fit"
        lines.append(f"{measure.name} {measure.text(result.value)}{ended}")
    if rival:
        lines.append(f"another answer: {rival} likely")
    if verdict.cleared_cells:
        lines.append(f"{verdict.cleared_cells} cells around robots were the robots themselves: floor now")
    if changed := verdict_text.resampled(result.fusion):
        lines.append(f"resampled: {changed}")
    lines.append(
        f"acceptance index {verdict.acceptance_index:.3f} "
        f"over {verdict.overlap_cells} cells ({verdict.overlap_area:.1f} m²)"
    )
    return lines
