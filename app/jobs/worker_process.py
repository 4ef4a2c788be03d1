"""What a worker process runs: it does what worker_pool asks of it, for several tabs."""

from __future__ import annotations

import contextlib
import itertools
import logging
import pickle
import signal
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Any

from algorithms.methods.stage_runner import StageCache
from algorithms.methods.steps import Step
from app.jobs.incremental_pickle import IncrementalPickle
from app.model.merge_job import MergeJob
from app.system.memory import give_back, whole

log = logging.getLogger(__name__)

SHARE = 0.5  # of this machine's memory that a worker may have; more is a MemoryError, not the end of others


@dataclass(frozen=True)
class Failed:
    """What went wrong here, for the page; anew: both ends no longer agree."""

    error: Exception
    trace: str
    anew: bool = False


@dataclass
class _Tab:
    pickler: IncrementalPickle = field(default_factory=lambda: IncrementalPickle("worker"))
    memo: StageCache = field(default_factory=dict)
    runs: dict[int, Iterator[Step]] = field(default_factory=dict)


_runs = itertools.count()


def serve(line: Connection) -> None:
    """Answer what the page asks, until its process is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # worker_pool ends it
    _bound_memory()
    tabs: dict[int, _Tab] = {}
    with contextlib.suppress(EOFError, OSError):  # the first process is gone
        while True:
            line.send(_answer(tabs, *line.recv()))


def _answer(tabs: dict[int, _Tab], verb: str, number: int, *what: Any) -> tuple[Any, ...]:
    if verb == "forget":
        if tabs.pop(number, None) is not None:
            give_back()
        return ()
    tab = tabs.setdefault(number, _Tab())
    if verb == "start":
        return _started(tabs, number, tab, *what)
    (run,) = what
    if verb == "leave":
        tab.runs.pop(run, None)
        return ()
    try:
        step = next(tab.runs[run], None)
    except Exception as error:
        del tab.runs[run]
        return (_failed(error),)
    if step is None:
        del tab.runs[run]
        return (None,)
    try:
        return (tab.pickler.pack(step),)
    except Exception as error:
        del tabs[number]
        return (_failed(error, anew=True),)


def _started(
    tabs: dict[int, _Tab], number: int, tab: _Tab, aside: bool, turns: int, data: bytes
) -> tuple[Any, ...]:
    try:
        for _ in range(turns):
            tab.pickler.turn_over()
        job: MergeJob = tab.pickler.unpack(data)
    except Exception as error:
        del tabs[number]
        return (_failed(error, anew=True),)
    try:
        steps = job.run(dict(tab.memo) if aside else tab.memo)
    except Exception as error:
        return (_failed(error),)
    run = next(_runs)
    tab.runs[run] = steps
    return (run,)


def _failed(error: Exception, anew: bool = False) -> Failed:
    trace = traceback.format_exc()
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # not every library's errors can travel
        error = RuntimeError(f"{type(error).__name__}: {error}")
    return Failed(error, trace, anew)


def _bound_memory() -> None:
    """Have what is too much for this machine fail here, before the system ends whom it likes."""
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (int(SHARE * whole()),) * 2)
    except (ImportError, AttributeError, ValueError, OSError):  # not on every system
        log.debug("memory is not bounded", exc_info=True)
