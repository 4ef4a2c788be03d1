"""What a stranger can try: each attack works on viser as it comes, and not on a server of ours."""

from __future__ import annotations

import contextlib
import logging
import math
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
import viser
from viser import _messages
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from app.access import Access
from app.gate import CHUNK, MAX_FRAME, MAX_UPLOAD
from app.guard import guarded_server

PATIENCE = 20.0
SPEAKS = [f"viser-v{viser.__version__}"]


CAMERA = {
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [0.0, 0.0, 9.0],
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 1.0, 0.0],
    "fov": 1.0,
    "near": 1.0,
    "far": 99.0,
    "image_height": 100,
    "image_width": 100,
}


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
        room.dropdown = gui.add_dropdown("dropdown", ("a", "b"))
        room.text, room.note = gui.add_text("text", ""), gui.add_text("note", "")
        room.disabled = gui.add_button("disabled", disabled=True)
        with gui.add_folder("hidden", visible=False):
            room.hidden = gui.add_button("hidden")
        room.upload = gui.add_upload_button("upload")
        for name in ("slider", "dropdown", "text", "note", "disabled", "hidden"):
            handle = getattr(room, name)
            hear = handle.on_click if name in ("disabled", "hidden") else handle.on_update
            hear(lambda event, name=name: self.done.append((name, event.target.value)))
        room.upload.on_upload(lambda event: self.done.append(("upload", event.target.value.name)))
        self.rooms.append(room)

    def stop(self) -> None:
        self.server.stop()


