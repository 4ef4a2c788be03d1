"""The network in which robots are looked for: DDS, and servers of rosbridge."""

from __future__ import annotations

from dataclasses import dataclass

from app.live.ros_link import RosLink


@dataclass(frozen=True)
class RobotNetwork:
    """Nothing is opened before a link is asked for.

    domain    : of DDS, the robots' ROS_DOMAIN_ID
    interface : as of DdsLink
    bridge    : address of a rosbridge server, where the robots of the page are reached by one; "" for DDS
    """

    domain: int = 0
    interface: str = ""
    bridge: str = ""

    def links(self) -> RobotLinks:
        """Of one listener, who closes them."""
        return RobotLinks(self)


class RobotLinks:
    """A link to each address that robots are reached by, made when it is first asked for."""

    def __init__(self, network: RobotNetwork) -> None:
        self._network = network
        self._links: dict[str, RosLink] = {}

    def link(self, address: str = "") -> RosLink:
        """By DDS, or by the rosbridge server at an address; raises SettingError."""
        if address not in self._links:
            self._links[address] = self._dds() if not address else self._bridge(address)
        return self._links[address]

    def close(self) -> None:
        for link in self._links.values():
            link.close()
        self._links.clear()

    def _dds(self) -> RosLink:
        from app.live.dds_link import DdsLink

        return DdsLink(self._network.domain, self._network.interface)

    def _bridge(self, address: str) -> RosLink:
        from app.live.rosbridge_link import RosbridgeLink

        return RosbridgeLink(address)
