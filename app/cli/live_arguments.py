"""Flags of commands that reach robots that run: the domain of DDS, its interface."""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING

from algorithms.common.errors import SettingError
from app.cli.argument_parser import Parser

if TYPE_CHECKING:
    from app.live.watch.robot_network import RobotNetwork

DOMAIN = "ROS_DOMAIN_ID"


def add_dds(parser: Parser) -> None:
    group = parser.add_argument_group("ROS 2, by DDS (pip install 'mapmeld[ros2]')")
    about = f"the robots' {DOMAIN} (default: that of the environment, else 0)"
    group.add_argument("--domain", type=int, metavar="N", help=about)
    about = "name or address of the network interface (default: as DDS finds it); lo stays on this machine"
    group.add_argument("--interface", default="", metavar="NAME", help=about)


def network_of(args: argparse.Namespace, bridge: str = "") -> RobotNetwork:
    """What the flags of ``add_dds`` ask for; raises SettingError."""
    from app.live.watch.robot_network import RobotNetwork

    return RobotNetwork(domain_of(args.domain), args.interface, bridge)


def domain_of(given: int | None) -> int:
    """The domain that is asked for, or that of the environment; raises SettingError."""
    if given is not None:
        return given
    told = os.environ.get(DOMAIN, "") or "0"
    try:
        return int(told)
    except ValueError:
        raise SettingError(f"{DOMAIN} is {told!r}; set it to a number, or give --domain") from None
