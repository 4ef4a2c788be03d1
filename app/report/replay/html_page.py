"""A recording and its player in one HTML file that asks nothing of anybody."""

from __future__ import annotations

import json
import re
from html import escape
from typing import Any

from app.drawing.palette import DARK, LIGHT
from app.report.replay.metadata import ReplayMetadata
from app.report.replay.recorder import Recording
from app.system.data_paths import asset


def replay_html(recording: Recording, about: ReplayMetadata) -> bytes:
    """The page; equal runs give equal bytes. Every text in it is data, never markup."""
    data = recording | {
        "name": about.inputs.name,
        "method": about.method_title,
        "seed": about.seed,
        "version": about.versions.get("mapmeld", "unknown"),
        "facts": about.facts(),
        "settings": about.settings(),
        "notes": about.notes(),
        "dark": recolouring(),
    }
    parts = {
        "{{title}}": escape(f"{about.inputs.name}: replay of a merge"),
        "/*{{style}}*/": asset("replay/player.css"),
        "/*{{ink}}*/": asset("map_drawing.js"),
        "/*{{charts}}*/": asset("replay/charts.js"),
        "/*{{player}}*/": asset("replay/player.js"),
        "{{recording}}": as_script(data),
    }
    # in one go: what has been put in is not looked at again
    slots = re.compile("|".join(map(re.escape, parts)))
    return slots.sub(lambda slot: parts[slot.group()], asset("replay/player.html")).encode()


def recolouring() -> dict[str, str]:
    """What becomes of each colour on a dark page; both as "red,green,blue"."""
    table = {}
    for name in ("agreed", "margin", "free", "unknown", "text"):
        light, dark = getattr(LIGHT, name), getattr(DARK, name)
        table[",".join(map(str, light))] = ",".join(map(str, dark))
    return table


def as_script(data: Any) -> str:
    """JSON that may stand inside of a script element, whatever the texts in it say."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")
