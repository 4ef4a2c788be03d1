"""What the robots are called, and in which frame the merged map is taken away, in a real Chromium."""

from __future__ import annotations

import hashlib
import json
import re
import zipfile

import numpy as np
import pytest
import yaml
from driver import READY, Tab, of_two, settle

from algorithms.common.pose import Pose2
from algorithms.files.map_file import read_map
from algorithms.maps.wall_distance import distance_to_walls
from app.system.data_paths import samples

pytestmark = pytest.mark.browser

SAMPLE = "office_r2_r1"  # with which every tab opens


def name_field(tab: Tab, number: int):
    label = f"Robot {number} is called"
    return tab.page.locator(f'xpath=//label[normalize-space()="{label}"]/following::input[1]')


def call(tab: Tab, ref: str, mov: str) -> None:
    """Type what the robots are called."""
    for number, name in ((1, ref), (2, mov)):
        name_field(tab, number).fill(name)
        tab.page.wait_for_timeout(100)  # of what is written within 50 ms the page sends only the last


def title(tab: Tab) -> str:
    return tab.page.locator(".mm-case").inner_text()


def merge(tab: Tab) -> None:
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")


def everything(tab: Tab, folder) -> None:
    """The export, unpacked."""
    with tab.page.expect_download() as download:
        tab.press("Download everything")
    with zipfile.ZipFile(download.value.path()) as packed:
        packed.extractall(folder)


def click(tab: Tab, x: float, y: float) -> None:
    """Click at a place of the scene."""
    tab.page.mouse.click(*tab.page.evaluate("(p) => mapmeld.pixel(p)", [x, y]))


def test_robots_that_are_given_names_are_told_by_them_everywhere_and_undo_and_reload_keep_them(
    open_tab, tmp_path
):
    tab = open_tab(size=(1400, 900))
    tab.unfold("Names")
    call(tab, "Bob", "<i>Alice")
    settle(lambda: title(tab) == f"{SAMPLE}: Bob saw <i>Alice", "the names")
    legend = "() => mapmeld.hud.legend.map((entry) => entry.t)"
    assert tab.page.evaluate(legend) == ["Bob's map", "<i>Alice's map"]
    merge(tab)
    settle(lambda: tab.number("<i>Alice's place, 1 σ"), "the result")
    assert of_two(tab) == []
    assert tab.page.locator("i", has_text="Alice").count() == 0  # a name is no HTML
    assert "--frame-id bob/map --child-frame-id '<i>alice/map'" in tab.text.replace("\n", " ")
    everything(tab, tmp_path)
    assert "Bob saw &lt;i&gt;Alice</h1>" in (tmp_path / "report.html").read_text("utf-8")
    with tab.page.expect_download() as download:
        tab.press("Save replay")
    assert "Bob saw" in download.value.path().read_text("utf-8")

    call(tab, "Bob", "Bob")
    settle(lambda: "both robots are called Bob; give them two names" in tab.text, "why not")
    call(tab, "Bob", "Carol")
    settle(lambda: title(tab) == f"{SAMPLE}: Bob saw Carol" and tab.mood == "accepted", "another name")
    settle(lambda: tab.number("Carol's place, 1 σ"), "the same result")
    tab.page.reload()
    tab.page.wait_for_function(READY)
    settle(lambda: title(tab) == f"{SAMPLE}: Bob saw Carol" and tab.mood == "accepted", "all of it again")
    tab.page.get_by_role("button", name="Undo").click()
    settle(lambda: title(tab) == f"{SAMPLE}: Bob saw <i>Alice", "the name before")
    settle(lambda: name_field(tab, 2).input_value() == "<i>Alice", "it in its field")
    tab.choose("Sample", "office_r3_r2")
    settle(lambda: title(tab) == "office_r3_r2", "robots without names")
    settle(lambda: name_field(tab, 2).input_value() == "", "empty fields")


def test_two_maps_that_have_names_make_a_fleet_of_robots_that_have_them(open_tab):
    tab = open_tab(size=(1400, 900))
    tab.unfold("Names")
    call(tab, "Bob", "Alice")
    settle(lambda: "Bob saw Alice" in title(tab), "the names")
    tab.press("Add robots")
    rows = tab.page.locator("button[data-mm-pair]")
    settle(lambda: rows.all_inner_texts() == ["Bob saw Alice\nnot merged yet"], "the fleet")
    assert not name_field(tab, 1).is_visible()  # a fleet has fields of its own


