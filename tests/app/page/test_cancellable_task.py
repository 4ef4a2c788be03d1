"""Reading can be left: soon, whatever the file is, and with nothing half-loaded."""

from __future__ import annotations

import io
from threading import RLock
from types import SimpleNamespace

import numpy as np
import pytest
from panels import FilesDesk
from PIL import Image

from algorithms.common.errors import InputFileError
from algorithms.files.map_file import map_from_bytes
from app.drawing.browser_messages import BrowserMessages
from app.page.cancellable_task import CancellableTask
from app.page.export.export_panel import ReplayButton
from app.system.cancellation import CancellableReader, Cancelled
from app.web.download import DOWNLOADS

YAML = b"image: a\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
BEFORE = {"state": "Ready. Press Merge.", "mood": "idle", "progress": None}


def image(kind: str, side: int = 1100) -> bytes:
    packed = io.BytesIO()
    grey = np.random.default_rng(0).integers(0, 255, (side, side), dtype=np.uint8)
    pixels = Image.fromarray(grey)
    if kind == "ppm":
        pixels = pixels.convert("RGB")
    pixels.save(packed, {"pgm": "ppm"}.get(kind, kind))
    return packed.getvalue()


class Silent(BrowserMessages):
    """Keeps what it is told to say."""

    def __init__(self) -> None:
        super().__init__()
        self.sent = []

    def send(self, message):
        self.sent.append(message.get("hud", {}).get("state"))


class Person:
    """Presses Stop as soon as it can be pressed, where it is impatient."""

    def __init__(self) -> None:
        self.stage = Silent()
        self.stage.hud(**BEFORE)
        self.task = CancellableTask(self.stage, RLock(), self._stoppable)
        self.impatient, self.could_stop = False, []

    def _stoppable(self, yes: bool) -> None:
        self.could_stop.append(yes)
        if yes and self.impatient:
            self.task.stop()

    @property
    def said(self):
        return self.stage.said(*BEFORE)


@pytest.fixture
def person():
    return Person()


@pytest.mark.parametrize("kind", ["pgm", "ppm", "png", "bmp"])
def test_no_reader_takes_stop_for_a_damaged_file(kind):
    looks = 0

    def check():
        nonlocal looks
        looks += 1
        if looks == 2:
            raise Cancelled

    content = image(kind)
    with pytest.raises(Cancelled):
        map_from_bytes("m.yaml", YAML, "m", CancellableReader(content, check))
    assert looks == 2
    whole = map_from_bytes("m.yaml", YAML, "m", CancellableReader(content, lambda: None))
    assert (whole.cells == map_from_bytes("m.yaml", YAML, "m", content).cells).all()


@pytest.mark.parametrize("kind", ["pgm", "png"])
@pytest.mark.parametrize("with_yaml", [True, False], ids=["map", "image alone"])
def test_a_file_whose_reading_is_stopped_leaves_everything_as_it_was(server, person, kind, with_yaml):
    desk = FilesDesk(server.gui, person.task)
    load = desk.controller._load
    desk.controller._load = lambda *what: (load(*what), person.stage.hud(**BEFORE))
    if with_yaml:
        desk.open({"m.yaml": YAML})
    desk.open({"a": image(kind)})
    before, so_far = dict(desk.panel.files.uploads), len(desk.loaded)
    person.impatient = True
    desk.open({"a": image(kind, 1200)})
    assert desk.panel.files.uploads == before
    assert len(desk.loaded) == so_far
    assert desk.reports == []
    assert person.said == BEFORE
    assert "Reading a, " in " ".join(filter(None, person.stage.sent))
    person.impatient = False
    desk.open({"a": image(kind, 1200)})  # and it can be loaded after all
    assert desk.panel.files.uploads["image1"].content == image(kind, 1200)
    assert person.could_stop == [True, False] * 3
    assert len(desk.loaded) == so_far + 1


