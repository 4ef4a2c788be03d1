"""``mapmeld serve``: the page, on this machine alone unless asked otherwise."""

from __future__ import annotations

import argparse
import contextlib
import os
import socket
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.argument_parser import Parser, whole_number
from app.cli.live_arguments import add_dds, network_of
from app.cli.map_arguments import add_known, add_reading, any_known, known_from, read_maps
from app.cli.project_argument import ALONE, is_project
from app.web.security.access_control import TOKEN_VARIABLE, Access, access_for, is_local, numeric

if TYPE_CHECKING:
    from algorithms.files.case_folder import Case

LOCAL = "127.0.0.1"
PORT = 8080
FIRST_SAMPLE = "office_r2_r1"

USAGE = "[PROJECT | MAP1 MAP2 [--observation FILE | what else is known]] [--host HOST] [--port PORT] ..."
DESCRIPTION = f"""\
Open the page: two maps, the sighting, every step of the merge.

Examples:
  mapmeld serve                      a sample that ships with mapmeld
  mapmeld serve map1.yaml map2.yaml --observation observation.yaml
  mapmeld serve office.mapmeld       a project that was saved on the page
  mapmeld serve --keep work          what is done outlives the server: reload the page after it is back
  mapmeld serve --port 9000 --no-browser
  mapmeld serve --lesson my_lesson   the lesson with texts of your own, a Markdown file a step
  mapmeld serve --live --domain 7    robots that run can be followed, by ROS 2
  mapmeld serve --live --rosbridge ws://192.168.0.9:9090

  mapmeld serve --host 0.0.0.0 --certfile cert.pem --keyfile key.pem

The page is for this machine alone ({LOCAL}). At any other --host it is for those who have the
token, which is part of the address that is printed: a new one at each start, or the one in
--token-file or ${TOKEN_VARIABLE}, which holds on this machine, too. With --proxy-host it is for
those who have the token and come through the proxy of that name. Without --certfile what is sent
can be read on the network, the token with it. SECURITY.md tells more. Ctrl-C ends it."""


def add_arguments(parser: Parser, words: Sequence[str]) -> None:
    about = "map of robot 1, the observer; or a project alone"
    parser.add_argument("map1", type=Path, metavar="MAP1", nargs="?", help=about)
    parser.add_argument("map2", type=Path, metavar="MAP2", nargs="?", help="map of robot 2, the observed")
    add_known(parser)
    add_reading(parser)
    parser.add_argument("--host", default=LOCAL, help=f"address to listen at (default: {LOCAL})")
    port = whole_number(0, 65535, "is no port; give a number in [0, 65535]")
    parser.add_argument("--port", type=port, default=PORT, help=f"0 for any free one (default: {PORT})")
    parser.add_argument("--token-file", type=Path, metavar="FILE", help="holds the token to enter with")
    parser.add_argument("--certfile", type=Path, metavar="FILE", help="PEM certificate: the page is https")
    parser.add_argument("--keyfile", type=Path, metavar="FILE", help="its PEM key, if not in the same file")
    parser.add_argument(
        "--proxy-host",
        action="append",
        default=[],
        metavar="NAME",
        help="host name of a proxy in front of it, as browsers see it",
    )
    # its name in earlier versions, still taken from those who wrote it into a script
    parser.add_argument("--behind", action="append", default=[], help=argparse.SUPPRESS)
    help_ = "operator (default): maps, sighting, result; research: every setting and stage, too"
    parser.add_argument("--mode", choices=("operator", "research"), default="operator", help=help_)
    about = "folder in which the work of every tab outlives the server, even where that is killed"
    parser.add_argument("--keep", type=Path, metavar="DIR", help=about)
    about = "look for robots that run, and follow those that are added on the page; nothing is published"
    parser.add_argument("--live", action="store_true", help=about)
    about = "with --live: the server by which they are reached (pip install 'mapmeld[rosbridge]')"
    parser.add_argument("--rosbridge", default="", metavar="ADDRESS", help=about)
    add_dds(parser)
    parser.add_argument("--verbose", action="store_true", help="log who comes and what is run, too")
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")
    parser.add_argument(
        "--lesson",
        type=Path,
        metavar="DIR",
        help="folder of the lesson's texts, yours in place of those in static/lesson/en",
    )


