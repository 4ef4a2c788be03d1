"""``mapmeld replay``: a merge as one HTML page that plays offline."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from algorithms.files.atomic_write import check_file, write_file
from algorithms.methods import registry as methods
from algorithms.observations.pair_problem import PairProblem
from app.cli.argument_parser import Parser
from app.cli.map_arguments import add_known, add_names, add_reading, pair_inputs
from app.cli.progress_bar import with_bar
from app.cli.setting_flags import add_method, configs_from
from app.report.replay.html_page import ReplayMetadata, replay_html
from app.report.replay.recorder import record

USAGE = (
    "{CASE | MAP1 MAP2 [--observation FILE | what else is known]} --out FILE.html "
    "[--names NAME1 NAME2] [options]"
)
DESCRIPTION = """\
Merge two maps and save the run as one HTML page: maps, candidates, swarm, proof and verdict play
again in any browser, without a network and without mapmeld. For a talk, a lesson, a report.

Examples:
  mapmeld replay office_r2_r1 --out merge.html
                                     a sample that ships with mapmeld, or the folder of a case
  mapmeld replay map1.yaml map2.yaml --observation observation.yaml --out merge.html
  mapmeld replay office_r2_r1 --out paper.html --method paper-argmax --seed 7

The same maps, settings and seed give the same file. In the page: space plays and pauses,
the arrow keys go from step to step.

Exit status: 0 written, whether the maps were merged or refused; 1 refused without any transform to
show, and nothing written; 2 bad input; 130 interrupted."""

HTML_SUFFIXES = (".html", ".htm")


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("first", metavar="CASE|MAP1", help="a sample's name or a case folder; or a map")
    parser.add_argument("map2", type=Path, metavar="MAP2", nargs="?", help="map of robot 2, the observed")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.html", help="the page to write")
    add_known(parser)
    add_names(parser)
    add_reading(parser)
    add_method(parser, words, suits=True)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Merge, record, write; the exit status."""
    if args.out.suffix.lower() not in HTML_SUFFIXES:
        parser.error(f"--out is {args.out}; let its name end in .html, or no browser will open it")
    inputs = pair_inputs(args, parser)
    check_file(args.out)
    assert inputs.ref is not None
    assert inputs.mov is not None
    configs = configs_from(args)
    problem = PairProblem.of(inputs.ref, inputs.mov, inputs.known)
    method = methods.default_method(problem, tuple(configs))
    config = configs[method]
    steps = methods.run(method, inputs.ref, inputs.mov, inputs.known, config, args.seed)
    recording = record(with_bar(steps), inputs, config)
    page = replay_html(recording, ReplayMetadata(inputs, method, config, args.seed))
    write_file(args.out, page)
    print(recording["verdict"])
    print(f"written to {args.out}: {len(page) / 1000:,.0f} kB, {recording['length']:.0f} s")
    return 0
