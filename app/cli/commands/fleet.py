"""``mapmeld fleet``: any number of robots, their maps and sightings in, one map out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from math import degrees
from pathlib import Path
from typing import Any

from algorithms.files.atomic_write import check_folder, write_files
from algorithms.files.fleet_file import FLEET_FILE, read_fleet
from algorithms.fleets.fleet_merge import FleetResult, PairStep
from algorithms.fleets.pair_hypotheses import aligned_priors
from algorithms.observations.fleet import Fleet
from app.cli.argument_parser import Parser
from app.cli.executor_flags import add_workers, executor_for
from app.cli.output_arguments import add_output, check_apart, frame_of
from app.cli.progress_bar import bar
from app.cli.project_argument import is_project, opened_fleet
from app.evaluation.table_files import aligned
from app.jobs.fleet_pairs import run_pairs
from app.model import verdict_text
from app.model.fleet_state import FleetState
from app.report.export_frame import changes_text
from app.report.fleet_files import exported_maps, fleet_files, remove_other_islands
from app.report.fleet_report import summary
from app.report.result_files import REPORT_FILE

USAGE = "FLEET --out DIR [--frame ROBOT] [--no-yaw] [--force] [--json] [--jobs N | --scheduler ADDRESS]"
DESCRIPTION = f"""\
Merge the maps of any number of robots, from whatever sightings there are between them.

Examples:
  mapmeld fleet fleet.yaml --out result
  mapmeld fleet folder --out result          a folder that holds {FLEET_FILE}
  mapmeld fleet fleet.mapmeld --out result   a project that the page has saved, with what was found of it

The file names the robots and their maps, and who saw whom:
  anchor: r1                                 whose frame the result is in; else the first robot's
  robots:
    r1: {{map: r1.yaml}}
    r2: {{map: r2.yaml}}
  sightings:
    - observer: {{robot: r1, pose: [31.2, 2.7, 2.964]}}
      observed: {{robot: r2, pose: [24.8, 34.6]}}
      measurement: {{range: 2.97, bearing: 0.406}}
  known:                                     what else is known of two: initial, turn or near; or left out
    - {{of: r2, in: r1, turn: {{yaw: 0.1, sigma: 0.1}}}}

Files in the folder of --out:
  merged.yaml, merged.pgm   the map of all robots that are tied to the anchor, in its frame
  merged_island2.yaml, …    the maps of robots that are tied to each other alone
  transforms.yaml           where every robot's frame lies, and the line that publishes it in ROS 2
  graph.g2o                 the pose graph, for other tools
  report.html, report.json  the graph over the map; robots, sightings and pairs, with probability and reason

A sighting that contradicts the rest is named and left out. A robot that nothing ties to the anchor is not
placed: no guess is made. With --force the likeliest answers are taken, however
unlikely they are, and said to be unlikely.

Exit status: 0 every robot is placed, 1 some are not (what was placed is written), 2 bad input,
130 interrupted."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument(
        "fleet", type=Path, metavar="FLEET", help="fleet file, a folder with one, or a project"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the files")
    parser.add_argument("--force", action="store_true", help="place robots however unlikely that is")
    parser.add_argument("--json", action="store_true", help="print report.json and nothing else")
    about = "the robot whose frame the merged map is in, in place of the file's anchor"
    add_output(parser, dest="anchor", metavar="ROBOT", help=about)
    add_workers(parser, None)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Merge, write and tell; the exit status."""
    check_folder(args.out)
    frame = frame_of(args)
    state = opened_fleet(args.fleet) if is_project(args.fleet) else FleetState(read_fleet(args.fleet))
    if args.anchor is not None:
        state = state.anchored(args.anchor)
    fleet = state.fleet
    check_apart(args.out, args.fleet)
    for name, grid in fleet.maps.items():
        for remark in grid.remarks:
            print(f"warning: {name}'s map ({grid.name}): {remark}.", file=sys.stderr)
    executor = executor_for(args.jobs, args.scheduler)
    result = _with_bar(state.merged(partial(run_pairs, executor), args.force))
    name = args.fleet.resolve().name if args.fleet.is_dir() else args.fleet.stem
    exported = exported_maps(result, frame)
    files = fleet_files(fleet, result, name, exported)
    write_files({args.out / file: data for file, data in files.items()})
    remove_other_islands(args.out, exported)
    if args.json:
        sys.stdout.write(files[REPORT_FILE].decode())
    else:
        print(summary(result, len(fleet.maps)), *_robots(result), *_left_out(fleet, result), sep="\n")
        if not frame.as_merged:
            print(*(f"{stem}.yaml: {changes_text(each.cells)}" for stem, each in exported.items()), sep="\n")
        print(f"written to {args.out}: {', '.join(files)}")
    return 0 if result.whole else 1


def _with_bar(steps: Iterator[Any]) -> FleetResult:
    with bar(unit="pair") as shown:
        for step in steps:
            if isinstance(step, PairStep):
                shown.total = step.total
                shown.update(step.done - shown.n)
            else:
                result = step
    return result


def _robots(result: FleetResult) -> list[str]:
    """A table of all robots."""
    rows = [["robot", "map", "x (m)", "y (m)", "turn", "likely"]]
    for number, island in enumerate(result.islands, 1):
        for name, T in island.poses.items():
            alone = number > 1 and len(island.poses) == 1
            likely = "–" if alone else verdict_text.likelihood(island.probability[name])
            where = "merged" if number == 1 else "alone" if alone else f"island {number}"
            rows.append([name, where, f"{T.x:.3f}", f"{T.y:.3f}", f"{degrees(T.theta):.2f}°", likely])
    return aligned(rows)


def _left_out(fleet: Fleet, result: FleetResult) -> list[str]:
    """Sightings, and what else is known, that nothing rests on."""
    said = [f"sighting {each.number + 1} is left out: {each.reason}" for each in result.left_out]
    priors = {(told.ref, told.mov) for told in aligned_priors(fleet)}
    for number, finding in enumerate(result.findings):
        order = finding.order
        if not order.sightings and (order.ref, order.mov) in priors and number not in result.chosen:
            said.append(f"what is known of {order.mov} in {order.ref} is left out: {finding.said}")
    return said
