"""``mapmeld simulate``: robots that explore a building of the generator, on topics or in a recording."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from algorithms.common.errors import SettingError
from algorithms.files.atomic_write import write_file
from algorithms.files.bags.bag_path import NANO
from algorithms.files.bags.message_writing import Fields
from algorithms.simulator.buildings.building_types import BUILDINGS
from algorithms.simulator.fleets.exploration import Exploration, SlamCorrection
from algorithms.simulator.fleets.fleet_scenario import simulate_fleet
from app.cli.argument_parser import Parser, whole_number
from app.cli.live_arguments import add_dds, network_of
from app.cli.progress_bar import bar
from app.live.bag_writing import BagRecorder
from app.live.ros_link import Publication, RosLink, Topic
from app.live.simulation import PACE, fleet_text, map_of, messages_of
from app.system.clock import stamp

USAGE = "(--ros2 | --bag OUT) [--robots N] [--building KIND] [--seed N] [--speed S] [--fleet FILE] …"
DESCRIPTION = """\
Simulated robots explore a building at the same time, meet, and publish what robots publish: maps that grow,
transforms, laser scans, and where they see each other.

Examples:
  mapmeld simulate --ros2 --interface lo --fleet fleet.yaml
  mapmeld live fleet.yaml --interface lo     in another terminal: merges them by itself
  mapmeld simulate --bag recording --robots 2

Topics of a robot: /r1/map, /r1/scan, /r1/sees/r2, and /tf with r1/map → r1/base_link. They drive as soon as
somebody listens to the first of them. With --bag all of it goes into a recording of ROS 2, as fast as it
can be made.

It ends with 0 once all have driven; on topics the last maps stay there until Ctrl-C."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--ros2", action="store_true", help="publish by DDS, as robots with ROS 2 do")
    where.add_argument("--bag", type=Path, metavar="OUT", help="new folder, of the recording")
    parser.add_argument(
        "--robots", type=whole_number(2), default=3, metavar="N", help="how many (default: 3)"
    )
    kinds = ", ".join(BUILDINGS)
    about = f"kind of building: {kinds} (default: office)"
    parser.add_argument("--building", choices=tuple(BUILDINGS), default="office", metavar="KIND", help=about)
    parser.add_argument("--seed", type=int, default=3, metavar="N", help="another one, another building")
    about = "times as fast as robots drive (default: 1)"
    parser.add_argument("--speed", type=float, default=1.0, metavar="S", help=about)
    parser.add_argument("--fleet", type=Path, metavar="FILE", help="write the fleet file for mapmeld live")
    about = "after so many seconds of their time SLAM turns a robot's map, e.g. r2@40:3"
    parser.add_argument("--correct", type=_correction, metavar="ROBOT@SECONDS:DEGREES", help=about)
    parser.add_argument("--once", action="store_true", help="end when all have driven")
    add_dds(parser)


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Simulate until all have driven; the exit status."""
    if not args.speed > 0:
        raise SettingError(f"--speed is {args.speed:g}; give a number above 0")
    made = simulate_fleet(args.building, args.seed, args.robots, lies=0.0)
    if args.correct is not None and args.correct.robot not in made.robots:
        raise SettingError(f"--correct names {args.correct.robot!r}; there are {', '.join(made.robots)}")
    exploration = Exploration(made, args.correct)
    if args.fleet is not None:
        write_file(args.fleet, fleet_text(exploration.names).encode())
    names = ", ".join(exploration.names)
    print(
        f"{names} explore the {made.building.name}: {exploration.scans * PACE:.0f} s of their time",
        flush=True,
    )
    if args.bag is not None:
        with BagRecorder(args.bag) as recorder:
            _drive(exploration, recorder.write, None)
        print(f"written to {args.bag}")
        return 0
    links = network_of(args).links()
    try:
        topics = _Topics(links.link())
        print("waiting for somebody who listens", flush=True)
        topics.wait(map_of(exploration.names[0]))
        _drive(exploration, topics.send, args.speed)
        print("all have driven" + ("" if args.once else "; their maps stay until Ctrl-C"), flush=True)
        while not args.once:
            time.sleep(1.0)
    except KeyboardInterrupt:
        pass
    finally:
        links.close()
    return 0


class _Topics:
    """Sends messages on topics, which are advertised with the first one."""

    def __init__(self, link: RosLink) -> None:
        self._link = link
        self._topics: dict[Topic, Publication] = {}

    def send(self, topic: Topic, fields: Fields, _: int) -> None:
        self._publication(topic).send(fields)

    def wait(self, topic: Topic) -> None:
        """Until somebody listens to a topic: robots that met before it would have met for nobody."""
        while self._publication(topic).listeners == 0:
            time.sleep(0.1)

    def _publication(self, topic: Topic) -> Publication:
        if topic not in self._topics:
            self._topics[topic] = self._link.advertise(topic)
        return self._topics[topic]


def _drive(exploration: Exploration, send: Callable[[Topic, Fields, int], None], speed: float | None) -> None:
    """Publish scan by scan; ``speed`` times as fast as robots drive, or without waiting where None."""
    begin, start = stamp(), time.monotonic()
    with bar(total=exploration.scans, unit="scan") as shown:
        for scan in range(exploration.scans + 1):
            after = scan * PACE / (speed or 1.0)
            if speed is not None:
                time.sleep(max(0.0, start + after - time.monotonic()))
            at = begin + round(after * NANO)
            for topic, fields in messages_of(exploration, scan, at):
                send(topic, fields, at)
            shown.update(1)


def _correction(text: str) -> SlamCorrection:
    robot, _, rest = text.partition("@")
    seconds, _, degrees = rest.partition(":")
    try:
        return SlamCorrection(robot, round(float(seconds) / PACE), float(degrees))
    except (ValueError, OverflowError):
        raise argparse.ArgumentTypeError(f"{text} is not ROBOT@SECONDS:DEGREES") from None
