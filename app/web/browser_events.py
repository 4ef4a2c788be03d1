"""What the page does by itself and tells Python of: named events, each field checked before anyone acts.

map_viewer.js sends a numbered text into a field that is on no panel; viser's own widgets would keep only the
latest of several messages within 50 ms. What is not an event that someone has asked for, field by field,
is dropped: a browser may send anything.
"""

from __future__ import annotations

import json
import logging
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from threading import Condition, Thread
from typing import Any

import viser

from app.drawing.browser_messages import BrowserMessages
from app.web.callback_errors import words
from app.web.security.message_filter import listen_unseen

log = logging.getLogger(__name__)

LONGEST = 4000  # letters of a message
LONGEST_WORD = 200  # letters of a text in it
LARGEST = 1e9  # metres, pixels, degrees: nothing on the page is larger
MOST_WAITING = 500  # messages that nobody had the time for yet; further ones are dropped


@dataclass(frozen=True)
class Numbers:
    """A field that is a list of so many numbers."""

    least: int
    most: int


# what a field may be: float, int, bool, str, one of some words, or a list of numbers
Kind = type | tuple[str, ...] | Numbers


@dataclass(frozen=True)
class _Event:
    callback: Callable[..., None]
    latest: bool
    fields: dict[str, Kind]


def checked(value: Any, kind: Kind) -> Any:
    """The value as that kind; raises ValueError where it is another."""
    if isinstance(kind, Numbers):
        if not isinstance(value, list) or not kind.least <= len(value) <= kind.most:
            raise ValueError(f"not {kind.least} to {kind.most} numbers")
        return [checked(part, float) for part in value]
    if isinstance(kind, tuple):
        if not isinstance(value, str) or value not in kind:
            raise ValueError("not one of the words")
        return value
    if kind is str and isinstance(value, str) and len(value) <= LONGEST_WORD:
        return value
    if kind is bool and isinstance(value, bool):
        return value
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if kind is float and number and -LARGEST <= value <= LARGEST:  # NaN is on neither side
        return float(value)
    if kind is int and number and -LARGEST <= value <= LARGEST and value == int(value):
        return int(value)
    raise ValueError(f"not {kind.__name__}")


class BrowserEvents:
    """Calls back in the order of the messages, one at a time, in a thread of its own."""

    def __init__(self, gui: viser.GuiApi, messages: BrowserMessages) -> None:
        self._messages = messages
        self._events: dict[str, list[_Event]] = {}
        self._last = 0  # number of the newest message
        self._waiting: deque[tuple[_Event, dict[str, Any]]] = deque()
        self._wake = Condition()
        self._closed = False
        with gui.add_folder("", visible=False):
            self._text = gui.add_text("", "")

        @self._text.on_update
        async def _(_: viser.GuiEvent[Any]) -> None:  # in viser's own loop: messages stay in order
            self.take(self._text.value)

        listen_unseen(self._text._impl.uuid)
        messages.listen(self._text._impl.uuid)
        Thread(target=self._work, name="mapmeld-channel", daemon=True).start()

    def on(
        self, event: str, callback: Callable[..., None], /, *, latest: bool = False, **fields: Kind
    ) -> None:
        """Call back with the fields of every such event, by their names; several may ask for one.

        latest : of several that wait in a row only the newest counts: a place on a path, not an action
        """
        self._events.setdefault(event, []).append(_Event(callback, latest, fields))

    def take(self, text: str) -> bool:
        """Take in a message; whether it was one."""
        try:
            number, name, values = _parsed(text)
            asked = [(event, _fields_of(event, values)) for event in self._events[name]]
        except (ValueError, KeyError, RecursionError):
            return False
        if number <= self._last or all(fields is None for _, fields in asked):
            return False
        with self._wake:
            self._last = number
            return all(self._take(event, fields) for event, fields in asked if fields is not None)

    def _take(self, event: _Event, fields: dict[str, Any]) -> bool:
        """Queue what has come; one that is waiting for the same gives way where only the newest counts."""
        if event.latest:
            for k in reversed(range(len(self._waiting))):
                before, _ = self._waiting[k]
                if before is event:
                    del self._waiting[k]
                if before is event or not before.latest:
                    break
        return self._queue(event, fields)

    def then(self, callback: Callable[..., None], *args: Any) -> None:
        """Call back with that after all that was told before it, and before what comes later.

        For what a widget tells, from a callback in viser's own loop: in a thread it would be overtaken.
        """
        with self._wake:
            self._queue(_Event(partial(callback, *args), latest=False, fields={}), {})

    def _queue(self, event: _Event, fields: dict[str, Any]) -> bool:
        if self._closed or len(self._waiting) >= MOST_WAITING:
            return False
        self._waiting.append((event, fields))
        self._wake.notify()
        return True

    def close(self) -> None:
        listen_unseen(self._text._impl.uuid, False)
        with self._wake:
            self._closed = True
            self._wake.notify()

    def _work(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._closed or self._waiting)
                if self._closed:
                    return
                event, fields = self._waiting.popleft()
            try:
                event.callback(**fields)
            except Exception as error:  # as in viser's own callbacks: said, logged, and the tab lives on
                log.exception("an event of the page ended in a bug")
                self._messages.hud(state=words(error), mood="failed", progress=None)
                self._messages.flush()


def _fields_of(event: _Event, values: dict[str, Any]) -> dict[str, Any] | None:
    """The fields that an event asks for; None where the values are others."""
    if set(values) != set(event.fields):
        return None
    try:
        return {field: checked(values[field], kind) for field, kind in event.fields.items()}
    except ValueError:
        return None


def _parsed(text: str) -> tuple[int, str, dict[str, Any]]:
    """Number, name and fields of a message; raises ValueError."""
    if len(text) > LONGEST:
        raise ValueError("too long")
    match json.loads(text):
        case [int(number), str(name), dict(fields)]:
            return number, name, fields
    raise ValueError("not a message")
