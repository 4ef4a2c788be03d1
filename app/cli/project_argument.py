"""A project in place of two maps or of a fleet file. Nothing heavy is loaded before there is one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from algorithms.common.errors import InputFileError

if TYPE_CHECKING:
    from algorithms.observations.pair_problem import PairProblem
    from app.model.fleet_state import FleetState
    from app.model.merge_inputs import MergeInputs
    from app.page.undo.page_snapshot import PageSnapshot

SUFFIX = ".mapmeld"
ALONE = "a project holds both maps and what is known of them: give it alone"


def is_project(path: Path | None) -> bool:
    """Whether a path is called as projects are."""
    return path is not None and path.suffix.lower() == SUFFIX


def opened_project(words: Sequence[str]) -> PageSnapshot | None:
    """The page of two maps that a project among the words of a command was left at; None: there is none.

    raises : InputFileError, TooLargeError; InputFileError also where it shows a fleet, or lacks something
    """
    named = [Path(word) for before, word in pairwise(["", *words]) if before != "--out"]
    path = next(filter(is_project, named), None)
    if path is None:
        return None
    snapshot = _page(path)
    if snapshot.fleet is not None and snapshot.fleet.opened is None:
        raise InputFileError(path, "shows a fleet", f"merge it with: mapmeld fleet {path}")
    if missing := snapshot.inputs.missing():
        raise InputFileError(path, "cannot be merged yet", f"open it with mapmeld serve. {missing}")
    return snapshot


def opened_fleet(path: Path) -> FleetState:
    """The fleet that a project was left at, with what was found of it.

    raises : InputFileError, TooLargeError; InputFileError also where it holds none
    """
    snapshot = _page(path)
    if snapshot.fleet is None:
        raise InputFileError(path, "holds two maps and no fleet", f"merge it with: mapmeld merge {path}")
    return snapshot.fleet.closed(snapshot.inputs.known, None)


def _page(path: Path) -> PageSnapshot:
    from app.page.project.project_file import read_project

    saved = read_project(path)
    return saved.steps[saved.position].snapshot


def problem_of(pair: MergeInputs) -> PairProblem:
    """Both maps, which are there, and what is known of them."""
    from algorithms.observations.pair_problem import PairProblem

    assert pair.ref is not None
    assert pair.mov is not None
    return PairProblem.of(pair.ref, pair.mov, pair.known)
