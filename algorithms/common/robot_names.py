"""What the two robots of a pair are called, in sentences on robot 1 and robot 2, map 1 and map 2."""

from __future__ import annotations

import re
from dataclasses import dataclass

from algorithms.common.errors import SettingError

LONGEST_NAME = 64  # letters of a robot's name
NAME_RULE = f"give 1 to {LONGEST_NAME} letters, without a slash, and no space at either end"

# Not in quotes, in brackets or as a part of a file's name: what a stranger wrote stays as it is.
BEFORE, WORDS_OF_TWO = r"(?<![\w'\"“(/.-])", r"([Rr]obot|[Mm]ap) ([12])('s)?(?![\w-]|\.\w)"
WORDS = re.compile(BEFORE + WORDS_OF_TWO)
IN_HTML = re.compile(rf"(?:{BEFORE}|(?<==\")){WORDS_OF_TWO}")  # also where an attribute begins with it


def is_name(text: str) -> bool:
    """Whether a robot can be called so: it goes into names of frames, and is shown to people."""
    fits = 1 <= len(text) <= LONGEST_NAME and text == text.strip()
    return fits and text.isprintable() and "/" not in text


def check_name(text: str) -> None:
    """Raise SettingError where no robot can be called so."""
    if not is_name(text):
        raise SettingError(f"{text!r} is no name for a robot; {NAME_RULE}")


@dataclass(frozen=True)
class RobotNames:
    """ref, mov : of the robot whose map is map 1, and of the other"""

    ref: str = "robot 1"
    mov: str = "robot 2"

    @staticmethod
    def of(ref: str, mov: str) -> RobotNames:
        """Names that a person gives; "" and spaces alone leave a robot without one.

        raises : SettingError where a robot cannot be called so, or both are called alike
        """
        names = RobotNames(ref.strip() or UNNAMED.ref, mov.strip() or UNNAMED.mov)
        for name in (names.ref, names.mov):
            check_name(name)
        if names.ref == names.mov:
            raise SettingError(f"both robots are called {names.ref}; give them two names")
        return names

    def told(self, text: str, words: re.Pattern[str] = WORDS) -> str:
        """A sentence of ours with the names in it: "robot 2 lies in map 1" becomes "Alice lies in Bob's map".

        It must hold no name yet: a robot may be called robot 2, and be the first. Without names it stays.
        """
        if self == UNNAMED:
            return text

        def named(found: re.Match[str]) -> str:
            name = (self.ref, self.mov)[int(found[2]) - 1]
            if found[1].lower() == "robot":
                return f"{name}{found[3] or ''}"
            return f"{name}'s{'' if found[3] else ' map'}"

        return words.sub(named, text)

    def told_in_html(self, text: str) -> str:
        """The same for HTML, SVG and Markdown: no name is taken for a tag or for emphasis."""
        return RobotNames(_plain(self.ref), _plain(self.mov)).told(text, IN_HTML)


def _plain(name: str) -> str:
    """A name as HTML and Markdown show it, punctuation as numbers of characters."""
    return "".join(letter if letter.isalnum() or letter == " " else f"&#{ord(letter)};" for letter in name)


UNNAMED = RobotNames()
