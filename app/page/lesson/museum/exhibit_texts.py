"""The texts of the museum: one Markdown file an exhibit, with a front matter in YAML."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from algorithms.files.yaml_fields import Fields, positive_number, shown
from algorithms.methods.registry import METHODS
from app.model.knowledge import Choice
from app.page.lesson.lesson_texts import Settings, parts_of, settings_in
from app.system import data_paths as paths

KNOWN: tuple[Choice, ...] = ("sighting", "nothing")
EXHIBIT = (
    "title",
    "case",
    "rough",
    "sighting",
    "picture",
    "method",
    "settings",
    "known",
    "cure",
    "why",
    "cured",
)


@dataclass(frozen=True)
class Exhibit:
    """One failure of the museum: what to load, how it fails, and what cures it.

    case, rough  : name of a sample, and whether its badly measured sighting is taken
    sighting     : number from 1, where the sample is a fleet: its pair is merged by that alone, and the cure
                   merges the fleet; 0 where it is a pair
    picture      : name of a picture with a sighting that was made of it: that one is merged by, and no other;
                   empty where it is the sample's own
    method, settings, known : it fails with; of what is known that is used
    cure_method, cure_settings, cure_known : it merges with
    why, cured   : what happened, and why the cure helps; Markdown
    """

    source: str
    title: str
    case: str
    rough: bool
    sighting: int
    picture: str
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


def museum_folder(language: str = "en") -> Path:
    """Where the museum that comes along is."""
    return paths.static() / "museum" / language


def read_exhibit(path: Path) -> Exhibit:
    """Read an exhibit of the museum; raises InputFileError as ``read_step`` does."""
    fields, body = parts_of(path)
    fields.refuse_unknown(*EXHIBIT)
    case = fields.text("case", "name a sample")
    sighting = int(positive_number(fields, "sighting", "the number of a sighting", 0.0))
    samples = paths.fleets() if sighting else paths.samples()
    if case not in samples:
        raise fields.error("case", f"is {shown(case)}", f"known are {', '.join(samples)}")
    picture = fields.text("picture", "name a picture") if "picture" in fields.values else ""
    if picture and picture not in paths.pictures():
        raise fields.error("picture", f"is {shown(picture)}", f"known are {', '.join(paths.pictures())}")
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
        picture=picture,
        method=method,
        settings=settings_in(fields, METHODS[method].defaults),
        known=known,
        cure=cure.text("button", "say in a few words what the cure does"),
        cure_method=cure_method,
        cure_settings=settings_in(cure, METHODS[cure_method].defaults),
        cure_known=_known(cure, known, cure_method),
        body=body,
        why=fields.text("why", "say what happened, and why"),
        cured=fields.text("cured", "say why the cure helps"),
    )


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
