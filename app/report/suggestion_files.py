"""The answers to choose from after a refusal, as files: suggestions.json and a picture of each."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.maps.grid_map import GridMap
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.suggestions import MOST, Suggestion, suggestions_of
from algorithms.verdict.probability_model import OTHERS, QUANTITIES
from app.drawing.palette import LIGHT
from app.drawing.png import png_bytes
from app.drawing.svg.thumbnail import thumbnail
from app.report import suggestion_text as words

SUGGESTIONS_FILE = "suggestions.json"
PICTURE_SIZE = 800, 600  # pixels
HEAD = ("", "likely", "map 2 in map 1", "agrees on", "against it")


def picture_file(number: int) -> str:
    """Name of the picture of a suggestion, by its number from 1 on."""
    return f"suggestion_{number}.png"


SUGGESTION_FILES = (SUGGESTIONS_FILE, *(picture_file(number) for number in range(1, MOST + 1)))


def suggestion_files(
    result: MergeResult, ref: GridMap, mov: GridMap, names: RobotNames = UNNAMED
) -> dict[str, bytes]:
    """All of these files by name; the pictures come first."""
    choices = suggestions_of(result)
    files = {
        picture_file(each.number): png_bytes(thumbnail(ref, mov, each.T_ref_mov, LIGHT, PICTURE_SIZE))
        for each in choices
    }
    plain = [_plain(each, names) for each in choices]
    files[SUGGESTIONS_FILE] = (json.dumps(plain, ensure_ascii=False, indent=2) + "\n").encode()
    return files


def suggestion_rows(choices: Sequence[Suggestion]) -> list[list[str]]:
    """A row of cells each, under ``HEAD``."""
    return [
        [
            str(each.number),
            words.likely(each),
            words.place(each),
            words.speaks_for(each),
            words.speaks_against(each),
        ]
        for each in choices
    ]


def _plain(suggestion: Suggestion, names: RobotNames) -> dict[str, object]:
    """As JSON holds it; metres, radians."""
    seen = suggestion.weighed.evidence
    titles = {OTHERS: "other answers"} | {name: quantity.title for name, quantity in QUANTITIES.items()}
    return {
        "number": suggestion.number,
        "T_ref_mov": asdict(suggestion.T_ref_mov),
        "probability": suggestion.probability,
        "agreeing_wall_m": seen.shared_wall * (1 - seen.contradiction),
        "shared_wall_m": seen.shared_wall,
        "shared_floor_m2": seen.floor,
        "against": [names.told(titles[name]) for name in suggestion.against],
        "contributions": dict(suggestion.contributions),
        "picture": picture_file(suggestion.number),
    }
