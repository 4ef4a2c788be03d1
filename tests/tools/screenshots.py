"""Pictures of the page: ``python tests/tools/screenshots.py FOLDER [NAME ...]``.

Without names every picture is kept, ``shown`` stands for those that the README and the guides show.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from chromium import find_chromium
from driver import ARGUMENTS, Tab, settle
from PIL import Image
from playwright.sync_api import Browser, sync_playwright
from training_pairs import training_pairs

from algorithms.files.case_folder import Case, read_case
from algorithms.files.map_file import map_to_bytes
from algorithms.observations.observation import Observation
from app.page.application import make_server
from app.system.data_paths import samples

SIZE = (1280, 800)
SAMPLE = "office_r2_r1"
BENT = "bent_r2_r1"
ALIKE = 8139  # a simulated corridor that looks alike when turned
SHOWN = (
    "swarm", "merged", "proof", "rival", "why", "curtain", "by_hand", "place", "plain_image", "lesson_camera",
    "lesson_laser", "lesson_hough", "lesson_swarm", "lesson_knowledge", "lesson_chain", "fleet", "live",
    "museum", "museum_poster", "compared", "swept", "camera_sighting",
)  # fmt: skip

Keep = Callable[[str], None]


def main(folder: Path, names: list[str]) -> None:
    """Play every scene and keep the pictures that are asked for."""
    folder.mkdir(parents=True, exist_ok=True)
    wanted = set(SHOWN if names == ["shown"] else names)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=ARGUMENTS)
        for scene, pictures in SCENES.items():
            if wanted and not wanted & set(pictures):
                continue
            with opened(browser, opening(scene)) as tab:

                def keep(name: str, tab: Tab = tab) -> None:
                    if not wanted or name in wanted:
                        tab.page.screenshot(path=folder / f"{name}.png")

                scene(tab, keep)
        browser.close()


@contextmanager
def opened(browser: Browser, initial: Case | None) -> Iterator[Tab]:
    """A tab of a server of its own."""
    server = make_server(port=0, initial=initial)
    tab = Tab(browser, f"http://127.0.0.1:{server.get_port()}/", SIZE)
    tab.page.wait_for_timeout(800)
    yield tab
    tab.close()
    server.stop()


def opening(scene: Callable[[Tab, Keep], None]) -> Case | None:
    """What a scene begins with."""
    if scene is a_rival:
        alike = next(iter(training_pairs(ALIKE)))
        return Case("a corridor", alike.case.ref, alike.case.mov, alike.observations, "", None)
    case = read_case(samples()[BENT if scene is a_bend else SAMPLE])
    if scene is a_wrong_sighting:
        o = case.observations[0]
        wrong = Observation(o.observer, o.observed_x + 6.0, o.observed_y - 5.0, o.range, o.bearing)
        return Case("a wrong sighting", case.ref, case.mov, (wrong,), "", None)
    return None if scene is an_empty_page else case


def until(tab: Tab, words: str, pause: int = 0) -> None:
    """Wait for words at the top, and so many milliseconds."""
    settle(lambda: words in tab.state, words)
    tab.page.wait_for_timeout(pause)


def merged(tab: Tab, mood: str = "accepted") -> None:
    """Merge without waiting, and come to rest."""
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for(mood)
    tab.page.wait_for_timeout(1500)


# --- scenes ---------------------------------------------------------------------------------------


def a_merge(tab: Tab, keep: Keep) -> None:
    """Every stage, every view, light and dark."""
    tab.page.wait_for_timeout(700)
    keep("loaded")
    tab.press("Slow")
    tab.press("Merge")
    until(tab, "Augmenting", 900)
    keep("augmented")
    until(tab, "Turning", 1800)
    keep("turned")
    until(tab, "candidate 3", 700)
    keep("shifted")
    until(tab, "Searching: candidate 1", 1200)
    keep("swarm")
    tab.press("Swarm space")
    tab.page.wait_for_timeout(700)
    keep("swarm_space")
    tab.press("Map")
    tab.press("Stop")
    tab.page.wait_for_timeout(800)
    keep("stopped")
    merged(tab)
    tab.press("Show everything")
    tab.page.wait_for_timeout(1500)
    tab.page.get_by_role("button", name="Merge", exact=True).scroll_into_view_if_needed()
    tab.page.wait_for_timeout(300)
    keep("merged")
    tab.press("Proof")
    tab.press("Swarm space")
    tab.page.wait_for_timeout(1500)
    keep("proof")
    tab.press("Result")
    tab.press("Heights")
    tab.page.wait_for_timeout(2500)
    keep("heights")
    tab.press("Map")
    tab.page.get_by_label("Dark", exact=True).click()
    tab.page.wait_for_timeout(2500)
    keep("dark")


def a_comparison(tab: Tab, keep: Keep) -> None:
    """The merged map looked at in every way, then taken into the hand."""
    merged(tab)
    for name in ("Curtain", "Blink", "Difference"):
        tab.press(name)
        tab.page.wait_for_timeout(900)
        keep(name.lower())
    tab.press("Overlay")
    tab.press("Move map 2 by hand")
    tab.page.wait_for_timeout(1200)
    x, y = tab.page.evaluate("() => window.mapmeld.pixel([2, -2], 'mov')")
    tab.page.mouse.move(x, y)
    tab.page.mouse.down()
    tab.page.mouse.move(x + 9, y - 6, steps=6)
    tab.page.wait_for_timeout(900)
    keep("by_hand")
    tab.page.mouse.up()
    tab.page.keyboard.press("?")
    tab.page.wait_for_timeout(400)
    keep("keys")


def a_rival(tab: Tab, keep: Keep) -> None:
    """Two places fit nearly as well."""
    merged(tab, "refused")
    keep("rival")


def a_bend(tab: Tab, keep: Keep) -> None:
    """Maps that no one transform lays on each other, what counts for the merge, and what if."""
    merged(tab, "bent")
    keep("bent")
    tab.page.locator("summary", has_text="Why").click()
    tab.page.mouse.move(640, 500)
    tab.page.wait_for_timeout(600)
    keep("why")
    tab.unfold("What if")
    tab.page.get_by_text("Reset what if").scroll_into_view_if_needed()
    tab.page.wait_for_timeout(600)
    keep("what_if")


def a_wrong_sighting(tab: Tab, keep: Keep) -> None:
    """A sighting that is wrong by some metres, and the question before its map is taken away."""
    merged(tab, "refused")
    keep("refused")
    tab.press("Download everything")
    tab.page.wait_for_timeout(800)
    keep("refused_download")


def an_empty_page(tab: Tab, keep: Keep) -> None:
    """Nothing loaded yet; then an image alone, and the form that asks what it means."""
    keep("empty")
    case = read_case(samples()[SAMPLE])
    with TemporaryDirectory() as folder:
        image = Path(folder) / "floor.png"
        pixels = np.asarray(Image.open(io.BytesIO(map_to_bytes(case.ref, "floor")["floor.pgm"])))
        Image.fromarray(pixels).save(image)
        tab.open_files(image)
        until(tab, "has no YAML file yet", 600)
    tab.page.locator("img[alt='what each pixel means']").first.scroll_into_view_if_needed()
    tab.page.wait_for_timeout(900)
    keep("plain_image")


def a_placement(tab: Tab, keep: Keep) -> None:
    """Robots placed by hand."""
    tab.press("Move the robots by hand")
    tab.page.wait_for_timeout(1500)
    keep("place")


def a_camera(tab: Tab, keep: Keep) -> None:
    """The sample's sighting from camera and scan."""
    tab.unfold("From camera and scan")
    tab.press("From the sample")
    tab.page.wait_for_timeout(600)
    tab.press("Look")
    settle(lambda: tab.page.locator(".mm-seen img").count(), "what was seen")
    tab.page.get_by_text("From camera and scan", exact=True).evaluate("(head) => head.scrollIntoView()")
    tab.page.wait_for_timeout(1200)
    keep("camera_sighting")


