"""What a person reads where the page cannot be drawn or its server has gone; and whom the page asks."""

from __future__ import annotations

from urllib.parse import urlsplit

import pytest
from chromium import find_chromium
from driver import PATIENCE, READY, settle

from app.page.application import make_server

pytestmark = pytest.mark.browser

BLIND = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-software-rasterizer",
    "--disable-3d-apis",
]


def test_a_browser_without_webgl_reads_why_and_what_to_do(browser, server):
    blind = browser.browser_type.launch(executable_path=find_chromium(), args=BLIND)
    try:
        page = blind.new_page(viewport={"width": 1000, "height": 700})
        page.goto(f"http://127.0.0.1:{server.get_port()}/")
        assert not page.evaluate("() => !!document.createElement('canvas').getContext('webgl2')")
        words = page.locator("#mm-nowebgl")
        words.get_by_text("WebGL 2 is missing").wait_for(timeout=1000 * PATIENCE)
        text = words.inner_text()
        assert "Use graphics acceleration when available" in text
        assert "mapmeld merge map1.yaml map2.yaml --observation observation.yaml --out result" in text
        assert page.title() == "mapmeld"
        top = "() => document.elementFromPoint(500, 350).closest('#mm-nowebgl') !== null"
        settle(lambda: page.evaluate(top), "nothing to lie over the words")
        with page.expect_navigation():
            page.get_by_role("button", name="Try again").click()
        words.get_by_text("WebGL 2 is missing").wait_for(timeout=1000 * PATIENCE)
    finally:
        blind.close()


def test_a_browser_without_scripts_reads_that_it_needs_them(browser, server):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"http://127.0.0.1:{server.get_port()}/")
    text = page.locator("body").inner_text()
    assert "mapmeld needs scripts" in text
    assert "mapmeld merge map1.yaml map2.yaml" in text
    context.close()


def test_a_lost_connection_is_told_until_it_is_back(open_tab, sample):
    first = make_server(port=0, initial=sample)
    port = first.get_port()
    tab = open_tab(at=first)
    words = tab.page.locator("#mm-lost")
    assert words.count() == 0
    first.stop()
    settle(lambda: words.count() == 1, "the words")
    assert "The connection to mapmeld is lost." in words.inner_text()
    assert "mapmeld serve" in words.inner_text()
    second = make_server(port=port, initial=sample)
    try:
        settle(lambda: words.count() == 0, "the words to go")
        tab.page.wait_for_function(READY, timeout=1000 * PATIENCE)
        settle(lambda: tab.state == "Ready. Press Merge.", "the page to be there again")
    finally:
        second.stop()


def test_the_page_asks_nobody_but_its_own_server(browser, server):
    context = browser.new_context(viewport={"width": 1000, "height": 700})
    asked: list[str] = []
    context.on("request", lambda request: asked.append(request.url))
    page = context.new_page()
    page.on("websocket", lambda socket: asked.append(socket.url))
    page.goto(f"http://127.0.0.1:{server.get_port()}/")
    page.wait_for_function(READY, timeout=1000 * PATIENCE)
    page.get_by_role("button", name="Research", exact=True).click()
    page.get_by_role("button", name="Instant", exact=True).click()
    page.get_by_role("button", name="Merge", exact=True).click()
    mood = "() => document.querySelector('.mm-state').dataset.mood"
    settle(lambda: page.evaluate(mood) == "accepted", "the merge")
    for view in ("Heights", "Swarm space", "Map"):
        page.get_by_role("button", name=view, exact=True).click()
    hosts = {urlsplit(url).netloc for url in asked if urlsplit(url).scheme not in ("data", "blob")}
    assert hosts == {f"127.0.0.1:{server.get_port()}"}
    context.close()
