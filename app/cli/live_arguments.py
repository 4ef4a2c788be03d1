"""Flags of commands that reach robots that run: the domain of DDS, its interface, rosbridge."""

from __future__ import annotations

import argparse
import os

from algorithms.common.errors import SettingError
from app.cli.argument_parser import Parser
from app.live.ros_link import RosLink

DOMAIN = "ROS_DOMAIN_ID"


def add_dds(parser: Parser) -> None:
    group = parser.add_argument_group("ROS 2, by DDS (pip install 'mapmeld[ros2]')")
    about = f"the robots' {DOMAIN} (default: that of the environment, else 0)"
    group.add_argument("--domain", type=int, metavar="N", help=about)
    about = "name or address of the network interface (default: as DDS finds it); lo stays on this machine"
    group.add_argument("--interface", default="", metavar="NAME", help=about)


class RobotLinks:
    """A link to each address that robots are reached by, made when it is first asked for."""

    def __init__(self, args: argparse.Namespace) -> None:
        self._args = args
        self._links: dict[str, RosLink] = {}

    def link(self, address: str = "") -> RosLink:
        """By DDS, or by the rosbridge server at an address; raises SettingError."""
        if address not in self._links:
            self._links[address] = self._dds() if not address else self._bridge(address)
        return self._links[address]

    def close(self) -> None:
        for link in self._links.values():
            link.close()

    def _dds(self) -> RosLink:
        from app.live.dds_link import DdsLink

        return DdsLink(domain_of(self._args.domain), self._args.interface)

    def _bridge(self, address: str) -> RosLink:
        from app.live.rosbridge_link import RosbridgeLink

        return RosbridgeLink(address)


def domain_of(given: int | None) -> int:
    """The domain that is asked for, or that of the environment; raises SettingError."""
    if given is not None:
        return given
    told = os.environ.get(DOMAIN, "") or "0"
    try:
        return int(told)
    except ValueError:
        raise SettingError(f"{DOMAIN} is {told!r}; set it to a number, or give --domain") from None
