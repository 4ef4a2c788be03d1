"""Config dataclasses as settings that a panel can show: label, range, unit, hint; and back again."""

from __future__ import annotations

import ast
import inspect
import itertools
import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from enum import Enum
from functools import cache
from typing import Any, Literal, get_args, get_origin, get_type_hints

from algorithms.common.setting_bounds import Bounds, bounds_of

Path = tuple[str, ...]


GONE = re.compile(r"verdict\.((bent_)?(contradiction|wall)|bent|plenty|ambiguity|deviations)")
"""Settings of the verdict that there were: its limits have become one probability."""


def what_became_of(name: str) -> str:
    """What to say of a setting that is gone, as ``verdict.bent-wall``; empty where it never was one."""
    gone = GONE.fullmatch(name.lstrip("-").replace("-", "_"))
    return "the verdict's limits have become one probability, verdict.accept_from" if gone else ""


@dataclass(frozen=True)
class Setting:
    """One field of a config, wherever it is nested.

    path    : names from the outermost config to the field
    label   : symbol, words, unit, as a person reads them
    hint    : the string below the field
    bounds  : range of a number; None for a choice or a switch
    choices : what a choice may be, by the words for it; None otherwise
    whole   : whether a number is an int
    """

    path: Path
    label: str
    hint: str
    default: Any
    bounds: Bounds | None = None
    choices: dict[str, Any] | None = None
    whole: bool = False

    @property
    def options(self) -> dict[str, Any]:
        """What a choice may be, by the words for it on the command line."""
        return {str(getattr(option, "value", option)): option for option in (self.choices or {}).values()}


@cache
def field_docs(config_type: type) -> dict[str, str]:
    """The string below each field of a class and of its bases whose source is there, its lines joined."""
    docs: dict[str, str] = {}
    for base in reversed(config_type.__mro__[:-1]):
        try:
            tree = ast.parse(textwrap.dedent(inspect.getsource(base)))
        except (OSError, TypeError, SyntaxError):
            continue
        for pair in itertools.pairwise(tree.body[0].body):  # type: ignore[attr-defined]
            match pair:
                case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                    docs[name] = " ".join(text.split())
    return docs


def settings_of(config: Any, path: Path = ()) -> Iterator[Setting]:
    """Yield a Setting per field of a config and of the configs in it, in the order they are written."""
    kind = type(config)
    hints, docs, bounds = get_type_hints(kind), field_docs(kind), dict(bounds_of(kind))
    for field in fields(config):
        value, here = getattr(config, field.name), (*path, field.name)
        if is_dataclass(value):
            yield from settings_of(value, here)
            continue
        words, hint = field.name.replace("_", " "), docs.get(field.name, "")
        if words == "kind" and path:  # of what?
            words = f"{path[-1]} kind"
        if field.name in bounds:
            b = bounds[field.name]
            parts = (b.symbol, b.label or words, f"({b.unit})" if b.unit else "")
            label = " ".join(part for part in parts if part)
            yield Setting(here, label, hint, value, bounds=b, whole=hints[field.name] is int)
        elif isinstance(value, bool):
            yield Setting(here, words, hint, value)
        elif isinstance(value, Enum):
            choices = {str(option.value): option for option in type(value)}
            yield Setting(here, words, hint, value, choices=choices)
        elif get_origin(hints[field.name]) is Literal:
            options = get_args(hints[field.name])
            yield Setting(here, words, hint, value, choices={_word(str(o)): o for o in options})


def _word(option: str) -> str:
    """An option as a menu shows it: "pso" is an abbreviation, "coupled" a word."""
    return option.upper() if len(option) <= 3 else option.capitalize()


def value_at(config: Any, path: Path) -> Any:
    for name in path:
        config = getattr(config, name)
    return config


def with_value(config: Any, path: Path, value: Any) -> Any:
    """A copy of the config with one field changed; raises SettingError where it is out of bounds."""
    name, *rest = path
    inner = with_value(getattr(config, name), tuple(rest), value) if rest else value
    return replace(config, **{name: inner})


def word_for(setting: Setting, value: Any) -> str:
    assert setting.choices is not None
    return next(word for word, option in setting.choices.items() if option == value)


def text_for(setting: Setting, value: Any, on: str, off: str) -> str:
    """A value in words, without its unit; ``on`` and ``off`` for a tick."""
    if setting.choices is not None:
        return word_for(setting, value)
    if isinstance(value, bool):
        return on if value else off
    return f"{value:g}"


def in_cells(metres: float, *cells: float) -> str:
    """A length in cells, for one or two resolutions (metres per cell): "60 cells" or "60 / 30 cells"."""
    counts = dict.fromkeys(f"{metres / cell:.3g}" for cell in cells)
    return " / ".join(counts) + " cells"
