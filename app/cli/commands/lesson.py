"""``mapmeld lesson``: the whole lesson on a pair of maps, as one page to print and hand out."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from algorithms.common.errors import SettingError
from algorithms.files.atomic_write import check_file, write_file
from app.cli.argument_parser import Parser, whole_number
from app.cli.map_arguments import add_known, add_names, add_reading, pair_inputs
from app.cli.progress_bar import bar
from app.page.lesson.handout import handout_page, numbered_steps
from app.page.lesson.lesson_texts import files, lesson_folder
from app.page.lesson.whole_lesson import whole_lesson

USAGE = "[CASE | MAP1 MAP2 --observation FILE] --out FILE.html [options]"
DESCRIPTION = """\
Write the whole lesson as one HTML page: every step with its words, equations and picture, made of
the maps that are named, then what there is to try, the answers, and the table of symbols. It needs
no network, and prints well: in a browser, Print, Save as PDF.

Examples:
  mapmeld lesson --out handout.html            of the sample office_r2_r1
  mapmeld lesson corridor_r3_r2 --out handout.html
  mapmeld lesson map1.yaml map2.yaml --observation observation.yaml --out handout.html
  mapmeld lesson --texts my_lesson --out handout.html
                                               with texts of your own, a Markdown file a step

Seven pairs are merged for it: the maps, and those that steps 17 and 18 compare.

Exit status: 0 written; 1 the maps have no transform at all to show, and nothing is written; 2 bad
input; 130 interrupted."""

SAMPLE = "office_r2_r1"
HTML_SUFFIXES = (".html", ".htm")


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    about = "a sample's name or a case folder; or a map (default: %(default)s)"
    parser.add_argument("first", metavar="CASE|MAP1", nargs="?", default=SAMPLE, help=about)
    parser.add_argument("map2", type=Path, metavar="MAP2", nargs="?", help="map of robot 2, the observed")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.html", help="the page to write")
    about = "folder of the lesson's texts, yours in place of those in static/lesson/en"
    parser.add_argument("--texts", type=Path, metavar="DIR", help=about)
    about = "random seed of the merges (default: 0)"
    seed = whole_number(0, 2**31 - 1, "is no seed; give a whole number from 0 on")
    parser.add_argument("--seed", type=seed, default=0, metavar="N", help=about)
    add_known(parser)
    add_names(parser)
    add_reading(parser)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Merge, draw, write; the exit status."""
    if args.out.suffix.lower() not in HTML_SUFFIXES:
        parser.error(f"--out is {args.out}; let its name end in .html, or no browser will open it")
    steps = numbered_steps(files(args.texts or lesson_folder()))
    inputs = pair_inputs(args, parser)
    if not inputs.sighted:
        raise SettingError("the lesson is about two maps and a sighting; give --observation FILE")
    check_file(args.out)
    with bar(total=1.0, bar_format="{desc}|{bar}| {percentage:3.0f}% {elapsed}") as shown:

        def tell(done: float, what: str) -> None:
            shown.set_description_str(what)
            shown.update(max(0.0, done - shown.n))

        lesson = whole_lesson(inputs, {step.picture for step in steps.values()}, args.seed, tell)
        page = handout_page(lesson, steps)
    write_file(args.out, page)
    print(f"written to {args.out}: {len(steps)} steps, {len(page) / 1000:,.0f} kB")
    return 0
