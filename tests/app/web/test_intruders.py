"""Who gets in: each attack works on viser as it comes, and not on a server of ours."""

from __future__ import annotations

import logging
import socket

import pytest
import viser
from strangers import PATIENCE, TOKEN, Visitor, get, join
from websockets.exceptions import InvalidStatus

from app.page.application import PortError, make_server
from app.web.security.access_control import Access

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


def test_without_the_token_there_is_no_page_and_no_connection(stock, locked):
    assert get(stock.port)[0] == 200  # it has nothing to ask for
    join(stock.port).close()
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
    status, headers, body = get(locked.port, f"/?token={TOKEN}")
    assert status == 200
    assert b'content="0;url=./"' in body  # it leaves the address, and a proxy's folder stays
    assert len(body) < 300
    assert headers["Cache-Control"] == "no-store"
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
    before = ours.server.gate.dropped["unasked"]
    for stand in (stock, ours):
        visitor = Visitor(stand)
        visitor.send("ShareUrlRequest")
        assert visitor.has_been_heard()
        visitor.socket.close()
    assert stock.tunnels == 1
    assert ours.tunnels == 0
    assert ours.server.gate.dropped["unasked"] == before + 1


def test_a_server_listens_at_this_machine_alone_unless_it_is_told_otherwise(caplog, monkeypatch):
    monkeypatch.setattr("app.page.application.warm_up", lambda: None)  # nothing is merged here
    caplog.set_level(logging.INFO, "websockets.server")
    for start, listens in (
        (lambda: viser.ViserServer(port=0, verbose=False), "0.0.0.0"),  # for a moment, with nothing on it
        (lambda: make_server(port=0), "127.0.0.1"),
    ):
        caplog.clear()
        server = start()
        port = server.get_port()
        server.stop()
        assert [said for said in caplog.messages if said.startswith("server listening")] == [
            f"server listening on {listens}:{port}"
        ]


def test_a_port_that_is_taken_is_an_error_and_not_silently_another_one(stock):
    """Whoever opens the address that was asked for would be at somebody else's page."""
    second = viser.ViserServer(host="127.0.0.1", port=stock.port, verbose=False)
    try:
        assert second.get_port() > stock.port
    finally:
        second.stop()
    says = f"port {stock.port} is taken by another program; give another one with --port, or 0 for any"
    with pytest.raises(PortError, match=says):
        make_server(port=stock.port)


@pytest.mark.parametrize(
    "path", ["/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%5c..%5cx", "//etc/passwd"]
)
def test_no_path_leads_out_of_the_page(stock, ours, path):
    """Not in viser either, which this holds it to: ours hands it every path that it lets in."""
    for stand in (stock, ours):
        answer = said(stand.port, f"GET {path} HTTP/1.1", f"Host: 127.0.0.1:{stand.port}")
        assert answer.startswith(b"HTTP/1.1 404 ")


@pytest.mark.parametrize("method", ["POST", "PUT", "HEAD", "OPTIONS", "BREW"])
def test_whatever_but_get_ends_its_own_connection_without_an_answer(stock, ours, method):
    """As it does in viser, whose library takes nothing else."""
    for stand in (stock, ours):
        visitor = Visitor(stand)
        host = f"Host: 127.0.0.1:{stand.port}"
        assert said(stand.port, f"{method} / HTTP/1.1", host, "Content-Length: 0") == b""
        assert visitor.has_been_heard()  # everyone else's lives on
        visitor.socket.close()
        assert get(stand.port)[0] == 200


def said(port: int, *lines: str) -> bytes:
    """The first words of the answer to a request of these lines, as they are; b"" where there is none."""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as raw:
        raw.sendall("".join(f"{line}\r\n" for line in (*lines, "")).encode("latin-1"))
        return raw.recv(1000)


@pytest.mark.parametrize(
    ("path", "cookie"), [("/?token=\xff", "a=b"), ("/", "{name}=\xff"), ("/?token=%ff", "\xff=\xff")]
)
def test_what_is_no_text_is_answered_as_a_wrong_token(locked, path, cookie):
    name = Access(None, TOKEN).cookie
    answer = said(locked.port, f"GET {path} HTTP/1.1", "Host: x", f"Cookie: {cookie.format(name=name)}")
    assert answer.startswith(b"HTTP/1.1 401 ")


def test_a_path_longer_than_any_file_is_one_that_is_not_there(stock, ours):
    long = "/" + "a" * 300
    assert get(stock.port, long)[0] == 500
    assert get(ours.port, long)[0] == 404


def test_a_request_that_nobody_understands_is_refused_counted_and_told_of_by_its_kind(stock, ours, caplog):
    for stand, begins in ((stock, b"HTTP/1.1 500 "), (ours, b"HTTP/1.1 400 ")):
        before = stand.server.gate.dropped["request, 400"] if stand is ours else 0
        host = f"Host: 127.0.0.1:{stand.port}"
        caplog.clear()
        twice = said(stand.port, "GET / HTTP/1.1", host, "Accept-Encoding: gzip", "Accept-Encoding: br")
        assert twice.startswith(begins)
    assert ours.server.gate.dropped["request, 400"] == before + 1
    assert [record.getMessage() for record in caplog.records if record.levelname == "WARNING"] == [
        "a request could not be answered: MultipleValuesError"
    ]


TWICE = {
    "two hosts, its own first": ("Host: 127.0.0.1:{port}", "Host: evil.example"),
    "two hosts, its own last": ("Host: evil.example", "Host: 127.0.0.1:{port}"),
    "two hosts in one": ("Host: 127.0.0.1:{port}, evil.example",),
}


@pytest.mark.parametrize("hosts", TWICE.values(), ids=TWICE)
def test_a_page_is_asked_for_by_one_name(stock, ours, hosts):
    for stand, begins in ((stock, b"HTTP/1.1 200 "), (ours, b"HTTP/1.1 421 ")):
        named = [host.format(port=stand.port) for host in hosts]
        assert said(stand.port, "GET / HTTP/1.1", *named).startswith(begins)


@pytest.mark.parametrize("upgrades", [("websocket", "h2c"), ("h2c", "websocket"), (",websocket",)])
def test_no_words_about_the_upgrade_lead_past_the_question_for_the_page(ours, upgrades):
    lines = [f"Upgrade: {word}" for word in upgrades]
    host = f"Host: 127.0.0.1:{ours.port}"
    foreign = "Origin: http://evil.example"
    answer = said(ours.port, "GET / HTTP/1.1", host, foreign, "Connection: Upgrade", *lines)
    assert answer.startswith(b"HTTP/1.1 403 ")
