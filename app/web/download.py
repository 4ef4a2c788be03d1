"""Files on their way to a person. A server that is told to end lets them arrive first."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition
from time import monotonic, sleep

import viser

PATIENCE = 15.0  # seconds; who ends a server does not wait for ever


class Downloads:
    """What is being made, and what has been made and not been taken yet."""

    def __init__(self) -> None:
        self._made = Condition()
        self._making = 0
        self._ending = False
        self._sent: list[viser.ClientHandle] = []

    @contextmanager
    def making(self) -> Iterator[bool]:
        """While files are made; gives False where the server ends and nothing new is begun."""
        with self._made:
            begun = not self._ending
            self._making += begun
        try:
            yield begun
        finally:
            with self._made:
                self._making -= begun
                self._made.notify_all()

    def send(self, client: viser.ClientHandle, name: str, content: bytes) -> None:
        with self._made:
            self._sent = [known for known in self._sent if _waits(known)]
            self._sent.append(client)
        client.send_file_download(name, content, save_immediately=True)

    def finish(self, patience: float = PATIENCE) -> None:
        """Begin nothing more, and wait until all that was begun has been sent."""
        end = monotonic() + patience
        with self._made:
            self._ending = True
            self._made.wait_for(lambda: not self._making, patience)
        while monotonic() < end and any(_waits(client) for client in self._sent):
            sleep(0.05)


def _waits(client: viser.ClientHandle) -> bool:
    """Whether anything that was said to a tab has not been sent to it yet."""
    buffer = client._websock_connection.get_message_buffer()
    return bool(buffer.message_from_id) and not buffer.done


DOWNLOADS = Downloads()
