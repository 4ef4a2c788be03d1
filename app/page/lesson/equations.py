"""The equations of the lesson: LaTeX in static/equations/NAME.tex, typeset once into NAME.svg."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from html import escape
from pathlib import Path

from algorithms.common.errors import InputFileError
from app.system import data_paths as paths


@dataclass(frozen=True)
class Equation:
    """What a .tex file holds.

    number : what stands beside it: "(4)" of the paper, or where it comes from; the first line, after a %
    latex  : the rest, without dollars
    """

    name: str
    number: str
    latex: str

    @property
    def digest(self) -> str:
        """Of the LaTeX; the SVG that was made from it carries the same."""
        return sha256(self.latex.encode()).hexdigest()[:16]


def folder() -> Path:
    """Where the equations are."""
    return paths.static() / "equations"


def names() -> list[str]:
    """Of all equations there are."""
    return sorted(path.stem for path in folder().glob("*.tex"))


def read_equation(path: Path) -> Equation:
    """Read a .tex file; raises InputFileError where its first line is no number."""
    first, _, rest = path.read_text(encoding="utf-8").partition("\n")
    if not first.startswith("%") or not rest.strip():
        raise InputFileError(path, "does not begin with a line like % (4)", "add it, then the LaTeX below it")
    return Equation(path.stem, first[1:].strip(), rest.strip())


@cache
def _drawn(name: str) -> tuple[str, str]:
    """Its SVG and its number."""
    source = folder() / f"{name}.tex"
    return source.with_suffix(".svg").read_text(encoding="utf-8").strip(), read_equation(source).number


def equations_html(chosen: Iterable[str]) -> str:
    """HTML of equations one below the other, each with its number at the right."""
    return "".join(
        f'<div class="mm-eq" data-equation="{escape(name)}"><span>{drawn}</span>'
        f"<small>{escape(number)}</small></div>"
        for name in chosen
        for drawn, number in [_drawn(name)]
    )