class Visitor:
    """A client of the wire protocol that keeps to no rules."""

    def __init__(self, stand: Stand, **headers: str) -> None:
        had = len(stand.rooms)
        self.stand = stand
        self.socket = join(stand.port, **headers)
        self.send("ViewerCameraMessage", **CAMERA)  # with it a tab begins to be one
        self.room = until(lambda: stand.rooms[had] if len(stand.rooms) > had else None)

    def send(self, kind: str, **fields: Any) -> None:
        self.socket.send(msgspec.msgpack.encode({"type": kind, **fields}))

    def write(self, handle: Any, **updates: Any) -> None:
        self.send("GuiUpdateMessage", uuid=handle._impl.uuid, updates=updates)

    def start_upload(self, name: str, size: int, parts: int | None = None) -> str:
        transfer = f"t{time.monotonic_ns()}"
        self.send(
            "FileTransferStartUpload",
            source_component_uuid=self.room.upload._impl.uuid,
            transfer_uuid=transfer,
            filename=name,
            mime_type="text/yaml",
            part_count=-(-size // CHUNK) if parts is None else parts,
            size_bytes=size,
        )
        return transfer

    def hears_out(self) -> None:
        """Take what comes until the connection is closed."""
        with contextlib.suppress(ConnectionClosed):
            while True:
                self.socket.recv(timeout=PATIENCE)

    def has_been_heard(self) -> bool:
        """Whether all that was sent before has been dealt with, and the connection lives."""
        mark = f"mark {time.monotonic_ns()}"
        self.write(self.room.text, value=mark)
        return bool(until(lambda: ("text", mark) in self.stand.done))


def until(check: Callable[[], Any]) -> Any:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if found := check():
            return found
        time.sleep(0.01)
    return None


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


@pytest.fixture(scope="module")
def stock() -> Iterator[Stand]:
    stand = Stand(viser.ViserServer(host="127.0.0.1", port=0, verbose=False))
    yield stand
    stand.stop()


@pytest.fixture(scope="module")
def ours() -> Iterator[Stand]:
    stand = Stand(guarded_server("127.0.0.1", 0, Access(), 40))
    yield stand
    stand.stop()


@pytest.fixture(scope="module")
def locked() -> Iterator[Stand]:
    stand = Stand(guarded_server("127.0.0.1", 0, Access(None, TOKEN), 40))
    yield stand
    stand.stop()


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


# --- who gets in ------------------------------------------------------------------------------------


FOREIGN = {
    "another site's page": {"origin": "http://evil.example"},
    "a foreign name for this machine": {"origin": "http://evil.example:80", "host": "evil.example:80"},
    "a page of another port": {"origin": "http://127.0.0.1:1"},
    "a sandboxed page": {"origin": "null"},
    "no page at all": {"origin": None},
}


@pytest.mark.parametrize("who", FOREIGN.values(), ids=FOREIGN)
def test_nobody_connects_but_the_page_itself(stock, ours, who):
    join(stock.port, **who).close()
    with pytest.raises(InvalidStatus) as refused:
        join(ours.port, **who)
    assert refused.value.response.status_code in (403, 421)


def test_the_page_is_not_served_under_a_foreign_name(stock, ours):
    assert get(stock.port, Host="evil.example")[0] == 200
    assert get(ours.port, Host="evil.example")[0] == 421
    assert get(ours.port, Host=f"localhost:{ours.port}")[0] == 200


@pytest.mark.parametrize("query", ["?websocket=ws://evil.example", "?playbackPath=http://evil.example/x"])
def test_no_address_makes_the_page_obey_another_server(stock, ours, query):
    """viser's page connects to, or plays, what its address names."""
    assert get(stock.port, f"/{query}")[0] == 200
    status, headers, _ = get(ours.port, f"/{query}")
    assert (status, headers["Location"]) == (303, "./")
    policy = get(ours.port)[1]["Content-Security-Policy"]
    assert "connect-src 'self' data: blob:;" in policy


def test_the_page_cannot_be_framed_by_another(stock, ours):
    assert "Content-Security-Policy" not in get(stock.port)[1]
    assert "frame-ancestors 'none'" in get(ours.port)[1]["Content-Security-Policy"]


def test_without_the_token_there_is_no_page_and_no_connection(ours, locked):
    assert get(ours.port)[0] == 200
    status, headers, body = get(locked.port)
    assert status == 401
    assert b"give the token" in body
    assert b"mapmeld-" not in body
    assert len(body) < 2000
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    for cookie in ("", "mapmeld=1", f"{Access(None, TOKEN).cookie}={TOKEN}x", f"other={TOKEN}"):
        with pytest.raises(InvalidStatus) as refused:
            join(locked.port, cookie=cookie)
        assert refused.value.response.status_code == 401
    assert get(locked.port, f"/?token={TOKEN[:-1]}")[0] == 401
    assert get(locked.port, f"/index.html?token={TOKEN}")[0] == 401


def test_the_token_becomes_a_cookie_that_scripts_and_other_sites_cannot_use(locked):
    status, headers, _ = get(locked.port, f"/?token={TOKEN}")
    assert (status, headers["Location"]) == (303, "./")  # it leaves the address, and a proxy's folder stays
    kept = headers["Set-Cookie"]
    assert "HttpOnly" in kept
    assert "SameSite=Strict" in kept
    assert "Path" not in kept
    assert "Secure" not in kept
    assert "Secure" in get(locked.port, f"/?token={TOKEN}", **{"X-Forwarded-Proto": "https"})[1]["Set-Cookie"]
    cookie = kept.partition(";")[0]
    assert get(locked.port, Cookie=f"a=b; {cookie}")[0] == 200
    Visitor(locked, cookie=cookie).socket.close()
    with pytest.raises(InvalidStatus):
        join(locked.port, origin="http://evil.example", cookie=cookie)


def test_no_client_has_a_public_tunnel_opened(stock, ours):
    for stand in (stock, ours):
        visitor = Visitor(stand)
        visitor.send("ShareUrlRequest")
        assert visitor.has_been_heard()
        visitor.socket.close()
    assert stock.tunnels == 1
    assert ours.tunnels == 0


@pytest.mark.parametrize(
    "path", ["/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%5c..%5cx", "//etc/passwd"]
)
def test_no_path_leads_out_of_the_page(ours, path):
    with socket.create_connection(("127.0.0.1", ours.port), timeout=PATIENCE) as raw:
        raw.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{ours.port}\r\n\r\n".encode())
        assert raw.recv(1000).startswith(b"HTTP/1.1 404 ")


# --- what a message may do --------------------------------------------------------------------------


def told(stand: Stand, do: Callable[[Visitor], None]) -> tuple[list[tuple[str, Any]], Visitor]:
    """What has come of something that a visitor did."""
    visitor = Visitor(stand)
    had = len(stand.done)
    do(visitor)
    assert visitor.has_been_heard()
    return [what for what in stand.done[had:] if what[0] != "text"], visitor


ABUSES: dict[str, Callable[[Visitor], None]] = {
    "a value beyond its range": lambda v: v.write(v.room.slider, value=1e9),
    "a choice that is none": lambda v: v.write(v.room.dropdown, value="<script>alert(1)</script>"),
    "a press of a disabled button": lambda v: v.write(v.room.disabled, value=True),
    "a press of a hidden button": lambda v: v.write(v.room.hidden, value=True),
    "a text of a megabyte": lambda v: v.write(v.room.note, value="x" * 1_000_000),
    "a value of another type": lambda v: v.write(v.room.slider, value="7"),
}


@pytest.mark.parametrize("abuse", ABUSES.values(), ids=ABUSES)
def test_a_control_takes_only_what_a_person_could_have_entered(stock, ours, abuse):
    happened, visitor = told(stock, abuse)
    assert happened
    visitor.socket.close()
    dropped = sum(ours.server.gate.dropped.values())
    happened, visitor = told(ours, abuse)
    assert happened == []
    assert sum(ours.server.gate.dropped.values()) == dropped + 1
    visitor.socket.close()


def test_only_the_value_of_a_control_can_be_written(stock, ours):
    for stand, still in ((stock, 0), (ours, 1)):
        visitor = Visitor(stand)
        visitor.write(stand.shared, update_cb=[])
        assert visitor.has_been_heard()
        assert len(stand.shared._impl.update_cb) == still
        visitor.write(visitor.room.slider, removed=True)
        assert visitor.has_been_heard()
        assert visitor.room.slider._impl.removed is not bool(still)
        visitor.socket.close()


NOISE: dict[str, bytes | str] = {
    "random bytes": bytes(range(256)),
    "a text": "hello",
    "no mapping": msgspec.msgpack.encode([1, 2]),
    "no type": msgspec.msgpack.encode({"a": 1}),
    "a very deep one": b"\x91" * 100_000,
}


@pytest.mark.parametrize("noise", NOISE.values(), ids=NOISE)
def test_garbage_ends_the_connection_it_came_by_and_nothing_else(ours, noise, caplog):
    other, visitor = Visitor(ours), Visitor(ours)
    with caplog.at_level(logging.INFO):
        visitor.socket.send(noise)
        visitor.hears_out()
    assert visitor.socket.close_code == 1007
    assert other.has_been_heard()
    other.socket.close()
    assert "Traceback" not in caplog.text


ODD: dict[str, dict[str, Any]] = {
    "of no kind that there is": {"type": "Nothing"},
    "of a kind that only a server sends": {"type": "RunJavascriptMessage", "source": "alert(1)"},
    "without its fields": {"type": "GuiUpdateMessage"},
    "with a field too many": {"type": "GuiUpdateMessage", "uuid": "x", "updates": {}, "more": 1},
    "about a number as a name": {"type": "GuiUpdateMessage", "uuid": 5, "updates": {}},
    "with a camera nowhere": {"type": "ViewerCameraMessage", **CAMERA, "position": [math.nan] * 3},
}


@pytest.mark.parametrize("odd", ODD.values(), ids=ODD)
def test_a_message_that_the_page_never_sends_is_dropped_and_counted(ours, odd):
    visitor = Visitor(ours)
    before = ours.server.gate.dropped.copy()
    visitor.send(**{"kind": odd["type"], **{key: odd[key] for key in odd if key != "type"}})
    assert visitor.has_been_heard()
    visitor.socket.close()
    assert sum((ours.server.gate.dropped - before).values()) == 1


def test_a_frame_larger_than_any_of_the_page_ends_its_connection(stock, ours):
    frame = b"x" * (MAX_FRAME + 1)
    stock_visitor, visitor = Visitor(stock), Visitor(ours)
    for one, code in ((stock_visitor, 1011), (visitor, 1009)):  # 1011: stock has read it, and stumbled
        one.socket.send(frame)
        one.hears_out()
        assert one.socket.close_code == code


def test_who_sends_too_fast_is_slowed_and_loses_nothing(ours):
    visitor = Visitor(ours)
    before = ours.server.gate.dropped["slowed"]
    for k in range(600):
        visitor.write(visitor.room.slider, value=k % 11)
    assert visitor.has_been_heard()
    assert ours.server.gate.dropped["slowed"] > before
    assert visitor.room.slider.value == 599 % 11
    visitor.socket.close()


# --- what an upload may do --------------------------------------------------------------------------


SIZES: dict[str, tuple[int, int | None]] = {
    "larger than any map": (MAX_UPLOAD + 1, None),
    "less than nothing": (-5, 1),
    "in more parts than it has": (10, 10**9),
}


@pytest.mark.parametrize(("size", "parts"), SIZES.values(), ids=SIZES)
def test_an_upload_says_how_large_it_is_and_keeps_to_it(stock, ours, size, parts):
    for stand, begun in ((stock, 1), (ours, 0)):
        visitor = Visitor(stand)
        visitor.start_upload("map.pgm", size, parts)
        assert visitor.has_been_heard()
        assert len(visitor.room.client.gui._current_file_upload_states) == begun
        visitor.socket.close()


def test_no_tab_makes_the_server_hold_more_than_two_large_files(stock, ours):
    for stand, most in ((stock, 6), (ours, 2)):
        visitor = Visitor(stand)
        for _ in range(6):
            visitor.start_upload("map.pgm", MAX_UPLOAD)
        assert visitor.has_been_heard()
        assert len(visitor.room.client.gui._current_file_upload_states) == most
        visitor.socket.close()


def test_a_part_is_as_long_as_it_was_announced(stock, ours):
    for stand, kept in ((stock, 1), (ours, 0)):
        visitor = Visitor(stand)
        transfer = visitor.start_upload("map.pgm", 2 * CHUNK)
        long = {"source_component_uuid": None, "transfer_uuid": transfer, "part_index": 1}
        visitor.send("FileTransferPart", **long, content=b"x" * (CHUNK - 1))
        assert visitor.has_been_heard()
        (state,) = visitor.room.client.gui._current_file_upload_states.values()
        assert len(state["parts"]) == kept
        visitor.socket.close()


def test_an_upload_that_keeps_to_the_rules_arrives(ours):
    visitor = Visitor(ours)
    data = bytes(CHUNK + 10)
    transfer = visitor.start_upload("map.pgm", len(data))
    for k in range(2):
        visitor.send(
            "FileTransferPart",
            source_component_uuid=visitor.room.upload._impl.uuid,
            transfer_uuid=transfer,
            part_index=k,
            content=data[k * CHUNK : (k + 1) * CHUNK],
        )
    assert until(lambda: ("upload", "map.pgm") in ours.done)
    visitor.socket.close()


def test_no_file_is_taken_by_a_control_that_takes_none(stock, ours):
    for stand, begun in ((stock, 1), (ours, 0)):
        visitor = Visitor(stand)
        visitor.room.upload = visitor.room.slider
        visitor.start_upload("map.pgm", 10)
        assert visitor.has_been_heard()
        assert len(visitor.room.client.gui._current_file_upload_states) == begun
        visitor.socket.close()


def test_the_messages_that_are_let_in_are_those_of_viser():
    assert all(hasattr(_messages, name) for name in ("ShareUrlRequest", "RunJavascriptMessage"))
