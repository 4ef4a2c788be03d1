"""Hangs the rules of access_control and message_filter into viser, which itself asks nobody who they are.

Measured on viser 1.1.1: any web page that is open in the same browser could drive a server on this
machine, any client could have a public tunnel opened, write any property of a widget, and fill the
memory with uploads. What this leans on of viser's insides, tests/app/web/test_canaries.py holds it to.
"""

from __future__ import annotations

import http
import logging
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import rich
import viser
import viser.infra._infra as infra
import websockets.asyncio.server
import websockets.datastructures
import websockets.exceptions
from viser import _messages as messages
from viser._gui_api import GuiApi
from websockets.http11 import Response

from app.system.logging_setup import quiet_handshakes
from app.web.callback_errors import watched
from app.web.index_page import served
from app.web.security.access_control import HEADERS, PAGE_POLICY, Access, HttpReply, HttpRequest
from app.web.security.frame_limit import bounded
from app.web.security.message_filter import MessageFilter
from app.web.upload import MOST, PATH, Uploads

log = logging.getLogger(__name__)

SPEAKS = f"viser-v{viser.__version__}"
TOO_MANY = HttpReply(503, "too many tabs are open here; close one, and reload")
NOT_FOUND = HttpReply(404, "there is no such page here")
NO_REQUEST = HttpReply(400, "this is no request of the page")


def guarded_server(host: str, port: int, access: Access, most: int) -> viser.ViserServer:
    """A ViserServer that answers whom ``access`` lets in.

    Its ``gate`` counts what it let nobody do, its ``uploads`` take in files.

    most : connections of pages at a time, and so many of files
    """
    _harden_widgets()
    quiet_handshakes()
    # viser prints what it thinks of, words of strangers among them, in the loop that serves everybody:
    # where nobody reads what is printed, that loop waits for ever
    rich.reconfigure(quiet=True)
    gate = MessageFilter()
    real_serve = websockets.asyncio.server.serve
    live: set[Any] = set()
    files: set[Any] = set()  # connections that bring one
    uploads = Uploads(gate, lambda: server.get_clients())

    def serve(handler: Any, at: str, on: int, *, process_request: Callable[..., Any], **options: Any) -> Any:
        async def process(connection: Any, request: Any) -> Any:
            try:
                incoming = HttpRequest.of(request.path, request.headers.raw_items())
                answer = access.answer(incoming)
                full = len(files if incoming.path == PATH else live) >= most
                if answer is None and incoming.upgrade and full:
                    answer = TOO_MANY
                if answer is None:
                    return _with_words(process_request(connection, request))
            except OSError:  # of a path that is longer than any file's
                answer = NOT_FOUND
            except Exception as error:  # its words are the stranger's
                log.warning("a request could not be answered: %s", type(error).__name__)
                answer = NO_REQUEST
            gate.drop(f"request, {answer.status}")
            return _response(answer)

        async def handle(connection: Any) -> None:
            is_upload = connection.request.path == PATH
            group = files if is_upload else live
            if not is_upload:
                if connection.subprotocol != SPEAKS:  # a tab from before an upgrade; it is asked to reload
                    gate.drop("version")
                    await connection.close(1002, "another version is served here: reload the page")
                    return
                gate.guard(connection)
            group.add(connection)
            try:
                await (uploads.receive if is_upload else handler)(connection)
            except RuntimeError:
                if not ending():  # viser tells who has gone in threads that may have ended already
                    raise
            finally:
                group.discard(connection)

        options["max_size"] = MOST
        options["create_connection"] = bounded(gate)
        return real_serve(handle, at, on, process_request=process, ssl=access.tls, **options)

    shim = SimpleNamespace(
        asyncio=SimpleNamespace(
            server=SimpleNamespace(serve=serve, ServerConnection=websockets.asyncio.server.ServerConnection)
        ),
        datastructures=websockets.datastructures,
        exceptions=websockets.exceptions,
    )

    def ending() -> bool:
        event = server._websock_server._stop_event
        return event is not None and event.is_set()

    real = infra.websockets
    infra.websockets = shim  # viser's own name for the library; it is looked up once, in the constructor
    try:
        server = viser.ViserServer(host=host, port=port, verbose=False)
    finally:
        infra.websockets = real
    for kind in (messages.ShareUrlRequest, messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(kind)
    server._thread_executor.submit = watched(server._thread_executor.submit)  # type: ignore[method-assign]
    server.gate, server.uploads = gate, uploads  # type: ignore[attr-defined]
    return server


def _response(answer: HttpReply) -> Response:
    body = answer.body.encode()
    kind = "text/html" if answer.body.startswith("<") else "text/plain"
    own = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(body))}
    headers = websockets.datastructures.Headers({**own, **HEADERS, **answer.headers})
    return Response(answer.status, http.HTTPStatus(answer.status).phrase, headers, body)


def _with_words(answer: Response | None) -> Response | None:
    """The page with what it says where it cannot be drawn; anything else as it is."""
    if answer is None:
        return None
    for name, value in HEADERS.items():
        answer.headers[name] = value
    if answer.headers.get("Content-Type", "").startswith("text/html"):
        answer.headers["Content-Security-Policy"] = PAGE_POLICY
        body = served(answer.body, answer.headers.get("Content-Encoding") == "gzip")
        del answer.headers["Content-Length"]
        answer.headers["Content-Length"] = str(len(body))
        answer.body = body
    return answer


def _harden_widgets() -> None:
    """Ask the gate before viser acts on what a browser sent."""
    if getattr(GuiApi, "_mapmeld_hardened", False):
        return
    GuiApi._mapmeld_hardened = True  # type: ignore[attr-defined]
    update = GuiApi._handle_gui_updates

    async def safe_update(self: Any, client_id: Any, message: Any) -> None:
        gate = getattr(self._root_server(), "gate", None)  # none: of a server that tests start
        if gate is None or gate.takes(self, message):
            await update(self, client_id, message)

    GuiApi._handle_gui_updates = safe_update  # type: ignore[method-assign]
