"""Two maps compared where they lie, a distance measured, the result taken away: as a person does it."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from driver import Tab, settle

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import read_observations
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.methods.registry import merge
from algorithms.observations.observation import Observation
from app.drawing.palette import LIGHT
from app.page.application import make_server

pytestmark = pytest.mark.browser

# places of the scene, whose zero is where robot 2 was seen: (3, 2) in the room
STEM, FOOT, BLOCK, FLOOR = (-2.75, 1.0), (1.5, -1.75), (1.5, 0.9), (0.5, 0.5)


def room(block: bool) -> GridMap:
    """A room of 6 m x 4 m with a thick wall at its left and at its foot, and perhaps a block in it."""
    cells = np.full((40, 60), FREE, dtype=np.int8)
    cells[:, :5] = OCCUPIED
    cells[:5, :] = OCCUPIED
    cells[12:16, 9:13] = OCCUPIED
    cells[-5:, -5:] = UNKNOWN
    if block:
        cells[26:32, 42:48] = OCCUPIED
    return GridMap(cells, 0.1)


@pytest.fixture
def merged(open_tab):
    """A tab where the room lies on the room, the second with a block that the first knows nothing of."""
    seen = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    case = Case("rooms", room(block=False), room(block=True), (seen,), "observation.yaml", None)
    own = make_server(port=0, initial=case)
    tab = open_tab(at=own)
    tab.press("Instant")
    tab.press("Merge")
    settle(lambda: tab.mood in ("accepted", "refused"), "a verdict")
    yield tab
    own.stop()


def seen_at(tab: Tab, place: tuple[float, float], colour: tuple[int, ...], what: str) -> None:
    settle(lambda: tab.colour_at(place) == colour, f"{what}; it is {tab.colour_at(place)}")


def metre(tab: Tab) -> float:
    """Pixels of a metre on the map."""
    ends = "() => [window.mapmeld.pixel([0, 0]), window.mapmeld.pixel([1, 0])]"
    (x0, _), (x1, _) = tab.page.evaluate(ends)
    return x1 - x0


def test_a_curtain_has_map_1_to_its_left_and_map_2_to_its_right_wherever_it_is_dragged(merged):
    seen_at(merged, STEM, LIGHT.agreed, "one wall of both")
    merged.press("Curtain")
    seen_at(merged, STEM, LIGHT.ref, "map 1 to the left")
    seen_at(merged, FOOT, LIGHT.mov, "map 2 to the right")
    handle = merged.page.get_by_role("slider", name="Curtain between map 1 and map 2")
    box = handle.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = merged.at_rest()
    merged.page.mouse.move(x, y)
    merged.page.mouse.down()
    merged.page.mouse.move(merged.page.evaluate("() => window.mapmeld.pixel([2.5, 0])")[0], y, steps=6)
    seen_at(merged, FOOT, LIGHT.ref, "map 1 where map 2 was")
    seen_at(merged, BLOCK, LIGHT.free, "no block in map 1")
    merged.page.mouse.up()
    stayed = merged.page.evaluate("() => window.mapmeld.pixel([0, 0])")
    assert stayed == pytest.approx(before, abs=0.01)  # the map was not dragged
    assert merged.page.evaluate("() => window.mapmeld.hud.readout || ''") == ""  # nor clicked
    for _ in range(9):
        merged.page.keyboard.press("PageDown")
    seen_at(merged, STEM, LIGHT.mov, "map 2 where map 1 was")
    seen_at(merged, BLOCK, LIGHT.mov, "map 2's block")
    merged.press("Overlay")
    seen_at(merged, STEM, LIGHT.agreed, "both again")
    assert not handle.is_visible()
    merged.press("Move map 2 by hand")
    difference = merged.page.get_by_role("button", name="Difference", exact=True)
    settle(lambda: not difference.is_visible(), "no difference of cells that are not merged")
    merged.press("Curtain")
    seen_at(merged, STEM, LIGHT.mov, "the curtain where it was, over a map in the hand")
    merged.press("Leave it as it was")
    settle(difference.is_visible, "the answer to come back")


def test_maps_take_turns_until_one_is_held_and_stay_for_who_wants_no_motion(merged):
    merged.press("Blink")
    seen_at(merged, STEM, LIGHT.ref, "map 1's turn")
    seen_at(merged, STEM, LIGHT.mov, "map 2's turn")
    seen_at(merged, STEM, LIGHT.ref, "map 1's turn again")
    merged.press("map 2")
    seen_at(merged, STEM, LIGHT.mov, "map 2")
    assert merged.page.evaluate("() => window.mapmeld.compare.held") is True
    merged.press("▶ take turns")
    seen_at(merged, STEM, LIGHT.ref, "map 1's turn once more")
    merged.press("Overlay")
    merged.page.emulate_media(reduced_motion="reduce")
    merged.press("Blink")
    settle(lambda: merged.page.get_by_role("button", name="▶ take turns").is_visible(), "a held map")
    seen_at(merged, STEM, LIGHT.ref, "map 1 held")
    merged.press("map 2")
    seen_at(merged, STEM, LIGHT.mov, "map 2 at a press")


def test_the_difference_shows_what_one_map_denies_and_its_place_can_be_gone_to(merged):
    seen_at(merged, BLOCK, LIGHT.conflict, "a contradiction")
    merged.press("Difference")
    seen_at(merged, BLOCK, LIGHT.mov, "the block of map 2")
    faint = settle(lambda: (now := merged.colour_at(STEM)) != LIGHT.agreed and now, "faint agreement")
    assert min(faint) > 140
    (row,) = merged.page.locator("[data-mm-place]").all()
    assert "map 2's wall" in row.inner_text()
    assert row.inner_text().replace("\n", " ").endswith("x 4.5, y 2.9")
    far = metre(merged)
    row.click()
    settle(lambda: metre(merged) > 1.5 * far, "the place from near")
    settle(lambda: row.get_attribute("aria-pressed") == "true", "the row to be marked")
    x, _ = merged.page.evaluate("(p) => window.mapmeld.pixel(p)", list(BLOCK))
    box = merged.page.locator("#mapmeld-ink").bounding_box()
    assert abs(x - box["x"] - box["width"] / 2) < 40
    row.click()
    settle(lambda: metre(merged) == pytest.approx(far, rel=0.02), "everything again")
    merged.press("Swarm space")
    settle(lambda: not merged.page.get_by_role("button", name="Measure").is_visible(), "no map, no tools")
    assert not merged.page.get_by_role("button", name="Difference").is_visible()
    merged.press("Map")
    seen_at(merged, BLOCK, LIGHT.mov, "the block once more")
    merged.press("Slow")
    merged.press("Merge")  # told step by step, there is nothing to compare at first
    settle(lambda: not merged.page.get_by_role("button", name="Difference").is_visible(), "the modes to go")


def test_a_distance_is_measured_with_two_clicks_or_a_drag_and_the_map_stays_where_it_is(tab):
    def at(x: float, y: float) -> tuple[float, float]:
        return tuple(tab.page.evaluate("(p) => window.mapmeld.pixel(p)", [x, y]))

    def line() -> dict[str, float] | None:
        return tab.page.evaluate("() => window.mapmeld.measure.line")

    before = tab.at_rest()
    tab.press("Measure")
    tab.page.mouse.click(*at(0, 0))
    tab.page.mouse.click(*at(3, -4))
    found = settle(line, "a line")
    assert found["metres"] == pytest.approx(5.0, abs=0.01)
    assert found["degrees"] == pytest.approx(-53.13, abs=0.2)
    tab.page.mouse.move(*at(1, 1))
    assert line() == found  # it stays
    tab.page.mouse.move(*at(0, 0))
    tab.page.mouse.down()
    tab.page.mouse.move(*at(0, 2), steps=4)
    tab.page.mouse.up()
    assert line()["metres"] == pytest.approx(2.0, abs=0.01)
    assert line()["degrees"] == pytest.approx(90.0, abs=0.5)
    assert at(0, 0) == pytest.approx(before, abs=0.01)
    assert tab.page.evaluate("() => window.mapmeld.hud.readout || ''") == ""
    near = metre(tab)
    tab.page.mouse.wheel(0, -200)
    settle(lambda: metre(tab) > 1.05 * near, "the wheel to zoom while measuring")
    tab.page.keyboard.press("Escape")
    assert line() is None
    assert tab.page.get_by_role("button", name="Measure").get_attribute("aria-pressed") == "false"


def test_everything_is_taken_away_at_once_and_reads_back_and_the_report_opens_without_a_net(
    tab, browser, sample, tmp_path
):
    def named(name: str):
        return tab.page.get_by_role("button", name=name, exact=True)

    assert tab.page.get_by_text("After a merge it can be taken away from here").count() == 1
    assert not named("Download everything").is_visible()
    assert not named("Download this file").is_visible()
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    with tab.page.expect_download() as download:
        tab.press("Download everything")
    with zipfile.ZipFile(download.value.path()) as packed:
        packed.extractall(tmp_path)
    expected = merge(sample.ref, sample.mov, sample.observations)
    assert np.array_equal(read_map(tmp_path / "merged.yaml").cells, expected.fusion.merged.cells)
    assert read_observations(tmp_path / "observation.yaml") == sample.observations
    with tab.page.expect_download() as download:
        tab.press("Download this file")
    assert download.value.suggested_filename == "report.html"
    (tmp_path / "alone.html").write_bytes(download.value.path().read_bytes())
    for name in ("report.html", "alone.html"):
        asked, said = [], []
        page = browser.new_page(viewport={"width": 900, "height": 900})
        page.on("request", lambda request, asked=asked: asked.append(request.url))
        page.on("console", lambda message, said=said: said.append(message.text))
        page.goto((tmp_path / name).as_uri())
        assert [url.split(":")[0] for url in asked if not url.startswith("data:")] == ["file"]
        assert said == []  # nothing that the page's own policy had to forbid
        assert page.locator(".verdict.accepted").inner_text() == expected.verdict.reason
        assert page.locator("figure svg").count() == 5
        drawn = "() => [...document.querySelectorAll('figure svg')].every((one) => one.clientHeight > 150)"
        assert page.evaluate(drawn)
        assert not page.evaluate("() => document.documentElement.scrollWidth > innerWidth")
        page.close()


def test_the_publishing_line_is_copied_at_a_press_and_a_moved_slider_greys_it(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    tab.context.grant_permissions(["clipboard-read", "clipboard-write"])
    tab.press("Copy the line")
    settle(lambda: tab.page.get_by_role("button", name="Copied").count() == 1, "a word that it is done")
    line = tab.page.evaluate("() => navigator.clipboard.readText()")
    assert line.startswith("ros2 run tf2_ros static_transform_publisher --x ")
    assert line == tab.page.locator(".mm-publish code").inner_text()
    tab.page.evaluate("() => { navigator.clipboard.writeText = () => Promise.reject(new Error('no')); }")
    settle(lambda: tab.page.get_by_role("button", name="Copy the line").count() == 1, "the button's own word")
    tab.press("Copy the line")
    settle(lambda: tab.page.get_by_role("button", name="Copied").count() == 1, "the old way to copy")
    tab.page.evaluate(  # what is greyed may be so for some milliseconds only
        """() => {
            window.greyed = false;
            new MutationObserver(() => {
                if (document.querySelector("[data-mm-copy]:disabled")) window.greyed = true;
            }).observe(document.body, { childList: true, subtree: true });
        }"""
    )
    tab.move("spread", 5)
    settle(lambda: tab.page.evaluate("() => window.greyed"), "the line to be greyed")
    settle(lambda: tab.page.get_by_role("button", name="Copy the line").is_enabled(), "the new line")
