"""The texts of the lesson: one Markdown file a step, with a front matter in YAML.

A teacher rewrites, reorders, adds or translates them without touching code: the order is that of the file
names. What is wrong with a file is reported with its name; the files beside it are shown all the same.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Protocol

from algorithms.common.errors import InputFileError, MapMergeError, unreadable
from algorithms.files.yaml_fields import Fields, parse, shown
from algorithms.methods.spectra_config import PipelineConfig
from app.model.settings import Path as SettingPath
from app.model.settings import Setting, settings_of, what_became_of, with_value
from app.page.lesson import equations
from app.page.lesson.checks.effects import EFFECTS
from app.page.lesson.checks.step_checks import CHECKS
from app.system import data_paths as paths

Settings = tuple[tuple[SettingPath, Any], ...]

FENCE = "---"
PLACEHOLDER = re.compile(r"\{([A-Za-z_][A-Za-z_0-9]*)\}")
PART = re.compile(r"^\*\*\*\s*$", flags=re.M)  # between the parts of a text
EXAMPLE = "begin the file with a line ---, then title: …, then a line ---, then the text"


class Picture(Protocol):
    """What a text has to know of a picture: the names of other ways in which it can be drawn."""

    @property
    def ways(self) -> Collection[str]: ...


@dataclass(frozen=True)
class Exercise:
    """One thing to try, and what there is to be seen then, and why; shown when asked for.

    button   : what the button that does it is called; empty where hands and eyes do
    settings : what the button sets
    show     : the other way in which it has the picture drawn; empty where it sets something
    """

    ask: str
    answer: str
    button: str = ""
    settings: Settings = ()
    show: str = ""


@dataclass(frozen=True)
class Question:
    """What a student is asked to do; ``test``, of ``step_checks.CHECKS``, tells whether it was done."""

    ask: str
    test: str


@dataclass(frozen=True)
class Effect:
    """What a step shows, if the maps do.

    test    : of ``effects.EFFECTS``, tells whether they do
    missing : what is said where they do not
    sample  : one that does
    """

    test: str
    missing: str
    sample: str


@dataclass(frozen=True)
class StepText:
    """One step of the lesson.

    picture   : a name of ``figure_registry``, or empty
    equations : those beside each part of the picture; one group where it has no parts
    body      : Markdown; a line of three asterisks between the words for each part
    notes     : for who teaches it; empty for none
    check     : a question that is answered by doing; None: the step has none
    effect    : what maps have to show; None: all do
    """

    source: str
    title: str
    picture: str
    equations: tuple[tuple[str, ...], ...]
    trials: tuple[Exercise, ...]
    body: str
    notes: str = ""
    check: Question | None = None
    effect: Effect | None = None

    @property
    def parts(self) -> int:
        """How many parts of the picture have words of their own; at least 1."""
        return len(PART.split(self.body))

    def words(self, part: int) -> str:
        """What stands beside a part of the picture, from 0."""
        words = PART.split(self.body)
        return words[min(part, len(words) - 1)]

    def formulas(self, part: int) -> tuple[str, ...]:
        """Names of the equations beside a part of the picture, from 0."""
        return self.equations[min(part, len(self.equations) - 1)] if self.equations else ()


def lesson_folder(language: str = "en") -> Path:
    """Where the lesson that comes along is."""
    return paths.static() / "lesson" / language


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


def first_number(found: Sequence[Path]) -> int:
    """What the first of these texts is counted as: 0 where its name begins with 00."""
    return 0 if found[0].name.startswith("00") else 1


def read_step(path: Path, pictures: Mapping[str, Picture], numbers: Collection[str]) -> StepText:
    """Read a step of the lesson; raises InputFileError that names the file, the finding and the remedy.

    pictures, numbers : the pictures by their names, and the names of the placeholders that there are
    """
    fields, body = parts_of(path)
    fields.refuse_unknown("title", "picture", "equations", "try", "check", "effect", "notes")
    picture = fields.text("picture", "name a picture, or leave it out") if "picture" in fields.values else ""
    if picture and picture not in pictures:
        raise fields.error("picture", f"is {shown(picture)}", f"known are {', '.join(sorted(pictures))}")
    groups, known = _list(fields, "equations", "give a list of names, or leave it out"), equations.names()
    if not any(isinstance(group, list) for group in groups):
        groups = [groups] if groups else []
    for name in (name for group in groups for name in (group if isinstance(group, list) else [group])):
        if name not in known:
            raise fields.error("equations", f"holds {shown(name)}", f"known are {', '.join(known)}")
    title = fields.text("title", "give the step a title")
    ways = pictures[picture].ways if picture else ()
    notes = fields.text("notes", "say what a teacher should know") if "notes" in fields.values else ""
    entries = enumerate(_list(fields, "try", "give a list"), 1)
    trials = tuple(_trial(fields, k, entry, ways) for k, entry in entries)
    check = _question(fields) if "check" in fields.values else None
    effect = _effect(fields) if "effect" in fields.values else None
    told = [notes, check.ask if check else "", effect.missing if effect else ""]
    for text in (body, *told, *(words for trial in trials for words in (trial.ask, trial.answer))):
        for found in PLACEHOLDER.findall(text):
            if found not in numbers:
                wrong = f"holds {{{found}}}, which is no number of the lesson"
                near = get_close_matches(found, list(numbers), n=5, cutoff=0.0)
                raise InputFileError(path, wrong, f"nearest are {', '.join(near)}")
    grouped = tuple(tuple(group) if isinstance(group, list) else (group,) for group in groups)
    return StepText(str(path), title, picture, grouped, trials, body, notes, check, effect)


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


def parts_of(path: Path) -> tuple[Fields, str]:
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


def _question(fields: Fields) -> Question:
    own = fields.section("check", "give {ask: …, test: …}")
    own.refuse_unknown("ask", "test")
    return Question(own.text("ask", "say what to do"), _test(own, CHECKS))


def _effect(fields: Fields) -> Effect:
    own = fields.section("effect", "give {test: …, missing: …, sample: …}")
    own.refuse_unknown("test", "missing", "sample")
    missing = own.text("missing", "say what the maps do not show")
    return Effect(_test(own, EFFECTS), missing, own.text("sample", "name a sample that shows it"))


def _test(fields: Fields, known: Collection[str]) -> str:
    test, remedy = fields.text("test", "name a test"), f"known are {', '.join(known)}"
    if test not in known:
        raise fields.error("test", f"is {shown(test)}", remedy)
    return test


def _trial(fields: Fields, index: int, entry: Any, ways: Collection[str]) -> Exercise:
    if not isinstance(entry, dict):
        raise fields.error("try", f"holds {shown(entry)}", "give {ask: …, answer: …} per thing to try")
    own = Fields(fields.source, entry, f"try {index}: ")
    own.refuse_unknown("ask", "answer", "button", "set", "show")
    settings = settings_in(own, PipelineConfig(), "set") if "set" in entry else ()
    button = own.text("button", "say what the button is called") if "button" in entry else ""
    show = own.text("show", "name a way to draw the picture") if "show" in entry else ""
    if show and show not in ways:
        remedy = f"known are {', '.join(ways)}" if ways else "this picture is drawn in one way only"
        raise own.error("show", f"is {shown(show)}", remedy)
    if show and settings:
        raise own.error("set and show", "are both there", "give one of them")
    if bool(button) != bool(settings or show):
        remedy = "give both of them, or neither; with show in place of set"
        raise own.error("button and set", "are not both there", remedy)
    ask, answer = own.text("ask", "say what to try"), own.text("answer", "say what is to be seen")
    return Exercise(ask, answer, button, settings, show)


def settings_in(fields: Fields, config: Any, key: str = "settings") -> Settings:
    """What a text sets, of a method that has this config."""
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
