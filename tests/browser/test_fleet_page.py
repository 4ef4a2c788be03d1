"""A fleet in a real Chromium: loaded, merged before the eyes, its pairs opened, its robots changed."""

from __future__ import annotations

import zipfile

import pytest
from driver import READY, SAID, Tab, of_two, settle

from algorithms.files.case_folder import read_case
from algorithms.files.fleet_archive import fleet_to_files
from algorithms.files.fleet_file import read_fleet
from app.model.fleet_state import FleetState
from app.page.application import make_server
from app.page.fleet.fleet_display import READY as OF_ROBOTS
from app.report.result_files import zip_bytes
from app.system.data_paths import fleets, samples

pytestmark = pytest.mark.browser

ISLAND = "home_fleet_island"
WATCH_PAIRS = """() => {
    const pairs = () => [...document.querySelectorAll("button[data-mm-pair]")].map((row) => row.innerText);
    const watch = new MutationObserver(() => window.seenPairs.push(...pairs()));
    window.seenPairs = [];
    watch.observe(document.body, { subtree: true, childList: true, characterData: true });
}"""
LIE = "r3 saw r4\nleft out: r3's sighting of r4 would put it 3.7 m off"


def rows(tab: Tab, what: str) -> list[str]:
    return tab.page.locator(f"button[data-mm-{what}]").all_inner_texts()


def robots(tab: Tab) -> dict[str, str]:
    """What is said of each robot."""
    told = (row.replace(" ⚓", "").split("\n") for row in rows(tab, "robot"))
    return {name: " ".join(words) for name, *words in told}


def merged(tab: Tab) -> None:
    settle(lambda: tab.mood in ("accepted", "refused"), "the fleet")


@pytest.fixture
def island(open_tab) -> Tab:
    """A tab with six robots, of which two have seen nobody of the others; one sighting is a lie."""
    tab = open_tab(size=(1400, 900))
    tab.choose("Sample", ISLAND)
    settle(lambda: tab.state == OF_ROBOTS.format(6), "the fleet")
    return tab


def test_a_fleet_is_merged_before_the_eyes_and_says_who_lies_and_who_is_alone(island):
    assert set(robots(island)) == {f"r{k}" for k in range(1, 7)}
    assert len(rows(island, "pair")) == 6
    island.page.evaluate(WATCH_PAIRS)  # each stands there but for a moment
    island.press("Merge")
    merged(island)
    assert any("right by itself" in row for row in island.page.evaluate("() => window.seenPairs"))
    assert island.state.startswith("4 of 6 robots are in the map of r1.")
    told = robots(island)
    assert told["r1"] == "the anchor"
    assert all(told[name].startswith("placed, ") for name in ("r2", "r3", "r4"))
    assert all(told[name].startswith("island 2") for name in ("r5", "r6"))
    assert LIE in rows(island, "pair")
    names = island.page.locator("tr td:first-child").all_inner_texts()
    assert [name for name in names if name in told] == list(told)  # where each lies, in the fleet's order
    assert not island.page.get_by_text("What do you know?", exact=True).is_visible()  # that is of two maps
    lines = [item for item in island.layer("sight") if item["k"] == "path"]
    assert sum(bool(item["d"]) for item in lines) == 1  # the lie alone is dashed
    assert {item["t"] for item in island.layer("robots")} == set(told)
    island.press("Heights")
    notice = island.page.locator(".mantine-Notification-root", has_text="This view is of two maps.")
    settle(lambda: notice.count() == 1, "why it stays a map")
    assert "Map" in island.page.evaluate("() => window.mapmeld.hud.pressed")

    island.page.get_by_role("button", name="Undo").click()  # back to the sample that was there before
    settle(lambda: island.state == "Ready. Press Merge.", "two maps")
    assert not rows(island, "robot")
    island.page.get_by_role("button", name="Redo").click()
    merged(island)
    assert LIE in rows(island, "pair")
    island.page.reload()
    island.page.wait_for_function(READY)
    merged(island)
    assert LIE in rows(island, "pair")


