"""A slow network on this machine: it hands on what a browser sends, so many bytes a second and no more."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock, Thread
from time import monotonic, sleep

PIECE = 16 * 1024  # bytes


class SlowLine:
    """A port that stands for another one.

    rate    : bytes a second towards the server, of all connections together; None: as fast as it goes
    carried : bytes that went towards the server so far
    """

    def __init__(self, target: int) -> None:
        self.rate: float | None = None
        self.carried = 0
        self._target, self._free = target, 0.0  # when the line is free for the next piece
        self._lock = Lock()
        self._open: list[socket.socket] = []
        self._door = socket.socket()
        # what waits in buffers here is no longer under way for the browser: they are small
        self._door.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 * PIECE)
        self._door.bind(("127.0.0.1", 0))
        self._door.listen()
        Thread(target=self._serve, daemon=True).start()

    def get_port(self) -> int:
        """Where it listens."""
        return int(self._door.getsockname()[1])

    def cut(self) -> None:
        """Break every connection that there is; new ones are let through."""
        with self._lock:
            broken, self._open = self._open, []
        for end in broken:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Break everything, and take nothing more."""
        with contextlib.suppress(OSError):
            self._door.shutdown(socket.SHUT_RDWR)
        self._door.close()
        self.cut()

    def _serve(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._door.accept()
                far = socket.create_connection(("127.0.0.1", self._target))
                with self._lock:
                    self._open += [near, far]
                Thread(target=self._carry, args=(near, far, True), daemon=True).start()
                Thread(target=self._carry, args=(far, near, False), daemon=True).start()

    def _carry(self, source: socket.socket, sink: socket.socket, slowly: bool) -> None:
        with contextlib.suppress(OSError):
            while piece := source.recv(PIECE):
                if slowly:
                    self._wait(len(piece))
                sink.sendall(piece)
        for end in (source, sink):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def _wait(self, size: int) -> None:
        with self._lock:
            self.carried += size
            if self.rate is None:
                return
            now = monotonic()
            self._free = max(now, self._free) + size / self.rate
            wait = self._free - now
        sleep(wait)


@contextmanager
def slow_line(target: int) -> Iterator[SlowLine]:
    """A line that ends with the block."""
    line = SlowLine(target)
    yield line
    line.close()
