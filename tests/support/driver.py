"""One tab of the page as a person uses it, in a real Chromium."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Page

from algorithms.common.robot_names import WORDS

PATIENCE = 120.0  # seconds; a shared machine may be several times as slow as one of its own

# a software renderer, so that the tests need no graphics card
ARGUMENTS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
# what is drawn is less smooth, in two thirds of the time
ROUGHER = [
    "--disable-gpu-rasterization",
    "--disable-gpu-compositing",
    "--webgl-antialiasing-mode=none",
    "--disable-accelerated-2d-canvas",
]
READY = "() => window.mapmeld?.applied > 0 && document.querySelector('.mm-state span')?.textContent"

REMEMBER = """try {{ localStorage.getItem("mapmeld-mode") || localStorage.setItem("mapmeld-mode", "{}"); }}
catch {{ /* a page without a place to remember */ }}"""

# Ten pictures a second are enough: the renderer is software, and its time is that of the tests.
SLOW_FRAMES = """(() => {
    const draw = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (then) => window.setTimeout(() => draw(then), 100);
    window.cancelAnimationFrame = (wait) => window.clearTimeout(wait);
})()"""

# where two points of the scene are in the window, two frames later
AFTER_A_FRAME = """() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(
    () => done([[0, 0], [7, 4]].map((p) => window.mapmeld.pixel(p))))))"""
SCALE = "() => mapmeld.pixel([1, 0])[0] - mapmeld.pixel([0, 0])[0]"  # pixels per metre


def metres(told: str) -> float:
    """The number that a table tells."""
    return float(told.split()[0].replace("−", "-"))


def settle(check: Callable[[], Any], what: str) -> Any:
    """Poll until ``check`` gives something true, and return it."""
    end, pause = monotonic() + PATIENCE, 0.03
    while monotonic() < end:
        found = check()
        if found:
            return found
        sleep(pause)
        pause = min(1.2 * pause, 0.2)  # each look lays the page out anew
    raise AssertionError(f"waited {PATIENCE:.0f} s for {what}")


class Tab:
    """Finds things by their words; waits by polling."""

    def __init__(
        self,
        browser: Browser,
        address: str,
        size: tuple[int, int],
        touch: bool = False,
        mode: str = "Research",
        smooth: bool = False,
    ) -> None:
        """mode : that the browser remembers; empty for a browser that was never here
        smooth : every picture is drawn, as what is dragged needs it
        """
        self.context = browser.new_context(
            viewport={"width": size[0], "height": size[1]}, accept_downloads=True, has_touch=touch
        )
        if mode:
            self.context.add_init_script(REMEMBER.format(mode))
        if not smooth:
            self.context.add_init_script(SLOW_FRAMES)
        self.page: Page = self.context.new_page()
        self.errors: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on(
            "console",
            lambda message: (
                self.errors.append(message.text)
                if message.type == "error" and "mapmeld" in message.text
                else None
            ),
        )
        self.page.goto(address)
        self.page.wait_for_function(READY, timeout=1000 * PATIENCE)
        # viser's toast about the software renderer lies over the page's top left
        self.page.add_style_tag(content=".mantine-Notifications-root{display:none!important}")

    # --- reading ----------------------------------------------------------------------------------

    @property
    def state(self) -> str:
        """The sentence at the top."""
        return str(self.page.evaluate("() => document.querySelector('.mm-state span').textContent"))

    @property
    def mood(self) -> str:
        """idle, running, accepted, refused, stopped or failed."""
        return str(self.page.evaluate("() => document.querySelector('.mm-state').dataset.mood"))

    @property
    def text(self) -> str:
        """All words on the page."""
        return self.page.locator("body").inner_text()

    def layer(self, name: str) -> list[dict[str, Any]]:
        """What is drawn over the map under this name; [] where nothing is."""
        return list(self.page.evaluate("(name) => window.mapmeld.layers[name] || []", name))

    def swarm(self) -> list[float]:
        """Coordinates of all particles as they are drawn."""
        clouds = self.layer("swarm")
        return clouds[0]["p"] if clouds else []

    def number(self, name: str) -> str:
        """The number beside these words in a table; "" where they are not shown."""
        row = self.page.locator("tr", has=self.page.get_by_text(name, exact=True))
        return row.locator("td").last.inner_text() if row.count() else ""

    def pixels(self) -> np.ndarray:
        """(H, W, 3) what the window shows."""
        return np.asarray(Image.open(io.BytesIO(self.page.screenshot())).convert("RGB")).astype(int)

    def colour_at(self, point: tuple[float, float], frame: str = "scene") -> tuple[int, ...]:
        """The colour at a point of the scene; metres."""
        where = "([point, frame]) => window.mapmeld.pixel(point, frame)"
        x, y = self.page.evaluate(where, [list(point), frame])
        return tuple(self.pixels()[round(y), round(x)])

    def at_rest(self) -> list[float]:
        """Where the scene's zero is in the window, once the camera has come to rest."""
        seen: list[list[list[float]]] = []

        def rests() -> bool:  # two places: a zoom about the one leaves it where it is
            seen.append(self.page.evaluate(AFTER_A_FRAME))
            return len(seen) > 8 and seen[-8:] == seen[-1:] * 8

        settle(rests, "the camera to rest")
        return seen[-1][0]

    # --- doing ------------------------------------------------------------------------------------

    def press(self, name: str) -> None:
        """Press a button by its name."""
        button = self.page.get_by_role("button", name=name, exact=True)
        button.and_(self.page.locator("button")).click()  # a folder's head may be called the same

    def wait_for(self, mood: str) -> None:
        """Wait until the run has come to this."""
        settle(lambda: self.mood == mood, f"{mood}; the page says: {self.state}")

    def unfold(self, folder: str) -> None:
        """Open a folder of the panel."""
        self.page.get_by_text(folder, exact=True).click()

    def choose(self, label: str, option: str) -> None:
        """Choose from a menu."""
        self.page.get_by_label(label, exact=True).first.click()
        self.page.get_by_role("option", name=option, exact=True).click()

    def move(self, label: str, presses: int) -> None:
        """Move a slider by so many steps; to the left where it is negative."""
        words = self.page.locator("label", has_text=label).first
        thumb = self.page.locator(f'[id="{words.get_attribute("for")}"]').get_by_role("slider")
        thumb.focus()
        for _ in range(abs(presses)):
            self.page.keyboard.press("ArrowRight" if presses > 0 else "ArrowLeft")

    def open_files(self, *files: Path) -> None:
        """Choose these files, all at once, with the button for it."""
        chooser = self.page.locator(
            f'[id="file_upload_{self.page.evaluate("() => mapmeld.hud.open.button")}"]'
        )
        settle(lambda: chooser.evaluate("(input) => input.multiple"), "a choice of several files")
        chooser.set_input_files([str(file) for file in files])

    def drop(self, *paths: Path) -> None:
        """Drop files and folders on the map, all at once, as a file manager does."""
        events = self.context.new_cdp_session(self.page)
        box = self.page.locator("canvas").first.bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
        veil = self.page.locator(".mm-veil")
        for kind, veiled in (("dragEnter", False), ("dragOver", True), ("drop", False)):
            events.send("Input.dispatchDragEvent", {"type": kind, "x": x, "y": y, "data": data})
            if kind != "dragEnter":
                settle(lambda veiled=veiled: veil.is_visible() == veiled, "the words over the page")
        events.detach()

    def listed(self) -> list[str]:
        """The lines of the list of files."""
        return [" ".join(line.split()) for line in self.page.locator(".mm-given li").all_inner_texts()]

    def close(self) -> None:
        """Close the tab."""
        self.context.close()


def field(tab: Tab, label: str) -> float:
    """The number that stands in a field."""
    return float(tab.page.get_by_label(label, exact=True).input_value())


SAID = """() => [
    document.body.innerText, JSON.stringify(mapmeld.layers), JSON.stringify(mapmeld.hud),
    ...[...document.querySelectorAll("[title], [aria-label]")].flatMap((e) => [e.title, e.ariaLabel || ""]),
    ...[...document.querySelectorAll("svg text")].map((e) => e.textContent)].join("\\n")"""
FIELDS = re.compile(r"Robot [12] is called")  # that give names


def of_two(tab: Tab) -> list[str]:
    """What the page calls robot 1 or 2, map 1 or 2."""
    return [found[0] for found in WORDS.finditer(FIELDS.sub("", tab.page.evaluate(SAID)))]
