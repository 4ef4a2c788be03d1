"""Work that a person asks for and may leave: files are read, maps made of them, results written down.

It is left by an exception that no handler of errors catches, at the next place where it looks up; until
then it has touched nothing of the page.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Lock, RLock
from time import perf_counter
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    from app.drawing.browser_messages import Stage

OFTEN = 0.1  # seconds between two words of how far it is


class Check(Protocol):
    """What work calls now and then to look up; it may raise Left."""

    def __call__(self, done: float | None = None, /) -> None:
        """done : share of the work that is done, 0 … 1; None where nobody knows."""


class Left(BaseException):
    """Stop was pressed. No Exception: who takes any of those for a damaged file lets this one pass."""


def wanted(check: Check) -> bool:
    """Whether the work is still asked for."""
    try:
        check()
    except Left:
        return False
    return True


def unwatched(done: float | None = None, /) -> None:
    """The check of work that cannot be left."""


class Watched(io.BytesIO):
    """A file in memory whose reader looks up at every part of it."""

    def __init__(self, content: bytes, check: Check) -> None:
        super().__init__(content)
        self._check = check

    def read(self, size: int | None = -1, /) -> bytes:
        """The next part, or all that is left; raises Left."""
        self._check()
        return super().read(size)


@dataclass(eq=False)
class _Doing:
    """Something under way: its words, and those that are right once it is over."""

    said: dict[str, Any]
    before: dict[str, Any]
    left: bool = False


class Errand:
    """Of one tab: says what is done, and puts the words back where nothing is to be said of it."""

    def __init__(self, stage: Stage, drawing: RLock, stoppable: Callable[[bool], None]) -> None:
        """stoppable : is told whether there is anything to stop"""
        self._stage, self._drawing, self._stoppable = stage, drawing, stoppable
        self._lock = Lock()
        self._under_way: list[_Doing] = []

    @contextmanager
    def __call__(self, doing: str, aside: bool = False) -> Iterator[Check]:
        """Gives what the work calls to look up: it raises Left once Stop was pressed.

        aside : it changes nothing on the page, so that the words from before are right afterwards, too
        """
        said: dict[str, Any] = {"state": doing, "mood": "running", "progress": 0.05 if aside else 0.3}
        me, told = self._begin(said), perf_counter()

        def check(done: float | None = None, /) -> None:
            nonlocal told
            if me.left:
                raise Left
            if done is not None and perf_counter() - told >= OFTEN and self._shows(me):
                told = perf_counter()
                me.said["progress"] = done
                self._say(me.said)

        back = True
        try:
            yield check
            check()  # pressed at the last moment is pressed
            back = aside
        except Exception as error:
            if me.left:  # what becomes of it is of no matter any more
                raise Left from error
            raise
        finally:
            self._end(me, back)

    def stop(self) -> bool:
        """Have it leave what it is at; whether it is at anything that was not told so before."""
        with self._lock:
            leaving = [one for one in self._under_way if not one.left]
            for one in leaving:
                one.left = True
        for one in leaving:
            self._fall_back(one)
        return bool(leaving)

    def _begin(self, said: dict[str, Any]) -> _Doing:
        with self._drawing:
            shown = self._stage.said(*said)
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
        return self._stage.said(*me.said) == me.said

    def _say(self, words: dict[str, Any]) -> None:
        with self._drawing:
            self._stage.hud(**words)
            self._stage.flush()
