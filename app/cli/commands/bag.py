"""``mapmeld bag``: what a recording holds, and its map as files."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path

from algorithms.common.display_text import show_hidden
from algorithms.files.bags.bag_summary import BagSummary, TopicSummary, read_summary
from algorithms.files.bags.map_messages import read_bag_map
from algorithms.files.map_file import write_map
from app.cli.argument_parser import Parser
from app.cli.bag_arguments import recording

USAGE = "info BAG [--json] | map BAG[#/topic][@TIME] --out FILE"
DESCRIPTION = """\
Look into a recording (a bag of ROS 1, or of ROS 2 as .db3 or .mcap; its file or its folder), or write the map
that is in it as the files that Nav2 loads. ROS is not needed.

Examples:
  mapmeld bag info robot1.bag                       topics, times, frames, and what of it mapmeld can use
  mapmeld bag map robot1.bag --out map1.yaml        the last map
  mapmeld bag map robot1_bag#/robot1/map@61.5 --out map1.yaml
                                                    that of a topic, as it was 61.5 s after the beginning

Wherever mapmeld takes a map, it takes BAG[#/topic][@TIME] as well. TIME is in seconds: since the recording
began, before its end where negative, or since 1970 (what is 100,000,000 or more)."""

INFO, MAP = "info", "map"


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    parser.add_argument("what", choices=(INFO, MAP), metavar="info|map", help="tell, or write the map")
    parser.add_argument("bag", metavar="BAG[#/topic][@TIME]", help="the recording")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="map: the YAML file to write, beside its image"
    )
    parser.add_argument("--json", action="store_true", help="info: print it as JSON and nothing else")


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Tell or write; the exit status."""
    if args.what == MAP and args.out is None:
        parser.error("--out is missing: the YAML file to write")
    if args.what == INFO and args.out is not None:
        parser.error("--out is given, and info writes nothing; leave it out")
    asked = recording(args.bag)
    if args.what == MAP:
        grid = read_bag_map(asked)
        write_map(args.out, grid)
        size = f"{grid.width} × {grid.height} cells of {grid.resolution:g} m"
        print(
            *(f"{grid.name}: {remark}" for remark in grid.remarks), f"written to {args.out}: {size}", sep="\n"
        )
        return 0
    if asked.topic or asked.time is not None:
        parser.error("info tells of a whole recording; leave out what stands behind # and @")
    summary = read_summary(asked.path)
    print(json.dumps(_as_data(summary), indent=2) if args.json else "\n".join(_lines(asked.path, summary)))
    return 0


def _as_data(summary: BagSummary) -> dict[str, object]:
    return {
        "kind": summary.kind,
        "begin": summary.begin,
        "seconds": summary.length,
        "messages": summary.messages,
        "topics": [
            {
                "name": each.topic.name,
                "type": each.topic.type,
                "messages": each.topic.count,
                "first": each.first,
                "last": each.last,
                "use": each.use,
            }
            for each in summary.topics
        ],
        "frames": summary.frames,
    }


def _lines(path: Path, summary: BagSummary) -> Iterator[str]:
    when = datetime.fromtimestamp(summary.begin, timezone.utc).strftime("%Y-%m-%d %H:%M:%S UTC")
    span = f", {summary.length:.1f} s from {when} on" if summary.messages else ""
    yield f"{path}: {summary.kind}, {summary.messages:,} messages{span}"
    used = [each for each in summary.topics if each.use]
    yield from _table([_row(each) for each in used])
    others = ", ".join(show_hidden(each.topic.name) for each in summary.topics if not each.use)
    if others:
        yield f"of no use here: {others}"
    roots = [frame for frame, parent in summary.frames.items() if parent is None]
    for root in roots:
        yield from _branch(summary.frames, root, "frames: ")
    if not any(each.use.startswith("map:") for each in used):
        yield "It holds no map (nav_msgs/OccupancyGrid)."


def _row(each: TopicSummary) -> tuple[str, ...]:
    times = ("", "") if each.first is None else (f"{each.first:.1f} s", f"{each.last:.1f} s")
    kind = each.topic.type.replace("/msg/", "/")
    return (show_hidden(each.topic.name), show_hidden(kind), f"{each.topic.count:,}", *times, each.use)


def _table(rows: list[tuple[str, ...]]) -> Iterator[str]:
    """Lines with columns below their heads."""
    if not rows:
        return
    rows = [("topic", "type", "messages", "first", "last", "use"), *rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield (
            "  "
            + "  ".join(
                cell.rjust(width) if 2 <= k <= 4 else cell.ljust(width)
                for k, (cell, width) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
        )


def _branch(frames: dict[str, str | None], root: str, indent: str) -> Iterator[str]:
    """A frame, and below it those in it."""
    yield indent + show_hidden(root)
    for child in sorted(frame for frame, parent in frames.items() if parent == root):
        yield from _branch(frames, child, " " * len(indent) + "  " if indent.strip() else indent + "  ")
