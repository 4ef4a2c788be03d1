"""Someone who keeps to no rules, and servers to try it on: what the tests of attacks share."""

from __future__ import annotations

import contextlib
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Coroutine, Iterator
from types import SimpleNamespace
from typing import Any

import msgspec
import viser
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from wire import CAMERA, until

PATIENCE = 20.0
CHUNK = 512 * 1024  # bytes of a part of an upload, by viser's own way
SPEAKS = [f"viser-v{viser.__version__}"]


class Stand:
    """A server with a control of each kind for whoever comes, and what has been done to them."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server, self.port = server, server.get_port()
        self.rooms: list[SimpleNamespace] = []
        self.done: list[tuple[str, Any]] = []
        self.shared = server.gui.add_button("for everyone")
        self.shared.on_click(lambda _: self.done.append(("shared", True)))
        self.tunnels = 0
        server.request_share_url = self._tunnel  # type: ignore[method-assign]
        server.on_client_connect(self._furnish)

    def _tunnel(self, *_: Any, **__: Any) -> None:
        self.tunnels += 1

    def _furnish(self, client: viser.ClientHandle) -> None:
        gui = client.gui
        room = SimpleNamespace(client=client)
        room.slider = gui.add_slider("slider", min=0, max=10, step=1, initial_value=5)
        room.angle = gui.add_slider("angle", min=0.0, max=1.0, step=0.01, initial_value=0.5)
        room.number = gui.add_number("number", 1.0, step=0.01)  # without bounds of its own
        room.dropdown = gui.add_dropdown("dropdown", ("a", "b"))
        room.text, room.note = gui.add_text("text", ""), gui.add_text("note", "")
        room.disabled = gui.add_button("disabled", disabled=True)
        with gui.add_folder("hidden", visible=False):
            room.hidden = gui.add_button("hidden")
        room.upload = gui.add_upload_button("upload")
        for name in ("slider", "angle", "number", "dropdown", "text", "note", "disabled", "hidden"):
            handle = getattr(room, name)
            hear = handle.on_click if name in ("disabled", "hidden") else handle.on_update
            hear(self._noting(name))
        room.upload.on_upload(self._noting("upload"))
        self.rooms.append(room)

    def _noting(self, name: str) -> Callable[[Any], Coroutine[Any, Any, None]]:
        async def note(event: Any) -> None:  # in viser's own loop: what is done is noted in its order
            value = event.target.value
            self.done.append((name, value.name if name == "upload" else value))

        return note


class Visitor:
    """A client of the wire protocol that keeps to no rules."""

    def __init__(self, stand: Stand, **headers: str) -> None:
        had = len(stand.rooms)
        self.stand = stand
        self.socket = join(stand.port, **headers)
        self.send("ViewerCameraMessage", **CAMERA)  # with it a tab begins to be one
        self.room = until(lambda: stand.rooms[had:], "a room of its own", PATIENCE)[0]

    def send(self, kind: str, **fields: Any) -> None:
        self.socket.send(msgspec.msgpack.encode({"type": kind, **fields}))

    def write(self, handle: Any, **updates: Any) -> None:
        self.send("GuiUpdateMessage", uuid=handle._impl.uuid, updates=updates)

    def start_upload(self, name: str, size: int, control: str = "upload") -> str:
        """Announce a file by viser's own way."""
        transfer = f"t{time.monotonic_ns()}"
        self.send(
            "FileTransferStartUpload",
            source_component_uuid=self.find(control),
            transfer_uuid=transfer,
            filename=name,
            mime_type="text/yaml",
            part_count=max(1, -(-size // CHUNK)),
            size_bytes=size,
        )
        return transfer

    @property
    def port(self) -> int:
        return self.stand.port

    def find(self, label: str) -> str:
        """The id of the control of this label."""
        return str(getattr(self.room, label)._impl.uuid)

    @property
    def coming(self) -> list[Any]:
        """What the server keeps of files on their way."""
        return list(self.room.client.gui._current_file_upload_states.values())

    def hears_out(self) -> None:
        """Take what comes until the connection is closed."""
        with contextlib.suppress(ConnectionClosed):
            while True:
                self.socket.recv(timeout=PATIENCE)

    def has_been_heard(self) -> bool:
        """Whether all that was sent before has been dealt with, and the connection lives."""
        mark = f"mark {time.monotonic_ns()}"
        self.write(self.room.text, value=mark)
        return bool(until(lambda: ("text", mark) in self.stand.done, "what was sent", PATIENCE))


def join(port: int, origin: str | None = "", host: str = "", cookie: str = "") -> ClientConnection:
    """Open a websocket; origin "": that of the page itself."""
    own = f"http://127.0.0.1:{port}"
    headers = {"Cookie": cookie} if cookie else {}
    if host:  # a page under a foreign name that points here
        headers["Host"] = host
    return connect(
        f"ws://127.0.0.1:{port}/",
        subprotocols=SPEAKS,
        origin=own if origin == "" else origin,
        additional_headers=headers,
        compression=None,
        max_size=None,
        open_timeout=PATIENCE,
    )


TOKEN = "a-token-that-nobody-guesses"


def get(port: int, path: str = "/", **headers: str) -> tuple[int, Any, bytes]:
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", headers=headers)
    opener = urllib.request.build_opener(Stay)
    try:
        with opener.open(request, timeout=PATIENCE) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()


class Stay(urllib.request.HTTPRedirectHandler):
    """Follows no redirection."""

    def redirect_request(self, *_: Any) -> None:
        return None


@contextlib.contextmanager
def standing(server: viser.ViserServer) -> Iterator[Stand]:
    """A stand on a server that ends with it."""
    try:
        yield Stand(server)
    finally:
        server.stop()
