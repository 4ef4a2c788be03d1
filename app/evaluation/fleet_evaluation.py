"""Every fleet in a folder, merged and held against its truth: who is placed right, and who wrong."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from math import hypot
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2, wrap_angle
from algorithms.files.case_folder import group_of, name_in
from algorithms.files.fleet_file import FLEET_FILE, read_fleet
from algorithms.files.fleet_truth_file import FleetTruth, read_fleet_truth
from algorithms.files.truth_file import TRUTH_FILE
from algorithms.fleets.fleet_merge import FleetResult, merge_fleet
from algorithms.observations.fleet import Fleet

OVERALL = "overall"


@dataclass(frozen=True)
class EvaluatedFleet:
    """What came of one fleet; names of robots.

    right   : placed in the anchor's map where they truly lie; the anchor among them
    wrong   : placed anywhere else, in the anchor's map or in that of an island: what must not happen
    refused : not placed in the anchor's map, though true sightings tie them to it
    loose   : not placed, as it should be: nothing true ties them to the anchor
    lies_used, truths_left_out : numbers of sightings
    """

    fleet: str
    right: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    loose: tuple[str, ...] = ()
    lies_used: tuple[int, ...] = ()
    truths_left_out: tuple[int, ...] = ()
    seconds: float = 0.0
    error: str = ""

    def plain(self) -> dict[str, Any]:
        """As JSON holds it."""
        return asdict(self)


def fleet_folders(root: Path) -> list[Path]:
    """The folders under root, and root itself, that hold a fleet file; sorted."""
    return sorted(Path(folder) for folder, _, files in os.walk(root) if FLEET_FILE in files)


def evaluate_fleets(
    root: Path, folders: Sequence[Path], merge: Callable[[Fleet], FleetResult] = merge_fleet
) -> Iterator[EvaluatedFleet]:
    """Yield what came of each; one that cannot be run says why, and costs no other."""
    for folder in folders:
        name, began = name_in(root, folder), perf_counter()
        try:
            fleet, truth = read_fleet(folder), read_fleet_truth(folder / TRUTH_FILE)
            result = merge(fleet)
        except MapMergeError as error:
            yield EvaluatedFleet(name, error=str(error), seconds=perf_counter() - began)
            continue
        yield judged(name, fleet, truth, result, perf_counter() - began)


def judged(
    name: str, fleet: Fleet, truth: FleetTruth, result: FleetResult, seconds: float = 0.0
) -> EvaluatedFleet:
    """A result, held against the truth."""
    true = {fleet.anchor: Pose2(), **truth.T_anchor_robot}
    right, wrong, refused, loose = [], [], [], []
    for number, island in enumerate(result.islands):
        for robot, T in island.poses.items():
            lies = _lies_right(T, true[island.root].inverse() @ true[robot], robot, truth)
            if not lies:
                wrong.append(robot)
            elif number == 0:
                right.append(robot)
            else:
                (loose if robot in truth.loose else refused).append(robot)
    left = {each.number for each in result.left_out}
    return EvaluatedFleet(
        fleet=name,
        right=tuple(right),
        wrong=tuple(wrong),
        refused=tuple(refused),
        loose=tuple(loose),
        lies_used=tuple(number for number in truth.lies if number not in left),
        truths_left_out=tuple(sorted(left - set(truth.lies))),
        seconds=seconds,
    )


def _lies_right(T: Pose2, true: Pose2, robot: str, truth: FleetTruth) -> bool:
    at = np.array(truth.at.get(robot, (0.0, 0.0)))
    off = hypot(*(T.apply(at) - true.apply(at)).tolist())
    return off <= truth.tolerance_m and abs(wrap_angle(T.theta - true.theta)) <= truth.tolerance_rad


def fleet_totals(fleets: Sequence[EvaluatedFleet]) -> dict[str, dict[str, Any]]:
    """Counts of robots and sightings per group, and overall."""
    groups: dict[str, list[EvaluatedFleet]] = {}
    for fleet in fleets:
        groups.setdefault(group_of(fleet.fleet), []).append(fleet)
    totals = {name: _totals(groups[name]) for name in sorted(groups)}
    return {**totals, OVERALL: _totals(fleets)}


def _totals(fleets: Sequence[EvaluatedFleet]) -> dict[str, Any]:
    ran = [fleet for fleet in fleets if not fleet.error]

    def count(field: str) -> int:
        return sum(len(getattr(fleet, field)) for fleet in ran)

    return {
        "fleets": len(fleets),
        "right": count("right"),
        "refused": count("refused"),
        "loose": count("loose"),
        "wrong": count("wrong"),
        "lies_used": count("lies_used"),
        "truths_left_out": count("truths_left_out"),
        "errors": len(fleets) - len(ran),
        "median_seconds": median(fleet.seconds for fleet in ran) if ran else None,
    }
