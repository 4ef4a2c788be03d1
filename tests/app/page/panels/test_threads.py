"""The widgets of a tab call back from threads of their own: nothing is lost, nothing runs across."""

from __future__ import annotations

import json
import sys
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
import viser
from panels import settings_panel

from algorithms.methods.registry import METHODS
from app.web.tab_messages import TabMessages


@pytest.fixture
def sent():
    return []


@pytest.fixture
def stage(sent):
    connection = SimpleNamespace(queue_message=lambda message: sent.append(message.source))
    return TabMessages(SimpleNamespace(_websock_connection=connection))


@pytest.fixture
def restless():
    """Threads that take turns after every few instructions."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(usual)


@pytest.mark.usefixtures("restless")
def test_every_word_reaches_the_page_whoever_sends_meanwhile(stage, sent):
    def say(k: int) -> None:
        stage.hud(**{f"word{k}": k})
        stage.layer(f"layer{k}", [{"k": k}])
        stage.flush()

    with ThreadPoolExecutor(16) as pool:
        list(pool.map(say, range(2000)))
    arrived: dict[str, int] = {}
    for source in sent[1:]:  # the first is the page's own script
        message = json.loads(source.partition("apply(")[2].removesuffix(")"))
        arrived.update(message.get("hud", {}))
        arrived.update(dict.fromkeys(message.get("layers", {}), 0))
    assert len(arrived) == 2 * 2000


@pytest.fixture
def server():
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def test_a_reset_that_was_pressed_for_a_method_that_has_given_way_does_nothing(server):
    changes = []
    panel = settings_panel(server.gui, lambda: changes.append(panel.method), changes.append)
    buttons = [
        handle
        for handle in server.gui._gui_input_handle_from_uuid.values()
        if str(getattr(handle, "label", "")).startswith("Reset ")
    ]
    assert len(buttons) > 3
    pressed = [callback for button in buttons for callback in button._impl.update_cb]
    for method in METHODS:
        panel.restore(method, METHODS[method].defaults)
        for press in pressed:
            press(None)
    assert changes == []
