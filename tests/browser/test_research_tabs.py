"""The tabs "Compare" and "Sweep" as a researcher uses them, in a real browser."""

from __future__ import annotations

import io
import zipfile

import pytest
from driver import Tab, settle

pytestmark = pytest.mark.browser

QUICK = ("paper-argmax", "bilateral")  # a wrong merge, and one without any search


def turn_to(tab: Tab, name: str) -> None:
    tab.page.get_by_role("tab", name=name).click()


def slider(tab: Tab, label: str) -> str | None:
    words = tab.page.locator("label", has_text=label).first
    thumb = tab.page.locator(f'[id="{words.get_attribute("for")}"]').get_by_role("slider")
    return thumb.get_attribute("aria-valuenow")


def fill(tab: Tab, label: str, number: str) -> None:
    tab.page.get_by_label(label, exact=True).first.fill(number)
    tab.page.keyboard.press("Tab")


def downloaded(tab: Tab, button: str) -> set[str]:
    with tab.page.expect_download() as caught:
        tab.press(button)
    with open(caught.value.path(), "rb") as file:
        return set(zipfile.ZipFile(io.BytesIO(file.read())).namelist())


def test_methods_are_compared_and_one_of_them_is_looked_at_and_left_again(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    own = tab.state
    turn_to(tab, "Compare")
    tab.press("None")
    assert settle(lambda: tab.page.get_by_role("button", name="Compare methods").is_disabled(), "no method")
    for method in QUICK:
        tab.page.locator(f"[data-mm-pick={method}]").check()
    tab.press("Compare 2 methods")
    settle(lambda: tab.page.get_by_text("2 of 2 done.").count(), "both to end")

    wrong = tab.page.locator(f"[data-mm-show={QUICK[0]}]")
    assert "✗ Wrong" in wrong.inner_text()
    assert "Refused: " in wrong.inner_text()
    assert "✓ Right" in tab.page.locator(f"[data-mm-show={QUICK[1]}]").inner_text()
    names = downloaded(tab, "Download tables and pictures")
    assert {"methods.csv", "scores.csv", "bars.png", "maps_office_r2_r1.png"} <= names

    wrong.click()
    settle(lambda: tab.state.startswith("The paper's bare argmax: ✗ Wrong"), "whose merge this is")
    assert tab.mood == "refused"
    settle(lambda: wrong.get_attribute("aria-pressed") == "true", "the card to be marked")
    everything = tab.page.get_by_role("button", name="Download everything")
    assert everything.is_disabled()  # nobody takes it for their own
    assert "another method's merge" in tab.text
    tab.press("Difference")
    settle(lambda: "map 1 alone" in tab.page.locator(".mm-legend").inner_text(), "its difference")

    tab.press("◀ Back to your own")
    settle(lambda: tab.state == own, "one's own result")
    assert everything.is_enabled()
    assert wrong.get_attribute("aria-pressed") == "false"
    tab.page.keyboard.press("Control+z")
    settle(lambda: "✗ Wrong" in tab.state, "undo shows it once more")
    tab.choose("Sample", "warehouse_r2_r1")
    settle(lambda: not tab.page.locator("[data-mm-show]").count(), "no card of other maps")
    assert not tab.page.get_by_role("button", name="◀ Back to your own").is_visible()


def test_a_sweep_grows_its_points_load_settings_and_stop_stops(tab):
    turn_to(tab, "Sweep")
    tab.choose("Method", "Spectra and window, no swarm")
    settle(lambda: tab.page.get_by_text("Spectra and window, no swarm").count() > 1, "the method's settings")
    fill(tab, "values", "3")
    fill(tab, "seeds", "1")
    tab.press("Run the sweep")
    settle(lambda: tab.page.get_by_text("3 of 3 points.").count(), "three points")
    rows = tab.page.locator("button[data-mm-point]")
    assert rows.count() == 3
    assert slider(tab, "spread") == "3"  # the middle of what is offered is what there is
    assert rows.nth(1).get_attribute("aria-pressed") == "true"

    plot = tab.page.locator(".u-over:visible").bounding_box()
    tab.page.mouse.click(plot["x"] + 0.95 * plot["width"], plot["y"] + 0.5 * plot["height"])
    settle(lambda: slider(tab, "spread") == "12", "the settings of the last point")
    settle(lambda: rows.nth(2).get_attribute("aria-pressed") == "true", "the point to be marked")
    tab.page.keyboard.press("Control+z")
    settle(lambda: slider(tab, "spread") == "3", "the settings of before")
    assert {"augment.spread.csv", "augment.spread.png"} <= downloaded(tab, "Download tables and figure")

    tab.choose("second", "window kind")
    fill(tab, "values", "20")
    fill(tab, "seeds", "5")
    tab.press("Run the sweep")
    cell = tab.page.locator("rect[data-mm-point]").first
    settle(cell.is_visible, "the first cell")
    tab.press("Stop sweeping")
    settle(lambda: tab.page.get_by_text("Stopped.").count(), "it to stop")
    there = tab.page.locator("rect[data-mm-point]").count()
    assert 0 < there < 60
    tab.choose("Sample", "warehouse_r2_r1")
    settle(lambda: not tab.page.locator("rect[data-mm-point]").count(), "nothing of other maps")
