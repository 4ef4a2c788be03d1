"""Robots that run in a real Chromium: the demo, a still picture, the past; robots that come and leave."""

from __future__ import annotations

import pytest
from driver import Tab, settle
from explorers import exploration

from app.live import map_source
from app.live.message_fields import grid_message, transforms_message
from app.live.ros_link import TF, Topic
from app.live.simulation import map_of, messages_of
from app.live.watch.inner_link import InnerLink, InnerPublication
from app.live.watch.robot_network import RobotNetwork
from app.page.application import make_server

pytestmark = pytest.mark.browser

WHOLE = "3 of 3 robots are in the map of r1."
SECOND = 1_000_000_000


def robots(tab: Tab) -> dict[str, str]:
    """What is said of each robot."""
    told = (row.replace(" ⚓", "").split("\n") for row in tab.page.locator(".mm-robot").all_inner_texts())
    return {name: " ".join(words) for name, *words in told}


def history(tab: Tab, seconds: int) -> None:
    box = tab.page.get_by_label("History (s), number", exact=True)
    box.fill(str(seconds))
    box.press("Enter")


def test_the_demo_becomes_one_map_by_itself_is_frozen_looked_back_at_and_goes_on(open_tab):
    tab = open_tab(size=(1280, 800), mode="")
    tab.press("Live demo")
    settle(lambda: tab.state.startswith("Live, 0:0") and "1 of 3 robots" in tab.state, "the first picture")
    settle(lambda: tab.state.startswith("Live, ") and WHOLE in tab.state, "one map")
    tab.wait_for("accepted")

    def all_live() -> bool:
        told = [*robots(tab).values()]
        return len(told) == 3 and all(
            said.startswith(("the anchor", "placed, ")) and "live, " in said for said in told
        )

    settle(all_live, "how each robot does")
    assert {item["t"] for item in tab.layer("robots") if item["s"] == "robot"} == {"r1", "r2", "r3"}
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_disabled()

    tab.press("Freeze")
    settle(lambda: tab.state.startswith("Frozen at 0:"), "the still picture")
    frozen = tab.state
    tab.press("Merge")  # as with files
    settle(lambda: tab.state.startswith(WHOLE), f"the merge of what was frozen; {frozen}")
    settle(lambda: "The picture stands still." in tab.text, "that robots go on")
    history(tab, 1)
    settle(lambda: tab.state.startswith("Looking back at 0:0"), "the past")
    assert "1 of 3 robots" in tab.state
    assert "live, " not in str(robots(tab))
    tab.page.get_by_role("button", name="Undo").click()
    settle(lambda: tab.state.startswith(WHOLE), "the still picture again")

    tab.press("Go on live")
    settle(lambda: tab.state.startswith("Live, ") and WHOLE in tab.state, "the robots again")
    tab.page.locator("button[data-mm-pair]").first.click()  # nobody is called back from there
    settle(lambda: tab.page.get_by_role("button", name="Go on live").is_visible(), "that it stands still")
    assert " saw " in tab.page.locator(".mm-case").inner_text()
    tab.press("Go on live")
    settle(lambda: tab.state.startswith("Live, "), "the robots once more")
    tab.press("Live demo")
    settle(lambda: not tab.page.get_by_role("button", name="End it").is_visible(), "its end")
    assert tab.state.startswith("Frozen at ")


class Nearby(RobotNetwork):
    """Robots in this process; scan by scan as a test wants it."""

    def __init__(self) -> None:
        super().__init__()
        self.inner, self.robots, self.opened = InnerLink(), exploration(), 0
        self._ends: dict[Topic, InnerPublication] = {}

    def links(self):
        self.opened += 1
        return self

    def link(self, address: str = "") -> InnerLink:
        return self.inner

    def close(self) -> None:
        pass

    def drive(self, scan: int) -> None:
        for topic, fields in messages_of(self.robots, scan, scan * SECOND):
            self.send(topic, fields)

    def send(self, topic: Topic, fields) -> None:
        if topic not in self._ends:
            self._ends[topic] = self.inner.advertise(topic)
        self._ends[topic].send(fields)

    def leave(self, name: str) -> None:
        for topic in [topic for topic in self._ends if topic.name.startswith(f"/{name}/")]:
            self._ends.pop(topic).leave()


@pytest.fixture
def nearby():
    network = Nearby()
    server = make_server(port=0, network=network)
    yield network, server
    server.stop()


def test_robots_are_added_by_their_maps_grow_stale_leave_and_are_taken_back_loudly(
    open_tab, nearby, monkeypatch
):
    monkeypatch.setattr(map_source, "STALE_AFTER", 2.0)
    network, server = nearby
    network.drive(0)
    tab = open_tab(size=(1280, 800), at=server, mode="Operator")
    assert network.opened == 0  # before anybody asks
    tab.press("Look for maps")
    settle(lambda: "3 maps are published within reach." in tab.text, "the maps")
    for name in ("r1", "r2"):
        tab.choose("Published map", f"/{name}/map")
        tab.press("Add this robot")
        settle(lambda name=name: f"{name} is followed, by its map on /{name}/map." in tab.text, name)
    settle(lambda: set(robots(tab)) == {"r1", "r2"}, "both maps")
    eye = tab.page.locator("button[data-mm-eye='1']")
    eye.focus()  # the list is drawn anew every second, and keeps it
    marked = "() => document.querySelector('.mm-robot').marked = true"
    tab.page.evaluate(marked)
    settle(lambda: not tab.page.evaluate("() => document.querySelector('.mm-robot').marked"), "a new list")
    focused = "() => document.activeElement.getAttribute('data-mm-eye')"
    settle(lambda: tab.page.evaluate(focused) == "1", "the focus")

    scans = iter(range(1, network.robots.scans + 1))
    said = "2 of 2 robots are in the map of r1."

    def drives() -> bool:
        scan = next(scans, None)
        if scan is not None:
            network.drive(scan)
        tab.page.wait_for_timeout(150)
        return said in tab.state

    settle(drives, "one map")
    settle(lambda: "stale for" in robots(tab).get("r2", ""), "that no map comes")
    network.leave("r2")
    settle(lambda: "gone; " in robots(tab).get("r2", ""), "that it is gone")
    assert said in tab.state  # its last map stays

    grid = network.robots.grid("r2", network.robots.scans)
    network.send(Topic("/tf", TF), transforms_message([], SECOND))
    network.send(map_of("r2"), grid_message(grid, "r2/begun_anew", SECOND))
    settle(lambda: tab.state.startswith("Taken back: r2 has no place any more"), "that it is taken back")
    assert tab.mood == "refused"
    assert tab.page.locator(".mm-said").inner_text().startswith("Taken back")


def test_without_a_network_the_page_says_how_to_start_it_with_one(tab):
    tab.unfold("Running robots")
    settle(lambda: "mapmeld serve --live" in tab.text, "what to do")
    assert not tab.page.get_by_role("button", name="Look for maps").is_visible()
