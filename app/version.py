"""Which version of mapmeld, and of what it stands on, made a result."""

from __future__ import annotations

import platform
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed
from pathlib import Path

# what may change a number
MATTERS = ("numpy", "numba", "scipy", "opencv-python-headless", "scikit-image", "mahotas")


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


@cache
def code() -> str:
    """Eight letters that differ where the method's own code differs, whatever its version says."""
    folder = Path(__file__).resolve().parent.parent / "algorithms"
    digest = sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:8]


def _installed(name: str) -> str:
    try:
        return installed(name)
    except PackageNotFoundError:
        return "unknown"
