"""Which version of mapmeld, and of what it stands on, made a result."""

from __future__ import annotations

import ast
import platform
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed
from pathlib import Path

from app.system.data_paths import ALGORITHMS

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
def code(module: str = "") -> str:
    """Eight letters that differ where the method's own code differs, whatever its version says.

    module : of ``algorithms``; what it stands on counts, and no more. All of ``algorithms`` unless given
    """
    paths = {path.relative_to(ALGORITHMS.parent).as_posix() for path in ALGORITHMS.rglob("*.py")}
    if module:
        paths = _stands_on(module)
    digest = sha256()
    for path in sorted(paths):
        digest.update(path.encode() + b"\0" + (ALGORITHMS.parent / path).read_bytes())
    return digest.hexdigest()[:8]


def _stands_on(module: str) -> set[str]:
    """Files of a module of ours and of all that it imports, wherever in the file it does."""
    found: set[str] = set()
    left = [module]
    while left:
        name = left.pop()
        stem = Path(*name.split("."))
        path = next(
            (path for path in (stem.with_suffix(".py"), stem / "__init__.py")
             if (ALGORITHMS.parent / path).is_file()),
            None,
        )  # fmt: skip
        if path is None or path.as_posix() in found:  # a name in a module, or known
            continue
        found.add(path.as_posix())
        for node in ast.walk(ast.parse((ALGORITHMS.parent / path).read_bytes())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("algorithms"):
                left += [str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)]
            elif isinstance(node, ast.Import):
                left += [alias.name for alias in node.names if alias.name.startswith("algorithms")]
    return found


def _installed(name: str) -> str:
    try:
        return installed(name)
    except PackageNotFoundError:
        return "unknown"
