"""What a browser may say, once it is in: the messages of the page, and the values of controls.

viser believes all of it. What is not let through here is dropped and counted by its reason; only a
frame that is no message at all ends the connection it came by, and that connection alone.
"""

from __future__ import annotations

import asyncio
import logging
from collections import Counter
from collections.abc import Callable
from time import monotonic
from typing import Any

from viser import _messages as messages
from viser._gui_handles import GuiTabHandle

from app.web.security.message_schema import MAX_NUMBER, MAX_PARTS, MAX_TEXT, fault

log = logging.getLogger(__name__)

PATIENCE = 60.0  # seconds until a browser that reads nothing is given up
RATE, BURST = 200.0, 400.0  # messages a second, and at once; a tab that is dragged over sends about 60
WEIGHT = 32 * 1024  # bytes that count as one more: 6 MB a second

LOGGED_AT = frozenset(10**power for power in range(3, 10))  # how many things dropped make a line of the log

_unseen: set[str] = set()  # fields that are listened to though they lie on no panel


def listen_unseen(uuid: str, yes: bool = True) -> None:
    """Let a field that no panel shows take values, or no longer."""
    (_unseen.add if yes else _unseen.discard)(uuid)


class MessageFilter:
    """Lets through what a browser of ours could have sent; ``dropped`` counts what was not, by its kind."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.dropped: Counter[str] = Counter()
        self._clock = clock

    def drop(self, why: str) -> None:
        """Count something that was not let through; who keeps trying is told of, seldom."""
        self.dropped[why] += 1
        log.debug("dropped: %s", why)
        if self.dropped[why] in LOGGED_AT:
            log.warning("dropped %d times by now: %s", self.dropped[why], why)

    def guard(self, connection: Any) -> None:
        """Stand before a connection: its ``recv`` gives only what may pass, at a bearable rate.

        And ``send`` gives up a browser that takes nothing any more: what waits for it fills the memory.
        """
        receive = connection.recv
        limit = RateLimit(RATE, BURST, self._clock)

        async def recv(*args: Any, **kwargs: Any) -> Any:
            while True:
                raw = await receive(*args, **kwargs)
                wait = limit.take(1 + len(raw) // WEIGHT)
                if wait > 0:  # nothing is lost: whoever sends too fast waits for us
                    self.dropped["slowed"] += 1
                    await asyncio.sleep(wait)
                wrong = fault(raw)
                if not wrong:
                    return raw
                self.drop(wrong)
                if wrong == "garbage":
                    await connection.close(1007, "this is no message of the page")

        send = connection.send

        async def send_in_time(*args: Any, **kwargs: Any) -> None:
            try:
                await asyncio.wait_for(send(*args, **kwargs), PATIENCE)
            except asyncio.TimeoutError:
                self.drop("does not read")
                connection.transport.abort()  # nothing that is still to be sent would ever arrive

        connection.recv, connection.send = recv, send_in_time

    def takes(self, gui: Any, message: messages.GuiUpdateMessage) -> bool:
        """Whether a control may take what a browser says it holds now."""
        handle = gui._gui_input_handle_from_uuid.get(message.uuid)
        if handle is None:  # another tab's, or gone while this was on its way
            return False
        if set(message.updates) != {"value"}:
            self.drop("property")
        elif not usable(gui, handle):
            self.drop("not enabled")
        elif not acceptable(message.updates["value"], handle._impl.value, handle._impl.props):
            self.drop("value")
        else:
            return True
        return False


class RateLimit:
    """So many of something a second (rate), and more at once (burst) after a while of silence."""

    def __init__(self, rate: float, burst: float, clock: Callable[[], float] = monotonic) -> None:
        self._rate, self._burst, self._clock = rate, burst, clock
        self._left, self._at = burst, clock()

    def take(self, weight: float, earned: float = 0.0) -> float:
        """Take one that counts as so many, after ``earned`` further ones; seconds that it is too early."""
        now = self._clock()
        self._left = min(self._burst, self._left + (now - self._at) * self._rate + earned) - weight
        self._at = now
        return max(0.0, -self._left / self._rate)


def usable(gui: Any, handle: Any) -> bool:
    """Whether a person could use a control now: neither it nor what it lies in is hidden or disabled."""
    if handle._impl.uuid in _unseen:
        return True
    while True:
        props = handle._impl.props
        if getattr(props, "disabled", False) or not getattr(props, "visible", True):
            return False
        inside = gui._container_handle_from_uuid.get(handle._impl.parent_container_id)
        if isinstance(inside, GuiTabHandle):
            inside = inside._parent
        if not hasattr(inside, "_impl"):
            return True
        handle = inside


def acceptable(value: Any, now: Any, props: Any) -> bool:
    """Whether a control that holds ``now`` may hold ``value``: of its type, in its range, of its choices."""
    options = getattr(props, "options", None)
    if options is not None:
        return isinstance(value, str) and value in options
    if not _fits(value, now):
        return False
    low, high = getattr(props, "min", None), getattr(props, "max", None)
    for k, part in enumerate(value if isinstance(value, list | tuple) else [value]):
        if isinstance(part, int | float) and not isinstance(part, bool):
            bottom, top = (edge[k] if isinstance(edge, list | tuple) else edge for edge in (low, high))
            if (bottom is not None and part < bottom) or (top is not None and part > top):
                return False
    return True


def _fits(value: Any, now: Any) -> bool:
    if isinstance(now, bool):
        return isinstance(value, bool)
    if isinstance(now, int | float):
        return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= MAX_NUMBER
    if isinstance(now, str):
        return isinstance(value, str) and len(value) <= MAX_TEXT
    if isinstance(now, tuple):
        if not isinstance(value, list | tuple) or len(value) > MAX_PARTS:
            return False
        return len(value) == len(now) and all(map(_fits, value, now))
    return False
