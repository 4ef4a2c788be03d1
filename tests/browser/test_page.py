"""The page in a real Chromium: what an operator does, and what they see."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
from driver import settle

from algorithms.casefiles import Case, observations_to_bytes, read_case
from algorithms.gridmap import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.mapio import map_to_bytes, read_map
from algorithms.methods import METHODS, merge
from algorithms.observation import Observation
from algorithms.pose import Pose2
from app.palette import LIGHT
from app.paths import samples
from app.server import make_server

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


def test_the_proof_fills_its_page_and_the_result_says_how_it_ended(tab):
    tab.page.evaluate(
        """() => {
            const line = document.querySelector(".mm-state span");
            window.said = [];
            new MutationObserver(() => window.said.push(line.textContent)).observe(line, { childList: true });
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


def test_settings_of_the_agreement_are_there_only_where_they_do_something(tab):
    assert "Agreement" in tab.text
    tab.choose("Method", METHODS["spectra-swarm"].title)
    folder = tab.page.get_by_text("Agreement", exact=True)
    settle(lambda: not any(one.is_visible() for one in folder.all()), "the folder to go")
    tab.choose("objective", "Agreement")
    settle(lambda: any(one.is_visible() for one in folder.all()), "the folder to come back")


def test_a_method_without_a_proof_says_so_on_the_page_of_the_proof(tab):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    tab.press("Proof")
    settle(lambda: "Nothing on the whole circle" in tab.text, "the proof")
    tab.choose("Method", METHODS["spectra-swarm"].title)
    settle(lambda: "Is there a better place anywhere on the circle?" in tab.text, "the hint")


def test_a_rival_that_leaves_the_answer_in_doubt_is_drawn_and_told(open_tab):
    corridor = read_case(samples()["corridor_r3_r2"])
    own = make_server(port=0, initial=corridor)
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


def test_a_broken_upload_is_told_by_name_and_the_page_lives_on(tab, tmp_path):
    text = tmp_path / "mine.yaml"
    text.write_text(
        "image: mine.pgm\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    tab.unfold("Upload your own")
    tab.upload(0, text)
    tab.wait_for("failed")
    assert "mine.yaml" in tab.state
    assert "resolution" in tab.state
    assert tab.page.get_by_text("resolution").count() >= 2  # the sentence, and a notification
    assert "cannot be used" in tab.text
    assert tab.page.locator(".mm-title").inner_text().endswith("office_r2_r1")  # nothing is lost
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_enabled()
    tab.choose("Sample", "apartment_r2_r1")
    tab.wait_for("idle")
    settle(lambda: tab.page.get_by_text("This cannot be used").count() == 0, "the notice to go")
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")


def test_forgotten_uploads_are_gone_from_the_page(tab, tmp_path, sample: Case):
    (tmp_path / "o.yaml").write_bytes(observations_to_bytes(sample.observations))
    tab.unfold("Upload your own")
    tab.upload(4, tmp_path / "o.yaml")
    settle(lambda: "load the two maps" in tab.state, "what to load next")
    tab.press("Forget uploads")
    settle(lambda: tab.state.startswith("Choose a sample"), "the empty page")
    assert tab.page.get_by_role("button", name="Merge", exact=True).is_disabled()
    settle(lambda: not tab.page.locator(".mm-legend span").count(), "no legend where there is no map")


def test_a_file_name_is_shown_as_words_and_never_run(tab, tmp_path):
    nasty = tmp_path / "<img src=x onerror=window.hit=1>.yaml"
    nasty.write_text("nonsense: [")
    tab.unfold("Upload your own")
    tab.upload(4, nasty)
    tab.wait_for("failed")
    assert "<img" in tab.state
    assert tab.page.evaluate("() => window.hit") is None


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


def test_the_downloaded_map_reads_back_to_the_merged_cells(tab, tmp_path, sample: Case):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    with tab.page.expect_download() as download:
        tab.press("Download everything")
    assert download.value.suggested_filename == "merged.zip"
    with zipfile.ZipFile(download.value.path()) as packed:
        packed.extractall(tmp_path)
        assert {"merged.yaml", "merged.pgm"} <= set(packed.namelist())
    back = read_map(tmp_path / "merged.yaml")
    expected = merge(sample.ref, sample.mov, sample.observations).fusion.merged
    assert np.array_equal(back.cells, expected.cells)
    assert (back.resolution, back.origin) == (expected.resolution, expected.origin)


def test_another_sample_is_loaded_from_the_menu(tab):
    tab.choose("Sample", "apartment_r2_r1")
    settle(lambda: "apartment_r2_r1" in tab.page.locator(".mm-title").inner_text(), "the sample's name")
    assert tab.state == "Ready. Press Merge."


def test_the_optimiser_can_be_changed(tab):
    tab.press("Instant")
    tab.choose("Method", METHODS["spectra-swarm"].title)  # what is proven does not depend on the optimiser
    tab.press("Merge")
    tab.wait_for("accepted")
    before = settle(lambda: tab.number("Γ, eq. (17)"), "Γ")
    tab.choose("optimiser", "MCO")
    settle(lambda: tab.number("Γ, eq. (17)") not in ("", before), "Γ of the Monte-Carlo search")


def test_a_click_reads_out_the_map(tab):
    def click() -> str:
        x, y = tab.page.evaluate("() => window.mapmeld.pixel([0, 0])")
        tab.page.mouse.click(x, y)
        return tab.page.evaluate("() => window.mapmeld.hud.readout")

    readout = settle(click, "what is there")
    assert "map 1: free" in readout  # robot 2 stood there
    assert "map 2: unknown" in readout  # it lies beside map 1 still


def test_the_bilateral_method_has_its_own_settings_and_answers(tab):
    tab.press("Instant")
    tab.choose("Method", METHODS["bilateral"].title)
    settle(lambda: "N_p particles" not in tab.text, "the swarm's sliders to go")
    tab.press("Merge")
    settle(lambda: tab.mood in ("accepted", "refused"), "a verdict")
    assert settle(lambda: tab.number("error to the truth"), "the error").endswith("°")


def l_room() -> GridMap:
    """A room of 6 m x 4 m with a thick wall at its left and at its foot."""
    cells = np.full((40, 60), FREE, dtype=np.int8)
    cells[:, :5] = OCCUPIED
    cells[:5, :] = OCCUPIED
    cells[-5:, -5:] = UNKNOWN
    return GridMap(cells, 0.1)


def write_case(folder: Path, ref: GridMap, mov: GridMap, observation: Observation) -> list[Path]:
    """The five files in the order of the upload buttons."""
    paths = []
    for stem, grid in (("map1", ref), ("map2", mov)):
        files = map_to_bytes(grid, stem)
        for name in (f"{stem}.yaml", f"{stem}.pgm"):
            (folder / name).write_bytes(files[name])
            paths.append(folder / name)
    (folder / "observation.yaml").write_bytes(observations_to_bytes([observation]))
    return [*paths, folder / "observation.yaml"]


def test_uploads_one_by_one_say_what_is_missing_and_then_merge(tab, tmp_path):
    room = l_room()
    seen = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    tab.unfold("Upload your own")
    for slot, path in enumerate(write_case(tmp_path, room, room, seen)):
        tab.upload(slot, path)
        settle(lambda path=path: path.name in tab.text, f"the name {path.name}")
        if slot == 1:
            settle(lambda: "Load map 2" in tab.state, "the next step in words")
        if slot == 3:
            settle(lambda: "Load the observation" in tab.state, "the next step in words")
    settle(lambda: tab.state == "Ready. Press Merge.", "all five files")
    tab.press("Instant")
    tab.press("Merge")
    settle(lambda: tab.mood in ("accepted", "refused"), "a verdict")


def test_several_sightings_are_all_shown_and_counted(tab, tmp_path):
    room = l_room()
    first = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)
    second = Observation(Pose2(4.0, 3.0, 0.0), 5.0, 3.0, 1.0, 0.0)
    *maps, seen = write_case(tmp_path, room, room, first)
    tab.unfold("Observation")
    tab.unfold("Upload your own")
    for slot, path in enumerate(maps):
        tab.upload(slot, path)
        settle(lambda path=path: path.name in tab.text, f"the name {path.name}")
    seen.write_bytes(observations_to_bytes([first, second]).replace(b"- observer", b"- obsever"))
    tab.upload(4, seen)
    tab.wait_for("failed")
    assert "observation 1: obsever is not a known key" in tab.state
    seen = tmp_path / "both.yaml"
    seen.write_bytes(observations_to_bytes([first, second]))
    tab.upload(4, seen)
    settle(lambda: tab.state == "Ready. Press Merge.", "all five files")
    assert "Observation 1 of 2" in tab.text
    assert "Observation 2 of 2" in tab.text
    assert [item["t"] for item in tab.layer("sight") if "t" in item] == ["2", "2"]
    assert sorted(item["t"] for item in tab.layer("robots") if "t" in item)[:2] == ["robot 1", "robot 2"]


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


def test_a_refused_map_is_downloaded_only_after_a_warning(open_tab, sample: Case):
    o = sample.observations[0]
    wrong = Observation(o.observer, o.observed_x + 6.0, o.observed_y - 5.0, o.range, o.bearing)
    own = make_server(
        port=0, initial=Case("wrong", sample.ref, sample.mov, (wrong,), "observation.yaml", None)
    )
    try:
        tab = open_tab(at=own)
        tab.press("Instant")
        tab.press("Merge")
        tab.wait_for("refused")
        tab.press("Download everything")
        with tab.page.expect_download() as download:
            tab.press("Download the refused map anyway")
        assert download.value.suggested_filename == "merged.zip"
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
