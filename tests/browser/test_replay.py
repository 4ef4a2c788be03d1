"""A saved replay in a real Chromium, opened as a file and without a network."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from driver import settle
from playwright.sync_api import Browser, Page

from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS, run
from app.drawing.palette import DARK, LIGHT
from app.model.merge_inputs import MergeInputs
from app.report.replay.html_page import ReplayMetadata, replay_html
from app.report.replay.recorder import record

pytestmark = pytest.mark.browser

MOST_BYTES = 1_000_000


class Replay:
    """A page of a replay, offline; a script error in it, or a request for anything else, fails the test."""

    def __init__(self, browser: Browser, path: Path, scheme: str = "light") -> None:
        self.context = browser.new_context(
            viewport={"width": 1280, "height": 720}, offline=True, color_scheme=scheme
        )
        self.page: Page = self.context.new_page()
        self.errors: list[str] = []
        self.asked: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on(
            "console", lambda message: self.errors.append(message.text) if message.type == "error" else None
        )
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_function("() => window.replay?.ready")
        self.own = path.as_uri()

    @property
    def caption(self) -> str:
        return self.page.locator("#caption span").inner_text()

    @property
    def time(self) -> float:
        return float(self.page.evaluate("() => replay.time"))

    @property
    def step(self) -> str:
        return self.page.locator("#steps [aria-current=step]").inner_text()

    def colour_at(self, point: list[float]) -> tuple[int, ...]:
        """The colour of the map's canvas at a point of the scene; metres."""
        return tuple(
            self.page.evaluate(
                """(point) => {
                    const canvas = document.querySelector("#map canvas"), g = canvas.getContext("2d");
                    const [x, y] = replay.view.project("scene", point), k = canvas.width / replay.view.wide;
                    return [...g.getImageData(Math.round(x * k), Math.round(y * k), 1, 1).data].slice(0, 3);
                }""",
                point,
            )
        )

    def end(self) -> None:
        assert [url for url in self.asked if url != self.own and not url.startswith("data:")] == []
        assert self.errors == []
        self.context.close()


def page_of(case: Case, path: Path, name: str, method: str = "spectra-proven") -> Path:
    config = METHODS[method].defaults
    inputs = replace(MergeInputs.of(case), name=name)
    steps = run(method, case.ref, case.mov, inputs.known, config)
    path.write_bytes(replay_html(record(steps, inputs, config), ReplayMetadata(inputs, method, config, 0)))
    return path


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_search_over_the_plane_shows_its_surface_beside_the_map(browser, small_case, tmp_path, scheme):
    unseen = replace(small_case, observations=())
    replay = Replay(browser, page_of(unseen, tmp_path / "plane.html", "flat", "whole-plane"), scheme)
    replay.page.get_by_role("button", name="Plane", exact=True).click()
    dark = "[68, 1, 84]"  # what fits nowhere
    shown = f"""() => {{
        const canvas = document.querySelector("#charts"), g = canvas.getContext("2d");
        const data = g.getImageData(0, 0, canvas.width, canvas.height).data;
        let count = 0;
        for (let i = 0; i < data.length; i += 4) count += {dark}.every((value, k) => data[i + k] === value);
        return count / (data.length / 4);
    }}"""
    settle(lambda: replay.page.evaluate(shown) > 0.05, "the surface")
    replay.end()


