"""Operators see maps, sighting, result and export; researchers everything; the browser remembers which."""

from __future__ import annotations

import pytest
from driver import READY, Tab, settle

pytestmark = pytest.mark.browser

SIZE = (1280, 800)


@pytest.fixture
def operator(browser, server) -> Tab:
    """A tab of a browser that was never here."""
    tab = Tab(browser, f"http://127.0.0.1:{server.get_port()}/", SIZE, mode="")
    yield tab
    errors = tab.errors
    tab.close()
    assert errors == []


def seen(tab: Tab, words: str) -> bool:
    return tab.page.get_by_text(words, exact=True).first.is_visible()


def map_share(tab: Tab) -> float:
    """Of the window's width."""
    return tab.page.locator("#mapmeld-hud").bounding_box()["width"] / SIZE[0]


def test_an_operator_merges_without_a_slider_and_reads_the_verdict_once(operator):
    for words in ("Maps", "What do you know?", "Export"):
        assert seen(operator, words)
    for words in ("I_aug intensity", "Compare", "Sweep", "Method", "Swarm space", "What if"):
        assert not operator.page.get_by_text(words, exact=True).filter(visible=True).count()
    assert map_share(operator) >= 0.6
    operator.press("Instant")
    operator.press("Merge")
    operator.wait_for("accepted")
    settle(lambda: operator.page.get_by_text("Numbers", exact=True).is_visible(), "the result")
    said = operator.page.get_by_text("such merges are right").all()  # one of them for screen readers alone
    assert sum(words.bounding_box()["height"] > 2 for words in said) == 1
    assert not seen(operator, "T: Δx")
    operator.page.get_by_text("Numbers", exact=True).click()
    assert seen(operator, "T: Δx")
    operator.press("Merge")  # what was opened is open in the next result, too
    settle(lambda: operator.mood == "running" or seen(operator, "T: Δx"), "the next merge")
    operator.wait_for("accepted")
    settle(lambda: seen(operator, "T: Δx"), "the numbers")


def test_research_shows_everything_and_is_remembered(operator):
    operator.press("Research")
    settle(lambda: seen(operator, "Compare") and seen(operator, "I_aug intensity"), "all settings")
    operator.page.reload()
    operator.page.wait_for_function(READY)
    settle(lambda: seen(operator, "I_aug intensity"), "all settings again")
    operator.press("Operator")
    settle(lambda: not operator.page.get_by_text("Compare", exact=True).filter(visible=True).count(), "few")
    settle(lambda: map_share(operator) >= 0.6, "the wider map")


def test_the_lesson_has_its_sliders_for_operators_too_and_takes_them_away_again(operator):
    operator.press("Lesson")
    settle(lambda: seen(operator, "I_aug intensity"), "the sliders")
    operator.press("Leave")
    settle(lambda: not operator.page.get_by_text("I_aug intensity").filter(visible=True).count(), "none")


def test_a_long_refusal_is_shown_whole(operator):
    operator.page.evaluate("() => { mapmeld.hud.state = 'refused: ' + 'walls contradict '.repeat(40); }")
    operator.press("Instant")  # draws the words anew
    settle(lambda: operator.state.count("contradict") == 40, "the words")
    words = operator.page.locator(".mm-state > span")
    assert words.evaluate("(e) => e.scrollHeight <= e.clientHeight + 1 && e.offsetHeight > 40")
