"""A fleet on the page: its robots and sightings, what has been found of its pairs, and which pair is open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import LONGEST_NAME, RobotNames, check_name
from algorithms.fleets.fleet_merge import FleetResult, FleetStep, RunPairs, poses_so_far, run_fleet
from algorithms.fleets.island import Island
from algorithms.fleets.pair_hypotheses import PairFinding, PairOrder, aligned_priors, known_of, pair_orders
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import Fleet, FleetPrior, FleetSighting
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import Known
from app.model.live.robot_state import RobotState
from app.model.merge_inputs import MergeInputs

FindingKey = tuple[GridMap, GridMap, tuple[Known, ...]]
"""What a pair's merge depends on: both maps, which are equal where they are the same, and what is known."""

USED, LEFT_OUT = "used", "left out"
PLACED, ISLAND, ALONE, REFUSED, WAITING = "placed", "island", "alone", "taken out", "not merged yet"


@dataclass(frozen=True, eq=False)
class FleetState:
    """Nothing in it is ever changed.

    name   : of the fleet, for people
    hidden : robots whose maps are not drawn
    found  : of every pair that was merged with the same maps and knowledge, what came of it
    result : of all of them together; None before, and where anything has changed since
    opened : the pair, and its sightings, that the page shows in place of the fleet
    again  : there was a result, which is to be worked out again where the fleet is shown
    live   : how each robot does, where they run and the picture follows them; empty of one that stands still
    """

    fleet: Fleet
    name: str = ""
    hidden: frozenset[str] = frozenset()
    found: Mapping[FindingKey, PairFinding] = field(default_factory=dict)
    result: FleetResult | None = None
    opened: PairOrder | None = None
    again: bool = False
    live: Mapping[str, RobotState] = field(default_factory=dict)

    @property
    def robots(self) -> tuple[str, ...]:
        """Their names, in their order."""
        return tuple(self.fleet.maps)

    @property
    def islands(self) -> tuple[Island, ...]:
        """The maps that it has become; () before."""
        return () if self.result is None else self.result.islands

    @property
    def further(self) -> tuple[PairFinding, ...]:
        """What was accepted of pairs of which nothing is known: a person has opened, merged or laid them."""
        known = [{order.ref, order.mov} for order in pair_orders(self.fleet)]
        maps, further = self.fleet.maps, []
        for (ref, mov, told), finding in self.found.items():
            one, other = finding.order.ref, finding.order.mov
            same = maps.get(one) is ref and maps.get(other) is mov
            if finding.accepted and not told and same and {one, other} not in known:
                further.append(finding)
        return tuple(further)

    @property
    def orders(self) -> list[PairOrder]:
        """Pairs of which something is known or was found."""
        return [*pair_orders(self.fleet), *(finding.order for finding in self.further)]

    # --- what a person changes ----------------------------------------------------------------------

    def with_fleet(self, fleet: Fleet) -> FleetState:
        """Another fleet; what was found of pairs that are still the same stays at hand."""
        hidden = self.hidden & set(fleet.maps)
        return replace(self, fleet=fleet, hidden=hidden, result=None, again=False, live={})

    def with_robot(self, name: str, grid: GridMap) -> FleetState:
        """One robot more, called so as far as it can be; raises SettingError."""
        return self.with_fleet(replace(self.fleet, maps={**self.fleet.maps, self.unused(name): grid}))

    def unused(self, name: str) -> str:
        """What is a robot's name in it, with a number behind it where a robot has that."""
        letters = "".join(each for each in name if each.isprintable() and each != "/")
        name = letters.strip()[: LONGEST_NAME - 3].strip() or "robot"
        names = [name, *(f"{name}_{k}" for k in range(2, len(self.robots) + 3))]
        return next(each for each in names if each not in self.fleet.maps)

    def without_robot(self, name: str) -> FleetState:
        """One robot less, with all that is known of it; raises SettingError below two robots."""
        f = self.fleet
        maps = {each: grid for each, grid in f.maps.items() if each != name}
        left = tuple(seen for seen in f.sightings if name not in (seen.observer, seen.observed))
        priors = tuple(told for told in f.priors if name not in (told.ref, told.mov))
        return self.with_fleet(Fleet(maps, left, priors, f.anchor if f.anchor != name else ""))

    def renamed(self, old: str, new: str) -> FleetState:
        """The same robot under another name; raises SettingError where another has it, or it is none."""
        check_name(new)
        if new in self.fleet.maps:
            raise SettingError(f"there is a robot {new} already")

        def called(name: str) -> str:
            return new if name == old else name

        f = self.fleet
        fleet = Fleet(
            {called(name): grid for name, grid in f.maps.items()},
            tuple(
                replace(seen, observer=called(seen.observer), observed=called(seen.observed))
                for seen in f.sightings
            ),
            tuple(replace(told, ref=called(told.ref), mov=called(told.mov)) for told in f.priors),
            called(f.anchor),
        )
        found = {
            key: replace(
                each, order=replace(each.order, ref=called(each.order.ref), mov=called(each.order.mov))
            )
            for key, each in self.found.items()
        }
        hidden = frozenset(map(called, self.hidden))
        return replace(self, fleet=fleet, found=found, hidden=hidden, result=None, again=False, live={})

    def anchored(self, name: str) -> FleetState:
        """The result is to be in that robot's frame."""
        return self if name == self.fleet.anchor else self.with_fleet(replace(self.fleet, anchor=name))

    def toggled(self, name: str) -> FleetState:
        """The robot's map is hidden, or shown again."""
        return replace(self, hidden=self.hidden ^ {name})

    # --- a pair in the page of two maps ---------------------------------------------------------------

    def pair(self, order: PairOrder) -> MergeInputs:
        """The inputs of two robots: their maps, and what is known of how they lie."""
        maps, known = self.fleet.maps, known_of(self.fleet, order)
        verb = "and" if known and not order.sightings else "saw"
        inputs = MergeInputs.pair(maps[order.ref], maps[order.mov], name=f"{order.ref} {verb} {order.mov}")
        named = replace(inputs, names=RobotNames(order.ref, order.mov))
        return named.knowing(known, None if known else "sighting")

    def open(self, order: PairOrder) -> FleetState:
        return replace(self, opened=order, live={})

    def closed(self, known: Sequence[Known], finding: PairFinding | None) -> FleetState:
        """Back from the pair that is open, with what is known of it now, and what a merge said of it."""
        order, f, state = self.opened, self.fleet, replace(self, opened=None)
        if order is None:
            return self
        if tuple(known) != known_of(f, order):
            pair = order.ref, order.mov
            seen = [FleetSighting(*pair, one) for one in known if isinstance(one, Observation)]
            rough = [FleetPrior(*pair, one) for one in known if not isinstance(one, Observation)]
            others = [each for k, each in enumerate(f.sightings) if k not in order.sightings]
            priors = [told for told in aligned_priors(f) if (told.ref, told.mov) != pair]
            order = replace(order, sightings=tuple(range(len(others), len(others) + len(seen))))
            fleet = replace(f, sightings=(*others, *seen), priors=(*priors, *rough))
            state = state.with_fleet(fleet)
        if finding is not None:
            state = replace(state.with_finding(replace(finding, order=order)), result=None, again=False)
        return state

    # --- what is found --------------------------------------------------------------------------------

    def with_finding(self, finding: PairFinding) -> FleetState:
        return replace(self, found={**self.found, self.key(finding.order): finding})

    def finding(self, order: PairOrder) -> PairFinding | None:
        """What was found of it; None where it was not merged yet, or with other maps or sightings."""
        found = self.found.get(self.key(order))
        return None if found is None else replace(found, order=order)

    def key(self, order: PairOrder) -> FindingKey:
        """What a pair's merge depends on."""
        maps = self.fleet.maps
        return maps[order.ref], maps[order.mov], known_of(self.fleet, order)

    def merged(self, run_pairs: RunPairs, force: bool = False) -> Iterator[FleetStep]:
        """``run_fleet``, with what is found already: ``run_pairs`` merges the pairs that are not."""

        def pairs(fleet: Fleet, orders: Sequence[PairOrder]) -> Iterator[PairFinding]:
            found = [self.finding(order) for order in orders] if fleet is self.fleet else []
            known = [finding for finding in found if finding is not None]
            yield from known
            there = {finding.order for finding in known}
            yield from run_pairs(fleet, [order for order in orders if order not in there])

        return run_fleet(self.fleet, pairs, force, self.further)

    def standing(self, name: str) -> str:
        """What has become of a robot."""
        result = self.result
        if result is None:
            return WAITING
        if name in result.placed:
            return PLACED
        if name in result.refused:
            return REFUSED
        island = next(island for island in result.islands if name in island.poses)
        return ISLAND if len(island.poses) > 1 else ALONE

    def mood(self, number: int) -> str:
        """What has become of a sighting: USED, LEFT_OUT, or "" before all are merged."""
        if self.result is None:
            return ""
        return LEFT_OUT if any(each.number == number for each in self.result.left_out) else USED

    def together(self, one: str, other: str) -> bool:
        """Whether two robots are in one map."""
        return any({one, other} <= set(island.poses) for island in self.islands)

    def groups(self) -> list[Mapping[str, Pose2]]:
        """Robots that lie together, the anchor's group first: as they were found, or as far as pairs go."""
        if self.result is not None:
            return [island.poses for island in self.result.islands]
        findings = [found for order in self.orders if (found := self.finding(order)) is not None]
        together = poses_so_far(self.fleet, findings)
        return [together, *({name: Pose2()} for name in self.robots if name not in together)]
