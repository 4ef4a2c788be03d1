"""What the page leans on of viser's insides, each by name: an upgrade says which of it broke."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import fields
from itertools import dropwhile
from pathlib import Path

import pytest
import viser
import viser.infra._infra as infra
import websockets.asyncio.server
import websockets.protocol
from repository import ROOT
from strangers import PATIENCE, Stand, Visitor
from viser import _gui_handles, _messages
from viser._gui_api import GuiApi, _FileUploadState
from wire import until

from app.web.security.message_schema import MESSAGES

GUI = Path(inspect.getfile(GuiApi)).read_text(encoding="utf-8")  # as it is there: ours may stand in its place
CLIENT = Path(viser.__file__).parent / "client" / "src"


def source(thing: Callable[..., object]) -> str:
    return inspect.getsource(thing)


def typescript(name: str) -> str:
    return (CLIENT / name).read_text(encoding="utf-8")


def asked_of_websockets() -> set[str]:
    """What viser's module asks of the name websockets."""
    tree = ast.parse(Path(inspect.getfile(infra)).read_text(encoding="utf-8"))
    named = {ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    asked = {name for name in named if name.startswith("websockets.")}
    return {name for name in asked if not any(other.startswith(f"{name}.") for other in asked)}


def asked_of_the_viewer() -> set[str]:
    """What our scripts ask of the object that viser's page shows to tests: viewer(), or m for short."""
    scripts = [path.read_text(encoding="utf-8") for path in (ROOT / "app" / "frontend").glob("*.js")]
    asking = [script for script in scripts if "viewer()" in script]
    return {name for script in asking for name in re.findall(r"(?:\bviewer\(\)\??|\bm)\.(\w+)", script)}


ASSUMPTIONS: dict[str, Callable[[], bool]] = {
    "viser is the version that was measured": lambda: viser.__version__ == "1.1.1",
    "the server is started through the module's name websockets, so that ours stands in between": lambda: (
        infra.websockets is websockets
        and "websockets.asyncio.server.serve(" in source(infra.WebsockServer._background_worker)
    ),
    "and of that name it asks for no more than ours hands on": lambda: (
        asked_of_websockets()
        == {"websockets.asyncio.server.serve", "websockets.asyncio.server.ServerConnection"}
        | {"websockets.exceptions.ConnectionClosedOK", "websockets.exceptions.ConnectionClosedError"}
        | {"websockets.datastructures.Headers"}
    ),
    "requests are answered by process_request": lambda: (
        "process_request=(" in source(infra.WebsockServer._background_worker)
    ),
    "what serve is given first is the handler of a connection, the host and the port": lambda: (
        list(inspect.signature(websockets.asyncio.server.serve).parameters)[:3] == ["handler", "host", "port"]
        and re.search(
            r"server\.serve\(\s+ws_handler,\s+host,\s+port_attempt,\n",
            source(infra.WebsockServer._background_worker),
        )
        is not None
    ),
    "a port that is taken leads to the next one, of which nothing is said but by get_port": lambda: (
        "except OSError:  # Port not available.\n                    port_attempt += 1"
        in source(infra.WebsockServer._background_worker)
    ),
    "frames come by recv, one at a time, and as bytes": lambda: (
        "raw = await websocket.recv()" in source(infra._message_consumer)
    ),
    "what is said to a tab goes by send, and waits for it": lambda: (
        'await websocket.send(b"".join(parts))' in source(infra._message_producer)
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
    "what a browser writes into a control is taken by this method, with these words": lambda: (
        "async def _handle_gui_updates(\n"
        "        self, client_id: ClientId, message: _messages.GuiUpdateMessage\n" in GUI
    ),
    "uploads on their way are kept by their id, with these words about each": lambda: (
        set(_FileUploadState.__annotations__)
        == {"client_id", "filename", "mime_type", "part_count", "parts", "total_bytes"}
        | {"transferred_bytes", "lock"}
        and "self._current_file_upload_states: dict[str, _FileUploadState] = {}" in GUI
    ),
    "a tab that goes takes what is kept of its uploads along": lambda: (
        source(viser.ViserServer.__init__).count("gui._drop_uploads_from_client(") == 2
    ),
    "an upload comes to its end by its tab, its id and its button": lambda: (
        list(inspect.signature(GuiApi._finish_file_upload).parameters)[1:]
        == ["client_id", "transfer_uuid", "source_component_uuid"]
    ),
    "what controls and uploads do is done by _thread_executor.submit, asked for each time": lambda: (
        0 < GUI.count("thread_executor.submit") == GUI.count("self._thread_executor.submit(\n")
    ),
    "a picker of files bears the id of its button": lambda: (
        "id={`file_upload_${uuid}`}" in typescript("components/UploadButton.tsx")
    ),
    "a connection for files is not taken for a request of a file": lambda: (
        'request.headers.get("Upgrade") == "websocket"' in source(infra.WebsockServer._background_worker)
    ),
    "whatever hears of a kind of message can be taken away": lambda: (
        "self._incoming_handlers.pop(message_cls)" in source(infra.WebsockMessageHandler.unregister_handler)
    ),
    "the page's scripts travel as a message, whose source is run": lambda: (
        [field.name for field in fields(_messages.RunJavascriptMessage)] == ["source"]
        and 'case "RunJavascriptMessage": {\n        new Function(message.source)();'
        in typescript("MessageHandler.tsx")
    ),
    "an address can make the page obey another server, which is why queries are taken off": lambda: (
        "URLSearchParams(window.location.search).getAll(" in typescript("App.tsx")
    ),
    "the page shows its camera, its scene and its way of sending under this name": lambda: (
        "w.__viserMutable = mutable.current;" in typescript("App.tsx")
        and {name for name in asked_of_the_viewer() if f"\n  {name}: " not in typescript("ViewerContext.ts")}
        == set()
    ),
    "a worker tells the page that its connection has come and gone, in these words": lambda: all(
        words in typescript("WebsocketClientWorker.ts")
        for words in ('type: "connected"', 'type: "closed"', "versionMismatch: versionMismatch")
    ),
}


@pytest.mark.parametrize("assumption", ASSUMPTIONS)
def test_viser_still_is_as_the_page_takes_it_to_be(assumption):
    assert ASSUMPTIONS[assumption](), f"viser {viser.__version__} broke: {assumption}"


# --- what only a tab that is there can tell ----------------------------------------------------------


@pytest.fixture(scope="module")
def visitor(ours: Stand) -> Iterator[Visitor]:
    visitor = Visitor(ours)
    assert visitor.has_been_heard()
    yield visitor
    visitor.socket.close()


def hears_by(interface: infra.WebsockMessageHandler) -> list[str]:
    """The names of what hears a control's value, in the order in which they are asked."""
    return [hears.__name__ for hears in interface._incoming_handlers[_messages.GuiUpdateMessage]]


def folder_of(control: viser.GuiButtonHandle) -> object:
    gui = control._impl.gui_api
    return gui._container_handle_from_uuid[control._impl.parent_container_id]


def tab_lies_in_its_panel(gui: viser.GuiApi) -> bool:
    group = gui.add_tab_group(visible=False)
    with group.add_tab("tab"):
        inside = gui.add_button("inside")
    tab = folder_of(inside)
    known = isinstance(tab, _gui_handles.GuiTabHandle) and tab._parent is group
    known = known and not hasattr(tab, "_impl") and group._impl.props.visible is False
    group.remove()
    return known


def waits_in_a_buffer_until_it_is_sent(client: viser.ClientHandle) -> bool:
    buffer = client._websock_connection.get_message_buffer()
    until(lambda: not buffer.message_from_id, "all to be sent", PATIENCE)
    with client.atomic():  # nothing is sent meanwhile
        client._websock_connection.queue_message(_messages.RunJavascriptMessage(source="1"))
        (waiting,) = buffer.message_from_id.values()
        kept = waiting.source == "1" and not buffer.done
    return kept and bool(until(lambda: not buffer.message_from_id, "it to be sent", PATIENCE))


LIVING: dict[str, Callable[[Visitor], bool]] = {
    "a control's handle knows its id, and is found by it": lambda v: (
        v.room.client.gui._gui_input_handle_from_uuid[v.room.slider._impl.uuid] is v.room.slider
    ),
    "it knows its value, its range, its choices, and whether it is shown and enabled": lambda v: (
        (v.room.slider._impl.value, v.room.slider._impl.props.min, v.room.slider._impl.props.max)
        == (5, 0, 10)
        and tuple(v.room.dropdown._impl.props.options) == ("a", "b")
        and (v.room.disabled._impl.props.disabled, v.room.slider._impl.props.disabled) == (True, False)
    ),
    "what a control lies in is found by an id, and is hidden where nobody sees the control": lambda v: (
        folder_of(v.room.hidden)._impl.props.visible is False
    ),
    "outermost lies something that is no control": lambda v: not hasattr(folder_of(v.room.slider), "_impl"),
    "a tab of a panel is no control, and knows its panel, which is one": lambda v: tab_lies_in_its_panel(
        v.room.client.gui
    ),
    "a tab's controls find its server": lambda v: (
        v.room.client.gui._root_server() is v.stand.server
        and v.stand.server.gui._root_server() is v.stand.server
    ),
    "all work of all tabs is given to one executor": lambda v: (
        v.room.client.gui._thread_executor is v.stand.server._thread_executor
        and v.stand.server.gui._thread_executor is v.stand.server._thread_executor
        and v.stand.server._thread_executor.submit.__module__ == "app.web.callback_errors"
    ),
    "who hears a control's value is settled as a tab begins: ours was there before": lambda v: (
        hears_by(v.room.client._websock_connection) == ["safe_update"]
        and hears_by(v.stand.server._websock_server) == ["safe_update"]
    ),
    "what is said to a tab waits in a buffer of its own until it is sent": lambda v: (
        waits_in_a_buffer_until_it_is_sent(v.room.client)
    ),
    "a server that ends says so by an event, which is not set before": lambda v: (
        v.stand.server._websock_server._stop_event.is_set() is False
        and "call_soon_threadsafe(self._stop_event.set)" in source(infra.WebsockServer.stop)
    ),
}


@pytest.mark.parametrize("assumption", LIVING)
def test_a_tab_still_is_as_the_page_takes_it_to_be(visitor, assumption):
    assert LIVING[assumption](visitor), f"viser {viser.__version__} broke: {assumption}"


def test_a_buffer_says_when_its_tab_has_gone(ours):
    visitor = Visitor(ours)
    buffer = visitor.room.client._websock_connection.get_message_buffer()
    assert not buffer.done
    visitor.socket.close()
    until(lambda: buffer.done, "the buffer's end", PATIENCE)


def test_a_server_of_ours_hears_whatever_visers_does_but_of_the_tunnel(stock, ours):
    theirs, here = (set(stand.server._websock_server._incoming_handlers) for stand in (stock, ours))
    assert theirs - here == {_messages.ShareUrlRequest, _messages.ShareUrlDisconnect}
    assert here <= theirs


# --- that nothing is left out ------------------------------------------------------------------------


@pytest.mark.parametrize("kind", MESSAGES)
def test_a_message_has_the_fields_that_the_gate_asks_for(kind):
    theirs = {field.name for field in fields(getattr(_messages, kind)) if field.init}
    assert set(MESSAGES[kind].__struct_fields__) == {"type"} | theirs


def private(name: str) -> bool:
    return name.startswith("_") and not name.startswith(("__", "_mapmeld_"))


def chain(node: ast.AST) -> list[str]:
    """The names in what is asked of something: ["a", "b", "c"] of a.b().c."""
    names: list[str] = []
    while isinstance(node, ast.Attribute | ast.Call):
        if isinstance(node, ast.Attribute):
            names.append(node.attr)
        node = node.value if isinstance(node, ast.Attribute) else node.func
    return [*([node.id] if isinstance(node, ast.Name) else [""]), *reversed(names)]


def insides(tree: ast.AST) -> Iterator[str]:
    """Names of the insides of others that a module speaks of, and of what it asks of these."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            named = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
            yield from filter(private, named)
        elif isinstance(node, ast.Import):
            yield from filter(private, ".".join(alias.name for alias in node.names).split("."))
        elif isinstance(node, ast.Attribute):
            first, *rest = chain(node)
            if first in ("self", "cls"):  # what comes next is its own
                rest = rest[1:]
            if first not in ("os", "super"):
                asked = dropwhile(lambda name: not private(name), rest)
                yield from (name for name in asked if not hasattr(dict, name))


def test_whatever_the_page_touches_of_the_insides_is_named_here():
    touched = set()
    for path in (ROOT / "app").rglob("*.py"):
        touched |= set(insides(ast.parse(path.read_text(encoding="utf-8"))))
    assert {"_impl", "parent_container_id", "_stop_event", "queue_message", "_gui_api"} <= touched
    named = Path(__file__).read_text(encoding="utf-8")
    assert [name for name in sorted(touched) if not re.search(rf"\b{name}\b", named)] == []
