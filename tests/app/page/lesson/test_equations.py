"""The equations of the lesson: typeset and up to date, and each of their symbols told, in one meaning."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from algorithms.common.errors import InputFileError
from algorithms.methods.spectra_config import PipelineConfig
from app.model.settings import settings_of
from app.page.lesson import equations
from app.page.lesson.equations import symbols, symbols_in
from app.page.lesson.lesson_texts import files, lesson_folder
from app.page.lesson.museum.exhibit_texts import museum_folder

LAYOUT = re.compile(
    r"\\text\{[^}]*\}|\\(?:begin|end)\{[a-z]+\}|\\mathrm\{arg\}"
    r"|\\(?:t?frac|left|right|q?quad|sum|prod|max|exp|cos|sin|arctan|bmod|pi|nabla|angle|top|pm|times|cdot|[cl]dots"
    r"|in|leq|propto|leftarrow)(?![A-Za-z])"
)
"""What is written in every equation alike, and means what it means everywhere."""


def latex(name: str) -> str:
    return equations.read_equation(equations.folder() / f"{name}.tex").latex


@pytest.mark.parametrize("name", equations.names())
def test_every_symbol_of_an_equation_is_in_the_table(name):
    found, rest = symbols_in(latex(name))
    assert found
    assert re.findall(r"\\?[A-Za-z]+", LAYOUT.sub(" ", rest)) == []


def test_a_symbol_has_one_meaning_and_stands_in_an_equation_or_in_words():
    forms = [form for symbol in symbols() for form in symbol.latex]
    names = [name for symbol in symbols() for name in names_of(symbol)]
    assert sorted(forms) == sorted(set(forms))
    assert sorted(names) == sorted(set(names))
    used = {symbol for name in equations.names() for symbol in symbols_in(latex(name))[0]}
    assert {symbol.name for symbol in symbols() if symbol.latex and symbol not in used} == set()


def names_of(symbol) -> list[str]:
    return re.split(r", (?=\D)", symbol.name)


def test_sliders_and_texts_write_the_symbols_of_the_table():
    told = {name for symbol in symbols() for name in names_of(symbol)}
    on_sliders = {setting.bounds.symbol for setting in settings_of(PipelineConfig()) if setting.bounds}
    assert on_sliders - {""} <= told
    texts = [
        path.read_text(encoding="utf-8")
        for folder in (lesson_folder(), museum_folder())
        for path in files(folder)
    ]
    words = re.sub(
        r"\{[^}]*\}|[a-z]\w*\.\w+|\b\w+_r\d_\w+|\b\w+_fleet_\w+|case: .*|picture: .*", " ", " ".join(texts)
    )
    assert {word.rstrip("²") for word in re.findall(r"\w+_\w+", words)} <= told


def test_what_its_symbols_mean_stands_below_an_equation():
    page = equations.symbols_html(["gaussian", "augmented"])
    assert "<dt>Σ<sub>aug</sub></dt><dd>covariance of the levels" in page
    assert page.count("<dt>") == len(
        {s for name in ("gaussian", "augmented") for s in symbols_in(latex(name))[0]}
    )
    assert equations.symbols_html([]) == ""


@pytest.mark.parametrize("name", equations.names())
def test_every_equation_is_typeset_from_its_newest_source(name):
    source = equations.folder() / f"{name}.tex"
    drawn = source.with_suffix(".svg").read_text(encoding="utf-8")
    made_from = ElementTree.fromstring(drawn).attrib["data-source"]
    assert made_from == equations.read_equation(source).digest, "run make equations"


def test_no_typeset_equation_has_lost_its_source():
    assert sorted(path.stem for path in equations.folder().glob("*.svg")) == equations.names()


@pytest.mark.parametrize("name", equations.names())
def test_an_equation_takes_the_colour_and_the_size_of_the_words_around_it(name):
    drawn = ElementTree.parse(equations.folder() / f"{name}.svg").getroot()
    colours = {e.attrib[k] for e in drawn.iter() for k in ("fill", "stroke") if k in e.attrib}
    assert colours <= {"currentColor", "none"}
    assert drawn.attrib["width"].endswith("em")
    assert not [e for e in drawn.iter() if "id" in e.attrib]  # they would clash on a page


def test_an_equation_stands_with_its_number():
    page = equations.equations_html(["gaussian", "augmented"])
    assert re.findall(r"<small>(.*?)</small>", page) == ["(4)", "(5)"]


def test_an_equation_without_a_number_is_told(tmp_path):
    path = tmp_path / "mine.tex"
    path.write_text("x = y\n")
    with pytest.raises(InputFileError, match=r"mine\.tex: .*% \(4\)"):
        equations.read_equation(path)


RAW = re.compile(r"[^\W\d]\w*[_^]\w|\w[_^][^\W\d]")  # σ_aug, M^a, T_1,2


def test_the_table_of_symbols_shows_no_raw_index_in_a_name_or_in_what_it_means():
    for symbol in symbols():
        assert not RAW.search(symbol.html + " " + symbol.means_html)
    transform = next(symbol for symbol in symbols() if symbol.name == "T")
    assert "T<sub>1,2</sub> takes robot 2" in transform.means_html
    augmented = next(symbol for symbol in symbols() if symbol.name == "M^aug")
    assert "M<sup>a</sup>, too" in augmented.means_html


def test_symbols_in_words_are_set_with_their_indices_and_names_of_samples_are_left():
    said = equations.with_symbols("I_aug and Σ_aug on corridor_r2_r1, then σ_aug².")
    assert said == "I<sub>aug</sub> and Σ<sub>aug</sub> on corridor_r2_r1, then σ<sub>aug</sub>²."
