"""Tables and boxes for the panels, every text in them escaped; and telling a widget only what is new."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from html import escape
from typing import Any

from app.model.status_text import typeset

Action = Callable[[], None]

SHORT = 6  # letters of a first cell that is a sign or a number, not words
LONGEST = 26  # letters of a cell that is kept on one line; more would push the table out of its panel


def table(rows: Iterable[tuple[str, ...]], head: tuple[str, ...] = (), faded: bool = False) -> str:
    """HTML of a table: first column words, the others numbers set flush right."""

    def row(cells: tuple[str, ...], tag: str) -> str:
        first, *rest = cells
        style = "text-align:right;font-variant-numeric:tabular-nums;padding-left:8px"
        keep = ";white-space:nowrap" if len(first) <= SHORT else ""
        inner = f'<{tag} style="text-align:left;font-weight:400;opacity:.75{keep}">{escape(first)}</{tag}>'
        for cell in rest:
            wrap = "normal" if len(cell) > LONGEST else "nowrap"
            inner += f'<{tag} style="{style};white-space:{wrap}">{escape(typeset(cell))}</{tag}>'
        return inner

    body = "".join(f"<tr>{row(cells, 'td')}</tr>" for cells in rows)
    top = f'<tr style="opacity:.6;font-size:11px">{row(head, "th")}</tr>' if head else ""
    dim = ";opacity:.4" if faded else ""
    return (
        f'<table style="font-size:12.5px;line-height:1.45;border-collapse:collapse;'
        f'margin:2px 10px 8px;width:calc(100% - 20px){dim}">{top}{body}</table>'
    )


def box(text: str, mood: str, note: str = "", faded: bool = False) -> str:
    """HTML of a sentence in a coloured box; mood is accepted, bent, refused or plain."""
    colour = {"accepted": "#009E73", "bent": "#E69F00", "refused": "#D55E00"}.get(mood, "#6B7280")
    small = f'<div style="font-weight:400;margin-top:4px;opacity:.85">{escape(typeset(note))}</div>'
    dim = ";opacity:.4" if faded else ""
    return (
        f'<div style="margin:4px 10px 8px;padding:8px 10px;border-left:4px solid {colour};'
        f'border-radius:4px;background:{colour}1f;font-size:13px;font-weight:600;line-height:1.4{dim}">'
        f"{escape(typeset(text))}{small if note else ''}</div>"
    )


def small(text: str) -> str:
    """HTML of a remark in small letters; empty for none."""
    style = "margin:2px 12px 6px;font-size:12px;line-height:1.45;opacity:.85"
    return f'<p style="{style}">{escape(text, quote=False)}</p>' if text else ""


def says_html(words: str, share: float | None = None) -> str:
    """HTML of a line with a bar below it; both keep their place while there is nothing to say."""
    done = "" if share is None else f' style="width:{100 * share:.0f}%"'
    hidden = ' style="visibility:hidden"' if share is None else ""
    return (
        f'<div class="mm-says" role="status"><span>{escape(typeset(words))}</span>'
        f"<div{hidden}><i{done}></i></div></div>"
    )


def on_press(*buttons: tuple[Any, Action]) -> None:
    """Have each button do its action."""
    for button, action in buttons:
        button.on_click(lambda _, action=action: action())


def on_choice(handle: Any, action: Action) -> None:
    """Have a widget do this where a person changes it; where the page itself does, nothing."""
    handle.on_update(lambda event: action() if event.client_id is not None else None)


def put(handle: Any, **values: Any) -> None:
    """Give a widget these values, but for those that it has: each is a message, and draws it again."""
    for name, value in values.items():
        if getattr(handle, name) != value:
            setattr(handle, name, value)
