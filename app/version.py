"""Which version of mapmeld, and of what it stands on, made a result."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed

MATTERS = ("numpy", "numba", "scipy")  # what may change a number


def version() -> str:
    """Version of mapmeld; "unknown" where it runs from a folder that was never installed."""
    return _installed("mapmeld")


def versions() -> dict[str, str]:
    """Versions of mapmeld, Python and the packages that compute."""
    return {
        "mapmeld": version(),
        "python": platform.python_version(),
        **{name: _installed(name) for name in MATTERS},
    }


def _installed(name: str) -> str:
    try:
        return installed(name)
    except PackageNotFoundError:
        return "unknown"
