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

from app.inputs import Inputs
from app.panels.files import FilesPanel
from app.stage import TabStage


@pytest.fixture
def sent():
    return []


@pytest.fixture
def stage(sent):
    connection = SimpleNamespace(queue_message=lambda message: sent.append(message.source))
    return TabStage(SimpleNamespace(_websock_connection=connection))


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

    def load(inputs: Inputs) -> None:
        assert here.acquire(blocking=False), "two files are being shown at once"
        sleep(0.02)
        loaded.append(inputs)
        here.release()

    panel = FilesPanel(server.gui, load, reports.append, "", lambda name, content: None)
    lacking = b"image: mine.pgm\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    files = [
        ("yaml1", viser.UploadedFile("mine.yaml", lacking)),
        ("image1", viser.UploadedFile("mine.pgm", b"P5\n2 2\n255\n\0\1\2\3")),
    ]
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda file: panel._take_upload(*file), files))
    assert len(loaded) == 2
    assert len(reports) == 1
    assert "mine.yaml" in str(reports[0])
