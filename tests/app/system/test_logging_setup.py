"""What a server writes of what strangers do: no token, no request, and not the same line for ever."""

from __future__ import annotations

import json
import logging
import socket

import pytest
from strangers import PATIENCE, TOKEN, Stand, get

from app.system import logging_setup as logs
from app.web.security.access_control import Access

ACCESS = Access(None, TOKEN)


def sent(stand: Stand, request: str) -> bytes:
    """What is answered to a request, until the connection ends."""
    with socket.create_connection(("127.0.0.1", stand.port), timeout=PATIENCE) as line:
        line.sendall(request.encode("latin-1"))
        line.shutdown(socket.SHUT_WR)
        try:
            return b"".join(iter(lambda: line.recv(65536), b""))
        except ConnectionResetError:
            return b""


HOST = "Host: 127.0.0.1\r\n"
STUMBLES = {
    "an old protocol": f"GET /?token={TOKEN} HTTP/1.0\r\n{HOST}\r\n",
    "a space in the address": f"GET /?token={TOKEN} x HTTP/1.1\r\n{HOST}\r\n",
    "a bell in the cookie": f"GET / HTTP/1.1\r\n{HOST}Cookie: {ACCESS.cookie}={TOKEN}\x07\r\n\r\n",
    "several in one packet": f"GET /?token={TOKEN} HTTP/1.1\r\n{HOST}\r\n" * 20,
    "half of one": f"GET /?token={TOKEN}",
}


@pytest.mark.parametrize("request_", STUMBLES.values(), ids=STUMBLES)
def test_a_request_that_is_none_leaves_nothing_in_the_log(locked, request_, caplog):
    lines = logging.getLogger("websockets.server")
    told: list[logging.LogRecord] = []
    ours, lines.filters = lines.filters, [lambda record: told.append(record) is None]  # as it comes
    try:
        sent(locked, request_)
        assert get(locked.port)[0] == 401  # and with this the one before has been dealt with
    finally:
        lines.filters = ours
    assert any(TOKEN in logs.JsonFormatter().format(record) or record.exc_info for record in told)
    caplog.clear()
    sent(locked, request_)
    assert get(locked.port)[0] == 401
    assert caplog.text == ""


def test_who_looks_for_it_is_told_the_kind_of_a_handshake_that_failed(locked, caplog):
    with caplog.at_level(logging.DEBUG, "app.system.logging_setup"):
        sent(locked, STUMBLES["an old protocol"])
        assert get(locked.port)[0] == 401
    assert "opening handshake failed: InvalidMessage" in caplog.text
    assert TOKEN not in caplog.text


def test_a_handler_of_ours_that_fails_is_told_of_with_its_trace():
    record = logging.makeLogRecord({"levelno": logging.ERROR, "msg": "connection handler failed"})
    assert logs.Handshakes().filter(record)


def line(*what: object) -> str:
    record = logging.LogRecord("app", logging.WARNING, "", 0, str(what[0]), what[1:], None)
    return str(json.loads(logs.JsonFormatter().format(record))["what"])


def test_no_line_holds_a_token_whatever_it_came_with(monkeypatch):
    monkeypatch.setattr(logs, "_hidden", set())
    logs.hide("")
    logs.hide(TOKEN)
    assert line("said %r twice: %s", TOKEN, TOKEN) == "said '…' twice: …"
    assert line("GET /?token=another-one&x=1 HTTP/1.1") == "GET /?token=…&x=1 HTTP/1.1"
    assert line('"token=another-one"') == '"token=…"'
    assert line(f"Cookie: a=b; {ACCESS.cookie}=another-one; c=d") == f"Cookie: a=b; {ACCESS.cookie}=…; c=d"
    assert line("nothing to hide") == "nothing to hide"


def test_the_same_words_again_and_again_are_counted_not_written():
    now = [0.0]
    seldom = logs.RepeatFilter(lambda: now[0])

    def passes(words: str, level: int = logging.ERROR) -> logging.LogRecord | None:
        record = logging.LogRecord("asyncio", level, "", 0, words, (), None)
        return record if seldom.filter(record) else None

    written = [passes(f"accept() out of system resource\nsocket: {k}") for k in range(1000)]
    assert sum(record is not None for record in written) == logs.OFTEN
    assert passes("something else")
    assert all(passes("a tab came", logging.INFO) for _ in range(1000))
    now[0] += logs.WHILE
    again = passes("accept() out of system resource\nsocket: 7")
    assert again is not None
    assert again.facts == {"left out before": 1000 - logs.OFTEN}


def test_different_words_without_end_take_no_memory_without_end():
    seldom = logs.RepeatFilter()
    for k in range(3 * logs.MOST_WORDS):
        seldom.filter(logging.LogRecord("app", logging.ERROR, "", 0, f"words {k}", (), None))
    assert len(seldom._since) <= logs.MOST_WORDS


def test_a_server_writes_lines_that_hide_and_count(monkeypatch):
    monkeypatch.setattr(logging.root, "handlers", [])
    logs.start(verbose=False)
    logging.getLogger("app").setLevel(logging.NOTSET)
    (handler,) = logging.root.handlers
    assert isinstance(handler.formatter, logs.JsonFormatter)
    assert any(isinstance(one, logs.RepeatFilter) for one in handler.filters)
