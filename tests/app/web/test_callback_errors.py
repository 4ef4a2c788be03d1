"""What goes wrong on the server's side: said in the right tab, logged, and everything else goes on."""

from __future__ import annotations

import json
import logging
import os
import signal
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from wire import WireTab, until

from algorithms.methods.spectra_config import PipelineConfig
from algorithms.spectra.candidates import CandidateConfig
from app.drawing.scene.map_view import MapView
from app.jobs import worker_pool as workers
from app.model import status_text as words_of_the_page
from app.model.run_state import RunState
from app.page.application import make_server
from app.page.files.files_controller import read_case as real_read_case
from app.page.page_state import PageState
from app.system.logging_setup import JsonFormatter, facts
from app.web.callback_errors import OUT_OF_MEMORY, words


@pytest.fixture(scope="module")
def server(small_case):
    server = make_server(port=0, initial=small_case)
    yield server
    server.stop()


@pytest.fixture
def tab(server):
    tab = WireTab(server.get_port())
    tab.choose("Instant")
    yield tab
    tab.close()


def send_all(what: signal.Signals) -> None:
    """Send a signal to every process that merges."""
    for pid in workers.COMMON.pids:
        with suppress(ProcessLookupError):  # one that died with nothing to do
            os.kill(pid, what)


def merge(tab: WireTab) -> str:
    tab.words["mood"] = ""  # not that of the last time
    tab.press("Merge")
    until(lambda: tab.mood in ("accepted", "refused", "failed"), "the merge")
    return tab.mood


class Broken(PipelineConfig):
    """Settings with which a stage fails half-way through a merge."""

    @property
    def error(self) -> Exception:
        return MemoryError() if self.candidates.peaks == 1 else RuntimeError("within")

    def __getattribute__(self, name: str) -> Any:
        if name == "refine":
            raise self.error
        return super().__getattribute__(name)


@pytest.mark.parametrize("peaks", [1, 2])
def test_a_stage_that_fails_is_told_and_the_next_merge_works(server, tab, monkeypatch, caplog, peaks):
    other = WireTab(server.get_port())
    broken = Broken(candidates=CandidateConfig(peaks=peaks))
    job = PageState.job
    with monkeypatch.context() as patch:
        patch.setattr(PageState, "job", lambda page, **how: replace(job(page, **how), config=broken))
        assert merge(tab) == "failed"
    assert tab.state == words(broken.error)
    assert "within" not in tab.state
    assert other.mood == "idle"  # it was none of theirs
    assert "a run of spectra-proven ended in a bug" in caplog.text
    assert "RuntimeError: within" in caplog.text or peaks == 1
    assert merge(tab) == "accepted"
    other.close()


def test_a_merge_whose_process_is_killed_is_told_and_the_next_merge_works(tab, caplog):
    said = tab.notices("The run ended")
    tab.choose("Slow")
    tab.words["mood"] = ""
    tab.press("Merge")
    until(lambda: tab.mood == "running" and tab.words["progress"], "the merge to go on")
    send_all(signal.SIGKILL)
    until(lambda: tab.mood == "failed", "a word of it")
    assert tab.state == str(workers.WorkerDiedError())
    assert tab.notices("The run ended") == said + 1
    assert "a process that merges has ended" in caplog.text
    tab.choose("Instant")
    assert merge(tab) == "accepted"


def test_a_recording_whose_process_hangs_can_be_stopped_and_the_next_merge_works(tab, monkeypatch):
    monkeypatch.setattr("app.jobs.worker_pool.HANGS", 1.0)
    assert merge(tab) == "accepted"
    said, progress = tab.state, words_of_the_page.progress

    def hung(story: RunState) -> float:
        send_all(signal.SIGSTOP)
        return progress(story)

    with monkeypatch.context() as patch:
        patch.setattr(words_of_the_page, "progress", hung)
        tab.press("Save replay")
        until(lambda: tab.state.startswith("Recording the run"), "the recording")
        until(lambda: not tab.props[tab.find("Stop", "GuiButtonMessage")]["disabled"], "Stop")
        tab.press("Stop")
        until(lambda: tab.state == said, "the words from before")
        assert tab.mood == "accepted"
        until(lambda: tab.props[tab.find("Stop", "GuiButtonMessage")]["disabled"], "its end")
    send_all(signal.SIGCONT)  # those of other tabs
    assert tab.notices("This did not work") == 0
    assert merge(tab) == "accepted"
    tab.press("Save replay")
    until(lambda: any(name.startswith("replay_") for name in tab.files), "the replay after all")


