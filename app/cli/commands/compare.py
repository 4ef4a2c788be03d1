"""``mapmeld compare``: what several methods make of the same maps."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from algorithms.files.atomic_write import check_folder, write_files
from algorithms.files.case_folder import Case
from app.cli.argument_parser import Parser
from app.cli.executor_flags import add_workers, executor_for
from app.cli.map_arguments import case_folder
from app.cli.progress_bar import bar
from app.cli.setting_flags import add_seed, method_name
from app.evaluation.compared_methods import COMPARED
from app.evaluation.comparison_files import NOTES, case_files, contest_files, remarks, table_rows
from app.evaluation.method_comparison import compare_methods, defaults_of, pairs_in
from app.evaluation.table_files import aligned

USAGE = "DIR|CASE|SAMPLE [--methods A,B,…] [--rough] [--out DIR] [--jobs N | --scheduler ADDRESS]"
DESCRIPTION = """\
Run several methods on the same cases, at their defaults, and hold every transform against the truth.
whole-plane, which uses all that is known and needs none of it, runs without it, too: as
whole-plane-walls-alone.

Examples:
  mapmeld compare office_r2_r1       every method on one sample
  mapmeld compare cases --out compared
                                     on every case of a folder; tables and pictures go to compared/
  mapmeld compare cases --methods spectra-proven,paper-argmax --rough

The table, a row per method:
  n               cases that it could be run on
  right           its transform is within the case's tolerance (0.5 m and 3° where it names none), at
                  the seen robot
  fine            within 0.15 m and 1°
  wrong           it gave a transform that is not right; of maps that share no place, any
  none            it found no transform
  refused         mapmeld's verdict on its transforms; none included
  wrong accepted  wrong transforms that the verdict let pass
  eq. (23)        mean over the cases with a known truth; 0 where there is no transform
  median s        time of a merge, files read and code loaded before
mapmeld's verdict is laid on the transforms of all methods alike. It is no part of the rivals: by
themselves they would hand out every wrong one, so it is the column "wrong" that tells how safe they are.

Left in --out: methods.csv (that table), scores.csv (a row per case and method), compare.json (both, with
settings and machine), bars and, per case, maps: the merged maps side by side, .png and .svg.

Exit status: 0 done, 1 no method could be run on some case, 2 bad input, 130 interrupted."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument(
        "cases", metavar="DIR|CASE|SAMPLE", help="folder of cases, one case, or a sample's name"
    )
    parser.add_argument(
        "--methods",
        type=lambda text: tuple(
            dict.fromkeys(method_name(name.strip(), COMPARED) for name in text.split(","))
        ),
        default=tuple(COMPARED),
        metavar="A,B,…",
        help=f"which of them (default: all: {', '.join(COMPARED)})",
    )
    parser.add_argument("--rough", action="store_true", help="take observation_rough.yaml of each case")
    parser.add_argument("--out", type=Path, metavar="DIR", help="leave tables and pictures there")
    add_seed(parser)
    add_workers(parser, None)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Run all, print the table, leave the files; 1 where no method could be run on a case."""
    if args.out is not None:
        check_folder(args.out)
    root, configs = case_folder(args.cases, parser), defaults_of(args.methods)
    executor = executor_for(args.jobs, args.scheduler)
    n, pairs = pairs_in(root, args.rough)
    runs = compare_methods(pairs, configs, executor, args.seed)
    scores = list(bar(iterable=runs, total=n * len(configs), unit="merge"))
    print(*aligned(table_rows(scores)), "", *NOTES, *remarks(scores), sep="\n")
    if args.out is not None:
        files = contest_files(scores, configs, args.seed)
        for name, case in bar(iterable=pairs_in(root, args.rough)[1], total=n, unit="picture"):
            if isinstance(case, Case):
                files |= case_files(name, case, scores)
        write_files({args.out / name: data for name, data in files.items()})
        print(f"written to {args.out}: {', '.join(files)}")
    lost = {score.case for score in scores} - {score.case for score in scores if not score.trial.failed}
    return 1 if lost else 0
