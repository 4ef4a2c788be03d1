"""What the tabs of research need of the page they are on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from app.page.host import RunHost


class ResearchHost(RunHost, Protocol):
    """A page whose settings methods are run with, and that sends files."""

    def settings_for(self, method: str) -> Any:
        """The settings a method is to run with."""

    def save(self, name: str, make: Callable[[], bytes]) -> None:
        """Send a file, once it is made."""