def run(args: argparse.Namespace, parser: Parser) -> int:
    """Serve until Ctrl-C."""
    from app.cli.open_browser import browser
    from app.page.application import make_server
    from app.page.project.kept_work import KeptWork
    from app.page.project.project_file import read_project
    from app.system import logging_setup as logs
    from app.web.download import DOWNLOADS

    project = is_project(args.map1) or is_project(args.map2)
    if project and (args.map2 is not None or any_known(args)):
        parser.error(ALONE)
    if not project and (args.map1 is None) != (args.map2 is None):
        parser.error("give MAP1 and MAP2 together, or none of them for a sample")
    if args.map1 is None and any_known(args):
        parser.error("what is known is told of MAP1 and MAP2: give both maps, too")
    if not args.live and (args.domain is not None or args.interface or args.rosbridge):
        parser.error("--domain, --interface and --rosbridge tell where to look for robots: give --live, too")
    if args.behind:
        print(f"{parser.prog}: --behind is now --proxy-host", file=sys.stderr)
    proxies = (*args.proxy_host, *args.behind)
    logs.start(args.verbose)
    if args.lesson is not None:
        _check_lesson(args.lesson)
    access = access_for(args.host, args.token_file, proxies, args.certfile, args.keyfile)
    logs.hide(access.token)
    research = args.mode == "research"
    opened = read_project(args.map1) if project else _case(args)
    kept = None if args.keep is None else KeptWork(args.keep)
    network = network_of(args, args.rosbridge) if args.live else None
    server = make_server(args.host, args.port, opened, args.lesson, access, research, kept, network)
    port = server.get_port()
    url = address(args.host, port, access)
    try:
        print(f"mapmeld is at {url}   ({reach(args.host, access, proxies)}; Ctrl-C ends it)", flush=True)
        if everywhere(args.host):
            print(f"from other machines: {address(socket.gethostname(), port, access)}", flush=True)
        wanted = not args.no_browser and _has_display()
        with browser(url, secret=bool(access.token)) if wanted else contextlib.nullcontext():
            threading.Event().wait()
    except KeyboardInterrupt:
        DOWNLOADS.finish()
        server.stop()
        print()
    return 0


def address(host: str, port: int, access: Access) -> str:
    """Where a browser on this machine finds the page, with the token that lets it in."""
    named = numeric(host) or host
    shown = {"0.0.0.0": LOCAL, "": LOCAL, "::": "::1"}.get(named, named)  # of all addresses this machine's
    at = f"{'https' if access.tls else 'http'}://{f'[{shown}]' if ':' in shown else shown}:{port}/"
    return f"{at}?token={access.token}" if access.token else at


def everywhere(host: str) -> bool:
    """Whether a host stands for all addresses of this machine."""
    return (numeric(host) or host) in ("", "0.0.0.0", "::")


def reach(host: str, access: Access, proxies: Sequence[str] = ()) -> str:
    """Who may open the page, in words; ``proxies`` are the names of those in front of it."""
    if not access.token:
        return "for this machine alone"
    if not is_local(host):
        return f"for everyone on the network with the token{'' if access.tls else ', unencrypted'}"
    whom = f", and whom the proxy at {' or '.join(proxies)} lets through," if proxies else ""
    return f"for this machine{whom} with the token"


def _check_lesson(folder: Path) -> None:
    """Raise InputFileError for the first text that cannot be read: here its author sees it at once."""
    from app.page.lesson.figures.figure_registry import PICTURES
    from app.page.lesson.lesson_texts import files, read_step
    from app.page.lesson.placeholders import NUMBERS

    for path in files(folder):
        read_step(path, PICTURES, NUMBERS)


def _case(args: argparse.Namespace) -> Case | None:
    """What the page opens with: the maps that were named, else a sample; None if none is installed."""
    from algorithms.common.source_file import SourceFile
    from algorithms.files.case_folder import Case, read_case
    from algorithms.observations.observation import Observation
    from app.system.data_paths import samples

    if args.map1 is not None:
        (ref, mov), known = read_maps(args), known_from(args)
        seen = tuple(one for one in known if isinstance(one, Observation))
        priors = tuple(one for one in known if not isinstance(one, Observation))
        name = args.observation.name if args.observation is not None else ""
        read_from = SourceFile.at(args.observation) if args.observation is not None else None
        return Case(f"{ref.name} + {mov.name}", ref, mov, seen, name, None, priors, read_from)
    known = samples()
    return read_case(known.get(FIRST_SAMPLE) or next(iter(known.values()))) if known else None


def _has_display() -> bool:
    """Whether a browser window could open: a text browser in this terminal is not meant."""
    windows = sys.platform in ("darwin", "win32")
    return windows or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
