"""A pair of maps of 3000 x 3000 cells: it is told what takes a while, reading can be stopped, the tab lives
on, and whoever looks closely sees every cell.
"""

from __future__ import annotations

from time import sleep

import numpy as np
import pytest
from driver import Tab, settle

from algorithms.common.pose import Pose2
from algorithms.files.map_file import map_from_bytes, map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.observations.observation import Observation
from app.drawing.palette import LIGHT
from app.model.files import map_slots

pytestmark = pytest.mark.browser

SIDE, CELL = 3000, 0.05
PILLAR = (1431, 1472)  # row and column of a wall of one cell in the middle of a room
SEEN_AT = np.array([73.0, 70.0])  # robot 2, in both maps


def many_rooms() -> GridMap:
    """Rooms of many sizes over 150 m x 150 m."""
    cells = np.full((SIDE, SIDE), FREE, dtype=np.int8)
    at, wide = 0, 120
    while at < SIDE:
        cells[at : at + 3, :] = OCCUPIED
        cells[:, at : at + 3] = OCCUPIED
        at, wide = at + wide, wide + 17
    cells[SIDE // 2 - 20 : SIDE // 2 + 20, ::7] = FREE  # doors, of a kind
    cells[PILLAR] = OCCUPIED
    cells[-150:] = UNKNOWN  # a map without any would be warned of
    return GridMap(cells, CELL)


def centre(row: int, col: int) -> np.ndarray:
    """Where a cell of either map is, from the place where robot 2 was seen; metres."""
    return (np.array([col, row]) + 0.5) * CELL - SEEN_AT


def around_the_pillar(tab: Tab, frame: str) -> list[tuple[int, ...]]:
    """Colours of the pillar and of the cells beside it, as the window shows them."""
    row, col = PILLAR
    cells = [(row, col), (row, col - 1), (row, col + 1), (row - 1, col), (row + 1, col)]
    where = [
        tab.page.evaluate("([p, f]) => window.mapmeld.pixel(p, f)", [centre(*c).tolist(), frame])
        for c in cells
    ]
    shown = tab.pixels()
    return [tuple(shown[round(y), round(x)]) for x, y in where]


def look_at_the_pillar(tab: Tab, frame: str) -> None:
    """A cell is some 10 px wide."""
    move = """([x, y, f]) => {
        const m = window.mapmeld.maps[f.slice(3)], [u, v] = [x + m.x, y + m.y];
        window.mapmeld.follow = false;
        window.mapmeld.kit.aim(true, { view: "map", box: [u - 1.3, v - 1.3, u + 1.3, v + 1.3] });
    }"""
    tab.page.evaluate(move, [*centre(*PILLAR).tolist(), frame])
    tab.at_rest()


def test_large_maps_are_loaded_stopped_looked_at_and_dragged(tab, tmp_path, monkeypatch):
    tab.page.evaluate(
        """() => {
            const line = document.querySelector(".mm-state span");
            window.said = [];
            const observer = new MutationObserver(() => window.said.push(line.textContent));
            observer.observe(line, { childList: true, subtree: true });
        }"""
    )
    grid = many_rooms()
    content = {**map_to_bytes(grid, "map1"), **map_to_bytes(grid, "map2")}
    seen = Observation(Pose2(70.0, 70.0, 0.0), *SEEN_AT.tolist(), 3.0, 0.0)
    content["observation.yaml"] = known_to_bytes([seen])
    for name, data in content.items():
        (tmp_path / name).write_bytes(data)
    for names in (("map1.yaml", "map1.pgm"), ("map2.yaml", "map2.pgm", "observation.yaml")):
        tab.open_files(*(tmp_path / name for name in names))
        settle(lambda name=names[1]: any(name in line for line in tab.listed()), names[1])
    settle(lambda: tab.state == "Ready. Press Merge.", "both maps and the observation")
    said = tab.page.evaluate("() => window.said")
    # two words that come within one frame are seen as the later one
    assert {
        "Reading map1.pgm and 1 more, 9 MB.",
        "Reading map2.pgm and 2 more, 9 MB.",
        "Drawing the maps.",
    } & set(said)
    drawn = "(name) => !!window.__viserMutable.nodeRefFromName[`/world/${name}/walls`]"
    settle(lambda: all(tab.page.evaluate(drawn, name) for name in ("map1", "map2")), "the pictures")

    def slowly(yaml_name, yaml, name, image):
        while image.getvalue() == slow:
            image.read(1)
            sleep(0.01)
        return map_from_bytes(yaml_name, yaml, name, image)

    slow = content["map1.pgm"] + b" "
    monkeypatch.setattr(map_slots, "map_from_bytes", slowly)
    (tmp_path / "map1.pgm").write_bytes(slow)
    tab.open_files(tmp_path / "map1.pgm")
    settle(lambda: tab.state == "Reading map1.pgm, 9 MB.", "the reading")
    stop = tab.page.get_by_role("button", name="Stop", exact=True)
    settle(stop.is_enabled, "Stop")
    tab.press("Stop")
    settle(lambda: tab.state == "Ready. Press Merge.", "everything as it was")
    settle(stop.is_disabled, "nothing to stop")
    assert len(tab.listed()) == 5

    look_at_the_pillar(tab, "map1")
    settle(lambda: around_the_pillar(tab, "map1") == [LIGHT.ref, *[LIGHT.free] * 4], "every cell of map 1")
    look_at_the_pillar(tab, "map2")
    settle(lambda: around_the_pillar(tab, "map2") == [LIGHT.mov, *[LIGHT.free] * 4], "every cell of map 2")

    tab.press("Move map 2 by hand")
    settle(lambda: tab.page.evaluate("() => !!window.mapmeld.hand?.mov"), "map 2 in the hand")
    before = tab.page.evaluate("() => window.mapmeld.maps[2].x")
    x, y = tab.page.evaluate("(p) => window.mapmeld.pixel(p, 'map2')", centre(*PILLAR).tolist())
    tab.page.mouse.move(x + 40, y + 40)
    tab.page.mouse.down()
    tab.page.mouse.move(x + 140, y + 60, steps=8)
    tab.page.mouse.up()
    assert tab.page.evaluate("() => window.mapmeld.maps[2].x") > before
    settle(
        lambda: around_the_pillar(tab, "map2") == [LIGHT.mov, *[LIGHT.free] * 4], "the cells to come along"
    )

    tab.press("Merge")
    settle(lambda: tab.mood == "running", "the run")
    tab.press("Stop")
    tab.wait_for("stopped")
