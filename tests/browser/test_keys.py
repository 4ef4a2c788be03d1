"""Keys do what the buttons do, and one sheet lists them."""

from __future__ import annotations

from contextlib import suppress

import pytest
from driver import settle
from playwright.sync_api import Error

from app.system.data_paths import samples

pytestmark = pytest.mark.browser


def test_a_run_is_started_looked_at_and_compared_by_keys_alone(tab):
    keys = tab.page.keyboard
    tab.press("Instant")
    keys.press("m")
    tab.wait_for("accepted")
    keys.press("3")
    settle(lambda: tab.page.evaluate("() => window.mapmeld.view") != "map", "the swarm's space")
    keys.press("1")
    settle(lambda: tab.page.evaluate("() => window.mapmeld.view") == "map", "the map again")
    curtain = tab.page.get_by_role("slider", name="Curtain")
    settle(tab.page.get_by_role("button", name="Curtain").is_visible, "what there is to compare")
    keys.press("c")
    settle(lambda: curtain.is_visible(), "the curtain")
    keys.press("o")
    settle(lambda: not curtain.is_visible(), "both maps over each other")


def test_the_sheet_lists_every_key_and_closes_again(tab):
    tab.page.keyboard.press("?")
    sheet = tab.page.get_by_role("dialog", name="Keys")
    settle(sheet.is_visible, "the sheet")
    by_hand = "one cell; with Shift 1 cm"  # before anything is taken up
    for words in ("merge", "undo", "measure a distance", "draw a keep-out line", by_hand, "this list"):
        assert sheet.get_by_text(words, exact=True).count() == 1
    tab.page.keyboard.press("Escape")
    settle(lambda: not sheet.is_visible(), "the sheet to go")
    tab.page.get_by_role("button", name="Keys").click()
    settle(sheet.is_visible, "the sheet, by its button")


def chosen_by_keys(tab, button):
    """The chooser of files that Enter opens; a list that is just written anew loses its focus and the key."""
    for _ in range(10):
        with suppress(Error):
            with tab.page.expect_file_chooser(timeout=6000) as chooser:
                tab.page.keyboard.press("Enter")
            return chooser.value
        button.focus()
    raise AssertionError("no chooser of files came")


def test_files_and_folders_are_opened_by_keys_and_buttons_are_dark_in_the_dark(open_tab):
    tab = open_tab(smooth=True)
    keys, page = tab.page.keyboard, tab.page
    head, place = page.get_by_role("button", name="Names", exact=True), page.get_by_text("Robot 1 is called")
    settle(lambda: head.get_attribute("aria-expanded") == "false", "the head of the folder")
    page.get_by_label("Sample", exact=True).first.focus()
    for name, picker in (("Open files…", "multiple"), ("Open a folder…", "webkitdirectory")):
        keys.press("Tab")
        button = page.get_by_role("button", name=name)
        settle(lambda button=button: button.evaluate("(it) => it === document.activeElement"), name)
        chooser = chosen_by_keys(tab, button)
        assert chooser.element.evaluate(f"(input) => input.{picker}")
    chooser.set_files(str(samples()["apartment_r2_r1"]))
    settle(lambda: "✓ map1.yaml map 1 ✕" in tab.listed(), "the files of the folder")
    remove = page.get_by_role("button", name="remove map1.yaml")
    remove.focus()
    keys.press("Enter")
    settle(lambda: "Map 1's image has no YAML file yet" in tab.state, "one file less")
    following = page.get_by_role("button", name="remove map1.pgm")
    settle(lambda: following.evaluate("(it) => it === document.activeElement"), "the next line")
    head.focus()
    keys.press("Enter")
    settle(lambda: head.get_attribute("aria-expanded") == "true" and place.is_visible(), "what is in it")
    page.get_by_text("Dark", exact=True).click()
    brightness = "(e) => Math.max(...getComputedStyle(e).backgroundColor.match(/\\d+/g).map(Number))"
    upload = page.get_by_role("button", name="Open files…")
    settle(lambda: upload.evaluate(brightness) < 120, "a dark button")
    head.press(" ")
    settle(lambda: head.get_attribute("aria-expanded") == "false" and not place.is_visible(), "it to close")


def test_what_is_written_into_a_field_is_no_key(tab):
    tab.page.get_by_label("Seed", exact=True).first.click()
    tab.page.keyboard.type("m")
    tab.page.keyboard.press("?")
    assert tab.mood == "idle"
    assert not tab.page.get_by_role("dialog", name="Keys").is_visible()
