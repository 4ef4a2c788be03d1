"""How fast a merge is: its objective against what people would use instead, its stages, a huge pair.

`make bench`. The clock of one machine says little about another's, so what is pinned are ratios against
references that take turns with ours in the same run; the seconds are printed beside them.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from itertools import product
from pathlib import Path
from time import perf_counter

import cv2
import numpy as np
import pytest
from large_pair import simulate_large

from algorithms.common.pose import Pose2
from algorithms.files.map_file import write_map
from algorithms.files.observation_file import write_observations
from algorithms.maps.grid_map import GridMap
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, merge
from algorithms.observations.observation import encounter
from algorithms.observations.search_window import CoupledWindow, coupled_window
from algorithms.optimisation.branch_and_bound import ProofConfig, ProofState, prove
from algorithms.optimisation.likelihood_field import make_agreement
from algorithms.optimisation.objective import Lookup, Objective, make_objective
from algorithms.optimisation.transform_lattice import TransformLattice
from algorithms.simulator.scenario import SimulatedCase, simulate
from algorithms.spectra.augmented_map import AugmentedMap, augment

SIDE, WALLS, PARTICLES = 1000, 8_000, 400


def walls_of_a_building(rng: np.random.Generator) -> GridMap:
    """A 1000 × 1000 map at 0.05 m with about 8,000 occupied cells, in walls and not in dust."""
    cells = np.zeros((SIDE, SIDE), dtype=np.int8)
    while np.count_nonzero(cells) < WALLS:
        row, col, length = rng.integers(20, SIDE - 220, 3)
        length = 20 + length % 180
        if rng.random() < 0.5:
            cells[row : row + 2, col : col + length] = 100
        else:
            cells[row : row + length, col : col + 2] = 100
    return GridMap(cells, 0.05)


@pytest.fixture(scope="module")
def job() -> tuple[Objective, AugmentedMap, np.ndarray]:
    """An objective over the whole of two such maps, and 400 poses of a swarm."""
    rng = np.random.default_rng(0)
    grid = walls_of_a_building(rng)
    centre = np.array([25.0, 25.0])
    lifted = augment(grid, centre, np.eye(2) * 10.0**2, 100.0)
    around = Pose2().array() + rng.uniform(-1, 1, (PARTICLES, 3)) * (0.5, 0.5, np.deg2rad(5))
    return make_objective(lifted, lifted), lifted, around


def in_turns(ours: Callable[[], object], reference: Callable[[], object], rounds: int) -> tuple[float, float]:
    """Median seconds of both, taking turns so that a busy machine slows both alike."""
    ours(), reference()
    times = np.zeros((rounds, 2))
    for row in times:
        for column, call in enumerate((ours, reference)):
            began = perf_counter()
            call()
            row[column] = perf_counter() - began
    a, b = np.median(times, axis=0)
    return float(a), float(b)


def by_remap(lifted: AugmentedMap, poses: np.ndarray) -> np.ndarray:
    """The same sum with OpenCV's bilinear look-up of the moved points, one call for all poses."""
    grid = lifted.grid
    levels = np.zeros(grid.cells.shape, dtype=np.float32)
    levels[lifted.rows, lifted.cols] = lifted.levels
    x, y = (lifted.points / grid.resolution).astype(np.float32).T
    weights = lifted.levels.astype(np.float32)
    c, s = np.cos(poses[:, 2:3]).astype(np.float32), np.sin(poses[:, 2:3]).astype(np.float32)
    shift = (poses[:, :2] / grid.resolution - 0.5).astype(np.float32)
    u = c * x - s * y + shift[:, :1]
    v = s * x + c * y + shift[:, 1:]
    return cv2.remap(levels, u, v, cv2.INTER_LINEAR) @ weights


def by_warp(lifted: AugmentedMap, poses: np.ndarray) -> np.ndarray:
    """The same sum as it is printed: turn the whole second raster, multiply with the first, add up."""
    grid = lifted.grid
    ref = np.zeros(grid.cells.shape, dtype=np.float32)
    ref[lifted.rows, lifted.cols] = lifted.levels
    mov = np.zeros(lifted.grid.cells.shape, dtype=np.float32)
    mov[lifted.rows, lifted.cols] = lifted.levels
    values = np.zeros(len(poses))
    for n, pose in enumerate(poses):
        matrix = Pose2.from_array(pose).matrix()
        half = np.array([0.5, 0.5])
        matrix[:2, 2] = matrix[:2, 2] / grid.resolution + matrix[:2, :2] @ half - half
        values[n] = np.vdot(ref, cv2.warpAffine(mov, matrix[:2], ref.shape[::-1]))
    return values


@pytest.mark.parametrize("lookup", list(Lookup))
def bench_objective_against_remap(job, lookup, benchmark):
    objective, lifted, poses = job
    if lookup is Lookup.BILINEAR:  # the reference computes the same thing
        assert np.allclose(objective(poses), by_remap(lifted, poses), rtol=0.02)
    objective = make_objective(lifted, lifted, lookup)
    ours, reference = in_turns(lambda: objective(poses), lambda: by_remap(lifted, poses), 15)
    lookups = sum(len(side.points) for side in objective.sides) * len(poses)
    benchmark.extra_info.update(
        ratio=reference / ours, reference="cv2.remap of the points", lookups_per_s=lookups / ours
    )
    benchmark(objective, poses)
    assert reference / ours >= 2


