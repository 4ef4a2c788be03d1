"""The widgets of a tab call back from threads of their own: nothing is lost, nothing runs across."""

from __future__ import annotations

import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from time import sleep
from types import SimpleNamespace

import pytest
import viser
from panels import files_panel, settings_panel

from algorithms.methods.registry import METHODS
from app.model.merge_inputs import MergeInputs
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


def test_files_that_arrive_together_are_taken_one_after_the_other(server, tmp_path: Path):
    here, loaded, reports = Lock(), [], []

    def load(inputs: MergeInputs) -> None:
        assert here.acquire(blocking=False), "two files are being shown at once"
        sleep(0.02)
        loaded.append(inputs)
        here.release()

    panel = files_panel(server.gui, load, reports.append)
    text = (
        b"image: mine.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        b"occupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    files = [
        ("yaml1", viser.UploadedFile("mine.yaml", text)),
        ("image1", viser.UploadedFile("mine.pgm", b"P5\n2 2\n255\n\0\1\2\3")),
    ]
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda file: panel._take_upload(*file), files))
    assert len(loaded) == 2
    assert loaded[-1].ref is not None
    assert reports == []


def test_a_file_that_cannot_be_used_is_told_and_what_is_loaded_stays(server):
    loaded, reports = [], []
    panel = files_panel(server.gui, loaded.append, reports.append)
    panel._take_upload("image1", viser.UploadedFile("mine.pgm", b"P5\n2 2\n255\n\0\1\2\3"))
    assert len(loaded) == 1
    panel._take_upload("yaml1", viser.UploadedFile("mine.yaml", b"image: mine.pgm\n"))
    assert len(loaded) == 1
    assert "mine.yaml" in str(reports[0])
    assert set(panel.files.uploads) == {"image1"}
    assert "cannot be used" in panel._status.content
    panel._take_upload("observation", viser.UploadedFile("o.yaml", b"[]"))
    assert "mine.pgm" in panel._status.content


def test_a_yaml_file_that_names_another_image_is_taken_with_a_doubt(server):
    loaded = []
    panel = files_panel(server.gui, loaded.append, loaded.append)
    text = (
        b"image: other.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        b"occupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    panel._take_upload("yaml2", viser.UploadedFile("mine.yaml", text))
    panel._take_upload("image2", viser.UploadedFile("mine.pgm", b"P5\n2 2\n255\n\0\1\2\3"))
    assert loaded[-1].mov is not None
    assert "mine.yaml names the image other.pgm; loaded is mine.pgm." in loaded[-1].doubt()


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