def test_a_pair_is_opened_merged_and_put_back_and_a_click_on_its_line_opens_it(open_tab):
    tab = open_tab(size=(1400, 900))
    tab.choose("Sample", "corridor_fleet_loop")
    settle(lambda: tab.state == OF_ROBOTS.format(3), "the fleet")
    tab.press("Merge")
    merged(tab)
    assert tab.state == "3 of 3 robots are in the map of r1."
    (vague,) = (row for row in rows(tab, "pair") if row.startswith("r1 saw r2"))
    assert "alone it was refused" in vague
    tab.press("Instant")
    tab.page.locator("button[data-mm-pair]", has_text="r1 saw r2").click()
    settle(lambda: tab.page.locator(".mm-case").inner_text() == "r1 saw r2", "the pair")
    settle(lambda: tab.mood == "refused", "its own verdict")
    assert {item.get("t") for item in tab.layer("robots")} >= {"r1"}
    tab.press("Back to the fleet")
    settle(lambda: tab.state == "3 of 3 robots are in the map of r1.", "the fleet again")
    tab.at_rest()
    line = next(item for item in tab.layer("sight") if item["k"] == "path")
    middle = [sum(point[axis] for point in line["p"]) / 2 for axis in (0, 1)]
    tab.page.mouse.click(*tab.page.evaluate("(p) => mapmeld.pixel(p)", middle))
    settle(lambda: " saw " in tab.page.locator(".mm-case").inner_text(), "the pair of the line")


def test_robots_are_renamed_hidden_made_the_anchor_and_removed_and_undo_goes_back(island):
    island.page.locator("button[data-mm-robot]", has_text="r2").click()
    island.unfold("The chosen robot")
    label = island.page.locator("label").get_by_text("Name", exact=True)
    box = label.locator("xpath=ancestor::div[2]").locator("input")
    settle(lambda: box.input_value() == "r2", "its name")
    box.fill("Alice")
    island.page.wait_for_timeout(200)  # of what is written within 50 ms the page sends only the last
    island.press("Rename it")
    settle(lambda: "Alice" in robots(island), "the new name")
    assert "Alice saw r1\nnot merged yet" in rows(island, "pair")
    island.press("Make it the anchor")
    settle(lambda: "Alice ⚓" in " ".join(rows(island, "robot")), "the anchor")
    island.page.locator("button[data-mm-eye]").nth(1).click()
    settle(lambda: "Alice" not in {item["t"] for item in island.layer("robots")}, "a hidden map")
    island.press("Remove it")
    settle(lambda: "Alice" not in robots(island), "a robot less")
    assert not [row for row in rows(island, "pair") if "Alice" in row]
    undo = island.page.get_by_role("button", name="Undo")
    undo.click()
    settle(lambda: "Alice" in robots(island), "the robot again")
    undo.click()
    settle(lambda: "r1 ⚓" in " ".join(rows(island, "robot")), "the anchor of before")
    undo.click()
    settle(lambda: "r2" in robots(island), "the old name")


def test_an_opened_pair_is_told_by_its_robots_names_and_two_maps_without_names_as_ever(open_tab, tmp_path):
    fleet = FleetState(read_fleet(fleets()["corridor_fleet_loop"]))
    called = fleet.renamed("r1", "Bob").renamed("r2", "<i>Alice").fleet
    (tmp_path / "fleet.zip").write_bytes(zip_bytes(fleet_to_files(called)))
    tab = open_tab(size=(1400, 900))
    tab.open_files(tmp_path / "fleet.zip")
    settle(lambda: tab.state == OF_ROBOTS.format(3), "the fleet")
    tab.page.locator("button[data-mm-pair]", has_text="Bob saw <i>Alice").click()
    settle(lambda: tab.page.locator(".mm-case").inner_text() == "Bob saw <i>Alice", "the pair")
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("refused")
    settle(lambda: tab.page.locator("[data-mm-suggestion]").count(), "what it suggests")
    assert "little keeps <i>Alice's map in its place" in tab.state
    assert tab.number("<i>Alice's place, 1 σ")
    assert of_two(tab) == []
    for stage in ("Turn", "Shift", "Proof"):
        tab.press(stage)
        assert of_two(tab) == []
    for way in ("Blink", "Curtain", "Heights", "Map"):
        tab.press(way)
        tab.page.wait_for_timeout(300)
        assert of_two(tab) == []
    tab.press("Move <i>Alice's map by hand")
    settle(lambda: tab.state.startswith("By hand, would be refused"), "the verdict on it")
    assert of_two(tab) == []
    tab.press("Leave it as it was")
    tab.press("Move the robots by hand")
    settle(lambda: "<i>Alice, seen here" in {item.get("t") for item in tab.layer("robots")}, "the signs")
    tab.page.get_by_label("<i>Alice: x (m)").wait_for()
    assert of_two(tab) == []
    assert tab.page.locator("i", has_text="Alice").count() == 0  # a name is no HTML
    tab.choose("Sample", "office_r3_r2")
    settle(lambda: tab.state == "Ready. Press Merge.", "two maps")
    assert [entry["t"] for entry in tab.page.evaluate("() => mapmeld.hud.legend")] == ["map 1", "map 2"]
    settle(lambda: {"robot 1", "robot 2"} <= {item.get("t") for item in tab.layer("robots")}, "the signs")
    assert "Alice" not in tab.page.evaluate(SAID)


