"""Simulated robots drive while their maps are merged: at every moment, is what stands right? `make live`.

A robot is right where its place is within 0.3 m and 1.7° of the truth where it stands. Of every drive
a map is turned by 3° half-way, as a loop closure does, and some sightings lie.
"""

from __future__ import annotations

import argparse
import resource
import time
from dataclasses import dataclass, field, replace

import numpy as np

from algorithms.common.pose import pose_error
from algorithms.fleets.living_merge import LivingMerge
from algorithms.observations.fleet import FleetSighting
from algorithms.simulator.fleets.exploration import Exploration, SlamCorrection
from algorithms.simulator.fleets.fleet_scenario import simulate_fleet
from algorithms.simulator.path_planning import STEP
from app.live.search_thread import SearchThread
from app.live.simulation import SCANS_PER_MAP, SPEED

DRIVES = (("office", 3, 3), ("apartment", 2, 3), ("office", 7, 4), ("corridor", 37, 3), ("warehouse", 20, 3))
CLOSE = 0.3, 0.03  # metres, radians
TURNED = 3.0  # degrees


@dataclass
class Count:
    """Moments, a scan each, of all robots but the anchor; seconds of the steps that looked at maps."""

    right: int = 0
    wrong: int = 0
    unplaced: int = 0
    lies: int = 0
    steps: list[float] = field(default_factory=list)

    def row(self, name: str) -> str:
        steps = np.array(self.steps)
        megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        return (
            f"{name:<14} {self.right:>6} {self.wrong:>6} {self.unplaced:>9} {self.lies:>5}  "
            f"{np.median(steps):.2f} s  {np.percentile(steps, 95):.2f} s  {megabytes} MB"
        )


def drive(kind: str, seed: int, robots: int, speed: float, lies: float) -> Count:
    """One drive, so many times as fast as robots drive; ``lies``: share of the sightings beside true ones."""
    made = simulate_fleet(kind, seed, robots, lies=0.0)
    turned = list(made.robots)[seed % robots]
    half = Exploration(made).scans // 2
    exploration = Exploration(made, SlamCorrection(turned, half, TURNED))
    search, rng, count = SearchThread(), np.random.default_rng(seed), Count()
    search.warm_up()
    merge = LivingMerge(exploration.names, search)
    start, placed = time.monotonic(), {}
    for scan in range(exploration.scans + 1):
        at = scan * STEP / SPEED
        time.sleep(max(0.0, start + at / speed - time.monotonic()))
        for seen in exploration.seen(scan):
            merge.see(seen)
            if rng.random() < lies:
                merge.see(lie(seen, rng))
                count.lies += 1
        if scan % SCANS_PER_MAP == 0:
            for name in exploration.names:
                merge.take(name, exploration.grid(name, scan))
        began = time.monotonic()
        answer = merge.step(at)
        if answer is not None:
            placed = answer.placed
            count.steps.append(time.monotonic() - began)
        for name in exploration.names[1:]:
            if name not in placed:
                count.unplaced += 1
                continue
            told = scan - scan % SCANS_PER_MAP  # the scan of the last map
            truth = exploration.true_transform(name, told)
            off = pose_error(placed[name], truth, exploration.pose(name, told).xy)
            right = off[0] <= CLOSE[0] and off[1] <= CLOSE[1]
            count.right, count.wrong = count.right + right, count.wrong + (not right)
    search.close()
    return count


def lie(seen: FleetSighting, rng: np.random.Generator) -> FleetSighting:
    """The same with a range or a bearing that is far off."""
    o = seen.observation
    if rng.random() < 0.5:
        return replace(seen, observation=replace(o, range=o.range + rng.uniform(1.5, 6.0)))
    bearing = (o.bearing + rng.uniform(0.7, 2.0) + np.pi) % (2 * np.pi) - np.pi
    return replace(seen, observation=replace(o, bearing=float(bearing)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=10.0, help="times as fast as robots drive")
    parser.add_argument("--lies", type=float, default=0.3, help="share of lies beside the true sightings")
    args = parser.parse_args()
    print("drive           right  wrong  unplaced  lies  median  95 %    memory")
    for kind, seed, robots in DRIVES:
        count = drive(kind, seed, robots, args.speed, args.lies)
        print(count.row(f"{kind} {seed} ({robots})"), flush=True)


if __name__ == "__main__":
    main()
