"""Who gets in and out, as real browsers see it: tokens, certificates, other sites' pages."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
import trustme
import viser
from driver import PATIENCE, READY
from playwright.sync_api import Browser, Page
from wire import until

from app.cli import open_browser as opening
from app.cli.commands.serve import address
from app.page.application import make_server
from app.web.security.access_control import access_for

pytestmark = pytest.mark.browser

TOKEN = "a-token-that-nobody-guesses"
OPENS = """([address, speaks]) => new Promise((told) => {
    const socket = new WebSocket(address, [speaks]);
    socket.onopen = () => told(true);
    socket.onerror = () => told(false);
})"""
SPEAKS = f"viser-v{viser.__version__}"


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    context = browser.new_context(ignore_https_errors=True)
    yield context.new_page()
    context.close()


def test_with_a_certificate_and_a_token_the_page_opens_for_who_has_it(page, sample, tmp_path):
    issued = trustme.CA().issue_cert("127.0.0.1")
    cert, key, word = (tmp_path / name for name in ("cert.pem", "key.pem", "token"))
    cert.write_bytes(b"".join(part.bytes() for part in issued.cert_chain_pems))
    key.write_bytes(issued.private_key_pem.bytes())
    word.write_text(f"{TOKEN}\n")
    server = make_server(port=0, initial=sample, access=access_for("127.0.0.1", word, (), cert, key))
    at = f"https://127.0.0.1:{server.get_port()}"
    try:
        answer = page.goto(at)
        assert answer is not None
        assert answer.status == 401
        field = page.get_by_label("Token")
        field.fill("x" * 20)
        page.get_by_role("button", name="Open").click()
        assert "That is not the token." in page.inner_text("body")
        page.get_by_label("Token").fill(TOKEN)
        page.get_by_role("button", name="Open").click()
        page.wait_for_function(READY, timeout=1000 * PATIENCE)
        assert TOKEN not in page.url
        assert page.evaluate("() => document.cookie") == ""
        (kept,) = page.context.cookies()
        assert kept["secure"]
        assert kept["httpOnly"]
        page.reload()  # and the cookie lets it in again
        page.wait_for_function(READY, timeout=1000 * PATIENCE)
        assert [why for why in server.gate.dropped if not why.startswith("request")] == []
    finally:
        server.stop()


def test_a_link_with_the_token_lets_in_whoever_follows_it_from_a_file_or_another_site(
    page, sample, monkeypatch
):
    monkeypatch.setattr("webbrowser.open", page.goto)
    monkeypatch.setenv("MAPMELD_TOKEN", TOKEN)
    access = access_for("127.0.0.1")
    server = make_server(port=0, initial=sample, access=access)
    try:
        with opening.browser(address("127.0.0.1", server.get_port(), access), secret=True):
            page.wait_for_function(READY, timeout=1000 * PATIENCE)
        assert page.url == f"http://127.0.0.1:{server.get_port()}/"
    finally:
        server.stop()


def test_another_sites_page_drives_stock_viser_and_not_ours(page, server, tmp_path):
    (tmp_path / "index.html").write_text("<!doctype html><title>another site</title>")
    handler = partial(Silent, directory=str(tmp_path))
    site = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=site.serve_forever, daemon=True).start()
    stock = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        page.goto(f"http://127.0.0.1:{site.server_address[1]}/")
        assert page.evaluate(OPENS, [f"ws://127.0.0.1:{stock.get_port()}", SPEAKS]) is True
        assert page.evaluate(OPENS, [f"ws://127.0.0.1:{server.get_port()}", SPEAKS]) is False
        frame = """(address) => new Promise((told) => {
            const frame = document.createElement("iframe");
            frame.onload = () => told(frame.contentDocument === null);  // null: it holds another's page
            frame.src = address;
            document.body.append(frame);
        })"""
        page.evaluate(frame, f"http://127.0.0.1:{server.get_port()}/")
        framed = [frame for frame in page.frames if frame is not page.main_frame]
        assert [frame.url for frame in framed] == ["chrome-error://chromewebdata/"]
    finally:
        stock.stop()
        site.shutdown()


def test_an_address_makes_stock_viser_obey_another_server_and_not_ours(page, stock, ours):
    other = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    elsewhere = f"ws://127.0.0.1:{other.get_port()}"
    try:
        for stand, obeyed in ((stock, other.get_port()), (ours, ours.port)):
            with page.expect_websocket(timeout=1000 * PATIENCE) as opened:
                page.goto(f"http://127.0.0.1:{stand.port}/?websocket={elsewhere}")
            assert opened.value.url == f"ws://127.0.0.1:{obeyed}/"
            # and no script could make it do so either
            assert page.evaluate(OPENS, [elsewhere, SPEAKS]) is (stand is stock)
    finally:
        other.stop()


def test_nothing_on_the_page_can_send_anything_elsewhere(tab, page):
    asked = []
    site = ThreadingHTTPServer(("127.0.0.1", 0), partial(Listening, asked))
    threading.Thread(target=site.serve_forever, daemon=True).start()
    elsewhere = f"http://127.0.0.1:{site.server_address[1]}"
    tries = """async (elsewhere) => {
        const forbidden = [];
        document.addEventListener("securitypolicyviolation", (event) => forbidden.push(event.blockedURI));
        const failed = (doing) => doing.then(() => false, () => true);
        const image = new Image();
        const loads = new Promise((ok, no) => { image.onload = ok; image.onerror = no; });
        image.src = elsewhere + "/image";
        navigator.sendBeacon(elsewhere + "/beacon", "x");
        const outcome = [await failed(fetch(elsewhere + "/fetch", { mode: "no-cors" })), await failed(loads)];
        return [outcome, forbidden.map((uri) => uri.replace(elsewhere, "")).sort()];
    }"""
    sent = ["/beacon", "/fetch", "/image"]
    try:
        page.goto(f"{elsewhere}/")
        assert page.evaluate(tries, elsewhere) == [
            [False, True],
            [],
        ]  # it is no image, but was asked for
        until(lambda: set(sent) <= set(asked), "all that was sent")  # a beacon takes its time
        asked.clear()
        assert tab.page.evaluate(tries, elsewhere) == [[True, True], sent]
        assert asked == []
    finally:
        site.shutdown()


class Silent(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


class Listening(Silent):
    """Notes what it is asked for."""

    def __init__(self, asked: list[str], *args: object, **how: object) -> None:
        self.asked = asked
        super().__init__(*args, directory=str(Path(__file__).parent), **how)  # type: ignore[arg-type]

    def do_GET(self) -> None:
        self.asked.append(self.path)
        self.send_response(200)
        self.send_header("Content-Length", "0")
        self.end_headers()

    do_POST = do_GET  # noqa: N815  (http.server's names)