def a_lesson(tab: Tab, keep: Keep) -> None:
    """Every step of the lesson."""
    tab.press("Lesson")
    steps = {4: "lesson_hough", 12: "lesson_swarm", 17: "lesson_knowledge", 18: "lesson_chain"}
    number = 0
    while True:
        settle(lambda at=number: f"step {at} of" in tab.state, f"step {number}")
        tab.page.wait_for_timeout(1800)
        settle(lambda: tab.mood == "idle", "what is worked out")
        if steps.get(number) == "lesson_chain":  # its picture lies below its words
            tab.page.get_by_text("its answer is then right to").scroll_into_view_if_needed()
        if number == 0:
            _parts_of_a_sighting(tab, keep)
        keep(steps.get(number, f"lesson_{number:02d}"))
        if f"step {number} of {number}:" in tab.state:
            return
        tab.press("Next ▶")
        number += 1


def _parts_of_a_sighting(tab: Tab, keep: Keep) -> None:
    """The four parts of step 0, from the camera to why there are two sensors."""
    settle(lambda: tab.page.locator("svg.mm-picture image").count(), "the picture")
    tab.page.mouse.move(640, 700)
    tab.page.wait_for_timeout(800)
    for part in ("camera", "detector", "laser", "both"):
        if part != "camera":
            tab.move("part", 1)
            tab.page.wait_for_timeout(800)
        if part == "laser":  # its picture lies below its words
            tab.page.get_by_text("it lies behind the mean by").scroll_into_view_if_needed()
        keep(f"lesson_{part}")


