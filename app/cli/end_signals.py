"""Ctrl-C and SIGTERM as something to look at, for a loop that calls other people's code."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from threading import current_thread, main_thread


@contextmanager
def end_signals() -> Iterator[Sequence[int]]:
    """The numbers of the signals to end that have come so far.

    KeyboardInterrupt is lost where it is raised within a callback of a library in C: the loop would go on.
    Where it is not the main thread that asks, signals stay as they are.
    """
    come: list[int] = []
    before = {}
    if current_thread() is main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, lambda number, _: come.append(number))
    try:
        yield come
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
