"""Who gets in: each attack works on viser as it comes, and not on a server of ours."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest
from strangers import PATIENCE, TOKEN, Stand, Visitor, get, join, standing
from websockets.exceptions import InvalidStatus

from app.access import Access
from app.guard import guarded_server


@pytest.fixture(scope="module")
def locked() -> Iterator[Stand]:
    with standing(guarded_server("127.0.0.1", 0, Access(None, TOKEN), 40)) as stand:
        yield stand


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


def said(port: int, *lines: str) -> bytes:
    """The first words of the answer to a request of these lines, as they are."""
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