def a_poster(tab: Tab, keep: Keep) -> None:
    """The exhibit of a picture that deceives."""
    tab.press("Museum")
    tab.choose("Exhibit", "9. A poster of a robot")
    settle(lambda: "the detector:" in tab.text, "the picture")
    tab.page.mouse.move(640, 500)
    merged(tab, "refused")
    settle(lambda: tab.page.get_by_text("robot 1's map:").count(), "what the others say")
    tab.page.locator("[aria-label^='The picture that robot 1 took']").evaluate("(it) => it.scrollIntoView()")
    tab.page.wait_for_timeout(400)
    keep("museum_poster")


def a_museum(tab: Tab, keep: Keep) -> None:
    """The first exhibit fails as told."""
    tab.press("Museum")
    tab.page.wait_for_timeout(1500)
    tab.page.mouse.move(640, 500)  # no hint over the panel
    merged(tab, "refused")
    keep("museum")


def a_fleet(tab: Tab, keep: Keep) -> None:
    """Six robots, a lie and an island."""
    tab.choose("Sample", "home_fleet_island")
    until(tab, "A fleet of 6 robots.", 600)
    tab.press("Merge")
    settle(lambda: tab.mood == "refused", "the fleet")
    tab.page.mouse.move(640, 700)
    tab.page.wait_for_timeout(1800)
    keep("fleet")


def robots_that_run(tab: Tab, keep: Keep) -> None:
    """The demo, once its robots are in one map."""
    tab.press("Live demo")
    settle(lambda: tab.mood == "accepted", "one map")
    tab.page.mouse.move(640, 700)
    tab.page.wait_for_timeout(9000)
    keep("live")


def a_contest(tab: Tab, keep: Keep) -> None:
    """Methods compared, and one of them looked at."""
    tab.page.get_by_role("tab", name="Compare").click()
    tab.press("None")
    settle(lambda: tab.page.get_by_role("button", name="Compare methods").count(), "no method")
    for method in ("spectra-proven", "paper-argmax", "sift", "orb"):
        tab.page.locator(f"[data-mm-pick={method}]").check()
    tab.press("Compare 4 methods")
    settle(lambda: "It took" in tab.text, "all of them")
    tab.page.locator("[data-mm-show=paper-argmax]").click()
    tab.page.wait_for_timeout(1800)
    tab.page.locator("[data-mm-show=spectra-proven]").scroll_into_view_if_needed()
    tab.page.mouse.move(640, 700)
    tab.page.wait_for_timeout(400)
    keep("compared")


def a_sweep(tab: Tab, keep: Keep) -> None:
    """Two settings swept, and a point of theirs taken."""
    tab.page.get_by_role("tab", name="Sweep").click()
    tab.choose("Method", "Spectra and window, no swarm")
    settle(lambda: tab.page.get_by_text("Spectra and window, no swarm").count() > 1, "its settings")
    tab.choose("second", "window kind")
    tab.page.get_by_role("button", name="Merge", exact=True).scroll_into_view_if_needed()
    tab.press("Run the sweep")
    settle(lambda: "It took" in tab.text, "all points")
    tab.page.locator("rect[data-mm-point]").nth(3).click()
    settle(lambda: "up to date" in tab.state, "its settings")
    tab.page.mouse.move(640, 700)
    tab.page.wait_for_timeout(1200)
    keep("swept")


# what each scene is played for; the steps of the lesson that are not shown anywhere have their numbers
SCENES: dict[Callable[[Tab, Keep], None], tuple[str, ...]] = {
    a_merge: (
        "loaded", "augmented", "turned", "shifted", "swarm", "swarm_space", "stopped", "merged", "proof",
        "heights", "dark",
    ),
    a_comparison: ("curtain", "blink", "difference", "by_hand", "keys"),
    a_rival: ("rival",),
    a_bend: ("bent", "why", "what_if"),
    a_wrong_sighting: ("refused", "refused_download"),
    an_empty_page: ("empty", "plain_image"),
    a_placement: ("place",),
    a_camera: ("camera_sighting",),
    a_lesson: (
        "lesson_camera", "lesson_detector", "lesson_laser", "lesson_both", "lesson_hough", "lesson_swarm",
        "lesson_knowledge", "lesson_chain",
    ),
    a_museum: ("museum",),
    a_poster: ("museum_poster",),
    a_fleet: ("fleet",),
    robots_that_run: ("live",),
    a_contest: ("compared",),
    a_sweep: ("swept",),
}  # fmt: skip


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:])