def test_a_turn_that_is_known_of_two_maps_is_known_of_the_fleet_and_of_two_robots_again(open_tab):
    tab = open_tab(size=(1400, 900))
    tab.choose("Known is", "Roughly the turn")
    tab.press("Done")
    tab.press("Add robots")
    settle(lambda: rows(tab, "pair") == ["robot 1 and robot 2\nnot merged yet"], "what is known")
    tab.unfold("Add a robot")
    tab.choose("Or a sample", "apartment, r1")
    settle(lambda: "apartment_r1" in robots(tab), "a third robot")
    tab.unfold("The chosen robot")
    tab.page.locator("button[data-mm-robot]", has_text="apartment_r1").click()
    tab.press("Remove it")
    settle(lambda: len(robots(tab)) == 2, "two robots again")
    tab.page.locator("button[data-mm-pair]").click()
    settle(lambda: tab.page.locator(".mm-case").inner_text() == "robot 1 and robot 2", "the pair")
    assert tab.page.get_by_label("Known is", exact=True).first.input_value() == "Roughly the turn"
    assert tab.page.get_by_label("σ of Δθ (°)", exact=True).is_visible()


@pytest.fixture
def fresh():
    """A server that nothing was merged on."""
    server = make_server(port=0, initial=read_case(samples()["office_r2_r1"]))
    yield server
    server.stop()


def test_a_robot_is_added_to_two_maps_and_the_result_and_the_fleet_are_taken_away(open_tab, fresh, tmp_path):
    tab = open_tab(size=(1400, 900), at=fresh)
    tab.press("Add robots")
    settle(lambda: tab.state == OF_ROBOTS.format(2), "a fleet of two")
    third = samples()["office_r3_r2"]
    tab.unfold("Add a robot")
    tab.open_files(third / "map1.yaml")
    settle(lambda: "its image is missing" in " ".join(tab.listed()), "what is missing")
    tab.open_files(third / "map1.pgm")
    settle(lambda: set(robots(tab)) == {"robot 1", "robot 2", "map1"}, "a third robot")
    tab.choose("Or a sample", "apartment, r1")
    settle(lambda: "apartment_r1" in robots(tab), "a fourth, of another building")
    tab.press("Merge")
    merged(tab)
    assert robots(tab)["robot 2"].startswith("placed, ")
    assert robots(tab)["apartment_r1"] == "alone"
    with tab.page.expect_download() as download:
        tab.press("Download the result")
    download.value.save_as(tmp_path / "result.zip")
    with zipfile.ZipFile(tmp_path / "result.zip") as archive:
        assert {"merged.yaml", "transforms.yaml", "graph.g2o", "report.html"} <= set(archive.namelist())
    with tab.page.expect_download() as download:
        tab.press("Save the fleet")
    download.value.save_as(tmp_path / "fleet.zip")
    other = open_tab(size=(1400, 900))
    other.open_files(tmp_path / "fleet.zip")
    settle(lambda: set(robots(other)) == {"robot 1", "robot 2", "map1", "apartment_r1"}, "the fleet")


def test_what_is_no_fleet_is_told_and_a_merge_of_one_can_be_stopped(island, tmp_path):
    files = fleet_to_files(read_fleet(fleets()[ISLAND]))
    files.pop("robot_2.pgm")
    (tmp_path / "bad.zip").write_bytes(zip_bytes(files))
    before = rows(island, "robot")
    island.open_files(tmp_path / "bad.zip")
    settle(lambda: "names robot_2.pgm, which is not there" in island.state, "what is wrong")
    assert rows(island, "robot") == before
    island.press("Merge")
    settle(island.page.get_by_role("button", name="Stop", exact=True).is_enabled, "Stop")
    island.press("Stop")
    settle(lambda: island.state.startswith("Stopped."), "the stop")
    island.press("Merge")
    merged(island)
    assert LIE in rows(island, "pair")
