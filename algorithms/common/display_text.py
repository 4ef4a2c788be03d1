"""Texts of strangers, so that a person sees what is in them: a file's name, a value of a file."""

from __future__ import annotations

import re

# Control characters, line breaks of any kind, what turns the direction of writing round, and halves of
# characters, which no text that is sent may hold.
HIDDEN = re.compile(r"[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def show_hidden(text: str) -> str:
    """The text on one line, with each hidden character as its number: ``[U+202E]``.

    A text that went through this stays as it is.
    """
    return HIDDEN.sub(lambda found: f"[U+{ord(found[0]):04X}]", text)
