"""The merged map is corrected with the mouse, seen so, undone, and taken away, in a real Chromium."""

from __future__ import annotations

import numpy as np
import pytest
from driver import settle

from algorithms.files.map_file import read_map
from algorithms.maps.grid_map import OCCUPIED

pytestmark = pytest.mark.browser


def dark(tab, point) -> bool:
    """Whether there is wall at a point of the scene, as far as a line of one cell can be seen from afar."""
    x, y = tab.page.evaluate("(p) => mapmeld.pixel(p)", list(point))
    around = tab.pixels()[round(y) - 3 : round(y) + 4, round(x) - 1 : round(x) + 2]
    return bool(around.sum(axis=2).min() < 300)


def test_what_is_drawn_on_the_merged_map_is_seen_there_taken_away_and_undone(open_tab, tmp_path):
    tab = open_tab(smooth=True)
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    tab.unfold("Correct the map")
    tab.press("Draw a keep-out line")
    settle(lambda: tab.state.startswith("Drag along"), "the tool")
    tab.at_rest()
    box = tab.page.locator("canvas").first.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    middle = tab.page.evaluate("([x, y]) => mapmeld.ground(x, y)", [x, y])
    mouse = tab.page.mouse
    mouse.move(x - 60, y)
    mouse.down()
    mouse.move(x, y, steps=3)
    mouse.move(x + 60, y, steps=3)
    mouse.up()
    said = tab.page.get_by_text("1 keep-out line")
    said.wait_for()
    settle(lambda: dark(tab, middle), "the line")
    tab.page.keyboard.press("Escape")
    tab.wait_for("accepted")

    image, text = (tmp_path / f"merged.{suffix}" for suffix in ("pgm", "yaml"))
    for path in (image, text):
        tab.choose("One file", path.name)
        with tab.page.expect_download() as download:
            tab.press("Download this file")
        download.value.save_as(path)
    grid = read_map(text)
    anchor = tab.page.evaluate("() => mapmeld.hud.frames[0].slice(0, 2)")
    assert grid.value_at(np.array(middle) + anchor) == OCCUPIED

    tab.page.keyboard.press("e")
    settle(lambda: tab.state.startswith("Drag over"), "the brush")
    mouse.move(x - 80, y)
    mouse.down()
    mouse.move(x + 80, y, steps=6)
    mouse.up()
    settle(lambda: not dark(tab, middle), "the line to go")
    tab.page.keyboard.press("Control+z")
    settle(lambda: dark(tab, middle), "the line to come back")
    assert tab.state.startswith("Drag over")  # the brush is still taken up
