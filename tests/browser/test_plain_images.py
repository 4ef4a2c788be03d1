"""Images that come without a YAML file, as a person brings them."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from driver import Tab, settle
from PIL import Image

from algorithms.files.map_file import read_map
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN
from app.drawing.palette import LIGHT

pytestmark = pytest.mark.browser

PREVIEW = "img[alt='what each pixel means']"


def l_room(folder, name="room.png"):
    """An L of walls in grey, 6 x 4 pixels: its stem at the left, its foot below, the unknown at the right."""
    grey = np.full((4, 6), 254, dtype=np.uint8)
    grey[:, 0], grey[-1, :], grey[:, -1] = 0, 0, 205
    Image.fromarray(grey).save(folder / name)
    return folder / name


def preview(tab: Tab) -> np.ndarray:
    """(H, W, 3) the picture in the form, row 0 at the top."""
    data = tab.page.locator(PREVIEW).first.get_attribute("src")
    image = Image.open(io.BytesIO(base64.b64decode(data.split(",")[1])))
    return np.asarray(image.convert("RGBA"))[..., :3]


def fill(tab: Tab, label: str, value: str) -> None:
    tab.page.get_by_label(label, exact=True).first.fill(value)


def test_an_image_alone_is_read_as_the_form_says_and_its_yaml_can_be_taken_away(tab, tmp_path):
    tab.open_files(l_room(tmp_path))
    settle(lambda: "Map 1's image has no YAML file yet" in tab.state, "what to do")
    settle(lambda: "wall 33.3%" in tab.text, "the shares")
    assert "free 50.0%" in tab.text
    assert "6 × 4 cells: 0.3 m × 0.2 m" in tab.text
    shown = preview(tab)
    assert [tuple(shown[y, x]) for y, x in ((0, 0), (0, 1), (3, 3), (0, 5))] == [
        LIGHT.ref,
        LIGHT.free,
        LIGHT.ref,
        LIGHT.unknown,
    ]
    crisp = (
        "() => getComputedStyle(document.querySelector(\"img[alt='what each pixel means']\")).imageRendering"
    )
    assert tab.page.evaluate(crisp) == "pixelated"

    fill(tab, "resolution (m)", "0.5")
    settle(lambda: "3.0 m × 2.0 m" in tab.text, "the size to follow")
    fill(tab, "yaw (°)", "90")
    tab.press("Use this map")
    settle(lambda: "Map 1 is here" in tab.state, "the map")
    settle(lambda: "In use." in tab.text, "the note")
    # turned by 90° its left wall lies below: the scene's zero is the middle of what is known, 2.5 m x 2 m
    settle(lambda: tab.colour_at((0.25, -1.0)) == LIGHT.ref, "the stem of the L, lying")
    assert tab.colour_at((-0.25, 0.25)) == LIGHT.free

    tab.page.get_by_label("negate", exact=True).first.click()
    settle(lambda: "Changed: not in use yet." in tab.text, "that it is not in use")
    settle(lambda: tuple(preview(tab)[0, 1]) == LIGHT.ref, "the preview to follow")
    tab.page.get_by_label("negate", exact=True).first.click()
    settle(lambda: "In use." in tab.text, "the note")
    with tab.page.expect_download() as download:
        tab.press("Download YAML")
    assert download.value.suggested_filename == "room.yaml"
    download.value.save_as(tmp_path / "room.yaml")
    back = read_map(tmp_path / "room.yaml")
    assert (back.resolution, back.origin.theta) == (0.5, pytest.approx(np.pi / 2))
    assert back.cells[0].tolist() == [OCCUPIED] * 5 + [UNKNOWN]
    assert back.cells[-1].tolist() == [OCCUPIED] + [FREE] * 4 + [UNKNOWN]

    (tmp_path / "room.yaml").write_bytes((tmp_path / "room.yaml").read_bytes().replace(b": 0.5", b": 0.25"))
    tab.open_files(tmp_path / "room.yaml")
    form = tab.page.get_by_text("Map 1: what the image means", exact=True)
    settle(lambda: form.count() == 0 or not form.is_visible(), "the form to give way to the file")


def test_limits_that_cannot_be_and_images_that_cannot_be_read_are_told(tab, tmp_path):
    broken = tmp_path / "broken.png"
    broken.write_bytes(l_room(tmp_path).read_bytes()[:40])
    tab.open_files(broken)
    tab.wait_for("failed")
    assert "broken.png" in tab.state
    tab.open_files(l_room(tmp_path))
    settle(lambda: "wall 33.3%" in tab.text, "the shares")
    tab.move("free up to", 900)
    settle(lambda: "free_thresh must be the smaller one" in tab.text, "what is wrong")
    assert tab.page.get_by_role("button", name="Use this map", exact=True).is_disabled()
    tab.choose("mode", "raw")
    settle(lambda: "free up to" not in tab.text, "limits that do nothing to go")
    settle(lambda: "read as trinary" in tab.text, "the reading that the greys were made for")
    assert "wall 33.3%" in tab.text
