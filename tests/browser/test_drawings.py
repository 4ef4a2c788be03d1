"""What the page draws, in a real Chromium: windows, proof, rival, swarm space, heights, the map itself."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import symmetric_hall
from driver import settle
from rooms import l_room

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS
from algorithms.observations.observation import Observation
from app.drawing.palette import LIGHT
from app.page.application import make_server

pytestmark = pytest.mark.browser


def test_the_proof_fills_its_page_and_the_result_says_how_it_ended(tab):
    tab.page.evaluate(
        """() => {
            const line = document.querySelector(".mm-state span");
            window.said = [];
            const observer = new MutationObserver(() => window.said.push(line.textContent));
            observer.observe(line, { childList: true, subtree: true });
        }"""
    )
    tab.press("Merge")  # not faster: a tab that is behind shows the last of several words alone
    tab.wait_for("accepted")
    said = tab.page.evaluate("() => window.said")
    assert any(line.startswith("Proving: ") for line in said)
    assert "The swarm found the proven optimum." in said
    tab.press("Proof")
    settle(lambda: "Nothing on the whole circle is better than" in tab.text, "what was proven")
    optimum = tab.page.locator("tr", has=tab.page.get_by_text("optimum", exact=True)).last
    assert optimum.locator("td").last.inner_text() == "100%"
    ends, finite = tab.page.evaluate(
        """() => {
            const charts = Object.values(window.__viserTestpoints.uplots).map((one) => one.chart);
            const [x, ceiling, found, floor] = charts.find((c) => c.series.length === 6).data;
            const finite = [...ceiling, ...found, ...floor].every(Number.isFinite);
            return [[x[0], x[x.length - 1]], finite];
        }"""
    )
    assert ends == [-180, 180]
    assert finite
    tab.press("Result")
    settle(lambda: tab.number("optimum") == "proven", "the result")
    assert tab.number("found by the search") == "yes"
    assert float(tab.number("proof")) > 0  # milliseconds


def test_both_windows_are_drawn_and_follow_their_sliders_before_the_first_merge(tab):
    def names() -> list[str]:
        return [item["t"].split(",")[0] for item in tab.layer("window") if "t" in item]

    tab.move("deviations", 1)
    settle(lambda: names() == ["paper's window", "coupled window"], "both windows")
    disc = tab.layer("window")[1]
    tab.move("deviations", 3)
    settle(lambda: tab.layer("window")[1]["t"] != disc["t"], "another k")
    assert np.ptp(tab.layer("window")[1]["p"], axis=0)[0] > np.ptp(disc["p"], axis=0)[0]
    assert [item["c"].startswith("#") for item in tab.layer("window")] == [False, True]
    tab.choose("window kind", "Origin")
    settle(lambda: tab.layer("window")[0]["c"].startswith("#"), "the paper's window in use")
    assert not tab.layer("window")[1]["c"].startswith("#")


def test_the_swarm_space_holds_the_proven_optimum_and_says_whether_it_was_found(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    tab.press("Swarm space")
    (star,) = settle(lambda: [i for i in tab.layer("rival") if i.get("s") == "star"], "the proven optimum")
    assert star["t"] == "proven optimum"
    assert max(map(abs, star["p"])) <= 1.001
    assert tab.state == "The swarm found the proven optimum. Merged."
    tab.press("Map")
    settle(lambda: tab.state.startswith("Merged: "), "the whole verdict")


def test_a_method_without_a_proof_says_so_on_the_page_of_the_proof(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    tab.press("Proof")
    settle(lambda: "Nothing on the whole circle" in tab.text, "the proof")
    tab.choose("Method", METHODS["spectra-swarm"].title)
    settle(lambda: "Is there a better place anywhere on the circle?" in tab.text, "the hint")


def test_a_rival_that_leaves_the_answer_in_doubt_is_drawn_and_told(open_tab):
    hall, (seen, _) = symmetric_hall()
    own = make_server(port=0, initial=Case("a hall", hall, hall, (seen,), "", None))
    try:
        tab = open_tab(at=own)
        tab.press("Instant")
        tab.press("Merge")
        tab.wait_for("refused")
        outline, robot = settle(lambda: tab.layer("rival"), "the rival")
        assert outline["t"].startswith("rival: 180° turned, ")
        assert robot["s"] == "robot"
        assert tab.number("rival in doubt") == outline["t"].removeprefix("rival: ")
        ghost = "() => window.__viserMutable.nodeRefFromName['/world/ghost/walls'] !== undefined"
        assert tab.page.evaluate(ghost)
        tab.choose("Sample", "apartment_r2_r1")
        settle(lambda: tab.layer("rival") == [], "the rival to go")
    finally:
        own.stop()


def test_a_moved_slider_changes_the_pictures_before_the_first_merge(tab):
    tab.move("spread", 10)
    settle(lambda: "up to date" in tab.state, "the candidates")
    small = settle(lambda: tab.layer("aug"), "the rings of Σ_aug")[0]["p"]
    tab.move("spread", 20)
    settle(lambda: tab.layer("aug")[0]["p"] != small, "larger rings")
    assert tab.number("acceptance index") == ""  # no answer was asked for


def test_a_click_reads_out_the_map(tab):
    def click() -> str:
        x, y = tab.page.evaluate("() => window.mapmeld.pixel([0, 0])")
        tab.page.mouse.click(x, y)
        return tab.page.evaluate("() => window.mapmeld.hud.readout")

    readout = settle(click, "what is there")
    assert "map 1: free" in readout  # robot 2 stood there
    assert "map 2: unknown" in readout  # it lies beside map 1 still


def test_the_map_is_the_right_way_up_and_stays_so(open_tab, tmp_path):
    room = l_room()
    seen = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    own = make_server(port=0, initial=Case("rooms", room, room, (seen,), "observation.yaml", None))
    try:
        tab = open_tab(at=own)

        def reads_like_an_l() -> bool:  # the scene's origin is x̂1, (3, 2) in the map
            return (
                tab.colour_at((-2.75, 0.5)) == LIGHT.ref  # stem of the L
                and tab.colour_at((0.5, -1.75)) == LIGHT.ref  # its foot
                and tab.colour_at((2.0, 0.5)) == LIGHT.free
                and tab.colour_at((2.75, 1.75)) == LIGHT.unknown
            )

        settle(reads_like_an_l, "an L the right way up")
        box = tab.page.locator("#mapmeld-ink").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        tab.page.mouse.move(x, y)
        tab.page.mouse.down()
        tab.page.mouse.move(x + 40, y - 20, steps=5)
        tab.page.mouse.up()
        tab.page.mouse.wheel(0, 120)
        tab.move("spread", 2)  # arrow keys turn viser's camera where it is not locked
        tab.page.keyboard.press("ArrowUp")
        angles = (
            "() => { const k = window.__viserMutable.cameraControl; return [k.polarAngle, k.azimuthAngle]; }"
        )
        assert tab.page.evaluate(angles) == pytest.approx([np.pi / 2, 0.0], abs=1e-6)
    finally:
        own.stop()


def test_heights_and_swarm_space_are_shown_in_three_dimensions(tab):
    tab.press("Fast")
    tab.press("Merge")
    tab.press("Swarm space")
    settle(tab.swarm, "a swarm in its box")
    assert len(tab.layer("axes")) > 12  # the edges of the box, and their names
    tab.wait_for("accepted")
    tab.press("Heights")
    settle(lambda: tab.layer("floor"), "the floor under the heights")
    tab.press("Map")
    settle(lambda: tab.layer("robots"), "the robots on the map")
    assert tab.layer("axes") == []
