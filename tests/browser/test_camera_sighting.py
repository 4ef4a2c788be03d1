"""A sighting from camera and scan: files sent, robots found, one chosen and used; what is none is refused."""

from __future__ import annotations

from math import hypot
from pathlib import Path

import numpy as np
import pytest
from driver import Tab, field, metres, settle
from tagged_pictures import ASIDE, NEAR, laid_down, sighting_files

from algorithms.files.camera_picture import picture_to_png

SPOT, LINE = ".mm-seen button", "button.mm-found"  # a box in the image, and in the list
DOCK = "() => document.querySelector('.mantine-ScrollArea-viewport').getBoundingClientRect().width"
DROP = """(names) => {
  const zone = document.querySelector('[data-mm-files]'), data = new DataTransfer();
  for (const [name, bytes] of names) data.items.add(new File([new Uint8Array(bytes)], name));
  for (const kind of ['dragover', 'drop']) {
    zone.dispatchEvent(new DragEvent(kind, { dataTransfer: data, bubbles: true, cancelable: true }));
  }
}"""


def unfolded(tab: Tab) -> None:
    """The folder is open, and tags are looked for."""
    tab.unfold("From camera and scan")
    tab.unfold("Detector and robot")
    tab.choose("detector", "Tags (AprilTag, ArUco)")


def send(tab: Tab, *files: Path) -> None:
    """Choose files, several at once."""
    tab.page.wait_for_selector("[data-mm-files]")
    uuid = tab.page.locator("[data-mm-files]").get_attribute("data-mm-files")
    chooser = tab.page.locator(f'[id="file_upload_{uuid}"]')
    settle(lambda: chooser.evaluate("(input) => input.multiple"), "a choice of several files")
    chooser.set_input_files([str(file) for file in files])


def send_all(tab: Tab, files: dict[str, bytes], folder: Path) -> None:
    """Send the files of a moment; map 1 is of another room."""
    send(tab, *laid_down(files, folder))
    settle(lambda: tab.page.locator("[data-mm-files] tr[data-missing]").count() == 0, "all files")
    box = tab.page.get_by_label("use map 1", exact=True)
    if box.is_checked():
        box.click()
    settle(lambda: tab.page.get_by_role("button", name="Look", exact=True).is_enabled(), "Look")


def look(tab: Tab) -> str:
    """Press Look; what came of it."""
    tab.press("Look")
    settle(lambda: tab.page.locator(".mm-seen img").count(), "what was seen")
    return outcome(tab)


def outcome(tab: Tab) -> str:
    """The sentence over the image."""
    words = tab.page.get_by_text("The robot is ").or_(tab.page.get_by_text("No sighting: "))
    return words.first.inner_text()


def usable(tab: Tab) -> bool:
    return tab.page.get_by_role("button", name="Use this sighting").is_enabled()


def test_a_sighting_of_the_sample_is_used_and_undone(tab: Tab):
    before = tab.number("range r")
    tab.unfold("From camera and scan")
    tab.press("From the sample")
    settle(lambda: "as in encounters.csv" in tab.text, "where the robots stood")
    assert "seen_1.jpg, 640 × 480" in tab.text
    settle(lambda: tab.page.get_by_role("button", name="Look", exact=True).is_enabled(), "Look")
    assert look(tab).startswith("The robot is 5.3")
    assert not tab.page.get_by_text("Stages", exact=True).is_visible()  # the charts have given way
    assert tab.page.locator(SPOT).count() == tab.page.locator(LINE).count() == 1
    assert tab.page.locator(".mm-above svg").is_visible()
    widths = "(images) => images.map((image) => image.naturalWidth)"
    assert tab.page.locator(".mm-seen img").evaluate_all(widths) == [960]
    assert min(tab.page.locator(".mm-hog img").evaluate_all(widths)) > 100
    tab.press("Use this sighting")
    settle(lambda: tab.number("range r") != before, "the observation")
    assert metres(tab.number("range r")) == pytest.approx(5.313, abs=0.005)
    assert metres(tab.number("bearing β")) == pytest.approx(-4.4, abs=0.2)
    settle(lambda: tab.layer("window"), "what it leaves of the window")
    assert tab.page.get_by_text("Stages", exact=True).is_visible()
    settle(lambda: tab.page.evaluate(DOCK) < 330, "the charts as wide as before")
    tab.unfold("History")
    assert tab.page.locator(".mm-entry[aria-current]").inner_text() == "sighting from camera and scan"
    tab.press("Undo")
    settle(lambda: tab.number("range r") == before, "the observation before")


