"""What a person does by hand, in a real Chromium."""

from __future__ import annotations

import pytest
from driver import settle

from app.channel import Channel, Numbers
from app.guard import guarded_server
from app.stage import TabStage

pytestmark = pytest.mark.browser


def test_everything_the_page_tells_arrives_in_order(browser):
    told: list[list[float]] = []
    server = guarded_server("127.0.0.1", 0)
    context = browser.new_context()
    try:

        @server.on_client_connect
        def _(client) -> None:
            stage = TabStage(client)
            Channel(client.gui, stage).on("count", lambda at: told.append(at), at=Numbers(2, 2))
            stage.flush()

        page = context.new_page()
        page.goto(f"http://127.0.0.1:{server.get_port()}/")
        page.wait_for_function("() => window.mapmeld?.channel", timeout=60_000)
        page.evaluate("() => { for (let k = 0; k < 300; k++) mapmeld.tell('count', { at: [k, -k] }); }")
        settle(lambda: len(told) == 300, "300 events sent at once")
        assert told == [[float(k), float(-k)] for k in range(300)]
    finally:
        context.close()
        server.stop()
