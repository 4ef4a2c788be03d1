"""The three ways in which a merge ends, and what can be asked of a verdict, as the page shows them."""

from __future__ import annotations

import re
from dataclasses import replace

from driver import settle

from algorithms.files.case_folder import Case, read_case
from app.page.application import make_server


def merged(tab) -> str:
    """Merge at once; how it ended."""
    tab.press("Instant")
    tab.press("Merge")
    settle(lambda: tab.mood in ("accepted", "bent", "refused", "failed"), "the merge")
    return tab.mood


def colour(tab) -> str:
    return tab.page.evaluate("() => getComputedStyle(document.querySelector('.mm-state span')).color")


def of_server(case: Case):
    return make_server(port=0, initial=case)


def test_each_of_the_three_outcomes_has_a_word_and_a_colour_of_its_own(
    tab, open_tab, sample: Case, bent_folder
):
    (at,) = sample.observations
    elsewhere = replace(at, observed_x=at.observed_x + 6.0, observed_y=at.observed_y - 5.0)
    others = {
        "bent": of_server(read_case(bent_folder)),
        "refused": of_server(replace(sample, observations=(elsewhere,))),
    }
    try:
        assert merged(tab) == "accepted"
        told = {"accepted": (tab.state, colour(tab))}
        for mood, server in others.items():
            other = open_tab(at=server)
            assert merged(other) == mood
            told[mood] = other.state, colour(other)
        heads = [sentence.split(":")[0] for sentence, _ in told.values()]
        assert heads == ["Merged", "Merged, bent", "Refused"]
        assert len({paint for _, paint in told.values()}) == 3
        assert re.search(r"\d of 1,000 such merges", told["bent"][0])
    finally:
        for server in others.values():
            server.stop()


def test_a_mirrored_map_is_found_out_after_its_refusal(open_tab, sample: Case):
    turned = replace(sample.mov, cells=sample.mov.cells[:, ::-1].copy())
    server = of_server(replace(sample, mov=turned))
    try:
        tab = open_tab(at=server)
        assert merged(tab) == "refused"
        settle(lambda: "mirrored" in tab.text, "the cause")
    finally:
        server.stop()


def test_what_if_a_number_were_another_is_told_and_is_no_merge(tab):
    assert merged(tab) == "accepted"
    before = tab.state
    tab.unfold("What if")
    tab.move("contradicts (m)", 80)
    settle(lambda: "Refused" in tab.text or "bent" in tab.text, "the other verdict")
    assert tab.state == before
    tab.press("Reset what if")
    settle(lambda: "Refused" not in tab.text, "the verdict as it was")


def test_a_refused_merge_suggests_places_and_the_one_that_is_pressed_can_be_taken(open_tab, strangers: Case):
    server = of_server(replace(strangers, observations=()))
    try:
        tab = open_tab(size=(1280, 800), at=server)
        assert merged(tab) == "refused"
        buttons = tab.page.locator("button[data-mm-suggestion]")
        settle(lambda: buttons.count() > 0, "suggestions")
        likely = buttons.last.locator("b").inner_text()
        buttons.last.click()
        settle(lambda: tab.state.startswith("By hand, would be refused"), "map 2 in the hand")
        assert tab.number("likely right") == likely
        tab.press("Take it")
        settle(lambda: tab.state.startswith("Chosen by you. Refused"), "the answer")
        assert tab.number("made") == "chosen by you"
    finally:
        server.stop()
