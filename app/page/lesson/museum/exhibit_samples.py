"""The maps and sightings that an exhibit of the museum is made of."""

from __future__ import annotations

from dataclasses import replace

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.case_folder import read_case
from algorithms.files.fleet_file import read_fleet
from algorithms.files.fleet_truth_file import read_fleet_truth
from algorithms.files.observation_file import OBSERVATION_FILE, read_known
from algorithms.files.truth_file import TRUTH_FILE, Truth
from algorithms.fleets.pair_hypotheses import PairOrder
from algorithms.observations.fleet import Fleet
from app.model.fleet_state import FleetState
from app.model.merge_inputs import MergeInputs
from app.page.lesson.museum.exhibit_texts import Exhibit
from app.page.lesson.sighting_look import SightingTask
from app.system import data_paths as paths


def exhibit_inputs(exhibit: Exhibit) -> tuple[MergeInputs, MergeInputs]:
    """What an exhibit merges, and what its cure does: the same maps; raises InputFileError.

    Where it is of a fleet, the pair of its sighting, twice: its cure merges ``exhibit_fleet``.
    """
    if exhibit.sighting:
        pair = _pair_of_fleet(exhibit)
        return pair, pair
    inputs = MergeInputs.of(read_case(paths.samples()[exhibit.case], exhibit.rough))
    if exhibit.picture:
        inputs = inputs.knowing(read_known(paths.pictures()[exhibit.picture] / OBSERVATION_FILE))
    wrong = inputs.knowing(inputs.pool, exhibit.known)
    same = exhibit.cure_known == exhibit.known
    return wrong, wrong if same else inputs.knowing(inputs.pool, exhibit.cure_known)


def exhibit_picture(exhibit: Exhibit) -> SightingTask | None:
    """The look at the picture that an exhibit is of; None where it is of none."""
    if not exhibit.picture:
        return None
    return SightingTask(paths.pictures()[exhibit.picture], paths.samples()[exhibit.case])


def exhibit_fleet(exhibit: Exhibit) -> Fleet | None:
    """The fleet that an exhibit is of; None where it is of a pair; raises InputFileError."""
    return read_fleet(paths.fleets()[exhibit.case]) if exhibit.sighting else None


def _pair_of_fleet(exhibit: Exhibit) -> MergeInputs:
    folder = paths.fleets()[exhibit.case]
    fleet, truth = read_fleet(folder), read_fleet_truth(folder / TRUTH_FILE)
    if exhibit.sighting > len(fleet.sightings):
        remedy = f"{exhibit.case} has {len(fleet.sightings)}"
        raise InputFileError(exhibit.source, f"there is no sighting {exhibit.sighting}", remedy)
    seen = fleet.sightings[exhibit.sighting - 1]
    ref, mov = (truth.T_anchor_robot.get(name, Pose2()) for name in (seen.observer, seen.observed))
    order = PairOrder(seen.observer, seen.observed, (exhibit.sighting - 1,))
    pair = FleetState(fleet, exhibit.case).pair(order)
    return replace(pair, truth=Truth(ref.inverse() @ mov))
