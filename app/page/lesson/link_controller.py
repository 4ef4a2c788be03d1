"""Links to a place of the lesson: #lesson=9&sample=corridor_r3_r2 opens step 9 on that sample."""

from __future__ import annotations

from collections.abc import Callable

import segno

from algorithms.common.errors import InputFileError
from app.page.lesson.lesson_controller import LessonController
from app.page.tab import Tab
from app.system import data_paths as paths

SCHEMES = ("http://", "https://")


class LinkController:
    """Of one tab; the browser keeps its address in step with the lesson by itself: lesson.js."""

    def __init__(self, tab: Tab, lesson: LessonController, take_sample: Callable[[str], None]) -> None:
        """take_sample : shows the sample of a name in place of what is on the page"""
        self._tab, self._lesson, self._take_sample = tab, lesson, take_sample
        tab.events.on("place", self._open, lesson=int, sample=str)
        tab.events.on("link", self._show, address=str)

    def _open(self, lesson: int, sample: str) -> None:
        """Open a step of the lesson on a sample; on what is loaded where none is named."""
        state, samples = self._tab.state, paths.samples()
        with state.locks.action:
            if sample and sample not in samples:
                known = f"known are {', '.join(samples)}"
                found = f"names the sample {sample}, which is not here"
                self._tab.notices.report(InputFileError("This link", found, known))
                return
            if sample and sample != state.inputs.name:
                self._take_sample(sample)
            self._lesson.open_at(lesson)

    def _show(self, address: str) -> None:
        """Show an address as a QR code, to be read off the screen by phones."""
        if address.startswith(SCHEMES):
            code = segno.make(address, error="m", micro=False)
            drawn = code.svg_inline(omitsize=True, border=4, dark="#111827", light="#ffffff")
            self._tab.display.messages.link(address, drawn)
            self._tab.display.messages.flush()