def test_a_recording_whose_process_is_killed_is_told_and_is_no_bug(tab, monkeypatch, caplog):
    assert merge(tab) == "accepted"
    said, progress = tab.state, words_of_the_page.progress

    def killed(story: RunState) -> float:
        send_all(signal.SIGKILL)
        return progress(story)

    with monkeypatch.context() as patch:
        patch.setattr(words_of_the_page, "progress", killed)
        tab.press("Save replay")
        until(lambda: tab.notices("This did not work"), "a word of it")
    assert "Traceback" not in caplog.text
    until(lambda: tab.state == said, "the words from before")
    assert merge(tab) == "accepted"


@pytest.mark.parametrize("along", [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1e-320], [0.0, 1e12, 1.0]])
def test_a_click_that_meets_no_map_reads_nothing_out(tab, monkeypatch, along):
    asked, read_out = [], MapView.read_out

    def spy(view: MapView, place: np.ndarray, story: RunState) -> str:
        asked.append(place)
        return read_out(view, place, story)

    monkeypatch.setattr(MapView, "read_out", spy)
    click = {"event_type": "click", "screen_pos": [[0.5, 0.5]], "modifier": None}
    for direction in (along, [0.0, 0.0, -1.0]):
        tab.send("ScenePointerMessage", ray_origin=[0.0, 0.0, 600.0], ray_direction=direction, **click)
    until(lambda: asked, "a click to be read out")
    assert merge(tab) == "accepted"  # by then the other one would have been, too
    assert np.array(asked).tolist() == [[0.0, 0.0]]


def test_files_that_cannot_be_made_are_told_of_and_can_be_asked_for_again(tab, monkeypatch):
    assert merge(tab) == "accepted"

    def full(_: object) -> bytes:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("app.page.export.export_panel.zip_bytes", full)
        tab.press("Download everything")
        until(lambda: tab.notices("This did not work"), "a word of it")
    assert not tab.files
    tab.press("Download everything")
    until(lambda: tab.files, "the files")


def test_a_sample_that_has_gone_meanwhile_is_named_and_what_was_there_stays(tab, monkeypatch, tmp_path):
    monkeypatch.setattr(
        "app.page.files.files_controller.read_case", lambda _: real_read_case(tmp_path / "gone")
    )
    before = tab.words["case"]
    tab.write("Sample", "office_r2_r1", "Dropdown")
    until(lambda: tab.mood == "failed", "a word of it")
    assert "gone" in tab.state
    assert "no such file" in tab.state
    assert tab.words["case"] == before
    assert merge(tab) == "accepted"


def test_what_went_wrong_is_said_without_a_trace():
    assert words(MemoryError()) == OUT_OF_MEMORY
    assert "No space left on device" in words(OSError(28, "No space left on device"))
    assert "KeyError" in words(KeyError("secret"))
    assert "secret" not in words(KeyError("secret"))
    assert words(workers.WorkerDiedError()) == str(workers.WorkerDiedError())


def test_a_line_of_the_log_is_one_line_that_programs_read():
    record = logging.LogRecord("app.page.application", logging.INFO, __file__, 1, "a tab\ncame", (), None)
    record.__dict__.update(facts(tab=3))
    line = JsonFormatter().format(record)
    assert "\n" not in line
    told = json.loads(line)
    assert told["what"] == "a tab\ncame"
    assert told["tab"] == 3
    assert told["level"] == "info"
    assert told["when"].endswith("+00:00")
