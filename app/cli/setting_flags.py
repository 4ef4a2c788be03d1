"""Config dataclasses as flags: a new field with Bounds and a string below it has its flag by that alone."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Collection, Sequence
from typing import Any

from algorithms.methods.registry import DEFAULT_METHOD, METHODS, PLANE_METHOD
from app.cli.argument_parser import Parser, did_you_mean, whole_number
from app.model.settings import Setting, settings_of, value_at, what_became_of, with_value

SHORT = {("verdict", "accept_from"): ("--accept-from",), ("verdict", "refuse_bent"): ("--strict",)}
"""Settings that have a short flag, too."""


def add_method(
    parser: Parser, words: Sequence[str], default: str = DEFAULT_METHOD, suits: bool = False
) -> None:
    """Add ``--method``, ``--seed`` and the settings of the method that ``words`` ask for.

    default : the method whose settings are taken where none is named
    suits   : whether then the one that suits what is known is to run; ``configs_from`` has those in question
    """
    _method_flag(parser, default, suits)
    add_seed(parser)
    ahead = Parser(prog=parser.prog, add_help=False, strict=False)
    _method_flag(ahead, default, suits)
    named = ahead.parse_known_args(words)[0].method or default
    parser.set_defaults(settings_of=named)
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
    hint = "the same seed gives the same answer (default: 0)"
    parser.add_argument("--seed", type=whole_number(0), default=0, help=hint)


def config_from(args: argparse.Namespace, method: str = "", config: Any = None) -> Any:
    """The config of a method, of ``args.method`` unless given, with every setting that was given.

    config : what it is where nothing is given; None: the method's defaults
    """
    config = METHODS[method or args.method].defaults if config is None else config
    for setting in settings_of(config):
        value = getattr(args, _flag(setting), None)
        if value is not None and value != value_at(config, setting.path):
            config = with_value(config, setting.path, value)
    return config


def configs_from(args: argparse.Namespace) -> dict[str, Any]:
    """The config of the method that is named, or of each that ``default_method`` chooses from and that has
    every setting that was given; by the method's name.
    """
    if args.method is not None:
        return {args.method: config_from(args)}
    own = settings_of(METHODS[args.settings_of].defaults)
    given = {setting.path for setting in own if getattr(args, _flag(setting)) is not None}
    has = {
        name: {setting.path for setting in settings_of(METHODS[name].defaults)}
        for name in (DEFAULT_METHOD, PLANE_METHOD)
    }
    return {name: config_from(args, name) for name, paths in has.items() if given <= paths}


def method_name(name: str, known: Collection[str] = METHODS) -> str:
    """The name of a method, as it was given."""
    if name not in known:
        near = did_you_mean(name, known) or f"; known are {', '.join(known)}"
        raise argparse.ArgumentTypeError(f"there is no method {name or 'without a name'}{near}")
    return name


def _method_flag(parser: argparse.ArgumentParser, default: str, suits: bool) -> None:
    usual = f"{DEFAULT_METHOD} near a good sighting, else {PLANE_METHOD}" if suits else default
    titles = "\n".join(f"{name}: {method.title}" for name, method in METHODS.items())
    parser.add_argument(
        "--method",
        type=method_name,
        default=None if suits else default,
        metavar="NAME",
        help=f"one of\n{titles}\n(default: {usual})".replace("%", "%%"),
    )


def _flag(setting: Setting) -> str:
    return ".".join(setting.path).replace("_", "-")


def _add(group: Any, setting: Setting) -> None:
    names, about = [f"--{_flag(setting)}", *SHORT.get(setting.path, ())], setting.hint or setting.label
    bounds = setting.bounds
    how: dict[str, Any]
    if isinstance(setting.default, bool):
        default, how = "yes" if setting.default else "no", {"action": argparse.BooleanOptionalAction}
    elif setting.choices is not None:
        options = setting.options
        default = next(word for word, option in options.items() if option == setting.default)
        how = {"type": _choice(options), "metavar": "|".join(options)}
    else:
        unit = f" {bounds.unit}" if bounds and bounds.unit else ""
        default = f"{setting.default:g}{unit}"
        if bounds:
            symbol = f"{bounds.symbol}, " if bounds.symbol else ""
            about += f" [{symbol}{bounds.low:g} … {bounds.high:g}{unit}]"
        how = {"type": _number(setting), "metavar": "N" if setting.whole else "X"}
    text = f"{about} (default: {default})".replace("%", "%%")
    group.add_argument(*names, dest=_flag(setting), default=None, help=text, **how)


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
