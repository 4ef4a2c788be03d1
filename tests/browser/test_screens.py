"""Laptop, tablet and projector: the map has most of the room, and everyone can reach and read everything."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from driver import Tab, settle

pytestmark = pytest.mark.browser

SCREENS = {"1280 × 800 at 150 %": (853, 533), "tablet": (1024, 768), "projector": (1920, 1080)}
COVERED = """() => {
    const map = document.querySelector("#mapmeld-hud").getBoundingClientRect();
    return map.width / window.innerWidth;
}"""
SMALL = """() => [...document.querySelectorAll("button, input:not([type=checkbox])")].filter((e) => {
    const box = e.getBoundingClientRect();
    return box.width > 0 && box.height > 0 && box.height < 39 && !e.closest("[data-dock-header]");
}).map((e) => e.innerText || e.className)"""


def operator(browser, server, size: tuple[int, int], touch: bool = False) -> Tab:
    return Tab(browser, f"http://127.0.0.1:{server.get_port()}/", size, touch, mode="")


@pytest.mark.parametrize("screen", SCREENS)
def test_the_map_has_most_of_the_width_and_nothing_of_the_library_shows(browser, server, screen):
    tab = operator(browser, server, SCREENS[screen])
    try:
        assert tab.page.evaluate(COVERED) >= 0.6
        assert tab.page.evaluate("() => document.documentElement.scrollWidth <= window.innerWidth")
        for words in ("Save Canvas", "ws://", "WebGL"):
            assert not tab.page.get_by_text(words).filter(visible=True).count()
        assert not tab.page.locator(".tabler-icon-adjustments").is_visible()
    finally:
        tab.close()


def test_fingers_meet_nothing_smaller_than_they_are(browser, server):
    tab = operator(browser, server, SCREENS["tablet"], touch=True)
    try:
        assert tab.page.evaluate("() => matchMedia('(pointer: coarse)').matches")
        assert tab.page.evaluate(SMALL) == []
    finally:
        tab.close()


GRAVE = ("serious", "critical")


def faults(tab: Tab) -> list[tuple[str, str]]:
    """What hinders who cannot see well: the rule, and the element that breaks it."""
    found = Axe().run(tab.page).response["violations"]
    grave = [each for each in found if each["impact"] in GRAVE]
    return [(each["id"], node["html"][:120]) for each in grave for node in each["nodes"]]


def test_nothing_serious_hinders_who_cannot_see_well(open_tab):
    tab = open_tab(size=(1280, 800))
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    assert {mode: faults(tab) for mode in ("Research", "Operator") if not tab.press(mode)} == {
        "Research": [],
        "Operator": [],
    }
    tab.page.get_by_text("Dark", exact=True).click()
    settle(lambda: tab.page.locator("#mapmeld-hud[data-theme=dark]").count(), "the dark page")
    assert faults(tab) == []
    tab.press("Research")
    assert faults(tab) == []


def test_the_verdict_is_announced_and_no_step_before_it(tab):
    said = tab.page.get_by_role("status").filter(has_text="Merged")
    assert not said.count()
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    settle(lambda: said.count() == 1, "the announcement")
    assert said.inner_text() == tab.state
