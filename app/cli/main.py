"""The command line: parse, call, print. Each command imports what it needs only when it runs."""

from __future__ import annotations

import errno
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from io import UnsupportedOperation

from algorithms.common.errors import MapMergeError, NoAnswerError
from app.cli.argument_parser import Parser, did_you_mean

PROG = "mapmeld"

EXIT_REFUSED = 1
EXIT_BAD_INPUT = 2
EXIT_BUG = 70  # not 1, which means "refused"
EXIT_INTERRUPTED = 130

# what the system may refuse at any time, whatever the program does
REFUSALS = ("EACCES", "EDQUOT", "EFBIG", "EIO", "ELOOP", "ENAMETOOLONG", "ENOSPC", "EPERM", "EROFS")
SYSTEM_ERRORS = {getattr(errno, name) for name in REFUSALS}

COMMANDS = {
    "serve": "watch a merge in the browser",
    "merge": "merge two maps into a folder of files",
    "fleet": "merge the maps of any number of robots into one",
    "live": "merge the maps of robots that run, and go on while they grow",
    "simulate": "robots that explore a building, to try live with",
    "replay": "merge two maps and save the run as one HTML page that plays offline",
    "lesson": "the whole lesson on two maps as one page to print and hand out",
    "evaluate": "run a method on every case in a folder and count what came out right",
    "compare": "run several methods on the same cases: a table, and the merged maps side by side",
    "sweep": "run a method again and again while a setting changes: curves, heat maps, tables",
    "bag": "look into a recording of ROS, or write the map that is in it",
    "observe": "find a robot in a camera image and a laser scan: the sighting that merge takes",
    "detect": "train a detector on your own robot",
    "samples": "simulate pairs of maps with known truth",
}
"""Every command, a module of ``app.cli.commands`` each."""

DESCRIPTION = """\
mapmeld: merge the grid maps of two robots from one sighting of one by the other.

Examples:
  mapmeld serve                      open a sample in the browser and watch it merge
  mapmeld serve map1.yaml map2.yaml --observation observation.yaml

  mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result
                                     leaves merged.yaml, merged.pgm, transform.yaml,
                                     report.json and overlay.png in result/
  mapmeld replay office_r2_r1 --out merge.html
                                     the same as a recording for a talk or a lesson
  mapmeld evaluate cases --jobs 4 --json results.json
                                     every case folder under cases/, and how many came out right
  mapmeld compare cases --out compared
                                     the same for every method, with pictures
  mapmeld sweep office_r2_r1 --x augment.spread=1:8:8
                                     what a setting does: tables and a figure"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; the exit status. Usage errors leave by SystemExit(2), ``--help`` by SystemExit(0)."""
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        status = _run(words)
        sys.stdout.flush()
        return status
    except NoAnswerError as refusal:  # where a command has nothing of its own to say of it
        return _print_error(str(refusal), EXIT_REFUSED)
    except MapMergeError as error:
        return _print_error(str(error), EXIT_BAD_INPUT)
    except MemoryError:
        return _print_error("there is not enough memory for these maps; use smaller ones", EXIT_BAD_INPUT)
    except KeyboardInterrupt:
        return _print_error("interrupted; nothing half-written is left", EXIT_INTERRUPTED)
    except BrokenPipeError:  # whoever read our stdout has gone: not our mistake, and not theirs
        _discard_stdout()
        return EXIT_INTERRUPTED
    except Exception as error:
        if isinstance(error, OSError) and error.errno in SYSTEM_ERRORS:
            return _print_error(_system_error(error), EXIT_BAD_INPUT)
        traceback.print_exc()  # of ours: shown whole, and with a status that nobody takes for a refusal
        return _print_error("this is a bug of mapmeld; please report the lines above", EXIT_BUG)


def entry() -> None:
    """The command of the terminal: ``main``, and out."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by whoever started us, as for work in the background
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
    for name in ("SIGTERM", "SIGHUP"):  # whoever asks it to end, or takes its terminal away: it ends whole
        signum = getattr(signal, name, None)
        if signum is not None and signal.getsignal(signum) is not signal.SIG_IGN:  # as nohup has it
            signal.signal(signum, signal.default_int_handler)
    status = main()
    if status == EXIT_INTERRUPTED:
        # not by the ordinary way out, which waits for threads that the interrupt may have caught
        # half-way; every file is written whole or not at all, so there is nothing to clear up
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    sys.exit(status)


def _run(words: list[str]) -> int:
    top = Parser(prog=PROG, usage=f"{PROG} {{{','.join(COMMANDS)}}} …", description=DESCRIPTION)
    top.add_argument("--version", action="store_true", help="print the version and end")
    group = top.add_argument_group("commands, each with a --help of its own")
    for name, what in COMMANDS.items():
        group.add_argument(f"_{name}", metavar=name, help=what, nargs="?")
    if words and not words[0].startswith("-"):
        name = words[0]
        if name not in COMMANDS:
            top.error(f"there is no command {name}{did_you_mean(name, COMMANDS)}")
        command = import_module(f"app.cli.commands.{name}")
        parser = Parser(
            prog=f"{PROG} {name}", usage=f"{PROG} {name} {command.USAGE}", description=command.DESCRIPTION
        )
        rest = [_hyphened(word) for word in words[1:]]
        command.add_arguments(parser, rest)
        return int(command.run(parser.parse_args(rest), parser))
    if top.parse_args(words).version:
        from app.system.version import version

        print(f"{PROG} {version()}")
        return 0
    top.print_help(sys.stderr)
    return EXIT_BAD_INPUT


def _hyphened(word: str) -> str:
    """``--box.sigma_x=1`` as ``--box.sigma-x=1``: both spellings of a flag are taken."""
    flag, equals, value = word.partition("=")
    return flag.replace("_", "-") + equals + value if word.startswith("--") else word


def _system_error(error: OSError) -> str:
    """What the machine would not do, and what helps."""
    if error.filename is None:
        _discard_stdout()
        where = "where the output goes, and for temporary files ($TMPDIR)"
        return f"the system says: {error.strerror}; see that there is room {where}"
    return f"{error.filename}: {error.strerror}; check the path and who may use it"


def _discard_stdout() -> None:
    """Let what is left for stdout go nowhere: Python would try it again at its end, and complain."""
    with suppress(UnsupportedOperation):  # a stdout that is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _print_error(message: str, status: int) -> int:
    sys.stderr.write(f"{PROG}: {' '.join(message.split())}\n")
    return status
