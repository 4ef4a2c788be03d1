"""The equations of the lesson: LaTeX in static/equations/NAME.tex, typeset once into NAME.svg; and what their
symbols mean, a table in static/equations/symbols.md.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from html import escape
from pathlib import Path

from algorithms.common.errors import InputFileError
from app.system import data_paths as paths

ROW = re.compile(r"^\| (?P<name>[^|]+?) \| *(?P<latex>[^|]*?) *\| (?P<means>[^|]+?) \|$", flags=re.M)
INDEX = r"_(?:[0-9ijkn]|\{[\d,]+\})"  # what _# stands for in the table


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


@dataclass(frozen=True)
class Symbol:
    """A row of the table.

    name  : as it is written in a text, an index after _, an exponent after ^; several with commas
    latex : as it is written in an equation; _# is any index of one sign, or of numbers
    """

    name: str
    latex: tuple[str, ...]
    means: str

    @property
    def html(self) -> str:
        return re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", _indexed(escape(self.name)))

    @property
    def means_html(self) -> str:
        """What it means, with the symbols in it set as in the equations."""
        return _indexed(escape(self.means))


def _indexed(html: str) -> str:
    """Words with what stands behind _ below the line, and what stands behind ^ above it."""
    return re.sub(r"([_^])(\w+(?:,\w+)?)", lambda at: _raised(at[1], at[2]), html)


def _raised(sign: str, words: str) -> str:
    kind = "sub" if sign == "_" else "sup"
    return f"<{kind}>{words}</{kind}>"


@cache
def symbols() -> tuple[Symbol, ...]:
    """All of the table."""
    rows = ROW.finditer((folder() / "symbols.md").read_text(encoding="utf-8"))
    read = [Symbol(row["name"], tuple(re.findall("`(.+?)`", row["latex"])), row["means"]) for row in rows]
    return tuple(read[1:])  # the first row is the heading


@cache
def _written() -> tuple[re.Pattern[str], dict[str, str]]:
    """What finds the symbols of the table that have an index or an exponent, and how each is set."""
    names = {
        name: _indexed(name)
        for symbol in symbols()
        for name in re.split(r", (?=\D)", symbol.name)
        if re.search("[_^]", name) and "*" not in name
    }
    either = "|".join(re.escape(name) for name in sorted(names, key=len, reverse=True))
    return re.compile(rf"(?<![\w{{])(?:{either})(?!(?!²)[\w}}])"), names


def with_symbols(html: str) -> str:
    """Words in which the symbols of the table are set as in the equations: σ_aug with its index below."""
    pattern, names = _written()
    return pattern.sub(lambda found: names[found[0]], html)


@cache
def _patterns() -> list[tuple[re.Pattern[str], Symbol]]:
    """What finds each form, the longest first: M_H before M."""
    forms = [(form, symbol) for symbol in symbols() for form in symbol.latex]
    forms.sort(key=lambda each: -len(each[0].replace("#", "")))
    return [(re.compile(_pattern(form)), symbol) for form, symbol in forms]


def _pattern(form: str) -> str:
    """It begins and ends where a form does, not within a command or before another index."""
    begins = "" if form.startswith("\\") else r"(?<![A-Za-z\\])"
    return begins + re.escape(form).replace(r"_\#", INDEX) + r"(?![A-Za-z_])"


def symbols_in(latex: str) -> tuple[list[Symbol], str]:
    """The symbols of an equation in the order of the table, and what of its LaTeX is none of them."""
    rest, found = re.sub(r"([_^])\{(\w|\*)\}", r"\1\2", latex), set()
    for pattern, symbol in _patterns():
        rest, count = pattern.subn(" ", rest)
        if count:
            found.add(symbol)
    return [symbol for symbol in symbols() if symbol in found], rest


def symbols_html(chosen: Iterable[str]) -> str:
    """HTML of what the symbols of these equations mean, to be opened; empty where there is no equation."""
    sources = [read_equation(folder() / f"{name}.tex").latex for name in chosen]
    found = {symbol for latex in sources for symbol in symbols_in(latex)[0]}
    rows = "".join(
        f"<dt>{symbol.html}</dt><dd>{symbol.means_html}</dd>" for symbol in symbols() if symbol in found
    )
    if not rows:
        return ""
    head = '<details class="mm-symbols"><summary>What the symbols mean</summary>'
    return f"{head}<dl>{rows}</dl></details>"