def bench_objective_against_warp(job, benchmark):
    objective, lifted, poses = job
    few = poses[:20]
    assert np.allclose(objective(few), by_warp(lifted, few), rtol=0.05)
    ours, reference = in_turns(lambda: objective(poses), lambda: by_warp(lifted, few), 5)
    ratio = reference * len(poses) / len(few) / ours
    benchmark.extra_info.update(ratio=ratio, reference="cv2.warpAffine and product")
    benchmark(objective, poses)
    assert ratio >= 100


@pytest.fixture(scope="module")
def pair():
    """Two maps of about 500 × 500 cells, from the simulator."""
    return simulate("office", 7, overlap=0.4).cases[0]


def bench_whole_merge(pair, benchmark):
    """Warm, with the median of every stage."""
    stages = []

    def whole() -> None:
        stages.append(merge(pair.ref, pair.mov, pair.observations).timings_s)

    benchmark.pedantic(whole, rounds=9, warmup_rounds=1)
    benchmark.extra_info.update(
        maps=f"{pair.ref.width}×{pair.ref.height} and {pair.mov.width}×{pair.mov.height}",
        **{f"{stage} ms": float(np.median([s[stage] for s in stages])) * 1000 for stage in stages[0]},
    )


def search_of(case: SimulatedCase) -> tuple[Objective, CoupledWindow]:
    """What the default method proves the best of."""
    config = METHODS[DEFAULT_METHOD].defaults
    seen = [encounter(observation) for observation in case.observations]
    window = coupled_window(seen, config.window)
    objective = make_agreement(
        case.ref, case.mov, seen, config.augment, config.agreement, window, Lookup.NEAREST
    )
    return objective, window


def proof_of(objective: Objective, window: CoupledWindow) -> ProofState:
    """The best of the whole circle, and its rivals."""
    *_, last = prove(objective, window, ProofConfig(), floor=0.5, worth=0.0)
    assert last.proven
    return last


@pytest.mark.parametrize("which", ["500 × 500", "1500 × 1500"])
def bench_proof_against_exhaustive_search(which, pair, benchmark):
    """Every transform of the lattice in the window, by the same kernel; a sample of them is timed."""
    case = pair if which == "500 × 500" else simulate_large(1500)
    objective, window = search_of(case)
    lattice = TransformLattice(objective, window)
    shifts = np.array([(0, column, row) for column, row in product(range(lattice.side), repeat=2)])
    inside = window.contains(lattice.poses(lattice.coordinates(shifts, 0)))
    shifts = shifts[inside]
    rng = np.random.default_rng(0)
    sample = shifts[rng.integers(len(shifts), size=2000)]
    sample[:, 0] = rng.integers(lattice.turns, size=2000)
    poses = lattice.poses(lattice.coordinates(sample, 0))
    ours, reference = in_turns(lambda: proof_of(objective, window), lambda: objective(poses), 9)
    exhaustive = reference / len(poses) * len(shifts) * lattice.turns
    benchmark.extra_info.update(
        maps=f"{case.ref.width}×{case.ref.height} and {case.mov.width}×{case.mov.height}",
        ratio=exhaustive / ours,
        reference=f"all {len(shifts) * lattice.turns:,} transforms",
        blocks=proof_of(objective, window).nodes,
    )
    benchmark(proof_of, objective, window)
    assert exhaustive / ours >= 20


def bench_proof_against_swarm(pair, benchmark):
    """The stage "prove" against the stage "refine", a swarm of 400 on each of four candidates."""
    rounds = [merge(pair.ref, pair.mov, pair.observations).timings_s for _ in range(10)][1:]
    ours, reference = (float(np.median([times[stage] for times in rounds])) for stage in ("prove", "refine"))
    benchmark.extra_info.update(ratio=reference / ours, reference="swarm of 400, four candidates")
    benchmark(proof_of, *search_of(pair))
    assert reference / ours >= 1


def bench_huge_pair(tmp_path: Path, benchmark):
    """A 4000 × 4000 pair from the command line: load, merge, write; seconds and peak memory."""
    case = simulate_large(4000)
    write_map(tmp_path / "map1.yaml", case.ref)
    write_map(tmp_path / "map2.yaml", case.mov)
    write_observations(tmp_path / "observation.yaml", case.observations)
    command = [
        sys.executable, "-m", "app", "merge", str(tmp_path / "map1.yaml"), str(tmp_path / "map2.yaml"),
        "--observation", str(tmp_path / "observation.yaml"), "--out", str(tmp_path / "out"),
        "--json", "--force",
    ]  # fmt: skip

    def command_line():
        done = subprocess.run(command, capture_output=True, check=False, text=True, env=os.environ)
        assert done.returncode in (0, 1), done.stderr
        return json.loads(done.stdout)

    report = benchmark.pedantic(command_line, rounds=3, warmup_rounds=1)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    benchmark.extra_info.update(
        maps=f"{case.ref.width}×{case.ref.height} and {case.mov.width}×{case.mov.height}",
        peak_memory=f"{peak:.0f} MiB",
        **{f"{stage} s": round(seconds, 3) for stage, seconds in report["timings_s"].items()},
    )
