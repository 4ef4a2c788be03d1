"""How the command line explains itself: examples first, and a remedy where a word is misspelt."""

from __future__ import annotations

import argparse
import difflib
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from math import inf
from typing import Any, NoReturn

NEGATIVE_NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)(e[+-]?\d+)?(,.*)?$", re.IGNORECASE)


class Parser(argparse.ArgumentParser):
    """A parser whose help opens with what the command does and worked examples, as they are written."""

    def __init__(self, strict: bool = True, **kwargs: Any) -> None:
        super().__init__(allow_abbrev=False, formatter_class=_Formatter, **kwargs)
        self._negative_number_matcher = NEGATIVE_NUMBER  # "-1e-3" is one, too, and "-1,2,0.5" begins with one
        self.strict = strict  # whether an option that is not known is an error
        self.hint = ""  # said after an error about one
        self.what_became_of: Callable[[str], str] = lambda flag: ""  # says it of an option that is gone

    def format_help(self) -> str:
        text = super().format_help()
        if not self.description or self.description not in text:
            return text
        usage, rest = text.split(self.description, 1)
        return f"{self.description.strip()}\n\n{usage.strip()}\n\n{rest.strip()}\n"

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[Any, list[str]]:
        """As usual, but an option that nobody knows is told first, with the nearest that there is."""
        words = list(sys.argv[1:] if args is None else args)
        known = self._option_string_actions
        for word in words[: words.index("--")] if "--" in words else words:
            flag = word.split("=", 1)[0]
            if self.strict and flag.startswith("--") and flag not in known:
                if became := self.what_became_of(flag):
                    self.error(f"there is no option {flag} any more: {became}")
                # an old name is taken, but not recommended
                shown = [name for name, action in known.items() if action.help != argparse.SUPPRESS]
                self.error(f"there is no option {flag}{did_you_mean(flag, shown)}{self.hint}")
        return super().parse_known_args(words, namespace)

    def error(self, message: str) -> NoReturn:
        """One line on stderr, exit status 2."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


class _Formatter(argparse.RawDescriptionHelpFormatter):
    """Keeps the lines of a help text that has several."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=30)

    def _split_lines(self, text: str, width: int) -> list[str]:
        lines = []
        for line in text.splitlines():
            lines += super()._split_lines(line, width)
        return lines


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """ ", did you mean X?" for the nearest known word; empty where none is near."""
    near = difflib.get_close_matches(word, list(known), n=1)
    return f", did you mean {near[0]}?" if near else ""


def whole_number(low: int, high: float = inf, fault: str = "") -> Callable[[str], int]:
    """The ``type`` of an argument that is a whole number in a range; ``fault`` is said of anything else."""
    fault = fault or f"is no whole number from {low} " + ("up" if high == inf else f"to {high}")

    def read(text: str) -> int:
        with suppress(ValueError):
            if low <= (number := int(text)) <= high:
                return number
        raise argparse.ArgumentTypeError(f"{text} {fault}")

    return read
