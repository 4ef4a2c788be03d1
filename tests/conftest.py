"""What several test modules need: case folders drawn in code, and two servers to attack."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import viser
from drawn import flat_pair
from hypothesis import HealthCheck, settings
from repository import ROOT
from strangers import TOKEN, Stand, standing

from algorithms.common.pose import Pose2
from algorithms.files.atomic_write import write_files
from algorithms.files.case_folder import Case
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import OBSERVATION_FILE, ROUGH_OBSERVATION_FILE, known_to_bytes
from algorithms.files.truth_file import TRUTH_FILE, Truth, truth_to_bytes
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import merge
from app.model.merge_inputs import MergeInputs
from app.web.security.access_control import Access
from app.web.viser_server import guarded_server

# A machine that is busy with other things must not fail a test; where CI runs, the same examples every time.
settings.register_profile(
    "mapmeld",
    deadline=None,
    derandomize="CI" in os.environ,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("mapmeld")


def round_hall() -> GridMap:
    """A hall without a corner, with pillars: nothing in it is like the flat."""
    size, cell = 200, 0.05
    rows, cols = np.indices((size, size))
    x, y = (cols - size / 2 + 0.5) * cell, (rows - size / 2 + 0.5) * cell
    from_centre = np.hypot(x, y)
    cells = np.where(from_centre < 4.5, FREE, UNKNOWN)
    cells[(from_centre >= 4.5) & (from_centre < 4.6)] = OCCUPIED
    for pillar_x, pillar_y in ((1.0, 2.0), (-2.5, 0.5), (0.5, -3.0)):
        cells[np.hypot(x - pillar_x, y - pillar_y) < 0.3] = OCCUPIED
    return GridMap(cells.astype(np.int8), cell, Pose2(-5.0, -5.0), "hall")


def write_case(case: Case, folder: Path) -> Path:
    """Write a case as the files of its folder."""
    rough = [replace(seen, range=seen.range + 0.2, sigma_range=0.3) for seen in case.observations]
    files = {
        **map_to_bytes(case.ref, "map1"),
        **map_to_bytes(case.mov, "map2"),
        OBSERVATION_FILE: known_to_bytes(case.observations),
        ROUGH_OBSERVATION_FILE: known_to_bytes(rough),
    }
    if case.truth is not None:
        files[TRUTH_FILE] = truth_to_bytes(case.truth)
    write_files({folder / name: data for name, data in files.items()})
    return folder


@pytest.fixture(scope="session")
def small_case() -> Case:
    """Two maps of one flat, seen in part by each robot, and the sighting without error."""
    ref, mov, observation, T_ref_mov = flat_pair()
    return Case("flat_1", ref, mov, (observation,), OBSERVATION_FILE, Truth(T_ref_mov))


@pytest.fixture(scope="session")
def inputs(small_case: Case) -> MergeInputs:
    """``small_case`` as the page holds it."""
    return MergeInputs.of(small_case)


@pytest.fixture(scope="session")
def result(small_case: Case) -> MergeResult:
    """What merging ``small_case`` gives."""
    return merge(small_case.ref, small_case.mov, small_case.observations)


@pytest.fixture(scope="session")
def strangers(small_case: Case) -> Case:
    """Maps of two different buildings, and a sighting that never was."""
    seen = replace(small_case.observations[0], observed_x=1.0, observed_y=-1.0, bearing_back=None)
    truth = Truth(None, expected="refuse")
    return replace(small_case, name="strangers_1", mov=round_hall(), observations=(seen,), truth=truth)


@pytest.fixture(scope="session")
def case_folder(small_case: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of ``small_case``; not to be written to."""
    return write_case(small_case, tmp_path_factory.mktemp("drawn") / small_case.name)


@pytest.fixture(scope="session")
def strangers_folder(strangers: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of ``strangers``; not to be written to."""
    return write_case(strangers, tmp_path_factory.mktemp("drawn") / strangers.name)


@pytest.fixture(scope="session")
def bent_folder() -> Path:
    """The folder of a sample that one of its robots bent; not to be written to."""
    return ROOT / "sample_maps" / "bent_r2_r1"


@pytest.fixture
def case_maker(tmp_path: Path) -> Callable[[Case, str], Path]:
    """``case_maker(case, name)`` writes a case into the folder ``cases`` of this test."""
    return lambda case, name: write_case(case, tmp_path / "cases" / name)


@pytest.fixture(scope="module")
def stock() -> Iterator[Stand]:
    """A server of viser's as it comes."""
    with standing(viser.ViserServer(host="127.0.0.1", port=0, verbose=False)) as stand:
        yield stand


@pytest.fixture(scope="module")
def ours() -> Iterator[Stand]:
    """A guarded one, with the same page."""
    with standing(guarded_server("127.0.0.1", 0, Access(), 40)) as stand:
        yield stand


@pytest.fixture(scope="module")
def locked() -> Iterator[Stand]:
    """A guarded one, for who has the token."""
    with standing(guarded_server("127.0.0.1", 0, Access(None, TOKEN), 40)) as stand:
        yield stand
