"""Who may talk to the page, and that viser still has the hooks the guard hangs on."""

from __future__ import annotations

import socket
import urllib.error
import urllib.request
from types import SimpleNamespace

import pytest
import viser
from viser import _messages

from app.guard import acceptable, refuse
from app.server import PortError, make_server


@pytest.fixture(scope="module")
def server():
    server = make_server(port=0)
    yield server
    server.stop()


@pytest.mark.parametrize(
    ("host", "origin", "local", "upgrade", "status"),
    [
        ("127.0.0.1:8080", None, True, False, None),
        ("localhost:8080", "http://localhost:8080", True, True, None),
        ("[::1]:8080", "http://[::1]:8080", True, True, None),
        ("evil.example:8080", None, True, False, 421),  # a foreign name that points here
        ("127.0.0.1:8080", "http://evil.example", True, True, 403),  # a foreign page
        ("127.0.0.1:8080", None, True, True, 403),
        ("robot.lan:8080", "http://robot.lan:8080", False, True, None),
        ("robot.lan:8080", "http://evil.example", False, True, 403),
    ],
)
def test_only_the_page_itself_may_connect(host, origin, local, upgrade, status):
    answer = refuse(host, origin, local, upgrade)
    assert (answer and answer[0]) == status


def test_a_foreign_name_is_refused_by_the_running_server(server):
    address = f"http://127.0.0.1:{server.get_port()}/"
    assert urllib.request.urlopen(address, timeout=10).status == 200
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(urllib.request.Request(address, headers={"Host": "evil.example"}), timeout=10)
    assert refused.value.code == 421


def test_no_client_can_open_a_public_tunnel(server):
    assert _messages.ShareUrlRequest not in server._websock_server._incoming_handlers


@pytest.mark.parametrize(
    ("value", "props", "fine"),
    [
        (5, {"min": 0, "max": 10}, True),
        (11, {"min": 0, "max": 10}, False),
        (float("nan"), {"min": 0, "max": 10}, False),
        (5, {"disabled": True}, False),
        ("a", {"options": ("a", "b")}, True),
        ("<script>", {"options": ("a", "b")}, False),
        ("x" * 20_000, {}, False),
        (list(range(100)), {}, False),
    ],
)
def test_a_widget_takes_only_what_it_could_have_sent(value, props, fine):
    assert acceptable(value, SimpleNamespace(**props)) is fine


def test_a_taken_port_is_an_error_that_says_what_to_do():
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        with pytest.raises(PortError, match=f"port {port} is taken by another program; give another one"):
            make_server(port=port)


def test_viser_is_the_version_whose_insides_the_page_leans_on():
    assert viser.__version__ == "1.1.1"
    assert hasattr(_messages, "RunJavascriptMessage")
