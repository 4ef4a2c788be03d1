"""What a person does by hand, in a real Chromium."""

from __future__ import annotations

import zipfile
from math import cos, degrees, sin

import numpy as np
import pytest
from driver import READY, SCALE, field, metres, settle

from algorithms.files.case_folder import Case
from algorithms.files.observation_file import read_observations
from algorithms.observations.observation import encounter
from app.drawing.scene_layout import lay_out
from app.page.application import make_server
from app.web.browser_events import BrowserEvents, Numbers
from app.web.security.access_control import Access
from app.web.tab_messages import TabMessages
from app.web.viser_server import guarded_server

pytestmark = pytest.mark.browser

VALUE = "agreement (m of wall)"


def test_everything_the_page_tells_arrives_in_order(browser):
    told: list[list[float]] = []
    server = guarded_server("127.0.0.1", 0, Access(), 4)
    context = browser.new_context()
    try:

        @server.on_client_connect
        def _(client) -> None:
            stage = TabMessages(client)
            BrowserEvents(client.gui, stage).on("count", lambda at: told.append(at), at=Numbers(2, 2))
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


def test_everything_can_be_undone_and_done_again_and_a_reload_loses_nothing(open_tab):
    tab = open_tab(smooth=True)
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
            entries(tab) == ["* load apartment_r2_r1", "σ_aug spread 4 → 4.5 m", "merge", "load office_r2_r1"]
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
    settle(lambda: "Instant" in tab.page.evaluate("() => window.mapmeld.hud.pressed"), "the speed, too")
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
    tab.move("spread", 1)  # more steps than one make one entry of the history only where they are quick
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


def drag(tab, start: list[float], by: tuple[float, float]) -> None:
    """Drag what lies at a place of the window by so many pixels, and let go."""
    tab.page.mouse.move(*start)
    tab.page.mouse.down()
    tab.page.mouse.move(start[0] + by[0], start[1] + by[1], steps=6)
    tab.page.mouse.up()


def at_mov(tab, point: tuple[float, float]) -> list[float]:
    """Where a point of map 2, from its anchor, is in the window."""
    tab.at_rest()
    return tab.page.evaluate("(p) => mapmeld.pixel(p, 'map2')", list(point))