def test_of_two_robots_one_is_chosen_in_the_image_and_in_the_list(tab: Tab, tmp_path: Path):
    unfolded(tab)
    send_all(tab, sighting_files(NEAR, ASIDE), tmp_path)
    assert "2 robots are in view" in look(tab)
    assert not usable(tab)
    assert tab.page.locator(SPOT).count() == 2
    tab.page.locator('.mm-seen [data-mm-box="1"]').click()
    settle(lambda: usable(tab), "a sighting")
    assert f"The robot is {hypot(*NEAR):.1f}" in outcome(tab)
    line = tab.page.locator('.mm-found[data-mm-box="0"]')
    line.focus()
    tab.page.keyboard.press("Enter")
    settle(lambda: f"The robot is {hypot(*ASIDE):.1f}" in outcome(tab), "the other robot")
    pressed = "() => document.activeElement.matches('.mm-found[data-mm-box=\"0\"][aria-pressed=true]')"
    settle(lambda: tab.page.evaluate(pressed), "the line that was pressed to keep the focus")
    tab.press("Close")
    settle(lambda: not tab.page.locator(".mm-seen").count(), "the dock to close")
    tab.press("Show what was seen")
    settle(lambda: usable(tab), "what was seen")
    tab.page.get_by_label("tag size (m)", exact=True).fill("0.2")
    tab.page.keyboard.press("Tab")
    settle(lambda: not usable(tab), "what was seen to be out of date")
    assert "press “Look again”" in tab.text
    tab.press("Look again")
    settle(lambda: "2 robots are in view" in outcome(tab), "another look")


def test_a_poster_and_an_empty_room_are_refused_with_the_reason(tab: Tab, tmp_path: Path):
    unfolded(tab)
    send_all(tab, sighting_files(NEAR, on_wall=True), tmp_path)
    assert "no step in depth" in look(tab)
    assert not usable(tab)
    tab.page.locator(LINE).click()
    assert "Refused: " in tab.page.locator(LINE).inner_text()
    assert not usable(tab)
    send(tab, *laid_down({"empty.png": sighting_files()["seen.png"]}, tmp_path))
    settle(lambda: "empty.png" in tab.text, "the other image")
    tab.press("Look again")
    settle(lambda: "no robot is found" in outcome(tab), "another look")
    assert tab.page.locator(SPOT).count() == 0
    assert not usable(tab)


def test_files_are_dropped_together_and_what_is_none_of_them_is_told(tab: Tab, tmp_path: Path):
    unfolded(tab)
    files = sighting_files(NEAR)
    dropped = [[name, list(content)] for name, content in {**files, "notes.txt": b"Dear diary"}.items()]
    tab.page.wait_for_selector("[data-mm-files]")
    tab.page.evaluate(DROP, dropped)
    settle(lambda: "notes.txt: is neither an image, nor a camera's calibration" in tab.text, "what is none")
    assert tab.mood == "failed"
    assert tab.page.locator("[data-mm-files] tr[data-missing]").count() == 0
    small = picture_to_png(np.zeros((240, 320, 3), np.uint8))
    send(tab, *laid_down({"small.png": small}, tmp_path))
    settle(
        lambda: "small.png is 320 × 240 pixels, and camera.yaml is for 640 × 480" in tab.text, "a mismatch"
    )
    assert tab.page.get_by_role("button", name="Look", exact=True).is_disabled()
    tab.unfold("Where the robots stood")
    tab.page.get_by_label("robot 2, x (m)", exact=True).fill("1.5")
    tab.page.keyboard.press("Tab")
    settle(lambda: "as typed" in tab.text, "a place that was typed")
    assert field(tab, "robot 2, x (m)") == 1.5
    tab.press("Forget these files")
    settle(lambda: tab.page.locator("[data-mm-files] tr[data-missing]").count() == 3, "nothing to be there")
