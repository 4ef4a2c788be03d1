"""A person's own files on the page in a real Chromium: they come, and the merged map goes."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from driver import settle
from rooms import l_room, write_case

from algorithms.common.pose import Pose2
from algorithms.files.atomic_write import write_files
from algorithms.files.case_folder import Case
from algorithms.files.map_file import map_to_bytes, read_map
from algorithms.files.observation_file import known_to_bytes
from algorithms.methods.registry import merge
from algorithms.observations.observation import Observation
from app.page.application import make_server

pytestmark = pytest.mark.browser


def test_a_broken_file_is_told_by_name_as_words_and_the_page_lives_on(tab, tmp_path):
    nasty = tmp_path / "<img src=x onerror=window.hit=1>.yaml"
    nasty.write_text("image: mine.pgm\norigin: [0, 0, 0]\nnegate: 0\nfree_thresh: 0.2\n")
    tab.open_files(nasty)
    tab.wait_for("failed")
    assert "<img" in tab.state
    assert "resolution" in tab.state
    assert tab.page.get_by_text("resolution").count() >= 3  # the sentence, a notification, and the list
    assert "cannot be used" in tab.listed()[0]
    assert tab.page.evaluate("() => window.hit") is None
    assert tab.page.locator(".mm-title").inner_text().endswith("office_r2_r1")  # nothing is lost
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_enabled()
    tab.choose("Sample", "apartment_r2_r1")
    tab.wait_for("idle")
    settle(lambda: tab.page.get_by_text("This cannot be used").count() == 0, "the notice to go")
    assert tab.listed() == []
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")


def test_two_map_folders_and_a_sighting_are_a_merged_map_on_disk_after_five_actions(
    open_tab, tmp_path, sample: Case
):
    folders = [tmp_path / "robot1", tmp_path / "robot2"]
    for folder, grid in zip(folders, (sample.ref, sample.mov), strict=True):
        made = map_to_bytes(grid, "map")  # as the savers call it
        write_files({folder / name: content for name, content in made.items()})
    seen = tmp_path / "observation.yaml"
    seen.write_bytes(known_to_bytes(sample.observations))
    tab = open_tab((1280, 800), mode="")
    tab.press("Instant")  # how long the stages are shown is no part of the work

    def download():
        with tab.page.expect_download() as download:
            tab.press("Download everything")
        download.value.save_as(tmp_path / "merged.zip")

    actions = [
        (lambda: tab.drop(folders[0]), "Map 1 is here. Load map 2, too."),
        (lambda: tab.drop(folders[1]), "Nothing is known"),
        (lambda: tab.drop(seen), "Ready. Press Merge."),
        (lambda: tab.press("Merge"), "Merged"),
        (download, "Merged"),
    ]
    for act, said in actions:
        act()
        settle(lambda said=said: said in tab.state, said)
    assert [line.split()[1] for line in tab.listed()[:4:2]] == ["robot1/map.yaml", "robot2/map.yaml"]
    with zipfile.ZipFile(tmp_path / "merged.zip") as packed:
        packed.extractall(tmp_path)
    back = read_map(tmp_path / "merged.yaml")
    expected = merge(sample.ref, sample.mov, sample.observations).fusion.merged
    assert np.array_equal(back.cells, expected.cells)
    assert (back.resolution, back.origin) == (expected.resolution, expected.origin)


def test_files_that_are_dropped_on_the_map_are_listed_swapped_removed_and_merged(open_tab, tmp_path):
    tab = open_tab(touch=True)
    room = l_room()
    first = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    second = Observation(Pose2(4.0, 3.0, 0.0), 5.0, 3.0, 1.0, 0.0)
    *maps, seen = write_case(tmp_path, room, room, first)
    for path in maps[:2]:
        tab.open_files(path)
        settle(lambda path=path: path.name in " ".join(tab.listed()), f"the name {path.name}")
    settle(lambda: "Load map 2" in tab.state, "the next step in words")
    tab.drop(*maps[2:])
    settle(lambda: "Nothing is known" in tab.state, "that Merge would try everything")
    several = known_to_bytes([first, second])
    seen.write_bytes(several.replace(b"- observer", b"- obsever"))
    tab.open_files(seen)
    tab.wait_for("failed")
    assert "observation 1: obsever is not a known key" in tab.state
    seen.write_bytes(several)
    tab.open_files(seen)
    settle(lambda: tab.state == "Ready. Press Merge.", "all five files")
    roles = ["map 1", "image of map 1", "map 2", "image of map 2", "what is known"]
    names = [*(path.name for path in maps), seen.name]
    assert tab.listed() == [f"✓ {name} {role} ✕" for name, role in zip(names, roles, strict=True)]
    assert "Observation 1 of 2" in tab.text
    assert "Observation 2 of 2" in tab.text
    assert [item["t"] for item in tab.layer("sight") if "t" in item] == ["2", "2"]
    assert sorted(item["t"] for item in tab.layer("robots") if "t" in item)[:2] == ["robot 1", "robot 2"]
    tab.press("Instant")
    tab.press("Merge")
    settle(lambda: tab.mood in ("accepted", "refused"), "a verdict")

    tab.press("Swap the maps")
    settle(lambda: tab.listed()[0].startswith("✓ map2.yaml map 1"), "map 2 in the place of map 1")
    remove = tab.page.get_by_role("button", name="remove map1.pgm")
    assert min(remove.bounding_box()[side] for side in ("width", "height")) >= 40  # for a finger
    remove.click()
    settle(lambda: "Load its image, too: map1.pgm" in tab.state, "what is missing now")
    assert "· map1.pgm image of map 2: missing" in tab.listed()
    tab.page.get_by_role("button", name="Undo").click()
    settle(lambda: len(tab.listed()) == 5 and "missing" not in " ".join(tab.listed()), "the file again")
    tab.press("Forget these files")
    settle(lambda: tab.state.startswith("Choose a sample"), "the empty page")
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_disabled()
    settle(lambda: not tab.page.locator(".mm-legend span").count(), "no legend where there is no map")


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
