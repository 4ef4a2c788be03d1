"""``mapmeld merge``: two maps and a sighting in, a folder of files out."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from math import degrees
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from algorithms.common.errors import NoAnswerError, OutputError, SettingError
from app.cli.argument_parser import Parser

if TYPE_CHECKING:
    from algorithms.maps.grid_map import GridMap
    from algorithms.methods.merge_result import MergeResult
    from algorithms.observations.observation import Observation

USAGE = "MAP1 MAP2 --observation FILE --out DIR [--json] [--force] [--strict] [options]"
DESCRIPTION = """\
Merge two maps from one sighting of robot 2 by robot 1, or from several in one file.

Examples:
  mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result
  mapmeld merge left.pgm right.pgm --resolution 0.05 --observation o.yaml --out result
  mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result \\
          --augment.spread 4 --swarm.particles 800 --seed 7 --json | jq .T_ref_mov

Files in the folder of --out:
  merged.yaml, merged.pgm   the merged map, in map 1's frame
  transform.yaml            where map 2 lies in map 1, and the line that publishes it in ROS 2
  report.html               all of it to read and print: verdict, pictures, numbers, settings
  report.json               transform, covariance, verdict, proof, times, settings
  overlay.png               both maps under the transform: agreement and contradiction
A merge ends in one of three ways:
  merged         the maps lie on each other
  merged, bent   it is likely right, but no one transform lays the maps on each other everywhere: walls
                 will be double
  refused        it cannot be trusted; the reason says what speaks against it, and what would help
A refused merge leaves the reports and overlay.png alone, and where the method found no transform
at all only report.json; so does a bent one with --strict. What an earlier run left of the other files
is then removed, so that nobody takes it for this run's. How a map was read is warned of on stderr
where it looks wrong.

Exit status: 0 merged, bent or not, 1 refused (with --force too), or bent with --strict, 2 bad input,
130 interrupted."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    """Tell the parser what the command takes; flags of the settings depend on the method in ``words``."""
    from app.cli.setting_flags import add_method

    parser.add_argument("map1", type=Path, metavar="MAP1", help="map of robot 1, the observer: YAML or image")
    parser.add_argument("map2", type=Path, metavar="MAP2", help="map of robot 2, the observed")
    parser.add_argument("--observation", type=Path, required=True, metavar="FILE", help="what robot 1 saw")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the files")
    add_reading(parser)
    parser.add_argument("--json", action="store_true", help="print report.json and nothing else")
    parser.add_argument("--force", action="store_true", help="write the merged map of a refused merge, too")
    add_method(parser, words)


def add_reading(parser: Parser) -> None:
    """Add what says how maps are read: ``--resolution``, for images without a YAML file, and
    ``--unknown-grey``.
    """
    parser.add_argument(
        "--resolution",
        type=_resolutions,
        metavar="M[,M]",
        help="metres per pixel of maps given as plain images, whose lower-left corner is then the origin; "
        "two numbers where the maps differ; a YAML file says its own",
    )
    parser.add_argument(
        "--unknown-grey",
        type=_grey,
        metavar="G",
        help="a grey, 0 to 255, that stands for unknown in both maps, whatever their thresholds say",
    )


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Merge, write and tell; the exit status."""
    from algorithms.maps.grid_map import remarks_on
    from algorithms.methods import registry as methods
    from app.cli.progress_bar import result_of
    from app.cli.setting_flags import config_from
    from app.model.merge_inputs import MergeInputs
    from app.report.result_files import MERGED_FILES, TRANSFORM_FILE, report_json, report_of, result_files

    config = config_from(args)
    began = perf_counter()
    ref, mov, observations = read_inputs(args)
    load_s = perf_counter() - began
    warnings = remarks_on((ref, mov))
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)
    _check_folder(args)
    given = {"map1": args.map1, "map2": args.map2, "observation": args.observation}
    named = {key: str(path) for key, path in given.items()}
    try:
        result = result_of(methods.run_explained(args.method, ref, mov, observations, config, args.seed))
    except NoAnswerError as refusal:
        return _without_answer(refusal, args, config, load_s, named, warnings)
    report = report_of(result, config, load_s, named, warnings)
    accepted = result.verdict.accepted
    inputs = MergeInputs.pair(ref, mov, observations, f"{args.map1.stem} and {args.map2.stem}")
    files = result_files(result, inputs, config, report, with_merged=accepted or args.force)
    stale = [] if accepted or args.force else [*MERGED_FILES, TRANSFORM_FILE]
    removed = _leave(args.out, files, stale)
    if args.json:
        sys.stdout.write(report_json(report).decode())
    else:
        print("\n".join(_summary(result, config, args, files, removed)))
    return 0 if accepted else 1


