"""Whether the packages named ``app`` and ``algorithms`` are mapmeld's own: others bear these names, too."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

CURE = "install mapmeld in an environment of its own (venv or pipx)"
_HERE = Path(__file__).resolve().parents[1]  # the folder that mapmeld, app and algorithms were installed in


def intruder(*names: str) -> str:
    """What is wrong, and the cure, where a package of ours is not the one that would be imported; else "".

    Asked before anything of it runs: whoever's it is, it is only looked for.
    """
    for name in names:
        spec = find_spec(name)
        if spec is None:
            return f"its package {name!r} is missing; {CURE}"
        folders = spec.submodule_search_locations or []  # none: a module of that name
        if [Path(folder).resolve() for folder in folders] != [_HERE / name]:
            where = spec.origin or ", ".join(folders)
            return f"another package named {name!r} ({where}) stands in its place; {CURE}"
    return ""
