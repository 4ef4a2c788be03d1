"""Config dataclasses as flags of the command line, and back again.

A new field with Bounds and a string below it has its flag with no change here.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from app.cli.argument_parser import Parser, did_you_mean
from app.model.settings import Setting, settings_of, value_at, what_became_of, with_value
from app.system.data_paths import samples

SHORT = {("verdict", "accept_from"): ("--accept-from",), ("verdict", "refuse_bent"): ("--strict",)}
"""Settings that have a short flag, too."""


def add_method(parser: Parser, words: Sequence[str], default: str = DEFAULT_METHOD) -> None:
    """Add ``--method``, ``--seed`` and the settings of the method that ``words`` ask for."""
    _method_flag(parser, default)
    add_seed(parser)
    ahead = Parser(prog=parser.prog, add_help=False, strict=False)
    _method_flag(ahead, default)
    named = ahead.parse_known_args(words)[0].method
    defaults = METHODS[named].defaults
    groups: dict[str, Any] = {}
    for setting in settings_of(defaults):
        stage = ".".join(setting.path[:-1])
        if stage and stage not in groups:
            about = type(value_at(defaults, setting.path[:-1])).__doc__ or ""
            groups[stage] = parser.add_argument_group(stage, about.strip().split("\n")[0])
        _add(groups.get(stage, parser), setting)
    parser.what_became_of = what_became_of
    if named != default:
        parser.hint = f" (it may belong to a method other than {named})"


def add_seed(parser: Parser) -> None:
    """Add ``--seed``."""
    parser.add_argument(
        "--seed", type=_seed, default=0, help="the same seed gives the same answer (default: 0)"
    )


def case_folder(name: str, parser: Parser) -> Path:
    """The folder of a case, or of the sample of that name; a usage error where there is neither."""
    known, folder = samples(), Path(name)
    if folder.is_dir():
        return folder
    if name not in known:
        parser.error(f"{name} is neither a folder nor a sample{did_you_mean(name, known)}")
    return known[name]


def config_from(args: argparse.Namespace) -> Any:
    """The config of ``args.method`` with every setting that was given."""
    config = METHODS[args.method].defaults
    for setting in settings_of(config):
        value = getattr(args, _flag(setting))
        if value is not None and value != value_at(config, setting.path):
            config = with_value(config, setting.path, value)
    return config


def _method_flag(parser: argparse.ArgumentParser, default: str) -> None:
    titles = "\n".join(f"{name}: {method.title}" for name, method in METHODS.items())
    parser.add_argument(
        "--method",
        type=_method,
        default=default,
        metavar="NAME",
        help=f"one of\n{titles}\n(default: {default})".replace("%", "%%"),
    )


def _method(name: str) -> str:
    if name not in METHODS:
        near = did_you_mean(name, METHODS) or f"; known are {', '.join(METHODS)}"
        raise argparse.ArgumentTypeError(f"there is no method {name}{near}")
    return name


def _seed(text: str) -> int:
    try:
        seed = int(text)
    except ValueError:
        seed = -1
    if seed < 0:
        raise argparse.ArgumentTypeError(f"{text} is no whole number from 0 up")
    return seed


def _flag(setting: Setting) -> str:
    return ".".join(setting.path).replace("_", "-")


def _add(group: Any, setting: Setting) -> None:
    flag, about = f"--{_flag(setting)}", [setting.hint or setting.label]
    if isinstance(setting.default, bool):
        word = "yes" if setting.default else "no"
        group.add_argument(
            flag,
            *SHORT.get(setting.path, ()),
            dest=_flag(setting),
            action=argparse.BooleanOptionalAction,
            default=None,
            help=_help(about, word),
        )
        return
    if setting.choices is not None:
        options = {str(getattr(option, "value", option)): option for option in setting.choices.values()}
        default = next(word for word, option in options.items() if option == setting.default)
        reader, metavar = _choice(options), "|".join(options)
    else:
        bounds = setting.bounds
        unit = f" {bounds.unit}" if bounds and bounds.unit else ""
        default = f"{setting.default:g}{unit}"
        if bounds:
            symbol = f"{bounds.symbol}, " if bounds.symbol else ""
            about.append(f"[{symbol}{bounds.low:g} … {bounds.high:g}{unit}]")
        reader, metavar = _number(setting), "N" if setting.whole else "X"
    names = [flag, *SHORT.get(setting.path, ())]
    group.add_argument(
        *names, dest=_flag(setting), type=reader, metavar=metavar, default=None, help=_help(about, default)
    )


def _help(about: list[str], default: str) -> str:
    return f"{' '.join(about)} (default: {default})".replace("%", "%%")


def _choice(options: dict[str, Any]) -> Callable[[str], Any]:
    def read(text: str) -> Any:
        if text not in options:
            raise argparse.ArgumentTypeError(f"{text} is none of {', '.join(options)}")
        return options[text]

    return read


def _number(setting: Setting) -> Callable[[str], float]:
    kind, bounds = (int, setting.bounds) if setting.whole else (float, setting.bounds)

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            what = "whole number" if kind is int else "number"
            raise argparse.ArgumentTypeError(f"{text} is no {what}") from None
        if bounds and not (math.isfinite(value) and bounds.low <= value <= bounds.high):
            unit = f" {bounds.unit}" if bounds.unit else ""
            raise argparse.ArgumentTypeError(
                f"{text}{unit} is out of range; it must lie in [{bounds.low:g}, {bounds.high:g}]{unit}"
            )
        return value

    return read