def test_map_2_is_dragged_turned_typed_and_stepped_and_the_verdict_goes_along(open_tab, tmp_path):
    tab = open_tab(smooth=True)
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    first = settle(lambda: tab.number("T: Δx"), "the answer")
    tab.press("Move map 2 by hand")
    settle(lambda: tab.state.startswith("By hand, would be merged: "), "the method's own answer, by hand")
    tab.choose("Numbers are of", "the origin of map 2")
    settle(lambda: field(tab, "T: Δx (m)") == pytest.approx(metres(first), abs=0.01), "numbers")
    x, y = field(tab, "T: Δx (m)"), field(tab, "T: Δy (m)")

    start = at_mov(tab, (1.5, -1.0))
    tab.page.mouse.move(*start)
    tab.page.mouse.down()
    tab.page.mouse.move(start[0] + 60, start[1] - 30, steps=6)
    settle(lambda: tab.state.startswith("By hand, would be refused: "), "a verdict before the hand lets go")
    settle(lambda: field(tab, "T: Δx (m)") > x + 1, "a number before the hand lets go")
    tab.page.mouse.up()
    scale = tab.page.evaluate(SCALE)
    settle(lambda: field(tab, "T: Δx (m)") == pytest.approx(x + 60 / scale, abs=0.05), "Δx of the drag")
    settle(lambda: field(tab, "T: Δy (m)") == pytest.approx(y + 30 / scale, abs=0.05), "Δy of the drag")

    turn = field(tab, "T: Δθ (°)")
    robot = at_mov(tab, (0.0, 0.0))
    tab.page.keyboard.down("Shift")
    drag(tab, [robot[0] + 80, robot[1]], (-80, -80))  # a quarter turn about robot 2
    tab.page.keyboard.up("Shift")
    settle(lambda: field(tab, "T: Δθ (°)") == pytest.approx(turn + 90, abs=2), "a quarter turn")
    assert at_mov(tab, (0.0, 0.0)) == pytest.approx(robot, abs=1)
    undo = tab.page.get_by_role("button", name="Undo")
    undo.click()
    settle(lambda: field(tab, "T: Δθ (°)") == pytest.approx(turn, abs=0.01), "the turn undone")

    ink, before = tab.page.locator("#mapmeld-ink").bounding_box(), at_mov(tab, (0.0, 0.0))
    drag(tab, [ink["x"] + 15, 140], (30, 0))
    settle(lambda: at_mov(tab, (0.0, 0.0))[0] > before[0] + 20, "the empty ground to pan")
    settle(lambda: field(tab, "T: Δθ (°)") == pytest.approx(turn, abs=0.01), "the number")

    tab.press("Show everything")
    width = tab.page.locator("#mapmeld-ink").bounding_box()["width"]
    far = tab.page.get_by_label("T: Δx (m)", exact=True)

    def lies() -> list[float]:
        return tab.page.evaluate("() => [mapmeld.maps[2].x, mapmeld.maps[2].y]")

    right = [lies()[0] - field(tab, "T: Δx (m)") + x, lies()[1] - field(tab, "T: Δy (m)") + y]
    far.fill(f"{x + 60:.2f}")
    far.press("Enter")
    settle(lambda: lies()[0] == pytest.approx(right[0] + 60, abs=0.02), "the number")
    settle(
        lambda: ink["x"] < tab.page.evaluate("() => mapmeld.pixel([0, 0], 'map2')[0]") < ink["x"] + width,
        "the camera to take in a map that was typed out of the picture",
    )
    for label, value in (("T: Δx (m)", x), ("T: Δy (m)", y)):
        box = tab.page.get_by_label(label, exact=True)
        box.fill(f"{value:.2f}")
        box.press("Enter")
    settle(lambda: lies() == pytest.approx(right, abs=0.02), "both numbers")
    settle(lambda: tab.state.startswith("By hand, would be merged: "), "the right place, typed")
    tab.page.evaluate("() => document.activeElement.blur()")
    tab.page.keyboard.press("ArrowRight")
    settle(lambda: field(tab, "T: Δx (m)") == pytest.approx(x + 0.05, abs=0.012), "one cell to the right")
    tab.page.keyboard.press("[")
    settle(lambda: field(tab, "T: Δθ (°)") == pytest.approx(turn + 0.5, abs=0.012), "half a degree")
    tab.page.keyboard.press("]")
    tab.page.keyboard.press("ArrowLeft")
    settle(lambda: field(tab, "T: Δx (m)") == pytest.approx(x, abs=0.012), "both back")

    tab.press("Take this as the answer")
    settle(lambda: tab.state.startswith("By hand. Merged: "), "the answer")
    assert settle(lambda: tab.number("made"), "who made it") == "by hand"
    replay = tab.page.get_by_role("button", name="Save replay")
    settle(lambda: not replay.is_visible(), "no replay where there was no run")
    with tab.page.expect_download() as download:
        tab.press("Download everything")
    download.value.save_as(tmp_path / "merged.zip")
    with zipfile.ZipFile(tmp_path / "merged.zip") as archive:
        assert 'method: "by hand"' in archive.read("transform.yaml").decode()


