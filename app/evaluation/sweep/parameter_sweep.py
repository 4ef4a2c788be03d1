"""One or two settings swept over their values, each with several seeds: Figs. 13 and 14 of the paper."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from statistics import fmean, median, pstdev
from threading import Event
from typing import Any

from algorithms.files.case_folder import Case
from algorithms.files.observation_file import known_to_bytes
from algorithms.files.truth_file import truth_to_bytes
from algorithms.maps.grid_map import GridMap
from algorithms.methods.registry import METHODS
from algorithms.methods.stage_runner import StageCache
from algorithms.verdict import performance_index as merit
from app.evaluation.method_run import MethodRun, run_method, true_fusion
from app.evaluation.sweep.checkpoint import Checkpoint
from app.jobs.executor import Executor, LostTask, Shared, Task
from app.model.settings import Path as SettingPath
from app.model.settings import Setting, settings_of, with_value
from app.report.json_report import plain
from app.system.version import code, versions

SEEDS = tuple(range(10))  # the paper averages over as many trials


@dataclass(frozen=True)
class SweepAxis:
    """A setting and the values it is to take, each once."""

    path: SettingPath
    values: tuple[Any, ...]

    @property
    def name(self) -> str:
        """As its flag is called."""
        return ".".join(self.path).replace("_", "-")

    @property
    def numeric(self) -> bool:
        """Whether the setting is a number; a choice has its values side by side."""
        return all(isinstance(value, int | float) and not isinstance(value, bool) for value in self.values)

    def place(self, value: Any) -> float:
        """Where a value stands: at its number, or in a row."""
        return float(value) if self.numeric else float(self.values.index(value))


@dataclass(frozen=True)
class SweepPlan:
    """What is swept: every value of x with every one of y, if any; all else stays as in ``config``."""

    method: str
    config: Any
    x: SweepAxis
    y: SweepAxis | None = None
    seeds: tuple[int, ...] = SEEDS

    def __post_init__(self) -> None:
        for x, y in self.places():  # raises SettingError at once, not in the middle
            self.config_at(x, y)

    @property
    def swept(self) -> list[str]:
        """Names of the settings that are swept."""
        return [axis.name for axis in (self.x, self.y) if axis is not None]

    def places(self) -> list[tuple[Any, Any]]:
        """Every (x, y), y None where there is no second setting; x runs fastest."""
        return [(x, y) for y in (self.y.values if self.y else (None,)) for x in self.x.values]

    def config_at(self, x: Any, y: Any = None) -> Any:
        config = with_value(self.config, self.x.path, x)
        return config if self.y is None else with_value(config, self.y.path, y)

    def setting(self, axis: SweepAxis) -> Setting:
        """What the swept setting is called, in which unit."""
        return next(found for found in settings_of(self.config) if found.path == axis.path)


@dataclass(frozen=True)
class Spread:
    """Mean, median, standard deviation and extremes of a number over the seeds."""

    mean: float
    median: float
    deviation: float
    low: float
    high: float

    @staticmethod
    def of(values: Sequence[float]) -> Spread:
        return Spread(fmean(values), median(values), pstdev(values), min(values), max(values))


@dataclass(frozen=True)
class SweepPoint:
    """One place of a sweep: a trial per seed, in the order of the seeds."""

    x: Any
    y: Any
    trials: tuple[MethodRun, ...]

    @property
    def index(self) -> Spread | None:
        """Eq. (23) over the seeds; None where the method could not be run."""
        values = [trial.index for trial in self.trials if trial.index is not None]
        return Spread.of(values) if values else None

    @property
    def seconds(self) -> Spread:
        """Time of a merge over the seeds."""
        return Spread.of([trial.seconds for trial in self.trials])

    @property
    def right(self) -> int | None:
        """How many of the trials have the right transform; None where no truth is known."""
        judged = [trial.right for trial in self.trials if trial.right is not None]
        return sum(judged) if judged else None

    @property
    def accepted(self) -> int:
        return sum(trial.accepted for trial in self.trials)

    @property
    def failed(self) -> str:
        """Why the method could not be run; empty where it could."""
        return next((trial.reason for trial in self.trials if trial.failed), "")


def sweep(
    case: Case,
    plan: SweepPlan,
    executor: Executor,
    journal: Checkpoint | None = None,
    stop: Event | None = None,
) -> Iterator[SweepPoint]:
    """Yield every point as it is done, coarse to fine; those that the journal knows first.

    Each is in the journal before it is yielded. Close the generator to stop, or set ``stop`` in a thread.
    """
    journal = Checkpoint() if journal is None else journal
    bases, todo = bases_of(case, plan), []
    for place in _coarse_first(plan.places()):
        record = journal.get(_digest(bases[place]))
        if record is None:
            todo.append(place)
        else:
            yield SweepPoint(*place, tuple(map(MethodRun.of, record["trials"])))
    if not todo:
        return
    shared = Shared.of(case)
    tasks = (Task((plan.method, plan.config_at(*place), plan.seeds), shared) for place in todo)
    for number, answer in executor.run(_work, tasks, stop):
        place = todo[number]
        if isinstance(answer, LostTask):
            yield SweepPoint(*place, (MethodRun.failure(answer.reason),))
            continue
        point = SweepPoint(*place, tuple(map(MethodRun.of, answer)))
        if not point.failed:
            record = {"x": plain(point.x), "y": plain(point.y), "swept": plan.swept}
            journal.add(_digest(bases[place]), {**record, "made_of": bases[place], "trials": answer})
        yield point


def done_before(case: Case, plan: SweepPlan, journal: Checkpoint) -> int:
    """How many points of a sweep the journal knows."""
    return sum(journal.get(key) is not None for key in point_keys(case, plan).values())


def outdated(case: Case, plan: SweepPlan, journal: Checkpoint) -> str:
    """Why points of this sweep that the journal has are not used, as a sentence; "" where there are none.

    Records of early versions do not say what they were made of, nor which settings were swept.
    """
    bases = bases_of(case, plan)
    at = {(json.dumps(plain(x)), json.dumps(plain(y))): place for place in bases for x, y in [place]}
    differing: dict[tuple[Any, Any], set[str]] = {}
    for record in journal.records():
        place = at.get((json.dumps(record.get("x")), json.dumps(record.get("y"))))
        if place is None or record.get("swept", plan.swept) != plan.swept:
            continue
        made_of = record.get("made_of", dict.fromkeys(bases[place]))
        found = {name for name, digest in bases[place].items() if made_of.get(name) != digest}
        differing[place] = min(found, differing.get(place, found), key=len)
    old = [found for found in differing.values() if found]
    if not old:
        return ""
    parts = [name for name in next(iter(bases.values())) if any(name in found for found in old)]
    made = f"with other {', '.join(parts)}"
    if len(parts) == len(next(iter(bases.values()))):
        made = f"by another version of mapmeld, or {made}"
    known = f"{len(old)} of {len(bases)} points are in the journal"
    return f"{known}, but were made {made}: they are merged anew, as answers may differ"


def in_order(plan: SweepPlan, points: Sequence[SweepPoint]) -> list[SweepPoint]:
    """The points as they stand in a table, however they came."""
    at = {(point.x, point.y): point for point in points}
    return [at[place] for place in plan.places() if place in at]


def _work(case: Case, order: tuple[str, Any, tuple[int, ...]]) -> list[dict[str, Any]]:
    """All seeds of one point: what does not depend on the seed is done once for all of them."""
    method, config, seeds = order
    true, memo = true_fusion(case), StageCache()
    return [asdict(run_method(case, method, config, seed, true, memo)) for seed in seeds]


def _coarse_first(places: list[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
    """The ends, the middle, quarters …: in the order of the van der Corput sequence."""
    if len(places) < 3:
        return places
    first, *inner, last = places
    bits = len(inner).bit_length()
    order = sorted(range(len(inner)), key=lambda n: int(f"{n + 1:0{bits}b}"[::-1], 2))
    return [first, last, *(inner[n] for n in order)]


# ---- what a point's numbers rest on


def point_keys(case: Case, plan: SweepPlan) -> dict[tuple[Any, Any], str]:
    """A key per place: equal where maps, sightings, truth, method, settings, seeds and code are equal."""
    return {place: _digest(basis) for place, basis in bases_of(case, plan).items()}


def bases_of(case: Case, plan: SweepPlan) -> dict[tuple[Any, Any], dict[str, str]]:
    """A digest of each thing that the numbers of a place rest on, by its name."""
    codes = [code(METHODS[plan.method].search.__module__), code(merit.__name__)]
    common = {
        "maps": [_cells_digest(case.ref), _cells_digest(case.mov)],
        "observations": known_to_bytes(case.known).decode() if case.known else "",
        "truth": None if case.truth is None else truth_to_bytes(case.truth).decode(),
        "method": plan.method,
        "seeds": plan.seeds,
        "versions": {**versions(), "code": codes},
    }
    digests = {name: _digest(value) for name, value in common.items()}
    return {place: {**digests, "settings": _digest(plain(plan.config_at(*place)))} for place in plan.places()}


def _digest(value: Any) -> str:
    return sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:32]


def _cells_digest(grid: GridMap) -> str:
    about = repr((grid.cells.shape, grid.resolution, grid.origin)).encode()
    return sha256(about + grid.cells.tobytes()).hexdigest()
