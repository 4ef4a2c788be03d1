"""Files on their way from a browser, each by a connection of its own: upload.js sends them.

viser sends a file in one go by the connection that carries everything else: on a slow network no control
of the page comes through until it has arrived, Stop neither. Here a part is sent once earlier ones have
arrived, nothing else waits for it, and to leave a file is to close its connection.

viser's own way is closed (message_schema). What comes is kept where viser would keep it: a tab that goes
takes its files along.
"""

from __future__ import annotations

import asyncio
import json
import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any
from uuid import uuid4

import msgspec
import viser
from viser._gui_handles import GuiUploadButtonHandle
from websockets.exceptions import ConnectionClosed

from algorithms.common.errors import InputFileError
from app.web.security.message_filter import MessageFilter, usable

log = logging.getLogger(__name__)

PATH = "/upload"
LEAST, MOST = 64 * 1024, 1024 * 1024  # bytes of a part; the last one may be shorter
AHEAD = 4 * 1024 * 1024  # bytes that may be on their way: enough for a line that is fast and long
MAX_UPLOAD = 200 * 2**20  # bytes of one file: a map of the largest size there may be
MAX_UPLOADS = 2 * MAX_UPLOAD  # bytes on their way from one tab: two maps
MAX_UPLOADS_OF_ALL = 5 * MAX_UPLOAD  # bytes on their way from all tabs
MAX_OPEN_UPLOADS = 8  # of one tab
MAX_NAME = 255  # letters of a file's name
IDLE_LIMIT = 60.0  # seconds until a connection that says nothing is given up
SHORT = 0.5  # seconds; what takes less can be left by nobody
CLOSE_PATIENCE = 10.0  # seconds until a connection that is left ends, whatever it still holds


class Announced(msgspec.Struct, forbid_unknown_fields=True):
    """The first word of a browser: which button takes which file."""

    button: Annotated[str, msgspec.Meta(min_length=1, max_length=64)]
    name: Annotated[str, msgspec.Meta(max_length=MAX_NAME)]
    kind: Annotated[str, msgspec.Meta(max_length=MAX_NAME)]
    size: Annotated[int, msgspec.Meta(ge=0, le=2**53)]


@dataclass(frozen=True)
class Recipient:
    """The page of a tab, as far as it hears of its files.

    can_stop : whether anything has been on its way for so long that it can be stopped
    refuse   : why a file is not taken; in a thread of viser's
    """

    can_stop: Callable[[bool], None]
    refuse: Callable[[InputFileError], None]


@dataclass(eq=False)
class Arrival:
    """One file on its way."""

    connection: Any
    tab: int
    gui: Any
    button: str
    size: int
    loop: asyncio.AbstractEventLoop
    id: str = field(default_factory=lambda: str(uuid4()))
    long: bool = False  # it takes longer than a moment
    arrived: int = 0

    @property
    def state(self) -> Any:
        """What viser keeps of it; None once it was left, or its tab has gone."""
        return self.gui._current_file_upload_states.get(self.id)

    def drop(self) -> bool:
        """Forget what has come of it; whether there was anything to forget."""
        return self.gui._current_file_upload_states.pop(self.id, None) is not None


