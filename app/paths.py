"""Where static/ and sample_maps/ are: beside the packages in a checkout, inside them in a wheel."""

from __future__ import annotations

from pathlib import Path

from algorithms.files.case_folder import FIRST_MAP_FILE

_APP = Path(__file__).resolve().parent


def _find(name: str) -> Path:
    installed = _APP / f"_{name}"
    return installed if installed.is_dir() else _APP.parent / name


def static() -> Path:
    """Folder of the logo and of the README's pictures."""
    return _find("static")


def sample_maps() -> Path:
    """Folder of the sample cases, a folder each."""
    return _find("sample_maps")


def samples() -> dict[str, Path]:
    """The sample cases by the name a person reads in the menu; empty where none are installed."""
    root = sample_maps()
    if not root.is_dir():
        return {}
    return {path.parent.name: path.parent for path in sorted(root.glob(f"*/{FIRST_MAP_FILE}"))}
