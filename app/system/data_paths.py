"""Files that ship with mapmeld: static/, sample_maps/ and those that a browser gets."""

from __future__ import annotations

from pathlib import Path

_APP = Path(__file__).resolve().parents[1]
ALGORITHMS = _APP.parent / "algorithms"


def _find(name: str) -> Path:
    """A folder beside the packages in a checkout, inside them in a wheel."""
    installed = _APP / f"_{name}"
    return installed if installed.is_dir() else _APP.parent / name


def static() -> Path:
    """Folder of the logo and of the README's pictures."""
    return _find("static")


def asset(name: str) -> str:
    """Text of a file of ``app/frontend/``: a script, a style, a page."""
    return (_APP / "frontend" / name).read_text(encoding="utf-8")


def sample_maps() -> Path:
    """Folder of the sample cases, a folder each."""
    return _find("sample_maps")


def samples() -> dict[str, Path]:
    """The sample cases by the name a person reads in the menu; empty where none are installed."""
    from algorithms.files.case_folder import FIRST_MAP_FILE  # it loads what reads maps

    return {path.parent.name: path.parent for path in sorted(sample_maps().glob(f"*/{FIRST_MAP_FILE}"))}


def pictures() -> dict[str, Path]:
    """Pictures that deceive, each with the sighting that was made of it, by the names of their folders."""
    from algorithms.files.case_folder import FIRST_MAP_FILE  # these load what reads maps
    from algorithms.files.encounter_table import ENCOUNTER_TABLE

    found = (path.parent for path in sorted(sample_maps().glob(f"*/{ENCOUNTER_TABLE}")))
    return {folder.name: folder for folder in found if not (folder / FIRST_MAP_FILE).exists()}


def fleets() -> dict[str, Path]:
    """The sample fleets by the name a person reads in the menu."""
    from algorithms.files.fleet_file import FLEET_FILE  # it loads what reads maps

    return {path.parent.name: path.parent for path in sorted(sample_maps().glob(f"*/{FLEET_FILE}"))}