class Uploads:
    """All of a server."""

    def __init__(self, gate: MessageFilter, tabs: Callable[[], dict[int, viser.ClientHandle]]) -> None:
        """tabs : those that are open, by their number"""
        self._gate, self._tabs = gate, tabs
        self._recipients: dict[int, Recipient] = {}
        self._coming: list[Arrival] = []
        self._lock = threading.Lock()
        self._endings: set[asyncio.Task[None]] = set()

    def connect(self, tab: int, recipient: Recipient) -> None:
        """From now on this page is told of its tab's files."""
        self._recipients[tab] = recipient

    def disconnect(self, tab: int) -> None:
        """The tab has gone: nothing of its files stays."""
        self._recipients.pop(tab, None)
        self._leave(tab, "lost")

    def stop(self, tab: int) -> bool:
        """Leave all that is on its way from a tab; whether anything was."""
        return self._leave(tab, "left")

    def _leave(self, tab: int, why: str) -> bool:
        with self._lock:
            going = [arrival for arrival in self._coming if arrival.tab == tab]
        dropped = [arrival.drop() for arrival in going]
        for arrival in going:
            arrival.loop.call_soon_threadsafe(self._end_soon, arrival.connection, why)
        return any(dropped)

    # --- in viser's loop --------------------------------------------------------------------------

    async def receive(self, connection: Any) -> None:
        """Take in the file that a connection brings."""
        try:
            arrival = self._admitted(connection, await _received(connection))
            if arrival is None:
                await _end(connection, "refused")
            elif await self._watched(arrival):
                await _end(connection, "arrived")
            else:  # by Stop, whose own word may come after this
                await _end(connection, "left")
        except ConnectionClosed:
            log.debug("a file's connection ended")
        except asyncio.TimeoutError:
            self._gate.drop("upload silent")
            connection.transport.abort()
        except (msgspec.DecodeError, ValueError):  # of something that is no page of ours
            self._gate.drop("upload garbage")
            await connection.close(1007, "this is no file of the page")

    def _admitted(self, connection: Any, word: Any) -> Arrival | None:
        """The file that is announced, with room kept for it; None where it may not come."""
        announced = msgspec.json.decode(word, type=Announced)
        for tab, client in self._tabs().items():
            if announced.button in client.gui._gui_input_handle_from_uuid:
                loop = asyncio.get_running_loop()
                arrival = Arrival(connection, tab, client.gui, announced.button, announced.size, loop)
                return self._begun(arrival, announced)
        return None  # its button is gone

    def _begun(self, arrival: Arrival, announced: Announced) -> Arrival | None:
        if not self._has_room(arrival):
            recipient = self._recipients.get(arrival.tab)
            if recipient is not None:  # called in a thread: it may have to wait for a picture that is drawn
                arrival.gui._thread_executor.submit(recipient.refuse, refusal(announced.name, announced.size))
            return None
        arrival.gui._current_file_upload_states[arrival.id] = {
            "client_id": arrival.tab,
            "filename": announced.name,
            "mime_type": announced.kind,
            "part_count": 0,  # as many as it takes
            "parts": {},
            "total_bytes": announced.size,
            "transferred_bytes": 0,
            "lock": threading.Lock(),
        }
        with self._lock:
            self._coming.append(arrival)
        return arrival

    def _has_room(self, arrival: Arrival) -> bool:
        """Whether a file may come now."""
        button, coming = arrival.gui._gui_input_handle_from_uuid.get(arrival.button), _coming(arrival.gui)
        if not isinstance(button, GuiUploadButtonHandle) or not usable(arrival.gui, button):
            self._gate.drop("upload unasked")
        elif len(coming) >= MAX_OPEN_UPLOADS:
            self._gate.drop("uploads")
        elif arrival.size > MAX_UPLOAD or arrival.size + sum(coming) > MAX_UPLOADS:
            self._gate.drop("upload size")
        elif arrival.size + sum(sum(_coming(tab.gui)) for tab in self._tabs().values()) > MAX_UPLOADS_OF_ALL:
            self._gate.drop("uploads of all")
        else:
            return True
        return False

    async def _watched(self, arrival: Arrival) -> bool:
        """Take it in, and have its tab know where that takes long; whether it is there."""
        alarm = arrival.loop.call_later(SHORT, self._say_slow, arrival)
        try:
            return await self._taken(arrival)
        finally:
            alarm.cancel()
            arrival.drop()
            with self._lock:
                self._coming.remove(arrival)
            self._tell(arrival.tab)

    async def _taken(self, arrival: Arrival) -> bool:
        """Part by part; in the end the button has the file, and says so as for any upload of viser's."""
        await arrival.connection.send(json.dumps({"least": LEAST, "most": MOST, "ahead": AHEAD}))
        while arrival.arrived < arrival.size:
            part = await _received(arrival.connection)
            state = arrival.state
            if state is None:
                return False
            rest = arrival.size - arrival.arrived
            if not isinstance(part, bytes) or not min(LEAST, rest) <= len(part) <= min(MOST, rest):
                raise ValueError("a part that is too short, or too long")
            state["parts"][state["part_count"]] = part
            state["part_count"] += 1
            state["transferred_bytes"] = arrival.arrived = arrival.arrived + len(part)
            await arrival.connection.send(json.dumps({"arrived": arrival.arrived}))
        if arrival.state is None:
            return False
        arrival.gui._finish_file_upload(arrival.tab, arrival.id, arrival.button)
        return True

    def _say_slow(self, arrival: Arrival) -> None:
        arrival.long = True
        self._tell(arrival.tab)

    def _tell(self, tab: int) -> None:
        if (recipient := self._recipients.get(tab)) is not None:
            recipient.can_stop(any(arrival.tab == tab and arrival.long for arrival in self._coming))

    def _end_soon(self, connection: Any, why: str) -> None:
        ending = asyncio.ensure_future(_end(connection, why))
        self._endings.add(ending)  # the loop itself would forget it
        ending.add_done_callback(self._endings.discard)


async def _received(connection: Any) -> Any:
    return await asyncio.wait_for(connection.recv(), IDLE_LIMIT)


async def _end(connection: Any, why: str) -> None:
    """Say the last word, and end the connection, however much it still holds.

    why : "arrived", "refused"; "left", by Stop; "lost", as its tab has gone
    """
    try:
        await asyncio.wait_for(connection.send(json.dumps({"over": why})), CLOSE_PATIENCE)
        await asyncio.wait_for(connection.close(), CLOSE_PATIENCE)
    except (asyncio.TimeoutError, ConnectionClosed):
        connection.transport.abort()


def _coming(gui: Any) -> list[int]:
    """Bytes of each file that is on its way from a tab."""
    return [state["total_bytes"] for state in gui._current_file_upload_states.values()]


def refusal(name: str, size: int) -> InputFileError:
    """Why a file may not come, for a person."""
    if size > MAX_UPLOAD:
        found = f"has {-(-size // 10**6)} MB, and {MAX_UPLOAD // 10**6} MB is the most"
        return InputFileError(name, found, "crop the map, or make its cells larger")
    return InputFileError(name, "too much is on its way already", "choose it again once that is there")
