"""Who may talk to the page: viser itself asks nobody who they are.

Measured on viser 1.1.1: any web page that is open in the same browser could drive a server on this
machine, any client could have a public tunnel opened, write any property of a widget, and fill the
memory with uploads. The patches below close that; a test checks that their hooks are still there.
"""

from __future__ import annotations

import contextlib
import http
import io
import ipaddress
import math
import urllib.parse
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import viser
import viser.infra._infra as infra
import websockets.asyncio.server
import websockets.datastructures
import websockets.exceptions
from viser import _messages as messages
from viser._gui_api import GuiApi
from websockets.http11 import Response

from app.entrance import served

MAX_UPLOAD = 200 * 2**20  # bytes of one file: a map of the largest size there may be
MAX_OPEN_UPLOADS = 4
MAX_TEXT = 10_000
CHUNK = 512 * 1024  # bytes of one part of an upload
LOOPBACK = ("127.0.0.1", "localhost", "::1")


def guarded_server(host: str, port: int) -> viser.ViserServer:
    """A ViserServer that answers only pages it has served itself.

    Bound to this machine it answers to this machine's names alone, so that no foreign name can be
    pointed at it (DNS rebinding).
    """
    _harden_widgets()
    local = host == "localhost" or _is_loopback(host)
    real_serve = websockets.asyncio.server.serve

    def serve(handler: Any, at: str, on: int, *, process_request: Callable[..., Any], **options: Any) -> Any:
        async def ask(connection: Any, request: Any) -> Any:
            refusal = refuse(request.headers.get("Host", ""), request.headers.get("Origin"), local,
                             request.headers.get("Upgrade", "").lower() == "websocket")  # fmt: skip
            if refusal is not None:
                return _answer(*refusal)
            return _with_words(process_request(connection, request))

        return real_serve(handler, at, on, process_request=ask, **options)

    shim = SimpleNamespace(
        asyncio=SimpleNamespace(
            server=SimpleNamespace(serve=serve, ServerConnection=websockets.asyncio.server.ServerConnection)
        ),
        datastructures=websockets.datastructures,
        exceptions=websockets.exceptions,
    )
    real = infra.websockets
    infra.websockets = shim  # viser's own name for the library; it is looked up once, in the constructor
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # a box with viser's name, even where not verbose
            server = viser.ViserServer(host=host, port=port, verbose=False)
    finally:
        infra.websockets = real
    for kind in (messages.ShareUrlRequest, messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(kind)
    return server


def refuse(host: str, origin: str | None, local: bool, upgrade: bool) -> tuple[int, str] | None:
    """Status and reason for which a request is refused; None where it is let in.

    host, origin : headers of the request
    local        : whether the server is for this machine alone
    upgrade      : whether it asks for a websocket, the only way to do anything
    """
    if local and urllib.parse.urlsplit(f"//{host}").hostname not in LOOPBACK:
        return 421, "this page is for this machine alone"
    if upgrade and (origin is None or urllib.parse.urlsplit(origin).netloc != host):
        return 403, "only the page itself may connect"
    return None


def _answer(status: int, reason: str) -> Response:
    body = reason.encode()
    headers = websockets.datastructures.Headers(
        [("Content-Type", "text/plain; charset=utf-8"), ("Content-Length", str(len(body)))]
    )
    return Response(status, http.HTTPStatus(status).phrase, headers, body)


def _with_words(answer: Response | None) -> Response | None:
    """The page with what it says where it cannot be drawn; anything else as it is."""
    if answer is None or not answer.headers.get("Content-Type", "").startswith("text/html"):
        return answer
    body = served(answer.body, answer.headers.get("Content-Encoding") == "gzip")
    del answer.headers["Content-Length"]
    answer.headers["Content-Length"] = str(len(body))
    answer.body = body
    return answer


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def acceptable(value: Any, props: Any) -> bool:
    """Whether a widget may take a value that a browser sent."""
    parts = value if isinstance(value, (list, tuple)) else [value]
    if len(parts) > 64 or getattr(props, "disabled", False) or not getattr(props, "visible", True):
        return False
    low, high = getattr(props, "min", None), getattr(props, "max", None)
    for k, part in enumerate(parts):
        if isinstance(part, str) and len(part) > MAX_TEXT:
            return False
        if isinstance(part, (int, float)) and not isinstance(part, bool):
            bottom, top = (edge[k] if isinstance(edge, (list, tuple)) else edge for edge in (low, high))
            if not math.isfinite(part):
                return False
            if (bottom is not None and part < bottom) or (top is not None and part > top):
                return False
    options = getattr(props, "options", None)
    return options is None or value in options


def _harden_widgets() -> None:
    """Let a browser write values alone, and only such as the widget could have sent."""
    if getattr(GuiApi, "_mapmeld_hardened", False):
        return
    GuiApi._mapmeld_hardened = True  # type: ignore[attr-defined]
    update, start, part = (
        GuiApi._handle_gui_updates,
        GuiApi._handle_file_transfer_start,
        GuiApi._handle_file_transfer_part,
    )

    async def safe_update(self: Any, client_id: Any, message: Any) -> None:
        handle = self._gui_input_handle_from_uuid.get(message.uuid)
        if handle is None or set(message.updates) != {"value"}:
            return
        if not acceptable(message.updates["value"], handle._impl.props):
            return
        try:
            await update(self, client_id, message)
        except (TypeError, ValueError, AssertionError):
            return  # a value of the wrong kind

    def safe_start(self: Any, client_id: Any, message: Any) -> None:
        mine = [s for s in self._current_file_upload_states.values() if s["client_id"] == client_id]
        parts = -(-message.size_bytes // CHUNK)
        if message.size_bytes > MAX_UPLOAD or message.part_count != parts or len(mine) >= MAX_OPEN_UPLOADS:
            return
        start(self, client_id, message)

    def safe_part(self: Any, client_id: Any, message: Any) -> None:
        state = self._current_file_upload_states.get(message.transfer_uuid)
        if state is None or state["client_id"] != client_id or len(message.content) > CHUNK:
            return
        part(self, client_id, message)

    GuiApi._handle_gui_updates = safe_update  # type: ignore[method-assign]
    GuiApi._handle_file_transfer_start = safe_start  # type: ignore[method-assign]
    GuiApi._handle_file_transfer_part = safe_part  # type: ignore[method-assign]