def _without_answer(
    refusal: NoAnswerError,
    args: argparse.Namespace,
    config: Any,
    load_s: float,
    named: Mapping[str, str],
    warnings: Sequence[str],
) -> int:
    """Leave and tell why there is no transform; the exit status."""
    from app.report.result_files import (
        MERGED_FILES,
        OVERLAY_FILE,
        PAGE_FILE,
        REPORT_FILE,
        TRANSFORM_FILE,
        report_json,
        report_of_no_answer,
    )

    written = report_json(
        report_of_no_answer(refusal, args.method, args.seed, config, load_s, named, warnings)
    )
    stale = [*MERGED_FILES, TRANSFORM_FILE, OVERLAY_FILE, PAGE_FILE]
    removed = _leave(args.out, {REPORT_FILE: written}, stale)
    if args.json:
        sys.stdout.write(written.decode())
        return 1
    print(refusal)
    print(f"written to {args.out}: {REPORT_FILE}")
    if removed:
        print(f"removed from {args.out}, being of an earlier run: {', '.join(removed)}")
    if args.force:
        print("--force: there is no transform to write a merged map with")
    return 1


def read_inputs(args: argparse.Namespace) -> tuple[GridMap, GridMap, tuple[Observation, ...]]:
    """Both maps and the observations that the command line names."""
    from algorithms.files.map_file import IMAGE_SUFFIXES, read_image, read_map
    from algorithms.files.observation_file import read_observations
    from algorithms.files.thresholds import Shading

    paths, given = (args.map1, args.map2), args.resolution or ()
    plain = [path.suffix.lower() in IMAGE_SUFFIXES for path in paths]
    # one number is for the plain images among the two, two numbers are for one map each
    if given and not (all(plain) or (len(given) == 1 and any(plain))):
        raise SettingError(
            f"--resolution is given, but {paths[plain.index(False)]} is no plain image: its YAML file says "
            "its own resolution; leave --resolution out, or correct the key resolution there"
        )
    ref, mov = (
        read_image(path, resolution, shading=Shading(unknown_grey=args.unknown_grey))
        if resolution is not None and image
        else read_map(path, args.unknown_grey)
        for path, resolution, image in zip(paths, (*given, *given, None, None), plain, strict=False)
    )
    return ref, mov, read_observations(args.observation)


def _leave(folder: Path, files: Mapping[str, bytes], stale: Sequence[str]) -> list[str]:
    """Write the files, then remove what an earlier run left under the names in ``stale``."""
    from algorithms.files.atomic_write import write_files

    write_files({folder / name: data for name, data in files.items()})
    removed = []
    for name in reversed(stale):  # what names another file goes before it
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
    from algorithms.files.atomic_write import check_folder
    from algorithms.files.map_file import YAML_SUFFIXES, parse_meta, read_bytes
    from app.report.result_files import MERGED_FILES, OVERLAY_FILE, PAGE_FILE, REPORT_FILE, TRANSFORM_FILE

    check_folder(args.out)
    inputs = [args.map1, args.map2, args.observation]
    for path in (args.map1, args.map2):
        if path.suffix.lower() in YAML_SUFFIXES:
            inputs.append(path.parent / parse_meta(str(path), read_bytes(path, "a map")).image)
    names = (*MERGED_FILES, TRANSFORM_FILE, OVERLAY_FILE, PAGE_FILE, REPORT_FILE)
    places = {os.path.realpath(args.out / name): args.out / name for name in names}
    for path in inputs:
        place = places.get(os.path.realpath(path))
        if place is not None:
            raise OutputError(place, "is an input of this merge", "choose another --out")


def _summary(
    result: MergeResult,
    config: Any,
    args: argparse.Namespace,
    files: Mapping[str, bytes],
    removed: list[str],
) -> list[str]:
    from app.model import verdict_text as words
    from app.model.objective_label import measure_of

    T, verdict, proof, measure = result.T_ref_mov, result.verdict, result.proof, measure_of(config)
    lines = [verdict.reason]
    if words.remedy(result):
        lines.append(words.remedy(result))
    lines.append(f"map 2 in map 1: x {T.x:.3f} m, y {T.y:.3f} m, turned by {degrees(T.theta):.2f}°")
    if result.value is not None:
        ended = "" if proof is None else f", {words.optimum(proof)} ({proof.nodes:,} blocks bounded)"
        if proof is not None and result.weighed[0].moved:
            ended += ", then moved to where the whole maps fit"
        lines.append(f"{measure.name} {measure.text(result.value)}{ended}")
    if words.rival(result):
        lines.append(f"another answer: {words.rival(result)} likely")
    if verdict.cleared_cells:
        lines.append(f"{verdict.cleared_cells} cells around robots were the robots themselves: floor now")
    lines += [
        f"acceptance index {verdict.acceptance_index:.3f} "
        f"over {verdict.overlap_cells} cells ({verdict.overlap_area:.1f} m²)",
        f"written to {args.out}: {', '.join(files)}",
    ]
    if removed:
        lines.append(f"removed from {args.out}, being of an earlier run: {', '.join(removed)}")
    if not verdict.accepted:
        forced = any(name.startswith("merged.") for name in files)
        lines.append(
            "--force: the merged map was written although the merge is refused"
            if forced
            else "no merged map was written; --force writes it all the same"
        )
    return lines


def _grey(text: str) -> int:
    if not text.isdecimal() or int(text) > 255:
        raise argparse.ArgumentTypeError(f"{text} is no grey; give a whole number from 0 to 255")
    return int(text)


def _resolutions(text: str) -> tuple[float, ...]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 2) or not all(0 < number < float("inf") for number in numbers):
        raise argparse.ArgumentTypeError(f"{text} is neither one positive number nor two with a comma")
    return tuple(numbers)
