"""How inner loops are compiled, and how work is spread over cores: one place for both.

Kernels release the GIL and never start threads of their own: numba's threading layers crash or
deadlock when two Python threads (two browser tabs) enter them at once, a thread pool does not.
Every item is worked on by one thread from beginning to end, so the answer does not depend on how
many threads there are.

numba is loaded when a kernel is first called: it takes 60 MB and half a second, and a process that merges
nothing has no use for it.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from functools import cache, update_wrapper
from itertools import pairwise
from pickle import UnpicklingError
from threading import Lock, local
from typing import Any, ParamSpec, TypeVar, cast

log = logging.getLogger(__name__)

P = ParamSpec("P")
R = TypeVar("R")
Given = TypeVar("Given")
Made = TypeVar("Made")


_UNREADABLE = (OSError, EOFError, UnpicklingError)
_kept_only = False


class NotKeptError(Exception):
    """A kernel would have to be compiled."""


@contextmanager
def kept_only() -> Iterator[None]:
    """For a process with one thread: a kernel whose compiled code was not kept raises NotKeptError."""
    global _kept_only
    _kept_only = True
    try:
        yield
    finally:
        _kept_only = False


class _Kept:
    """numba's store of compiled code; what cannot be read or kept costs the next start time, no merge."""

    def __init__(self, store: Any) -> None:
        self._store = store

    def __getattr__(self, name: str) -> Any:
        return getattr(self._store, name)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """The compiled code of an earlier run, None where there is none."""
        try:
            found = self._store.load_overload(signature, context)
        except _UNREADABLE as error:  # another user's, or torn by a power cut
            _say_once(f"compiled code of an earlier run cannot be used: {error}")
            with suppress(OSError):
                self._store.flush()  # begun anew, it can be
            found = None
        if found is None and _kept_only:
            raise NotKeptError
        return found

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep compiled code, if the disk lets us."""
        try:
            self._store.save_overload(signature, compiled)
        except _UNREADABLE as error:
            _say_once(f"compiled code cannot be kept for the next start: {error}")


@cache
def _say_once(what: str) -> None:  # there are dozens of loops
    log.warning(what)


_making = Lock()  # or two threads would compile the same loop, each for itself


class _Kernel:
    """A loop that numba is told of when it is first called, by Python or by another kernel."""

    def __init__(self, function: Callable[..., Any], fastmath: set[str] | bool) -> None:
        self._function, self._fastmath = function, fastmath
        self._loop: Any = None
        update_wrapper(self, function)

    def __call__(self, *args: Any) -> Any:
        return (self._loop or self._made())(*args)

    @property
    def _numba_type_(self) -> Any:  # numba asks what a kernel calls for it
        return (self._loop or self._made())._numba_type_

    def _made(self) -> Any:
        from numba import njit

        with _making:
            if self._loop is None:
                try:
                    loop: Any = njit(nogil=True, cache=True, fastmath=self._fastmath)(self._function)
                    loop._cache = _Kept(loop._cache)
                except RuntimeError:  # nowhere to keep compiled code: a read-only installation without a home
                    if _kept_only:
                        raise NotKeptError from None
                    loop = njit(nogil=True, fastmath=self._fastmath)(self._function)
                self._loop = loop
            return self._loop


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a loop in strict IEEE arithmetic; cached on disk, so that only the first use waits."""
    return cast("Callable[P, R]", _Kernel(function, fastmath=False))


def fast_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a loop whose sums may be reordered and fused, which lets it use vector registers.

    The order is fixed when it is compiled: one machine gives one answer. Without NaN in it: their
    absence is what lets min and max become one instruction.
    """
    fastmath = {"reassoc", "contract", "nsz", "arcp", "nnan"}
    return cast("Callable[P, R]", _Kernel(function, fastmath))


@cache
def cores() -> int:
    """How many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on macOS and Windows
        return os.cpu_count() or 1


_most_threads: int | None = None


def use_threads(most: int) -> None:
    """Share work among so many threads at most, from now on: for processes that share a machine's cores."""
    global _most_threads
    _most_threads = most


def threads() -> int:
    """How many threads share the work: one per core, unless ``use_threads`` was told otherwise."""
    return cores() if _most_threads is None else min(cores(), _most_threads)


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=cores(), thread_name_prefix="mapmeld-kernel")


_shared = local()  # whether the work of this thread is a part of what all threads share


def run_in_threads(work: Callable[[int, int], None], n: int, at_least: int = 1) -> None:
    """Call ``work(start, stop)`` so that the calls cover [0, n), on all threads.

    Work that is itself a part of such work stays on its thread.

    at_least : items below which another thread does not pay
    """
    parts = max(1, min(threads(), n // max(1, at_least)))
    if parts == 1 or getattr(_shared, "inside", False):
        work(0, n)
        return

    def part(start: int, stop: int) -> None:
        _shared.inside = True
        try:
            work(start, stop)
        finally:
            _shared.inside = False

    edges = [n * part // parts for part in range(parts + 1)]
    futures = [_pool().submit(part, start, stop) for start, stop in pairwise(edges[1:])]
    try:
        part(edges[0], edges[1])
    finally:
        wait(futures)
    for future in futures:
        future.result()


def each_on_a_core(make: Callable[[Given], Made], items: Sequence[Given]) -> list[Made]:
    """What ``make`` makes of each item, in their order, shared among all threads."""
    made: dict[int, Made] = {}

    def work(start: int, stop: int) -> None:
        made.update((n, make(items[n])) for n in range(start, stop))

    run_in_threads(work, len(items))
    return [made[n] for n in range(len(items))]
