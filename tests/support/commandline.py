"""The command line as tests call it: in this process, or in one of its own."""

import signal
import subprocess
import sys

import pytest
from repository import ROOT

from app.cli.main import main


def as_in_a_terminal():
    """What a shell without job control starts in the background ignores Ctrl-C; behind nohup SIGHUP, too."""
    for asked in (signal.SIGINT, signal.SIGHUP):
        signal.signal(asked, signal.SIG_DFL)


def inputs(folder):
    """The maps and the observation of a case's folder, as ``merge`` takes them."""
    return [str(folder / "map1.yaml"), str(folder / "map2.yaml"), f"--observation={folder}/observation.yaml"]


def usage_error(*words):
    """Exit status of words that the parser refuses."""
    with pytest.raises(SystemExit) as left:
        main(list(map(str, words)))
    return left.value.code


def in_a_process(*words, run=("-m", "app"), **kwargs):
    """What the command ended with, and said."""
    command = [sys.executable, *run, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, **kwargs)
