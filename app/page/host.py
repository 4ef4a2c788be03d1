"""What every part of a page may ask of it; each part's own Host says what it needs besides."""

from __future__ import annotations

from typing import Protocol

from app.drawing.palette import Palette
from app.model.merge_inputs import MergeInputs


class PageHost(Protocol):
    """A page with maps on it."""

    @property
    def inputs(self) -> MergeInputs:
        """What is loaded."""

    @property
    def palette(self) -> Palette:
        """The colours of the page."""


class MapHost(Protocol):
    """A page with several views, the map among them."""

    @property
    def on_map(self) -> bool:
        """Whether the map is looked at."""


class RunHost(PageHost, Protocol):
    """A page on which methods are run."""

    @property
    def seed(self) -> int:
        """Random seed of a run; the same seed gives the same answer."""
