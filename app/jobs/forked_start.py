"""How the processes begin in which merges run: where that is safe, as copies of one that has loaded all.

What such copies share takes memory once, and a copy is there in milliseconds. The one that is copied, a
forkserver of Python's own, has no threads; this process, which has many, is never copied.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context, resource_tracker
from threading import Lock
from typing import Any

PRELOADED = "app.jobs.preloaded"
_environ = Lock()

# Not on macOS, whose libraries do not survive a copy, nor on Windows, which has none. Before Python 3.11,
# or where it does not listen to the environment, a forkserver would load what lies in the current folder.
FORKS = sys.platform == "linux" and sys.version_info >= (3, 11) and not sys.flags.ignore_environment


def context() -> Any:
    """What gives processes of that kind, started anew each where they cannot be copied."""
    if not FORKS:
        return get_context("spawn")
    forked = get_context("forkserver")
    forked.set_forkserver_preload([PRELOADED])
    return forked


def start_parent() -> None:
    """Have the process that is copied; it loads what it needs while this one goes on.

    It looks for modules where this process does, and nowhere else, and does not hear Ctrl-C.
    """
    if not FORKS:
        return
    from multiprocessing.forkserver import ensure_running

    places = os.pathsep.join(str(path) or os.getcwd() for path in sys.path)
    with without_interrupt(), _environment(PYTHONSAFEPATH="1", PYTHONPATH=places):
        ensure_running()


@contextmanager
def without_interrupt() -> Iterator[None]:
    """A process that starts here does not hear Ctrl-C, not even before its first line: this one ends it."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # it would have this thread hear again
    heard = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, heard)


@contextmanager
def _environment(**variables: str) -> Iterator[None]:
    """What is started meanwhile is variables so."""
    with _environ:
        before = {name: os.environ.get(name) for name in variables}
        os.environ.update(variables)
        try:
            yield
        finally:
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
