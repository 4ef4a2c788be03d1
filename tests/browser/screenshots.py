"""Pictures of every stage of the page: ``python tests/browser/screenshots.py FOLDER [NAME ...]``.

With names only those are kept; ``static/screenshots swarm merged`` makes the README's pictures anew.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from chromium import find_chromium  # noqa: E402
from driver import ARGUMENTS, Tab, settle  # noqa: E402
from playwright.sync_api import sync_playwright  # noqa: E402

from algorithms.casefiles import Case, read_case  # noqa: E402
from algorithms.observation import Observation  # noqa: E402
from app.paths import samples  # noqa: E402
from app.server import make_server  # noqa: E402

SIZE = (1280, 800)
SAMPLE = "office_r2_r1"
ALIKE = "corridor_r3_r2"  # two places that look alike when turned


def main(folder: Path, names: list[str]) -> None:
    """Drive the page through a merge and keep a picture of every stage."""
    folder.mkdir(parents=True, exist_ok=True)
    case = read_case(samples()[SAMPLE])
    o = case.observations[0]
    wrong = Observation(o.observer, o.observed_x + 6.0, o.observed_y - 5.0, o.range, o.bearing)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=ARGUMENTS)
        for name, initial, script in (
            ("", case, a_merge),
            ("refused", Case("a wrong sighting", case.ref, case.mov, (wrong,), "", None), a_refusal),
            ("rival", read_case(samples()[ALIKE]), a_refusal),
            ("empty", None, an_empty_page),
        ):
            server = make_server(port=0, initial=initial)
            tab = Tab(browser, f"http://127.0.0.1:{server.get_port()}/", SIZE)

            def keep(picture: str, tab: Tab = tab) -> None:
                if not names or picture in names:
                    tab.page.screenshot(path=str(folder / f"{picture}.png"))

            script(tab, keep, name)
            tab.close()
            server.stop()
        browser.close()


def a_merge(tab: Tab, keep: Callable[[str], None], _: str) -> None:
    """Every stage, every view, light and dark."""

    def until(words: str, pause: int = 0) -> None:
        settle(lambda: words in tab.state, words)
        tab.page.wait_for_timeout(pause)

    tab.page.wait_for_timeout(1500)
    keep("loaded")
    tab.press("Slow")
    tab.press("Merge")
    until("Augmenting", 900)
    keep("augmented")
    until("Turning", 1800)
    keep("turned")
    until("candidate 3", 700)
    keep("shifted")
    until("Searching: candidate 1", 1200)
    keep("swarm")
    tab.press("Swarm space")
    tab.page.wait_for_timeout(700)
    keep("swarm_space")
    tab.press("Map")
    tab.press("Stop")
    tab.page.wait_for_timeout(800)
    keep("stopped")
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    tab.press("Show everything")
    tab.page.wait_for_timeout(1500)
    tab.page.locator(".mm-state").scroll_into_view_if_needed()
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


def a_refusal(tab: Tab, keep: Callable[[str], None], name: str) -> None:
    """A sighting that is wrong by some metres, or a rival that fits nearly as well."""
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("refused")
    tab.page.wait_for_timeout(1500)
    keep(name)
    tab.press("Download everything")
    tab.page.wait_for_timeout(800)
    keep(f"{name}_download")


def an_empty_page(tab: Tab, keep: Callable[[str], None], name: str) -> None:
    """Nothing loaded yet; then a file that cannot be used."""
    tab.page.wait_for_timeout(800)
    keep(name)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:])
