"""The page in a real Chromium: what an operator does, and what they see."""

from __future__ import annotations

import pytest
from driver import settle

from algorithms.methods.registry import METHODS

pytestmark = pytest.mark.browser

VALUE = "agreement (m of wall)"


def test_a_sample_merges_before_the_eyes(tab):
    assert tab.page.title() == "mapmeld"
    assert tab.state == "Ready. Press Merge."
    tab.press("Fast")
    tab.press("Merge")
    first = settle(tab.swarm, "a swarm")
    later = settle(lambda: (now := tab.swarm()) != first and now, "the swarm to move")
    assert len(later) == len(first)
    tab.wait_for("accepted")
    assert tab.state.startswith("Merged")
    assert settle(lambda: tab.number("acceptance index"), "the numbers").endswith("%")
    assert tab.number("error to the truth").endswith("°")
    assert tab.layer("best")[0]["s"] == "star"
    assert float(tab.number("all")) > 0  # milliseconds


def test_a_moved_slider_changes_the_answer(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    before = settle(lambda: tab.number(VALUE), "the agreement")
    tab.move("spread", 5)
    after = settle(lambda: (now := tab.number(VALUE)) not in ("", before) and now, "another")
    assert float(after) > float(before)  # a wider Gaussian takes in more walls


def test_stop_ends_a_run_and_it_stays_ended(tab):
    tab.press("Merge")
    settle(lambda: "candidate" in tab.state, "the candidates")
    tab.press("Stop")
    tab.wait_for("stopped")
    assert "unfinished" in tab.state
    drawn = tab.page.evaluate("() => window.mapmeld.applied")
    tab.page.wait_for_timeout(400)
    assert tab.page.evaluate("() => window.mapmeld.applied") == drawn
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")


def test_two_tabs_do_not_disturb_each_other(open_tab):
    first, second = open_tab(), open_tab()
    first.press("Instant")
    first.press("Merge")
    first.wait_for("accepted")
    assert second.state == "Ready. Press Merge."
    value = settle(lambda: first.number(VALUE), "the agreement")
    second.move("spread", 5)
    settle(lambda: "up to date" in second.state, "the other tab's candidates")
    assert first.number(VALUE) == value
    assert first.mood == "accepted"
    second.close()
    first.move("spread", 5)
    settle(lambda: first.number(VALUE) not in ("", value), "an answer after the other tab has gone")


def test_a_method_has_its_own_settings_and_its_optimiser_can_be_changed(tab):
    tab.press("Instant")
    assert "Agreement" in tab.text
    folder = tab.page.get_by_text("Agreement", exact=True)
    tab.choose("Method", METHODS["spectra-swarm"].title)  # what is proven does not depend on the optimiser
    settle(lambda: not any(one.is_visible() for one in folder.all()), "settings that do nothing to go")
    tab.press("Merge")
    tab.wait_for("accepted")
    before = settle(lambda: tab.number("Γ, eq. (17)"), "Γ")
    tab.choose("optimiser", "MCO")
    settle(lambda: tab.number("Γ, eq. (17)") not in ("", before), "Γ of the Monte-Carlo search")
    error = tab.number("error to the truth")
    tab.choose("Method", METHODS["bilateral"].title)
    settle(lambda: "N_p particles" not in tab.text, "the swarm's sliders to go")
    settle(lambda: tab.number("error to the truth") not in ("", error), "its own answer")
    tab.choose("Method", METHODS["spectra-swarm"].title)
    tab.choose("objective", "Agreement")
    settle(lambda: any(one.is_visible() for one in folder.all()), "its settings to come back")
