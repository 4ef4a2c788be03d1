"""Someone who presses whatever there is, in any order, at any moment: it shows what nobody thought of."""

from __future__ import annotations

import random
from time import monotonic, sleep
from typing import Any

from wire import WireTab

PAUSES = (0.0, 0.0, 0.01, 0.05, 0.3)  # seconds
LEFT_ALONE = {"trials", "Seeds", "Points"}  # numbers that make work for minutes, which is their purpose
FAR = (0.0, 1e-9, 0.5, 3.0, -40.0, 1e6, -1e9)
DEEDS: dict[str, dict[str, tuple[Any, ...]]] = {
    "step": {"by": (-1, 1, 1, -5, 100)},
    "go": {"to": (-1, 0, 1, 2, 99)},
    "carry": {"x": FAR, "y": FAR, "theta": FAR},
    "put": {"x": FAR, "y": FAR, "theta": FAR, "knew": (0, 1, 7)},
    "nudge": {"x": FAR, "y": FAR, "theta": FAR, "knew": (0, 1, 7)},
    "drag": {"id": ("observer", "seen", "observed"), "at": ([0.0, 0.0], [1e3, -2.0]), "heading": ([], [1.0])},
    "drop": {"id": ("observer", "seen", "observed"), "at": ([0.0, 0.0], [1e3, -2.0]), "heading": ([], [1.0])},
    "cancel": {},
    "resized": {},
    "back": {},
}


def play(tab: WireTab, seconds: float, seed: int) -> list[tuple[Any, ...]]:
    """Press, choose, move and tell at random; what was done, in its order."""
    chance, done = random.Random(seed), []
    end = monotonic() + seconds
    while monotonic() < end:
        done.append(_deed(tab, chance))
        sleep(chance.choice(PAUSES))
    return done


def _deed(tab: WireTab, chance: random.Random) -> tuple[Any, ...]:
    if chance.random() < 0.3:
        event = chance.choice(list(DEEDS))
        fields = {name: chance.choice(values) for name, values in DEEDS[event].items()}
        tab.tell(event, **fields)
        return event, fields
    usable = [
        (uuid, props)
        for uuid, props in list(tab.props.items())
        if props.get("visible", True) and not props.get("disabled") and props.get("label") not in LEFT_ALONE
    ]
    values = [(uuid, props, value) for uuid, props in usable for value in _values(props, chance)]
    uuid, props, value = chance.choice(values)
    tab.send("GuiUpdateMessage", uuid=uuid, updates={"value": value})
    return props["kind"], props.get("label"), value


def _values(props: dict[str, Any], chance: random.Random) -> list[Any]:
    """What a control of that kind may be set to; a button counts three times, for it is what does things."""
    kind = props.get("kind")
    if kind == "GuiButtonMessage":
        return [True] * 3
    if options := props.get("options"):
        return [chance.choice(options)]
    if kind == "GuiCheckboxMessage":
        return [chance.random() < 0.5]
    if kind in ("GuiSliderMessage", "GuiNumberMessage"):
        low, high = (props.get(name) for name in ("min", "max"))
        return [chance.choice([end for end in (low, high) if end is not None] or FAR)]
    return []
