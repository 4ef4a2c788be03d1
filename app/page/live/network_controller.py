"""Finds the robots of a network, and has those followed that a person adds."""

from __future__ import annotations

from threading import Thread
from typing import TYPE_CHECKING

from algorithms.common.errors import MapMergeError
from app.page.fleet.fleet_controller import FleetController
from app.page.live.live_controller import LiveController
from app.page.tab import Tab

if TYPE_CHECKING:  # as in live_thread
    from app.live.live_fleet_file import LiveFleet
    from app.live.watch.robot_network import RobotNetwork

NAME = "Running robots"


class NetworkController:
    """Of one tab; ``network`` is the server's, None where it was started without one."""

    def __init__(
        self, tab: Tab, live: LiveController, fleet: FleetController, network: RobotNetwork | None
    ) -> None:
        self._locks, self._notices, self._panel = tab.state.locks, tab.notices, tab.panels.network
        self._live, self._fleet, self._network = live, fleet, network
        self._found: tuple[str, ...] = ()
        self._followed: LiveFleet | None = None  # by us
        self._panel.connect(self._look, self._add)

    def _look(self) -> None:
        """List the maps that are published; that takes some seconds, for which nobody waits."""
        if self._network is not None:
            self._panel.looking(True)
            Thread(target=self._find, args=(self._network,), name="mapmeld-look", daemon=True).start()

    def _find(self, network: RobotNetwork) -> None:
        from app.live.watch.published_maps import published_maps

        try:
            self._found = found = published_maps(network)
            self._panel.offer(found)
            count = len(found)
            maps = f"{count} map is" if count == 1 else f"{count or 'No'} maps are"
            self._panel.say(f"{maps} published within reach.")
        except MapMergeError as error:
            self._panel.say(str(error))
            self._notices.report(error)
        finally:
            self._panel.looking(False)

    def _add(self, topic: str, name: str) -> None:
        """Follow a robot more, beside those that are followed, or that are on the page."""
        from app.live.watch.published_maps import ReachedRobots, name_of, with_robot, with_sightings

        network = self._network
        if network is None or topic not in self._found:
            return
        with self._locks.action:
            try:
                before = self._present()
                unused = _unused(name or name_of(topic) or "robot", before)
                fleet = with_sightings(with_robot(before, unused, topic, network))
            except MapMergeError as error:
                self._notices.report(error)
                return
            if self._live.begin(lambda: ReachedRobots(network, fleet), NAME):
                self._followed = fleet
                self._panel.say(f"{unused} is followed, by its map on {topic}.")

    def _present(self) -> LiveFleet:
        """Robots that are followed already, with what they have seen; else those of the fleet on the page."""
        from app.live.live_fleet_file import LiveFleet, LiveRobot

        if self._followed is not None and self._live.follows(NAME):
            seen, names = self._live.sightings, set(self._followed.robots)
            known = tuple(each for each in seen if {each.observer, each.observed} <= names)
            followed = self._followed
            return LiveFleet(followed.robots, known or followed.sightings, followed.priors, followed.anchor)
        state = self._fleet.shown
        if state is None:
            return LiveFleet({}, (), (), "")
        f = state.fleet
        robots = {name: LiveRobot(grid=grid) for name, grid in f.maps.items()}
        return LiveFleet(robots, f.sightings, f.priors, f.anchor)


def _unused(name: str, fleet: LiveFleet) -> str:
    """A robot's name, with a number behind it where another has it."""
    names = [name, *(f"{name}_{k}" for k in range(2, len(fleet.robots) + 3))]
    return next(each for each in names if each not in fleet.robots)