def test_the_merged_map_is_taken_away_in_map_2s_frame_without_yaw_and_the_changed_cells_are_told(
    open_tab, tmp_path
):
    tab = open_tab(size=(1400, 900), smooth=True)
    merge(tab)
    tab.unfold("Frame and cells")
    tab.choose("Frame", "map 2's")
    settle(lambda: "--frame-id map2 --child-frame-id map1" in tab.text.replace("\n", " "), "the line")
    tab.page.get_by_label("Without yaw", exact=True).check()
    told = settle(lambda: re.search(r"([\d,]+) of [\d,]+ cells changed", tab.text), "the count")
    everything(tab, tmp_path)
    merged, report = read_map(tmp_path / "merged.yaml"), json.loads((tmp_path / "report.json").read_text())
    transform = yaml.safe_load((tmp_path / "transform.yaml").read_text())
    assert merged.origin.theta == 0.0
    assert report["merged_map"]["cells_changed"] == int(told[1].replace(",", "")) > 0
    assert transform["frame"] == report["merged_map"]["frame"] == "map2"
    mov = read_map(samples()[SAMPLE] / "map2.yaml")  # in its own frame its walls lie where they were
    cols, rows = np.floor(merged.grid_coordinates(mov.points)).astype(int).T
    assert (distance_to_walls(merged.occupied)[rows, cols] < 1.5).mean() > 0.95  # cells
    assert report["files"]["map2"][1] == {
        "name": "map2.pgm",
        "sha256": hashlib.sha256((samples()[SAMPLE] / "map2.pgm").read_bytes()).hexdigest(),
    }
    page = (tmp_path / "report.html").read_text("utf-8")
    assert report["files"]["map1"][0]["sha256"] in page
    assert re.search(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ, mapmeld ", page)

    cell = tab.page.get_by_label("Cell size (m)", exact=True)
    cell.fill("0.1")
    cell.press("Tab")
    settle(lambda: "export: map 2's frame, without yaw, in cells of 0.1 m" in history(tab), "the step")
    tab.page.reload()
    tab.page.wait_for_function(READY)
    tab.wait_for("accepted")
    everything(tab, tmp_path)
    assert read_map(tmp_path / "merged.yaml").resolution == 0.1
    for _ in range(3):
        tab.page.get_by_role("button", name="Undo").click()
    settle(lambda: "--frame-id map1 --child-frame-id map2" in tab.text.replace("\n", " "), "the frame before")


def history(tab: Tab) -> str:
    return "\n".join(tab.page.locator(".mm-entry span").all_text_contents())


def test_a_frame_is_clicked_on_the_map_origin_first_then_a_point_on_its_x_axis(open_tab, tmp_path):
    tab = open_tab(size=(1400, 900))
    merge(tab)
    said = tab.state
    tab.unfold("Frame and cells")
    tab.choose("Frame", "one that I choose")
    settle(lambda: tab.state.startswith("Click where the frame's origin is to be"), "the first click")
    tab.press("Cancel")
    settle(lambda: tab.state == said, "the verdict again")
    tab.choose("Frame", "one that I choose")
    settle(lambda: tab.state.startswith("Click where the frame's origin is to be"), "the first click")
    tab.at_rest()
    click(tab, -4.0, -1.0)
    settle(lambda: tab.state == "Now click a point on its x-axis.", "the second click")
    click(tab, 4.0, 3.0)
    settle(lambda: tab.state == said, "the verdict again")
    settle(lambda: {"x", "y", "map"} <= {item.get("t") for item in tab.layer("frame")}, "its axes")
    settle(lambda: "turned by 26.6°" in tab.text, "where it lies")
    everything(tab, tmp_path)
    transform = yaml.safe_load((tmp_path / "transform.yaml").read_text())
    T = Pose2(**transform["T_ref_frame"])
    anchor = tab.page.evaluate("() => mapmeld.hud.frames[0].slice(0, 2)")
    assert (T.x - anchor[0], T.y - anchor[1]) == pytest.approx((-4, -1), abs=0.1)
    assert T.theta == pytest.approx(0.4636, abs=0.02)
    assert len(transform["publish"]) == 2
    tab.page.get_by_role("button", name="Undo").click()
    settle(lambda: not tab.layer("frame"), "map 1's frame again")
