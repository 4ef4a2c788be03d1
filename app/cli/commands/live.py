"""``mapmeld live``: robots that run, one map of them that grows."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from algorithms.common.errors import MapMergeError, SettingError
from algorithms.files.atomic_write import check_folder, write_files
from algorithms.files.bags.message_types import GRID, SEEN, TRANSFORMS
from algorithms.files.fleet_file import FLEET_FILE, MOST_BYTES, fleet_parts, fleet_to_bytes
from algorithms.files.map_file import map_to_bytes, read_bytes
from algorithms.fleets.live_answer import LiveAnswer
from app.cli.argument_parser import Parser
from app.cli.end_signals import end_signals
from app.cli.live_arguments import add_dds, network_of
from app.cli.output_arguments import check_apart
from app.evaluation.table_files import aligned
from app.live.live_fleet_file import LiveFleet, read_live_fleet
from app.live.live_publisher import MAP, LivePublisher
from app.live.live_run import LiveRun
from app.live.search_thread import SearchThread
from app.live.watch.published_maps import FIND_WITHIN
from app.report.fleet_files import TRANSFORMS_FILE, exported_maps, remove_other_islands, transforms_yaml

USAGE = (
    "(FLEET | --list) [--publish [TOPIC]] [--save-every SECONDS --out DIR] [--sightings DIR] [--domain N] …"
)
DESCRIPTION = """\
Merge the maps of robots that run, and go on while the maps grow. ROS need not be installed.

Examples:
  mapmeld live --list                        which maps are published
  mapmeld live fleet.yaml                    listen, and tell what becomes of it
  mapmeld live fleet.yaml --publish          tell the robots, too
  mapmeld live fleet.yaml --save-every 30 --out result

The file names the robots as that of mapmeld fleet does, with a topic in the place of the map:
  robots:
    r1: {topic: /r1/map, sees: {r2: /r1/sees/r2}}
    r2: {topic: /r2/map, base: r2/base_footprint}
    r3: {topic: /map, rosbridge: 'ws://192.168.0.9:9090'}
    r4: {map: r4.yaml}                       a robot that has done its work
base is the robot's own frame (NAME/base_link), tf the topic of its transforms (/tf); the frame of its map is
the one in the message. sees names topics of geometry_msgs/PoseWithCovarianceStamped: where another robot is,
in any frame of this one. sightings and known may stand in the file, too.

Of each robot the newest map is looked at once a second. What was found is held against it; it is searched
anew when it falls, or a sighting comes. A map that SLAM has moved or turned is noticed. What no longer holds
is taken back, and told.

rosbridge reaches robots with ROS 1, or behind a firewall (pip install 'mapmeld[rosbridge]').

Nothing is published without --publish. With it, wherever the robots are reached: the merged
nav_msgs/OccupancyGrid, latched, on /tf_static where the map of each placed robot lies in that of the anchor,
and /diagnostics every second.

--out leaves merged.yaml and merged.pgm, transforms.yaml, and the robots' maps and sightings as a fleet that
mapmeld fleet takes, and from which --resume goes on.

It ends with Ctrl-C, and with 0, once what there is has been saved."""

USES = {
    GRID: "topic: of a robot",
    TRANSFORMS[0]: "tf: of a robot",
    SEEN: "sees: of a robot",
}
PAUSE = 0.05  # seconds between two looks at what has come


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    about = "fleet file, or a folder with one"
    parser.add_argument("fleet", type=Path, nargs="?", metavar="FLEET", help=about)
    about = "tell what is published, maps first, and end; needs no FLEET"
    parser.add_argument("--list", action="store_true", help=about)
    about = f"publish the merged map (on TOPIC; default: {MAP}), the robots' frames, and diagnostics"
    parser.add_argument("--publish", nargs="?", const=MAP, metavar="TOPIC", help=about)
    about = "observation files that are put into DIR count: r2_saw_r1.yaml, r2_saw_r1_again.yaml"
    parser.add_argument("--sightings", type=Path, metavar="DIR", help=about)
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder for merged.yaml and the rest")
    about = "write them so often, whole or not at all (default: at the end alone)"
    parser.add_argument("--save-every", type=float, metavar="SECONDS", help=about)
    about = "begin with the sightings that an earlier run has left in the folder of --out"
    parser.add_argument("--resume", action="store_true", help=about)
    parser.add_argument("--for", type=float, dest="seconds", metavar="SECONDS", help="end after so long")
    add_dds(parser)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Listen until it is ended; the exit status."""
    if args.list:
        return _list(args)
    if args.fleet is None:
        raise SettingError("FLEET is missing: the fleet file; --list tells the topics that may stand in it")
    _check(args)
    fleet = read_live_fleet(args.fleet)
    if args.resume:
        fleet = _resumed(fleet, args.out)
    links, search = network_of(args).links(), SearchThread()
    try:
        search.warm_up()
        live = LiveRun(fleet, links.link, search, args.sightings)
        robots = fleet.robots.values()
        ways = {each.bridge for each in robots if each.grid is None} if args.publish else ()
        publishers = [LivePublisher(links.link(address), args.publish) for address in sorted(ways)]
        names = ", ".join(live.names)
        print(f"listening to {names}; {'publishing' if publishers else 'publishing nothing'}", flush=True)
        _listen(args, live, publishers)
    finally:
        search.close()
        links.close()
    return 0


