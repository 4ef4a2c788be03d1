"""Work that a person asks for and may leave: files are read, maps made of them, results written down.

It is left by an exception that no handler of errors catches, at the next place where it looks up; until
then it has touched nothing of the page.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from threading import Lock, RLock
from time import perf_counter
from typing import Any

import viser

from app.drawing.browser_messages import BrowserMessages
from app.system.cancellation import Cancelled, Check
from app.web.download import DOWNLOADS

OFTEN = 0.1  # seconds between two words of how far it is


@dataclass(eq=False)
class _Doing:
    """Something under way: its words, and those that are right once it is over."""

    said: dict[str, Any]
    before: dict[str, Any]
    left: bool = False


class CancellableTask:
    """Of one tab: says what is done, and puts the words back where nothing is to be said of it."""

    def __init__(self, messages: BrowserMessages, drawing: RLock, stoppable: Callable[[bool], None]) -> None:
        """stoppable : is said_at whether there is anything to stop"""
        self._messages, self._drawing, self._stoppable = messages, drawing, stoppable
        self._lock = Lock()
        self._under_way: list[_Doing] = []

    @contextmanager
    def __call__(self, doing: str, aside: bool = False) -> Iterator[Check]:
        """Gives what the work calls; it raises Cancelled after Stop. ``aside``: the old words come back."""
        said: dict[str, Any] = {"state": doing, "mood": "running", "progress": 0.05 if aside else 0.3}
        me, said_at = self._begin(said), perf_counter()

        def check(done: float | None = None, /) -> None:
            nonlocal said_at
            if me.left:
                raise Cancelled
            if done is not None and perf_counter() - said_at >= OFTEN and self._shows(me):
                said_at = perf_counter()
                me.said["progress"] = done
                self._say(me.said)

        back = True
        try:
            yield check
            check()  # pressed at the last moment is pressed
            back = aside
        except Exception as error:
            if me.left:  # what becomes of it is of no matter any more
                raise Cancelled from error
            raise
        finally:
            self._end(me, back)

    def stop(self) -> bool:
        """Have it leave what it is at; whether it is at anything that was not said_at so before."""
        with self._lock:
            leaving = [one for one in self._under_way if not one.left]
            for one in leaving:
                one.left = True
        for one in leaving:
            self._fall_back(one)
        return bool(leaving)

    def _begin(self, said: dict[str, Any]) -> _Doing:
        with self._drawing:
            shown = self._messages.said(*said)
            other = next((one for one in self._under_way if one.said == shown), None)
            me = _Doing(said, other.before if other else shown)
            with self._lock:
                self._under_way.append(me)
            self._say(said)
        self._stoppable(True)
        return me

    def _end(self, me: _Doing, back: bool) -> None:
        with self._lock:
            self._under_way.remove(me)
            any_left = bool(self._under_way)
        if back:
            self._fall_back(me)
        self._stoppable(any_left)

    def _fall_back(self, me: _Doing) -> None:
        """Say what else is under way, or what was said before: where its own words are said."""
        with self._drawing:
            if self._shows(me):
                others = [one for one in self._under_way if one is not me and not one.left]
                self._say(others[-1].said if others else me.before)

    def _shows(self, me: _Doing) -> bool:
        """Whether nobody else has had their say since."""
        return self._messages.said(*me.said) == me.said

    def _say(self, words: dict[str, Any]) -> None:
        with self._drawing:
            self._messages.hud(**words)
            self._messages.flush()


class DownloadTask:
    """Of one button: makes a file that is asked for, and sends it."""

    def __init__(self, client: viser.ClientHandle, task: CancellableTask) -> None:
        self._client, self._task = client, task
        self._at_work = Lock()

    def __call__(self, doing: str, name: str, make: Callable[[Check], bytes]) -> None:
        """Make a file, which may be left by Cancelled, while saying what is done; and send it."""
        if not self._at_work.acquire(blocking=False):
            return  # a second press while it is being made
        try:
            with DOWNLOADS.making() as begun, suppress(Cancelled):
                if begun:
                    with self._task(doing, aside=True) as check:
                        content = make(check)
                    DOWNLOADS.send(self._client, name, content)
        finally:
            self._at_work.release()
