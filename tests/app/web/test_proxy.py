"""A page behind a proxy, in a folder, over https: docs/examples/nginx.conf hands on what it needs.

By a proxy of our own that reads that file; and by nginx itself, where there is one.
"""

from __future__ import annotations

import asyncio
import re
import socket
import ssl
from functools import partial

import pytest
import trustme
import wire
from proxy import EXAMPLE, PROXIES, ours
from strangers import PATIENCE, SPEAKS
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from app.web.security.access_control import access_for
from app.web.upload import PATH
from app.web.viser_server import guarded_server

NAME, TOKEN = "robots.example", "a-token-that-nobody-guesses"


class Outside:
    """Someone at the other side of the proxy."""

    def __init__(self, port, context):
        self.host, self.context = f"{NAME}:{port}", context
        self.knock = partial(socket.create_connection, ("127.0.0.1", port), PATIENCE)

    def get(self, path, **headers):
        """Status line, headers and page."""
        told = {"Host": self.host, "Connection": "close", **headers}
        lines = "".join(f"{name}: {value}\r\n" for name, value in told.items())
        with self.context.wrap_socket(self.knock(), server_hostname=NAME) as line:
            line.sendall(f"GET {path} HTTP/1.1\r\n{lines}\r\n".encode())
            said = b"".join(iter(lambda: line.recv(65536), b"")).decode("latin-1")
        return int(said.split()[1]), said

    def connect(self, cookie="", origin=None, to=""):
        """The page's own connection, which goes to the folder without its slash, or to something in it."""

        async def come() -> None:  # one thread: two may not share a TLS connection
            async with connect(
                f"wss://{self.host}/maps{to}",
                host="127.0.0.1",
                ssl=self.context,
                server_hostname=NAME,
                subprotocols=SPEAKS,
                origin=origin or f"https://{self.host}",
                additional_headers={"Cookie": cookie},
                open_timeout=wire.PATIENCE,
            ):
                pass

        asyncio.run(come())

    def enter(self):
        """The cookie that the token is changed for, and all that was said with it."""
        status, said = self.get(f"/maps/?token={TOKEN}")
        assert status == 200
        return re.search(r"(?i)^set-cookie: ([^;]*)", said, re.M)[1], said


@pytest.fixture(scope="module")
def page():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MAPMELD_TOKEN", TOKEN)
        access = access_for("127.0.0.1", names=(NAME,))
    server = guarded_server("127.0.0.1", 0, access, 9)
    yield server.get_port()
    server.stop()


@pytest.fixture(scope="module")
def certificate():
    """A certificate for the proxy, and what trusts it."""
    authority, context = trustme.CA(), ssl.create_default_context()
    authority.configure_trust(context)
    return authority.issue_cert(NAME), context


@pytest.fixture(params=PROXIES)
def outside(request, page, certificate, tmp_path):
    cert, context = certificate
    with PROXIES[request.param](EXAMPLE, page, cert, tmp_path) as port:
        yield Outside(port, context)


def test_behind_the_example_the_token_lets_in_and_nothing_else_does(outside, tmp_path):
    assert outside.get("/maps/")[0] == 401
    cookie, said = outside.enter()
    assert 'content="0;url=./"' in said  # whatever the folder
    assert "; Secure" in said
    assert "Path=" not in said
    status, said = outside.get("/maps/", Cookie=cookie)
    assert status == 200
    assert "text/html" in said
    status, said = outside.get(f"/maps?token={TOKEN}")
    assert status == 301
    assert f"https://{outside.host}/maps/?token={TOKEN}" in said
    for to in ("", PATH):
        outside.connect(cookie, to=to)
        for refused in ({"cookie": ""}, {"cookie": cookie, "origin": "https://evil.example"}):
            with pytest.raises(InvalidStatus):
                outside.connect(**refused, to=to)
    assert outside.get("/maps/", Host="evil.example", Cookie=cookie)[0] == 421
    logged = tmp_path / "access.log"  # nginx's
    assert not logged.exists() or TOKEN not in logged.read_text()


@pytest.mark.parametrize("header", ["Host", "X-Forwarded-Proto", "Upgrade", "Connection"])
def test_no_header_of_the_example_can_be_left_out(header, page, certificate, tmp_path):
    less, count = re.subn(rf"^ *proxy_set_header {header} .*\n", "", EXAMPLE, flags=re.M)
    assert count == 1
    cert, context = certificate
    with ours(less, page, cert, tmp_path) as port:
        outside = Outside(port, context)
        cookie, said = outside.enter()
        if header == "X-Forwarded-Proto":
            assert "Secure" not in said
        else:
            with pytest.raises(InvalidStatus):
                outside.connect(cookie)