def test_a_small_file_is_read_without_a_word_and_a_small_png_of_many_pixels_is_not(server, person):
    desk = FilesDesk(server.gui, person.task)
    desk.open({"small.png": image("png", 100)})
    assert person.could_stop == []
    packed = io.BytesIO()
    Image.new("L", (3000, 3000), 254).save(packed, "PNG")
    assert len(packed.getvalue()) < 100_000
    desk.open({"blank.png": packed.getvalue()})
    assert person.could_stop == [True, False]


def test_a_replay_whose_recording_is_stopped_is_not_sent_and_can_be_made_after_all(
    server, person, monkeypatch
):
    sent = []
    client = SimpleNamespace(gui=server.gui, send_file_download=lambda name, *_, **__: sent.append(name))
    button = ReplayButton(client, person.task)

    def make(check):
        check(0.5)
        return b"<html>"

    monkeypatch.setattr(DOWNLOADS, "_sent", [])
    button.offer("a pair", make)
    person.impatient = True
    button._save()
    assert sent == []
    assert person.said == BEFORE
    person.impatient = False
    button._save()
    assert sent == ["replay_a_pair.html"]
    assert person.said == BEFORE
    assert person.could_stop == [True, False] * 2


def test_stop_has_nothing_to_stop_before_and_after(person):
    assert not person.task.stop()
    with person.task("Reading."):
        assert person.said["state"] == "Reading."
    assert not person.task.stop()
    with pytest.raises(InputFileError), person.task("Reading."):
        raise InputFileError("m.pgm", "is cut off", "copy it anew")
    assert not person.task.stop()


def test_words_aside_are_taken_back_and_tell_how_far_it_is(person, monkeypatch):
    monkeypatch.setattr("app.page.cancellable_task.perf_counter", iter(range(100)).__next__)
    with person.task("Making the files.", aside=True) as check:
        check(0.5)
        assert person.said == {"state": "Making the files.", "mood": "running", "progress": 0.5}
    assert person.said == BEFORE


def test_stop_ends_everything_that_is_under_way_at_once(person):
    left = []

    def both():
        with person.task("Reading.") as first, person.task("Making the files.", aside=True) as second:
            assert person.task.stop()
            for check in (first, second):
                with pytest.raises(Cancelled):
                    check()
                left.append(check)

    with pytest.raises(Cancelled):
        both()
    assert len(left) == 2
    assert person.could_stop == [True, True, True, False]
    assert person.said == BEFORE


@pytest.mark.parametrize("first_ends_first", [True, False])
def test_of_two_at_a_time_the_words_of_one_that_goes_on_are_said_and_in_the_end_those_from_before(
    person, first_ends_first
):
    first = person.task("Making the files.", aside=True)
    second = person.task("Recording.", aside=True)
    first.__enter__()
    second.__enter__()
    ends = [(first, "Recording."), (second, "Making the files.")]
    if not first_ends_first:
        ends.reverse()
    (one, goes_on), (other, _) = ends
    one.__exit__(None, None, None)
    assert person.said["state"] == goes_on
    other.__exit__(None, None, None)
    assert person.said == BEFORE


def test_stop_is_seen_at_once_and_a_second_one_is_for_somebody_else(person):
    def slow():
        with person.task("Reading."):
            assert person.task.stop()
            assert person.said == BEFORE  # though it has not looked up yet
            assert not person.task.stop()
            raise OSError("what becomes of it is of no matter any more")

    with pytest.raises(Cancelled):
        slow()


def test_a_press_at_the_last_moment_still_counts(person):
    with pytest.raises(Cancelled), person.task("Reading."):
        person.task.stop()
    assert person.said == BEFORE


def test_what_a_run_has_said_meanwhile_stays_said(person):
    def overtaken():
        with person.task("Reading."):
            person.stage.hud(state="Merged.", mood="accepted", progress=None)
            person.task.stop()

    with pytest.raises(Cancelled):
        overtaken()
    assert person.said["state"] == "Merged."
