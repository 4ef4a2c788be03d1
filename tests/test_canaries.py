"""What the page leans on of viser's insides, each by name: an upgrade says which of it broke."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import pytest
import viser
import viser.infra._infra as infra
import websockets.asyncio.server
import websockets.protocol
from viser import _gui_handles, _messages
from viser._gui_api import GuiApi, _FileUploadState

from app.access import Access
from app.guard import guarded_server
from app.heard import HEARD

GUI = Path(inspect.getfile(GuiApi)).read_text(encoding="utf-8")  # as it is there: ours may stand in its place
CLIENT = Path(viser.__file__).parent / "client" / "src"


def source(thing: Callable[..., object]) -> str:
    return inspect.getsource(thing)


def typescript(name: str) -> str:
    return (CLIENT / name).read_text(encoding="utf-8")


ASSUMPTIONS: dict[str, Callable[[], bool]] = {
    "viser is the version that was measured": lambda: viser.__version__ == "1.1.1",
    "the server is started through the module's name websockets, so that ours stands in between": lambda: (
        (infra.websockets is websockets or hasattr(infra.websockets, "asyncio"))
        and "websockets.asyncio.server.serve(" in source(infra.WebsockServer._background_worker)
    ),
    "requests are answered by process_request": lambda: (
        "process_request=(" in source(infra.WebsockServer._background_worker)
    ),
    "the handler of a connection is the first argument of serve": lambda: (
        next(iter(inspect.signature(websockets.asyncio.server.serve).parameters)) == "handler"
    ),
    "frames come by recv, one at a time, and as bytes": lambda: (
        "raw = await websocket.recv()" in source(infra._message_consumer)
    ),
    "a connection is of a kind that can be given": lambda: (
        "create_connection" in inspect.signature(websockets.asyncio.server.serve).parameters
        and "self.protocol = protocol"
        in source(websockets.asyncio.server.ServerConnection.__mro__[1].__init__)
    ),
    "every frame that comes is taken by recv_frame, which may refuse it": lambda: (
        "self.recv_frame(frame)" in source(websockets.protocol.Protocol.parse)
        and "except ProtocolError as exc:" in source(websockets.protocol.Protocol.parse)
    ),
    "a handshake that fails is told to this logger, in these words": lambda: (
        'logging.getLogger("websockets.server")' in source(websockets.asyncio.server.Server.__init__)
        and '"connection handler failed"' in source(websockets.asyncio.server.Server.conn_handler)
        and '"opening handshake failed"' in source(websockets.asyncio.server.Server.conn_handler)
    ),
    "a tab's controls are found by their id": lambda: (
        "self._gui_input_handle_from_uuid.get(message.uuid, None)" in GUI
    ),
    "what a control lies in is found by its id": lambda: "_container_handle_from_uuid" in GUI,
    "a tab of a panel knows its panel": lambda: (
        "_parent" in {field.name for field in fields(_gui_handles.GuiTabHandle)}
    ),
    "uploads on their way are kept by their id, with these words about each": lambda: (
        set(_FileUploadState.__annotations__)
        == {"client_id", "filename", "mime_type", "part_count", "parts", "total_bytes"}
        | {"transferred_bytes", "lock"}
    ),
    "a tab that goes takes what is kept of its uploads along": lambda: (
        source(viser.ViserServer.__init__).count("gui._drop_uploads_from_client(") == 2
    ),
    "an upload comes to its end by its tab, its id and its button": lambda: (
        list(inspect.signature(GuiApi._finish_file_upload).parameters)[1:]
        == ["client_id", "transfer_uuid", "source_component_uuid"]
    ),
    "a picker of files bears the id of its button": lambda: (
        "id={`file_upload_${uuid}`}" in typescript("components/UploadButton.tsx")
    ),
    "a connection for files is not taken for a request of a file": lambda: (
        'request.headers.get("Upgrade") == "websocket"' in source(infra.WebsockServer._background_worker)
    ),
    "a tab finds its server": lambda: callable(getattr(GuiApi, "_root_server", None)),
    "the share tunnel hangs on two messages": lambda: all(
        hasattr(_messages, name) for name in ("ShareUrlRequest", "ShareUrlDisconnect")
    ),
    "the page's scripts travel as a message": lambda: hasattr(_messages, "RunJavascriptMessage"),
    "an address can make the page obey another server, which is why queries are taken off": lambda: (
        "URLSearchParams(window.location.search).getAll(" in typescript("App.tsx")
    ),
}


@pytest.mark.parametrize("assumption", ASSUMPTIONS)
def test_viser_still_is_as_the_page_takes_it_to_be(assumption):
    assert ASSUMPTIONS[assumption](), f"viser {viser.__version__} broke: {assumption}"


@pytest.mark.parametrize("kind", HEARD)
def test_a_message_has_the_fields_that_the_gate_asks_for(kind):
    theirs = {field.name for field in fields(getattr(_messages, kind)) if field.init}
    assert set(HEARD[kind].__struct_fields__) == {"type"} | theirs


def test_every_message_that_is_heard_is_one_that_a_server_hears_or_ignores():
    """And what else the server would hear, the gate keeps out."""
    server = guarded_server("127.0.0.1", 0, Access(), 4)
    try:
        heard = {kind.__name__ for kind in server._websock_server._incoming_handlers}
        assert not heard & {"ShareUrlRequest", "ShareUrlDisconnect"}
        assert "GuiUpdateMessage" in heard
    finally:
        server.stop()