def _check(args: argparse.Namespace) -> None:
    """Raise SettingError for flags that do not go together, OutputError where nothing may be written."""
    if args.save_every is not None and (args.out is None or not args.save_every > 0):
        raise SettingError("--save-every needs seconds above 0, and --out DIR to write to")
    if args.resume and args.out is None:
        raise SettingError("--resume needs --out DIR: the folder of the run before")
    if args.out is not None:
        check_folder(args.out)
        check_apart(args.out, args.fleet)


def _list(args: argparse.Namespace) -> int:
    """Tell the topics of use that are published; 1 where there is no map among them."""
    links = network_of(args).links()
    link = links.link()
    time.sleep(FIND_WITHIN)
    published = link.published()
    links.close()
    rows = []
    for topic, count in sorted(published.items(), key=lambda each: (each[0].type != GRID, each[0].name)):
        if topic.type in USES:
            lost = topic.type == GRID and not topic.latched
            use = "a map, but not transient-local: SLAM's own is" if lost else USES[topic.type]
            rows.append([topic.name, topic.type.replace("/msg/", "/"), f"{count}", use])
    if rows:
        print(*aligned([["topic", "type", "publishers", "use"], *rows]), sep="\n")
    maps = sum(topic.type == GRID for topic in published)
    print(f"{maps or 'no'} maps among {len(published)} topics of ROS 2 in this domain")
    return 0 if maps else 1


def _listen(args: argparse.Namespace, live: LiveRun, publishers: Sequence[LivePublisher]) -> None:
    begin = saved = time.monotonic()
    unsaved: LiveAnswer | None = None
    with end_signals() as come:
        while not come and (args.seconds is None or time.monotonic() - begin < args.seconds):
            now = time.monotonic()
            update = live.step(now)
            answer = update.answer
            for event in (*update.events, *(answer.events if answer else ())):
                print(f"{now - begin:8.1f} s  {event.robot}: {event.kind}: {event.said}", flush=True)
            for publisher in publishers:
                publisher.publish(live, answer, now)
            unsaved = answer or unsaved
            if args.save_every is not None and unsaved is not None and now - saved >= args.save_every:
                saved, unsaved = now, _save(args.out, unsaved)
            time.sleep(PAUSE)
    if args.out is not None and live.answer.result is not None:
        _save(args.out, live.answer)
        print(f"written to {args.out}")


def _save(out: Path, answer: LiveAnswer) -> LiveAnswer | None:
    """Write what stands; the answer again where it could not be written, to be tried again."""
    if answer.result is None or answer.fleet is None:
        return None
    files: dict[str, bytes] = {}
    exported = exported_maps(answer.result)
    for stem, each in exported.items():
        files |= map_to_bytes(each.cells.grid, stem)
    files[TRANSFORMS_FILE] = transforms_yaml(answer.result)
    names = {name: f"robot_{number}" for number, name in enumerate(answer.fleet.maps, 1)}
    for name, grid in answer.fleet.maps.items():
        files |= map_to_bytes(grid, names[name])
    files[FLEET_FILE] = fleet_to_bytes(answer.fleet, {name: f"{stem}.yaml" for name, stem in names.items()})
    try:
        write_files({out / name: data for name, data in files.items()})
        remove_other_islands(out, exported)
    except MapMergeError as error:
        print(f"warning: {error}", flush=True)
        return answer
    return None


def _resumed(fleet: LiveFleet, out: Path) -> LiveFleet:
    """With the sightings that were saved there, of robots that are still in it."""
    file = out / FLEET_FILE
    saved = fleet_parts(str(file), read_bytes(file, "a saved fleet", MOST_BYTES)).sightings
    known = [each for each in saved if {each.observer, each.observed} <= set(fleet.robots)]
    more = (each for each in known if each not in fleet.sightings)
    return replace(fleet, sightings=(*fleet.sightings, *more))
