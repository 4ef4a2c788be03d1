"""The frames of a connection: no more, and no smaller ones, than a browser sends.

What is not the first of a message costs the sender nothing, and nothing in websockets bounds it: a message
that never ends, of empty frames, fills the memory, and pings keep the server busy with answers.
"""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import Any

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ProtocolError
from websockets.frames import OP_BINARY, OP_CONT, OP_TEXT, Frame

from app.web.security.message_filter import MessageFilter, RateLimit

MOST = 2048  # frames of one message; a browser cuts a megabyte into a hundred at most
RATE, BURST = 100.0, 1000.0  # further frames and pings a second, and at once
EARNS = 1024  # bytes that let another one come: a large file on a fast line has many


class FrameLimit:
    """Counts the frames of one connection."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._limit = RateLimit(RATE, BURST, clock)
        self._parts = 0  # of the message that is coming

    def allows(self, frame: Frame) -> bool:
        """Take in one more; whether an honest browser could have sent it."""
        first = frame.opcode is OP_TEXT or frame.opcode is OP_BINARY
        if first:
            self._parts = 1
        elif frame.opcode is OP_CONT:
            self._parts += 1
        early = self._limit.take(not first, earned=len(frame.data) / EARNS)
        return early <= 0 and self._parts <= MOST


def bounded(gate: MessageFilter) -> type[ServerConnection]:
    """The connections of a server of ours: one that sends too many frames ends at once, and alone."""

    class Bounded(ServerConnection):
        def __init__(self, *what: Any, **how: Any) -> None:
            super().__init__(*what, **how)
            take, allowance = self.protocol.recv_frame, FrameLimit()

            def recv_frame(frame: Frame) -> None:
                if not allowance.allows(frame):
                    gate.drop("frames")
                    self.protocol.data_to_send()  # a thousand answers to pings, which nobody hears any more
                    self.transport.abort()
                    raise ProtocolError("more frames than a browser sends")
                take(frame)

            self.protocol.recv_frame = recv_frame  # type: ignore[method-assign]

    return Bounded
