"""Tab "Compare": which methods are to run on the loaded pair, and a card for what came of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import viser

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.methods.registry import Family
from app.drawing.palette import LIGHT, QUIET, STOP
from app.evaluation.compared_methods import COMPARED
from app.model.status_text import typeset
from app.page.panels.html_widgets import Action, on_press, put, says_html
from app.page.research.other_result import RunSummary

OURS, PAPER, RIVALS, ALL, NONE = "Ours", "Paper's", "Rivals", "All", "None"
FAMILIES: dict[Family, tuple[str, str]] = {
    "ours": ("Ours", OURS),
    "paper": ("The paper's, and its parts", PAPER),
    "rivals": ("The paper's rivals, and today's", RIVALS),
}
HINT = "Which methods: tick them one by one, or a whole group."
INTRO = (
    "Run several methods on the maps that are loaded, and see whose merge is right. The method of the panel "
    "runs as its sliders stand, the others at their defaults."
)
SMALL = "margin:4px 12px 6px;font-size:12px;line-height:1.4;opacity:.8"

State = Literal["idle", "waits", "runs", "done"]


@dataclass(frozen=True)
class Card:
    """All that a card shows.

    picture : of the merged map, as a data URI; "" where there is none
    shown   : it is what lies over map 1 now
    old     : what has changed since, in two words; "" where nothing has
    note    : added to the numbers
    names   : of the robots
    """

    chosen: bool
    state: State = "idle"
    outcome: RunSummary | None = None
    picture: str = ""
    shown: bool = False
    old: str = ""
    note: str = ""
    names: RobotNames = UNNAMED


class ComparePanel:
    """Widgets; they know nothing of a run."""

    def __init__(self, gui: viser.GuiApi) -> None:
        gui.add_html(f'<p style="{SMALL}">{INTRO}</p>')
        self._groups = gui.add_button_group("", (OURS, PAPER, RIVALS, ALL, NONE), hint=HINT)
        self._run = gui.add_button("Compare methods", color=LIGHT.ref, icon=viser.Icon.SCALE, disabled=True)
        icon = viser.Icon.PLAYER_STOP
        self._stop = gui.add_button("Stop comparing", color=STOP, icon=icon, visible=False)
        self._says = gui.add_html(says_html(""))
        self._cards: dict[str, viser.GuiHtmlHandle] = {}
        for family, (title, _) in FAMILIES.items():
            gui.add_html(f'<h4 class="mm-family">{escape(title)}</h4>')
            for name, method in COMPARED.items():
                if method.family == family:
                    self._cards[name] = gui.add_html(card_html(name, Card(chosen=False)))
        hint = "A zip: a table of the methods, every transform, the merged maps side by side."
        quiet: Any = {"color": QUIET, "icon": viser.Icon.DOWNLOAD, "visible": False}
        self._save = gui.add_button("Download tables and pictures", hint=hint, **quiet)

    def connect(self, run: Action, stop: Action, group: Callable[[str], None], save: Action) -> None:
        """What is done where a person compares; ``group`` ticks all methods of a group, and no others."""
        on_press((self._run, run), (self._stop, stop), (self._save, save))
        self._groups.on_click(lambda _: group(self._groups.value))

    def possible(self, count: int, ready: bool, busy: bool, harvest: bool) -> None:
        """How many methods are chosen, whether there is a pair, whether they run, whether any has ended."""
        label = "Compare methods" if count == 0 else f"Compare {count} method{'s' if count > 1 else ''}"
        put(self._run, label=label, disabled=count == 0 or not ready, visible=not busy)
        put(self._stop, visible=busy)
        put(self._save, visible=harvest and not busy)

    def say(self, words: str, share: float | None = None) -> None:
        self._says.content = says_html(words, share)

    def show(self, cards: Mapping[str, Card]) -> None:
        """Show these cards; those that stay as they are cost nothing."""
        for name, card in cards.items():
            put(self._cards[name], content=card_html(name, card))


def card_html(name: str, card: Card) -> str:
    """HTML of a method: a box to tick it, and what came of it."""
    checked = " checked" if card.chosen else ""
    title = escape(COMPARED[name].title)
    head = (
        f'<label title="Run this method, too: {escape(name)}">'
        f'<input type="checkbox" data-mm-pick="{name}"{checked}><span>{title}</span></label>'
    )
    where = f'class="mm-method" data-method="{name}" data-state="{card.state}"'
    return f"<div {where}>{head}{_body(name, card)}</div>"


def _body(name: str, card: Card) -> str:
    summary = card.outcome
    if card.state in ("waits", "runs"):
        word = "Merging …" if card.state == "runs" else "Waits for its turn."
        return f'<div class="mm-card"><i class="mm-thumb"></i><span><small>{word}</small></span></div>'
    if summary is None:
        return ""
    numbers = " · ".join(part for part in (summary.numbers, card.note, card.old) if part)
    words = (
        f'<span><b data-mood="{summary.mood}">{escape(typeset(summary.says))}</b>'
        f"<small>{escape(typeset(summary.verdict))}</small>"
        f"<em>{escape(typeset(numbers))}</em></span>"
    )
    old, verdict = " data-old" if card.old else "", escape(summary.verdict)
    if not card.picture:
        return f'<div class="mm-card"{old} title="{verdict}"><i class="mm-thumb">–</i>{words}</div>'
    over = card.names.told("Press to lay it over map 1.")
    back = escape("Press again to go back to your own." if card.shown else over)
    pressed = str(card.shown).lower()
    return (
        f'<button type="button" class="mm-card" data-mm-show="{name}" aria-pressed="{pressed}"{old} '
        f'title="{verdict} {back}"><img class="mm-thumb" alt="" src="{card.picture}">{words}</button>'
    )
