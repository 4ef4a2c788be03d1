"""What a person does by hand, in a real Chromium."""

from __future__ import annotations

import pytest
from driver import READY, settle

from app.channel import Channel, Numbers
from app.guard import guarded_server
from app.stage import TabStage

pytestmark = pytest.mark.browser

VALUE = "agreement (m of wall)"


def test_everything_the_page_tells_arrives_in_order(browser):
    told: list[list[float]] = []
    server = guarded_server("127.0.0.1", 0)
    context = browser.new_context()
    try:

        @server.on_client_connect
        def _(client) -> None:
            stage = TabStage(client)
            Channel(client.gui, stage).on("count", lambda at: told.append(at), at=Numbers(2, 2))
            stage.flush()

        page = context.new_page()
        page.goto(f"http://127.0.0.1:{server.get_port()}/")
        page.wait_for_function("() => window.mapmeld?.channel", timeout=60_000)
        page.evaluate("() => { for (let k = 0; k < 300; k++) mapmeld.tell('count', { at: [k, -k] }); }")
        settle(lambda: len(told) == 300, "300 events sent at once")
        assert told == [[float(k), float(-k)] for k in range(300)]
    finally:
        context.close()
        server.stop()


def entries(tab) -> list[str]:
    """The history as it is shown, newest first; the one at hand with a star."""
    said = "(all) => all.map((one) => (one.ariaCurrent ? '* ' : '') + one.innerText.trim())"
    return tab.page.locator("button.mm-entry").evaluate_all(said)


def test_everything_can_be_undone_and_done_again_and_a_reload_loses_nothing(tab):
    tab.unfold("History")
    undo = tab.page.get_by_role("button", name="Undo")
    assert undo.is_disabled()
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    first = settle(lambda: tab.number(VALUE), "the agreement")
    tab.move("spread", 5)
    second = settle(lambda: (now := tab.number(VALUE)) not in ("", first) and now, "another")
    settle(lambda: tab.mood == "accepted", "its verdict")
    tab.choose("Sample", "apartment_r2_r1")
    settle(lambda: tab.state == "Ready. Press Merge.", "the other maps")
    settle(
        lambda: (
            entries(tab) == ["* load apartment_r2_r1", "Σ_aug spread 4 → 4.5 m", "merge", "load office_r2_r1"]
        ),
        "four entries",
    )

    tab.page.locator("body").press("Control+z")
    settle(lambda: tab.mood == "accepted" and tab.number(VALUE) == second, "the maps and their answer")
    assert tab.page.locator(".mm-case").inner_text() == "office_r2_r1"
    undo.click()
    settle(lambda: tab.number(VALUE) == first, "the first answer")
    spread = tab.page.locator("label", has_text="spread").first.get_attribute("for")
    thumb = tab.page.locator(f'[id="{spread}"]').get_by_role("slider")
    settle(lambda: thumb.get_attribute("aria-valuenow") == "4", "the slider where it was")

    tab.page.reload()
    tab.page.wait_for_function(READY)
    settle(lambda: tab.mood == "accepted" and tab.number(VALUE) == first, "everything after a reload")
    tab.page.locator("body").press("Control+Shift+z")
    settle(lambda: tab.number(VALUE) == second, "what was undone before the reload")
    tab.unfold("History")
    tab.page.get_by_role("button", name="load apartment_r2_r1", exact=True).click()
    settle(lambda: tab.state == "Ready. Press Merge.", "the other maps again")
    assert entries(tab)[0] == "* load apartment_r2_r1"
    tab.page.get_by_role("button", name="load office_r2_r1", exact=True).click()
    settle(lambda: entries(tab)[-1] == "* load office_r2_r1", "the beginning")
    assert undo.is_disabled()


def test_another_tab_begins_anew_and_a_text_field_keeps_its_own_undo(tab, open_tab):
    tab.move("spread", 3)
    settle(lambda: "up to date" in tab.state, "the candidates")
    other = open_tab()
    assert other.state == "Ready. Press Merge."
    seed = tab.page.get_by_label("Seed", exact=True)
    seed.click()
    seed.press("Control+z")
    tab.page.evaluate("() => new Promise((done) => setTimeout(done, 300))")
    assert "up to date" in tab.state
    undo = tab.page.get_by_role("button", name="Undo")
    undo.focus()
    undo.press("Control+z")
    settle(lambda: tab.state == "Ready. Press Merge.", "the slider undone")
