"""The lesson as one page to print: words, equations and pictures are made by what makes those of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from markdown_it import MarkdownIt

from app.drawing.palette import LIGHT
from app.page.lesson.checks.effects import missing
from app.page.lesson.equations import equations_html, symbols, with_symbols
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_display import NOT_HERE
from app.page.lesson.lesson_panel import emphasised
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.lesson_texts import StepText, filled, first_number, read_step
from app.page.lesson.placeholders import NUMBERS, numbers_of
from app.system.data_paths import asset
from app.system.version import version

_STYLE = asset("handout.css")
# what the file may fetch, said to the browser: nothing; its pictures are in it
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"


def numbered_steps(texts: Sequence[Path]) -> dict[int, StepText]:
    """The steps in these files by what they are counted as; raises InputFileError."""
    return {k: read_step(path, PICTURES, NUMBERS) for k, path in enumerate(texts, first_number(texts))}


def handout_page(lesson: LessonRun, steps: Mapping[int, StepText]) -> bytes:
    """An HTML page of these steps, on a lesson that is at its end."""
    numbers, told = numbers_of(lesson), lesson.inputs.names.told_in_html
    maps = escape(lesson.inputs.title or "two maps")
    parts = [
        *(_step(number, text, lesson, numbers) for number, text in steps.items()),
        _answers(steps, lesson, numbers),
        _symbols(),
    ]
    contents = "".join(
        f'<li value="{k}"><a href="#step{k}">{escape(text.title)}</a></li>' for k, text in steps.items()
    )
    html = (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        f"<title>How two maps become one: {maps}</title><style>{_STYLE}</style></head><body>"
        f"<header><h1>How two maps become one</h1><p>Every step of the method, worked out on {maps}.</p>"
        f"<ol>{contents}</ol></header>{told(''.join(parts))}"
        f"<footer>mapmeld {escape(version())}, seed {lesson.seed}</footer></body></html>"
    )
    return html.encode()


def _step(number: int, text: StepText, lesson: LessonRun, numbers: Mapping[str, str]) -> str:
    """Words, equations and picture of every part, then what to try."""
    parts = "".join(
        f'<div class="part"><div>{_words(filled(text.words(part), numbers))}'
        f"{equations_html(text.formulas(part))}</div>"
        f"<figure>{_picture(text.picture, lesson, part)}</figure></div>"
        for part in range(text.parts)
    )
    tries = "".join(
        f'<p class="try"><b>{number}.{k}</b> {emphasised(filled(trial.ask, numbers))}'
        f"{_button(trial.button)}</p>"
        for k, trial in enumerate(text.trials, 1)
    )
    notes = _missing(text, lesson, numbers)
    title = f"<h2><b>{number}</b> {escape(text.title)}</h2>"
    return f'<section id="step{number}">{title}{notes}{parts}{tries}{_question(text, numbers)}</section>'


def _question(text: StepText, numbers: Mapping[str, str]) -> str:
    """What is to be done on the page, which tells whether it was."""
    if text.check is None:
        return ""
    return f'<p class="check"><b>Check yourself</b> {emphasised(filled(text.check.ask, numbers))}</p>'


def _missing(text: StepText, lesson: LessonRun, numbers: Mapping[str, str]) -> str:
    """What these maps do not show of a step."""
    if text.effect is None or not missing(text.effect.test, lesson):
        return ""
    return f'<p class="missing">{emphasised(filled(text.effect.missing, numbers))}</p>'


def _button(name: str) -> str:
    return f" <span>On the page: <i>{with_symbols(escape(name))}</i></span>" if name else ""


def _picture(name: str, lesson: LessonRun, part: int, way: str = "") -> str:
    """A step's picture, its dials where they begin, or at a part of it; or drawn in another way."""
    picture = PICTURES.get(name)
    if picture is None:
        return ""
    if not lesson.reached(*picture.needs):
        return f"<figcaption>{NOT_HERE}</figcaption>"
    if way:
        return picture.ways[way].draw(lesson, picture.ways[way].places, LIGHT)
    start = tuple(dial.start for dial in picture.dials(lesson))
    return picture.draw(lesson, (part, *start[1:]) if part else start, LIGHT)


def _words(text: str) -> str:
    """HTML of Markdown; what looks like HTML in it stays words."""
    return with_symbols(str(MarkdownIt("commonmark", {"html": False}).render(text)))


def _answers(steps: Mapping[int, StepText], lesson: LessonRun, numbers: Mapping[str, str]) -> str:
    """What there is to be seen at each thing to try, with the picture where it is drawn in another way."""
    answers = "".join(
        f'<div class="part"><p><b>{number}.{k}</b> {emphasised(filled(trial.answer, numbers))}</p>'
        + (f"<figure>{_picture(text.picture, lesson, 0, trial.show)}</figure>" if trial.show else "")
        + "</div>"
        for number, text in steps.items()
        for k, trial in enumerate(text.trials, 1)
    )
    return f'<section class="answers"><h2>Answers</h2>{answers}</section>'


def _symbols() -> str:
    rows = "".join(f"<div><dt>{symbol.html}</dt><dd>{symbol.means_html}</dd></div>" for symbol in symbols())
    return f'<section class="symbols"><h2>Symbols</h2><dl>{rows}</dl></section>'