def test_a_run_saved_from_the_page_plays_as_a_file_without_a_network(tab, browser, tmp_path):
    save = tab.page.get_by_role("button", name="Save replay", exact=True)
    assert not save.is_visible()
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    verdict = tab.state
    settle(save.is_enabled, "the offer")
    with tab.page.expect_download() as download:
        tab.press("Save replay")
    assert download.value.suggested_filename == "replay_office_r2_r1.html"
    saved = tmp_path / "saved.html"
    download.value.save_as(saved)
    assert saved.stat().st_size < MOST_BYTES
    tab.move("spread", 5)
    settle(lambda: tab.state.startswith("Merged") and save.is_enabled(), "the offer of the new run")

    replay = Replay(browser, saved)
    settle(lambda: replay.caption == "Two robots, two maps, no common frame.", "the first picture")
    assert "office_r2_r1" in replay.page.locator(".title").inner_text()
    replay.page.keyboard.press("Space")
    settle(lambda: replay.time > 1.3 and replay.step != "Maps", "the clock to run")
    replay.page.keyboard.press("Space")
    assert not replay.page.evaluate("() => replay.playing")
    replay.page.keyboard.press("Home")
    for step in ("Observation", "Augmentation", "Hough spectra", "Candidates", "Swarm"):
        replay.page.keyboard.press("ArrowRight")
        settle(lambda step=step: replay.step == step, step)
    settle(lambda: replay.caption.startswith("Searching: candidate 1 of "), "the swarm")
    replay.page.keyboard.press("End")
    settle(lambda: replay.caption == verdict, "the verdict of the page")
    rows = replay.page.locator("#table tr")
    assert rows.filter(has_text="acceptance index").count() == 1
    replay.page.keyboard.press("Home")
    settle(lambda: replay.time == 0 and replay.step == "Maps", "the beginning")
    replay.page.get_by_role("button", name="Recording").click()
    facts = replay.page.locator("dialog").inner_text()
    assert "Nothing is computed here" in facts
    assert "Spectra, swarm, proven optimum (spectra-proven)" in facts
    assert verdict in facts
    replay.end()


def test_a_replay_is_the_right_way_up_light_and_dark_and_its_names_are_words(browser, small_case, tmp_path):
    nasty = "</script><img src=x onerror=window.hit=1>"
    replay = Replay(browser, page_of(small_case, tmp_path / "r.html", nasty))
    assert nasty in replay.page.locator(".title").inner_text()
    assert replay.page.evaluate("() => window.hit") is None
    grid, at = small_case.ref, MergeInputs.of(small_case).at.x_ref
    rows, cols = np.nonzero(grid.occupied)
    inner = [k for k in range(len(rows)) if grid.occupied[rows[k] - 1 : rows[k] + 2, cols[k]].all()]
    wall = (grid.centres(rows[inner[:1]], cols[inner[:1]])[0] - at).tolist()
    look = "([x, y]) => { replay.own = { metre: 900, x, y }; replay.seek(0.5); }"
    replay.page.evaluate(look, wall)
    settle(lambda: replay.colour_at(wall) == LIGHT.ref, "a wall of map 1 where it is in the map")
    beyond = (grid.corners()[2] + 1.0 - at).tolist()
    replay.page.evaluate(look, beyond)
    settle(lambda: replay.colour_at(beyond) == LIGHT.unknown, "nothing beyond the map")
    replay.page.keyboard.press("d")
    settle(lambda: replay.colour_at(beyond) == DARK.unknown, "the dark page")
    replay.page.get_by_role("button", name="Follow the run again").click()
    assert replay.page.evaluate("() => replay.own") is None
    replay.end()


def test_a_replay_is_driven_by_its_bar_and_pauses_at_steps(browser, small_case, tmp_path):
    replay = Replay(browser, page_of(small_case, tmp_path / "r.html", "a flat"), scheme="dark")
    assert replay.page.evaluate("() => replay.dark") is True
    replay.page.get_by_label("pause at steps").check()
    replay.page.get_by_label("Speed").select_option("4")
    replay.page.locator("#play").click()
    settle(lambda: not replay.page.evaluate("() => replay.playing"), "the first halt")
    assert replay.step == "Maps"
    replay.page.keyboard.press("Space")  # on the button in focus it must not count twice
    paused = "() => !replay.playing"
    settle(lambda: replay.step == "Observation" and replay.page.evaluate(paused), "the next halt")
    box = replay.page.locator("#seek").bounding_box()
    replay.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    length = replay.page.evaluate("() => replay.length")
    assert settle(lambda: replay.time, "the knob") == pytest.approx(length / 2, rel=0.01)
    replay.page.get_by_role("button", name="Verdict").click()
    settle(lambda: replay.caption.startswith("Merged"), "the verdict")
    fits = """() => {
        const root = document.documentElement;
        return root.scrollHeight <= innerHeight && root.scrollWidth <= innerWidth;
    }"""
    for size in ((1280, 720), (1920, 1080), (1024, 768)):
        replay.page.set_viewport_size({"width": size[0], "height": size[1]})
        assert replay.page.evaluate(fits)
    replay.end()
