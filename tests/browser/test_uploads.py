"""A file over a slow network: how far it is, Stop, and a page that goes on meanwhile."""

from __future__ import annotations

from os import truncate
from pathlib import Path

import pytest
from driver import Tab, settle
from slowline import slow_line

pytestmark = pytest.mark.browser

SLOW = 300_000  # bytes a second


def image(path: Path) -> Path:
    """Of 6 MB."""
    path.write_bytes(b"P5\n3000 2000\n255\n" + bytes(range(250)) * 24_000)
    return path


def watch(tab: Tab) -> None:
    """Note all that the line of files and the notices ever say, and how long after the choice of a file the
    line soonest said that it is being sent."""
    tab.page.evaluate(
        """() => {
            window.said = [];
            window.soonest = Infinity;
            const line = document.querySelector(".mm-sending");
            const sending = () => !line.hidden && line.innerText.startsWith("Sending");
            let chosen = 0;
            window.addEventListener("input", (e) => {
                if (e.target.type === "file" && !sending()) chosen = performance.now();
            }, true);
            const look = () => {
                if (!line.hidden) window.said.push(line.innerText);
                if (sending()) window.soonest = Math.min(window.soonest, performance.now() - chosen);
            };
            new MutationObserver(look).observe(line, { attributes: true, childList: true, subtree: true });
            new MutationObserver(() => {
                for (const toast of document.querySelectorAll(".mantine-Notification-root"))
                    window.said.push(toast.innerText);
            }).observe(document.body, { childList: true, subtree: true });
        }"""
    )


def said(tab: Tab) -> str:
    return " ".join(tab.page.evaluate("() => window.said"))


def test_a_file_on_its_way_is_told_of_holds_up_nothing_and_can_be_left(open_tab, server, tmp_path):
    with slow_line(server.get_port()) as line:
        tab = open_tab((1280, 800), at=line)
        watch(tab)
        stop = tab.page.get_by_role("button", name="Stop", exact=True)
        shown, way = (
            tab.page.locator(".mm-sending"),
            tab.page.get_by_role("progressbar", name="Files on their way"),
        )

        def percent() -> int:
            return int(way.get_attribute("aria-valuenow")) if shown.is_visible() else -1

        def kept() -> int:
            states = [client.gui._current_file_upload_states for client in server.get_clients().values()]
            return sum(len(of_tab) for of_tab in states)

        before = tab.state
        first, second = image(tmp_path / "floor_1.pgm"), image(tmp_path / "floor_2.pgm")
        line.rate = SLOW
        tab.open_files(first)
        settle(lambda: percent() > 5, "some progress")
        settle(stop.is_enabled, "Stop")
        tab.press("Slow")  # what a person does meanwhile does not wait for the file
        settle(lambda: tab.page.get_by_role("button", name="Slow", pressed=True).count(), "an answer")
        assert 5 < percent() < 90
        tab.open_files(second)
        settle(lambda: "Sending floor_1.pgm and floor_2.pgm" in shown.inner_text(), "both files")
        assert " of 12 MB" in shown.inner_text()
        both = percent()
        settle(lambda: percent() > both, "progress of both")
        tab.press("Stop")
        settle(shown.is_hidden, "nothing on its way")
        settle(lambda: not kept(), "nothing to stay")
        settle(lambda: not server.uploads._coming, "the end")
        settle(stop.is_disabled, "nothing to stop")
        assert (tab.state, tab.listed()) == (before, [])

        tab.open_files(first)
        settle(lambda: percent() > 0, "the same file again")
        tab.page.get_by_role("button", name="Stop sending").click()
        settle(lambda: shown.is_hidden() and not kept(), "nothing on its way")
        assert "did not arrive" not in said(tab)

        tab.open_files(first)
        settle(lambda: percent() > 0, "the same file once more")
        line.rate = None
        settle(lambda: "floor_1.pgm" in " ".join(tab.listed()), "the file")
        settle(shown.is_hidden, "it to be there")
        tab.page.evaluate("() => { window.said = []; }")
        (tmp_path / "small.yaml").write_text("image: [")
        tab.open_files(tmp_path / "small.yaml")
        settle(lambda: tab.mood == "failed", "the reason why not")
        assert tab.page.evaluate("() => window.soonest") >= 400  # ms: what takes but a moment is not told
        told = said(tab)
        assert "small.yaml: " in told
        assert "ploaded" not in told  # viser's own words for what has been refused
        assert "ploading" not in told

        line.rate = SLOW
        loaded = tab.listed()
        for spoil in (lambda: truncate(second, 100), second.unlink):  # while it is being read
            tab.open_files(second)
            settle(lambda: percent() > 0, "some of it")
            spoil()
            settle(
                lambda: shown.inner_text() == "floor_2.pgm cannot be read any more. Choose it again.",
                "the note",
            )
            image(second)
        tab.open_files(second)  # and it can be chosen again
        settle(lambda: percent() > 0 and kept() == 1, "a last one")
        assert tab.listed() == loaded
        line.cut()
        line.rate = None
        settle(
            lambda: "floor_2.pgm did not arrive: the connection broke off." in shown.inner_text(), "the note"
        )
        settle(lambda: not kept(), "nothing to stay")