def test_a_hand_is_refined_snapped_left_and_a_reload_keeps_it(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    proven = settle(lambda: tab.number("T: Δx"), "the answer")
    tab.press("Move map 2 by hand")
    settle(lambda: tab.state.startswith("By hand, would be merged: "), "map 2 in the hand")
    tab.choose("Numbers are of", "the origin of map 2")
    tab.press("Heights")
    settle(lambda: tab.layer("floor"), "the heights")
    tab.press("Map")
    settle(lambda: tab.layer("grip") and tab.page.evaluate("() => mapmeld.view") == "map", "the map again")
    tab.page.wait_for_function("() => !mapmeld.layers.floor")
    drag(tab, at_mov(tab, (1.5, -1.0)), (9, 6))
    settle(lambda: tab.state.startswith("By hand, would be refused: "), "half a metre off")
    tab.press("Refine from here")
    settle(lambda: tab.state.startswith("By hand, would be merged: "), "the search from there")
    settle(lambda: field(tab, "T: Δx (m)") == pytest.approx(metres(proven), abs=0.06), "the number")

    near = field(tab, "T: Δx (m)")
    drag(tab, at_mov(tab, (1.5, -1.0)), (50, 40))
    scale = tab.page.evaluate(SCALE)
    settle(lambda: field(tab, "T: Δx (m)") == pytest.approx(near + 50 / scale, abs=0.05), "all of the drag")
    moved = field(tab, "T: Δx (m)")
    settle(lambda: tab.state.startswith("By hand, would be refused: "), "metres off")
    tab.page.reload()
    tab.page.wait_for_function(READY)
    settle(lambda: tab.state.startswith("By hand, would be refused: "), "the hand after a reload")
    tab.choose("Numbers are of", "the origin of map 2")
    settle(lambda: field(tab, "T: Δx (m)") == moved, "the number")
    tab.press("Snap to proven optimum")
    settle(lambda: tab.mood == "accepted" and tab.number("T: Δx") == proven, "the proven optimum")
    tab.page.get_by_role("button", name="Undo").click()
    settle(lambda: tab.state.startswith("By hand, would be refused: "), "the snap undone")
    tab.press("Leave it as it was")
    settle(lambda: tab.mood == "accepted" and tab.state.startswith("Merged: "), "the method's answer")
    assert tab.layer("grip") == []


def test_robots_are_placed_with_the_mouse_where_there_is_no_observation(open_tab, sample, tmp_path):
    own = make_server(port=0, initial=Case("mine", sample.ref, sample.mov, (), "", None))
    o, at = sample.observations[0], encounter(sample.observations[0])
    layout = lay_out(sample.ref, sample.mov, None)
    try:
        tab = open_tab(size=(1280, 800), at=own)
        tab.page.add_style_tag(content=".mantine-Notifications-root{display:none}")

        def where(point, frame: str = "scene") -> list[float]:
            anchor = layout.anchor_ref if frame == "scene" else layout.anchor_mov
            place = [float(value) for value in np.asarray(point) - anchor]
            tab.at_rest()
            return tab.page.evaluate("([p, f]) => mapmeld.pixel(p, f)", [place, frame])

        assert "Nothing is known" in tab.state
        tab.choose("Known is", "A sighting")
        settle(lambda: tab.state.startswith("1 of 3: "), "the first step")
        ahead = (40 * cos(o.observer.theta), -40 * sin(o.observer.theta))
        drag(tab, where(o.observer.xy), ahead)
        settle(lambda: tab.state.startswith("2 of 3: "), "the second step")
        settle(lambda: field(tab, "robot 1: x (m)") == pytest.approx(o.observer.x, abs=0.08), "the number")
        settle(
            lambda: field(tab, "robot 1: heading (°)") == pytest.approx(degrees(o.observer.theta), abs=3),
            "the number",
        )
        tab.page.mouse.click(*where(at.x_ref))
        settle(lambda: tab.state.startswith("3 of 3: "), "the third step")
        settle(lambda: field(tab, "range r (m)") == pytest.approx(o.range, abs=0.15), "the number")
        tab.page.mouse.click(*where(o.observer.xy))
        settle(lambda: tab.state == "That is not in map 2.", "a touch in the wrong map to be told")
        drag(tab, where(at.x_mov, "map2"), (0, -40))
        settle(lambda: tab.state.startswith("Drag a sign"), "all three")
        settle(lambda: field(tab, "robot 2: heading (°)") == pytest.approx(90, abs=3), "the number")

        drag(tab, where(at.x_ref), tuple(0.5 * value for value in ahead))  # farther away
        (x0, y0), (x1, y1) = where(at.x_ref), where(at.x_ref + np.array([1.0, 0.0]))
        way = 20 / np.hypot(x1 - x0, y1 - y0)  # all of it: a number typed before is dragged on
        moved = at.x_ref + way * np.array([cos(o.observer.theta), sin(o.observer.theta)])
        far = np.hypot(*(moved - o.observer.xy))
        assert far > o.range + 0.3
        settle(lambda: field(tab, "range r (m)") == pytest.approx(far, abs=0.2), "the range to follow")
        box = tab.page.get_by_label("range r (m)", exact=True)
        box.fill(f"{o.range:.2f}")
        box.press("Enter")
        sight = (
            "() => { const p = (id) => mapmeld.hand.grips.find((g) => g.id === id).p, "
            "a = p('observer'), b = p('seen'); return Math.hypot(a[0] - b[0], a[1] - b[1]); }"
        )
        settle(lambda: tab.page.evaluate(sight) == pytest.approx(o.range, abs=0.006), "the typed range")
        tab.press("Add another observation")
        settle(lambda: tab.state.startswith("1 of 3: "), "another one")
        tab.press("Remove this observation")
        settle(lambda: tab.state.startswith("Drag a sign"), "the first one again")

        with tab.page.expect_download() as download:
            tab.press("Save what is known")
        assert download.value.suggested_filename == "observation.yaml"
        download.value.save_as(tmp_path / "observation.yaml")
        (saved,) = read_observations(tmp_path / "observation.yaml")
        assert saved.range == pytest.approx(o.range, abs=0.006)
        assert encounter(saved).x_mov == pytest.approx(at.x_mov, abs=0.08)

        tab.press("Done")
        settle(lambda: tab.state == "Ready. Press Merge.", "the end of it")
        tab.press("Move the robots by hand")  # floor and walls move to the map's middle together
        lies = (
            "(name) => { const at = window.__viserMutable.nodeRefFromName[name]?.position; "
            "return at && [at.x, at.y]; }"
        )
        middle = pytest.approx([0, 0], abs=1e-6)
        settle(lambda: tab.page.evaluate(lies, "/world/map1/free") == middle, "map 1 around its middle")
        for number in ("map1", "map2"):
            floor, walls = f"/world/{number}/free", f"/world/{number}/walls"
            settle(
                lambda f=floor, w=walls: (
                    tab.page.evaluate(lies, f) == pytest.approx(tab.page.evaluate(lies, w), abs=1e-6)
                ),
                "floor under walls",
            )
        # what the pointer reads off the maps goes by where they lie now
        frames = tab.page.evaluate("() => mapmeld.hud.frames")
        assert frames == [pytest.approx(frame) for frame in layout.frames()]
        tab.press("Done")
        settle(lambda: tab.state == "Ready. Press Merge.", "the end of it again")
        tab.press("Instant")
        tab.press("Merge")
        tab.wait_for("accepted")
        undo = tab.page.get_by_role("button", name="Undo")
        tab.unfold("History")
        told = tab.page.locator("button.mm-entry").first.get_by_role("img")  # a list that is drawn anew
        settle(lambda: told.count() == 1, "the verdict in the history")  # under a click loses it
        tab.page.get_by_role("button", name="load mine", exact=True).click()
        settle(lambda: "Nothing is known" in tab.state, "everything undone")
        assert undo.is_disabled()
    finally:
        own.stop()


def test_a_rough_pose_is_typed_and_dragged_and_the_maps_merge_near_it(open_tab, sample):
    own = make_server(port=0, initial=Case("mine", sample.ref, sample.mov, (), "", None))
    T = sample.truth.T_ref_mov
    try:
        tab = open_tab(size=(1280, 800), at=own)
        tab.choose("Known is", "A rough initial pose")
        settle(lambda: tab.state.startswith("Drag map 2"), "map 2 in the hand")
        for label, value in (("Δx (m)", T.x), ("Δy (m)", T.y), ("Δθ (°)", degrees(T.theta))):
            box = tab.page.get_by_label(label, exact=True)
            box.fill(f"{value:.1f}")
            box.press("Enter")
            tab.page.wait_for_timeout(200)  # of what is written within 50 ms the page sends only the last
        middle = tab.at_rest()
        drag(tab, middle, (9, 0))
        settle(lambda: field(tab, "Δx (m)") > round(T.x, 1), "the number to follow")
        assert field(tab, "Δy (m)") == pytest.approx(T.y, abs=0.1)
        tab.press("Instant")
        tab.press("Merge")
        tab.wait_for("accepted")
        assert tab.number("made") != "chosen by you"
    finally:
        own.stop()
