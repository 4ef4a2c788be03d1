"""The texts of the lesson and of the museum: one Markdown file each, with a front matter in YAML.

A teacher rewrites, reorders, adds or translates them without touching code: the order is that of the file
names. What is wrong with a file is reported with its name; the files beside it are shown all the same.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from algorithms.common.errors import InputFileError, MapMergeError, unreadable
from algorithms.files.yaml_fields import Fields, parse, positive_number, shown
from algorithms.methods.registry import METHODS
from algorithms.methods.spectra_config import PipelineConfig
from app.model.knowledge import Choice
from app.model.settings import Path as SettingPath
from app.model.settings import Setting, settings_of, what_became_of, with_value
from app.page.lesson import equations
from app.system import data_paths as paths

Settings = tuple[tuple[SettingPath, Any], ...]

KNOWN: tuple[Choice, ...] = ("sighting", "nothing")  # in an exhibit

EXHIBIT = "title", "case", "rough", "sighting", "method", "settings", "known", "cure", "why", "cured"
FENCE = "---"
PLACEHOLDER = re.compile(r"\{([A-Za-z_][A-Za-z_0-9]*)\}")
EXAMPLE = "begin the file with a line ---, then title: …, then a line ---, then the text"


@dataclass(frozen=True)
class Exercise:
    """One thing to try, and what there is to be seen then, and why; shown when asked for.

    button   : what the button that does it is called; empty where hands and eyes do
    settings : what the button sets
    """

    ask: str
    answer: str
    button: str = ""
    settings: Settings = ()


@dataclass(frozen=True)
class StepText:
    """One step of the lesson. ``picture`` is a name of ``figure_registry``, or empty."""

    source: str
    title: str
    picture: str
    equations: tuple[str, ...]
    trials: tuple[Exercise, ...]
    body: str


@dataclass(frozen=True)
class Exhibit:
    """One failure of the museum: what to load, how it fails, and what cures it.

    case, rough  : name of a sample, and whether its badly measured sighting is taken
    sighting     : number from 1, where the sample is a fleet: its pair is merged by that alone, and the cure
                   merges the fleet; 0 where it is a pair
    method, settings, known : it fails with; of what is known that is used
    cure_method, cure_settings, cure_known : it merges with
    why, cured   : what happened, and why the cure helps; Markdown
    """

    source: str
    title: str
    case: str
    rough: bool
    sighting: int
    method: str
    settings: Settings
    known: Choice
    cure: str
    cure_method: str
    cure_settings: Settings
    cure_known: Choice
    body: str
    why: str
    cured: str


def lesson_folder(language: str = "en") -> Path:
    """Where the lesson that comes along is."""
    return paths.static() / "lesson" / language


def museum_folder(language: str = "en") -> Path:
    """Where the museum that comes along is."""
    return paths.static() / "museum" / language


def files(folder: Path) -> list[Path]:
    """The texts of a folder in their order; raises InputFileError where there is none."""
    remedy = "give a folder of Markdown files like 01-name.md"
    try:
        found = sorted(path for path in Path(folder).iterdir() if path.suffix == ".md")
    except OSError as error:
        raise unreadable(folder, error, remedy) from error
    if not found:
        raise InputFileError(folder, "holds no text", remedy)
    return found


def read_step(path: Path, pictures: Collection[str], numbers: Collection[str]) -> StepText:
    """Read a step of the lesson; raises InputFileError that names the file, the finding and the remedy.

    pictures, numbers : names of the pictures and of the placeholders that there are
    """
    fields, body = _parts(path)
    fields.refuse_unknown("title", "picture", "equations", "try")
    picture = fields.text("picture", "name a picture, or leave it out") if "picture" in fields.values else ""
    if picture and picture not in pictures:
        raise fields.error("picture", f"is {shown(picture)}", f"known are {', '.join(sorted(pictures))}")
    named, known = _list(fields, "equations", "give a list of names, or leave it out"), equations.names()
    for name in named:
        if name not in known:
            raise fields.error("equations", f"holds {shown(name)}", f"known are {', '.join(known)}")
    title = fields.text("title", "give the step a title")
    trials = tuple(_trial(fields, k, entry) for k, entry in enumerate(_list(fields, "try", "give a list"), 1))
    for text in (body, *(words for trial in trials for words in (trial.ask, trial.answer))):
        for found in PLACEHOLDER.findall(text):
            if found not in numbers:
                wrong = f"holds {{{found}}}, which is no number of the lesson"
                raise InputFileError(path, wrong, f"known are {', '.join(numbers)}")
    return StepText(str(path), title, picture, tuple(named), trials, body)


def read_exhibit(path: Path) -> Exhibit:
    """Read an exhibit of the museum; raises InputFileError as ``read_step`` does."""
    fields, body = _parts(path)
    fields.refuse_unknown(*EXHIBIT)
    case = fields.text("case", "name a sample")
    sighting = int(positive_number(fields, "sighting", "the number of a sighting", 0.0))
    samples = paths.fleets() if sighting else paths.samples()
    if case not in samples:
        raise fields.error("case", f"is {shown(case)}", f"known are {', '.join(samples)}")
    cure = fields.section("cure", "give {button: …, method: …, settings: {…}, known: …}")
    cure.refuse_unknown("button", "method", "settings", "known")
    method = _method(fields)
    cure_method = _method(cure) if "method" in cure.values else method
    known = _known(fields, "sighting", method)
    return Exhibit(
        source=str(path),
        title=fields.text("title", "give the exhibit a title"),
        case=case,
        rough=fields.flag("rough", "give true or false") if "rough" in fields.values else False,
        sighting=sighting,
        method=method,
        settings=_settings(fields, METHODS[method].defaults),
        known=known,
        cure=cure.text("button", "say in a few words what the cure does"),
        cure_method=cure_method,
        cure_settings=_settings(cure, METHODS[cure_method].defaults),
        cure_known=_known(cure, known, cure_method),
        body=body,
        why=fields.text("why", "say what happened, and why"),
        cured=fields.text("cured", "say why the cure helps"),
    )


def with_settings(config: Any, settings: Settings) -> Any:
    """A copy of a config with these settings; those of other methods are passed over."""
    known = {setting.path for setting in settings_of(config)}
    for path, value in settings:
        if path in known:
            config = with_value(config, path, value)
    return config


def filled(text: str, numbers: Mapping[str, str]) -> str:
    """A text with its placeholders filled in; a number that is not known yet is an ellipsis."""
    return PLACEHOLDER.sub(lambda found: numbers.get(found[1], "…"), text)


def _parts(path: Path) -> tuple[Fields, str]:
    """Front matter and text of a file."""
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise unreadable(path, error, "save it as UTF-8 text") from error
    ends = [k for k, line in enumerate(lines) if line.strip() == FENCE]
    if len(ends) < 2 or ends[0] != 0:
        raise InputFileError(path, "has no front matter", EXAMPLE)
    front, text = "\n".join(lines[1 : ends[1]]), "\n".join(lines[ends[1] + 1 :]).strip()
    if not text:
        raise InputFileError(path, "has no text below its front matter", EXAMPLE)
    return parse(str(path), front.encode(), "the front matter of a text"), text


def _list(fields: Fields, key: str, remedy: str) -> list[Any]:
    value = fields.values.get(key, [])
    if not isinstance(value, list):
        raise fields.error(key, f"is {shown(value)}, not a list", remedy)
    return value


def _trial(fields: Fields, index: int, entry: Any) -> Exercise:
    if not isinstance(entry, dict):
        raise fields.error("try", f"holds {shown(entry)}", "give {ask: …, answer: …} per thing to try")
    own = Fields(fields.source, entry, f"try {index}: ")
    own.refuse_unknown("ask", "answer", "button", "set")
    settings = _settings(own, PipelineConfig(), "set") if "set" in entry else ()
    button = own.text("button", "say what the button is called") if "button" in entry else ""
    if bool(button) != bool(settings):
        raise own.error("button and set", "are not both there", "give both of them, or neither")
    ask, answer = own.text("ask", "say what to try"), own.text("answer", "say what is to be seen")
    return Exercise(ask, answer, button, settings)


def _method(fields: Fields) -> str:
    method = fields.text("method", "name a method")
    if method not in METHODS:
        raise fields.error("method", f"is {shown(method)}", f"known are {', '.join(METHODS)}")
    return method


def _known(fields: Fields, usual: Choice, method: str) -> Choice:
    """What is used of what is known; samples have sightings and nothing else."""
    remedy = f"known are {', '.join(KNOWN)}"
    word = fields.text("known", remedy) if "known" in fields.values else usual
    choice = next((one for one in KNOWN if one == word), None)
    if choice is None:
        raise fields.error("known", f"is {shown(word)}", remedy)
    if choice == "nothing" and METHODS[method].needs_sighting:
        raise fields.error("known", "is nothing", f"the method {method} needs a sighting")
    return choice


def _settings(fields: Fields, config: Any, key: str = "settings") -> Settings:
    if key not in fields.values:
        return ()
    section = fields.section(key, "give a mapping like {augment.intensity: 1}")
    known = {".".join(setting.path): setting for setting in settings_of(config)}
    for name in section.values:
        if became := what_became_of(name):
            raise section.error(name, "is no setting any more", became)
    section.refuse_unknown(*known)
    settings = tuple((known[name].path, _value(section, name, known[name])) for name in section.values)
    for name, (path, value) in zip(section.values, settings, strict=True):
        try:
            with_value(config, path, value)
        except MapMergeError as error:
            raise section.error(name, f"is {shown(section.values[name])}", str(error)) from error
    return settings


def _value(section: Fields, name: str, setting: Setting) -> Any:
    if setting.bounds is not None:
        number = section.number(name, f"give a number in [{setting.bounds.low:g}, {setting.bounds.high:g}]")
        return int(number) if setting.whole else number
    if setting.choices is not None:
        remedy = f"give one of {', '.join(setting.choices)}"
        word = section.text(name, remedy)
        for shown_as, option in setting.choices.items():
            if word.lower() == shown_as.lower():
                return option
        raise section.error(name, f"is {shown(word)}", remedy)
    return section.flag(name, "give true or false")
