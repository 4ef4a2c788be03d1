"""A person's own files on the page in a real Chromium: they come, and the merged map goes."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from driver import settle
from rooms import l_room, write_case

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import known_to_bytes
from algorithms.methods.registry import merge
from algorithms.observations.observation import Observation
from app.page.application import make_server

pytestmark = pytest.mark.browser


def test_a_broken_upload_is_told_by_name_and_the_page_lives_on(tab, tmp_path):
    text = tmp_path / "mine.yaml"
    text.write_text(
        "image: mine.pgm\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    tab.unfold("Upload your own")
    tab.upload(0, text)
    tab.wait_for("failed")
    assert "mine.yaml" in tab.state
    assert "resolution" in tab.state
    assert tab.page.get_by_text("resolution").count() >= 2  # the sentence, and a notification
    assert "cannot be used" in tab.text
    assert tab.page.locator(".mm-title").inner_text().endswith("office_r2_r1")  # nothing is lost
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_enabled()
    tab.choose("Sample", "apartment_r2_r1")
    tab.wait_for("idle")
    settle(lambda: tab.page.get_by_text("This cannot be used").count() == 0, "the notice to go")
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")


def test_forgotten_uploads_are_gone_from_the_page(tab, tmp_path, sample: Case):
    (tmp_path / "o.yaml").write_bytes(known_to_bytes(sample.observations))
    tab.unfold("Upload your own")
    tab.upload(4, tmp_path / "o.yaml")
    settle(lambda: "load the two maps" in tab.state, "what to load next")
    tab.press("Forget uploads")
    settle(lambda: tab.state.startswith("Choose a sample"), "the empty page")
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_disabled()
    settle(lambda: not tab.page.locator(".mm-legend span").count(), "no legend where there is no map")


def test_a_file_name_is_shown_as_words_and_never_run(tab, tmp_path):
    nasty = tmp_path / "<img src=x onerror=window.hit=1>.yaml"
    nasty.write_text("nonsense: [")
    tab.unfold("Upload your own")
    tab.upload(4, nasty)
    tab.wait_for("failed")
    assert "<img" in tab.state
    assert tab.page.evaluate("() => window.hit") is None


def test_the_downloaded_map_reads_back_to_the_merged_cells(tab, tmp_path, sample: Case):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    with tab.page.expect_download() as download:
        tab.press("Download everything")
    assert download.value.suggested_filename == "merged.zip"
    with zipfile.ZipFile(download.value.path()) as packed:
        packed.extractall(tmp_path)
        assert {"merged.yaml", "merged.pgm"} <= set(packed.namelist())
    back = read_map(tmp_path / "merged.yaml")
    expected = merge(sample.ref, sample.mov, sample.observations).fusion.merged
    assert np.array_equal(back.cells, expected.cells)
    assert (back.resolution, back.origin) == (expected.resolution, expected.origin)


def test_uploads_one_by_one_say_what_is_missing_and_then_merge(tab, tmp_path):
    room = l_room()
    seen = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    tab.unfold("Upload your own")
    for slot, path in enumerate(write_case(tmp_path, room, room, seen)):
        tab.upload(slot, path)
        settle(lambda path=path: path.name in tab.text, f"the name {path.name}")
        if slot == 1:
            settle(lambda: "Load map 2" in tab.state, "the next step in words")
        if slot == 3:
            settle(lambda: "Nothing is known" in tab.state, "that Merge would try everything")
    settle(lambda: tab.state == "Ready. Press Merge.", "all five files")
    tab.press("Instant")
    tab.press("Merge")
    settle(lambda: tab.mood in ("accepted", "refused"), "a verdict")


def test_several_sightings_are_all_shown_and_counted(tab, tmp_path):
    room = l_room()
    first = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    second = Observation(Pose2(4.0, 3.0, 0.0), 5.0, 3.0, 1.0, 0.0)
    *maps, seen = write_case(tmp_path, room, room, first)
    tab.unfold("Upload your own")
    for slot, path in enumerate(maps):
        tab.upload(slot, path)
        settle(lambda path=path: path.name in tab.text, f"the name {path.name}")
    seen.write_bytes(known_to_bytes([first, second]).replace(b"- observer", b"- obsever"))
    tab.upload(4, seen)
    tab.wait_for("failed")
    assert "observation 1: obsever is not a known key" in tab.state
    seen = tmp_path / "both.yaml"
    seen.write_bytes(known_to_bytes([first, second]))
    tab.upload(4, seen)
    settle(lambda: tab.state == "Ready. Press Merge.", "all five files")
    assert "Observation 1 of 2" in tab.text
    assert "Observation 2 of 2" in tab.text
    assert [item["t"] for item in tab.layer("sight") if "t" in item] == ["2", "2"]
    assert sorted(item["t"] for item in tab.layer("robots") if "t" in item)[:2] == ["robot 1", "robot 2"]


def test_a_refused_map_is_downloaded_only_after_a_warning(open_tab, sample: Case):
    o = sample.observations[0]
    wrong = Observation(o.observer, o.observed_x + 6.0, o.observed_y - 5.0, o.range, o.bearing)
    own = make_server(
        port=0, initial=Case("wrong", sample.ref, sample.mov, (wrong,), "observation.yaml", None)
    )
    try:
        tab = open_tab(at=own)
        tab.press("Instant")
        tab.press("Merge")
        tab.wait_for("refused")
        tab.press("Download everything")
        with tab.page.expect_download() as download:
            tab.press("Download the refused map anyway")
        assert download.value.suggested_filename == "merged.zip"
    finally:
        own.stop()
