"""A pair of maps of 4000 x 4000 cells: it is told what takes a while, and the tab lives on."""

from __future__ import annotations

import numpy as np
import pytest
from driver import settle

from algorithms.casefiles import observations_to_bytes
from algorithms.gridmap import FREE, OCCUPIED, GridMap
from algorithms.mapio import map_to_bytes
from algorithms.observation import Observation
from algorithms.pose import Pose2

pytestmark = pytest.mark.browser

SIDE = 4000  # cells


def many_rooms() -> GridMap:
    """Rooms of many sizes over 200 m x 200 m."""
    cells = np.full((SIDE, SIDE), FREE, dtype=np.int8)
    at, wide = 0, 120
    while at < SIDE:
        cells[at : at + 3, :] = OCCUPIED
        cells[:, at : at + 3] = OCCUPIED
        at, wide = at + wide, wide + 17
    cells[SIDE // 2 - 20 : SIDE // 2 + 20, ::7] = FREE  # doors, of a kind
    return GridMap(cells, 0.05)


def test_large_maps_are_loaded_shown_and_dragged_while_the_tab_says_what_it_does(tab, tmp_path):
    tab.page.evaluate(
        """() => {
            const line = document.querySelector(".mm-state span");
            window.said = [];
            new MutationObserver(() => window.said.push(line.textContent)).observe(line, { childList: true });
        }"""
    )
    grid = many_rooms()
    files = [*map_to_bytes(grid, "map1").items(), *map_to_bytes(grid, "map2").items()]
    seen = Observation(Pose2(100.0, 100.0, 0.0), 103.0, 100.0, 3.0, 0.0)
    files.append(("observation.yaml", observations_to_bytes([seen])))
    order = {"map1.yaml": 0, "map1.pgm": 1, "map2.yaml": 2, "map2.pgm": 3, "observation.yaml": 4}
    tab.unfold("Upload your own")
    for name, content in sorted(files, key=lambda file: order[file[0]]):
        (tmp_path / name).write_bytes(content)
        tab.upload(order[name], tmp_path / name)
        settle(lambda name=name: name in tab.page.locator("table").first.inner_text(), name)
    settle(lambda: tab.state == "Ready. Press Merge.", "both maps and the observation")
    said = tab.page.evaluate("() => window.said")
    # two words that come within one frame are seen as the later one
    assert {"Reading map1.pgm, 16 MB.", "Reading map2.pgm, 16 MB.", "Drawing the maps."} & set(said)
    drawn = "(name) => !!window.__viserMutable.nodeRefFromName[`/world/${name}/walls`]"
    settle(lambda: all(tab.page.evaluate(drawn, name) for name in ("ref", "mov")), "the pictures")

    eye = "() => window.__viserMutable.cameraControl.camera.position.x"
    before = tab.page.evaluate(eye)
    box = tab.page.locator("#mapmeld-ink").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.page.mouse.move(x, y)
    tab.page.mouse.down()
    tab.page.mouse.move(x + 60, y, steps=6)
    tab.page.mouse.up()
    settle(lambda: tab.page.evaluate(eye) != before, "the map to follow the hand")

    tab.press("Merge")
    settle(lambda: tab.mood == "running", "the run")
    tab.press("Stop")
    tab.wait_for("stopped")
