"""What measured numbers say of the paper's claims. A claim holds where the numbers do, and nowhere else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees
from typing import Literal

from app.evaluation.method_comparison import ComparedRun, MethodTotals, tally
from app.evaluation.method_run import MethodRun
from app.evaluation.sweep.parameter_sweep import Spread, SweepPlan, SweepPoint, in_order

NEXT_TO_NOTHING = 0.005  # of eq. (23): half a hundredth of the overlap
FLAT = 0.01  # within so much of the best, a curve has come to its end

Holds = Literal["yes", "partly", "no"]


@dataclass(frozen=True)
class Finding:
    """A claim of the paper, and what came out here."""

    claim: str
    here: str
    holds: Holds


@dataclass(frozen=True)
class Swept:
    """A finished sweep of one pair."""

    name: str
    cell: float
    plan: SweepPlan
    points: tuple[SweepPoint, ...]

    def along_x(self) -> dict[float, float]:
        """Mean eq. (23) per value of x, over all of y."""
        means: dict[float, list[float]] = {}
        for point in in_order(self.plan, self.points):
            if point.index is not None:
                means.setdefault(point.x, []).append(point.index.mean)
        return {x: sum(values) / len(values) for x, values in means.items()}

    def across_y(self) -> float:
        """The most by which y changes the mean of eq. (23), at any x."""
        by_x: dict[float, list[float]] = {}
        for point in self.points:
            if point.index is not None:
                by_x.setdefault(point.x, []).append(point.index.mean)
        return max(max(values) - min(values) for values in by_x.values())

    def luck(self) -> float:
        """The largest standard deviation over the seeds, at any point."""
        return max(point.index.deviation for point in self.points if point.index is not None)

    def settled_from(self) -> float | None:
        """The least x from which on eq. (23) stays within FLAT of the best; None where it ends lower."""
        means = self.along_x()
        best, least = max(means.values()), None
        for x in sorted(means, reverse=True):
            if means[x] < best - FLAT:
                break
            least = x
        return least

    def ends(self) -> tuple[SweepPoint, SweepPoint]:
        """The points of the least and of the greatest x."""
        first, *_, last = in_order(self.plan, self.points)
        return first, last


def _each(told: Sequence[str]) -> str:
    """A line of a table's cell for each pair, below what is said of them."""
    return "".join(f"<br>{line}" for line in told)


def _known(point: SweepPoint) -> Spread:
    assert point.index is not None
    return point.index


def held(oks: Sequence[bool]) -> Holds:
    """Whether something holds of all, of some or of none."""
    return "yes" if all(oks) else "partly" if any(oks) else "no"


def intensity(sweeps: Sequence[Swept]) -> Finding:
    """Fig. 13: I_a does not affect the index."""
    told = [
        f"{swept.name}: by {swept.across_y():.4f} at most (another seed: ± {swept.luck():.4f})"
        for swept in sweeps
    ]
    low, high = min(sweeps[0].plan.y.values), max(sweeps[0].plan.y.values)  # type: ignore[union-attr]
    return Finding(
        "I_a does not affect the index (Fig. 13)",
        f"From I_a = {low:g} to {high:g} the mean of eq. (23) changes:{_each(told)}<br>"
        "In exact arithmetic it could not change at all: I_a scales Γ and nothing else",
        held([swept.across_y() <= NEXT_TO_NOTHING for swept in sweeps]),
    )


def spread(sweeps: Sequence[Swept]) -> Finding:
    """Fig. 13: Σ_a has a significant influence."""
    oks, told = [], []
    for swept in sweeps:
        means = swept.along_x()
        low, high = min(means.values()), max(means.values())
        oks.append(high - low > max(FLAT, 3 * swept.across_y()))
        told.append(f"{swept.name}: {low:.3f} … {high:.3f}")
    return Finding(
        "Σ_a has a significant influence (Fig. 13)",
        f"Mean of eq. (23) over the values of Σ_a:{_each(told)}",
        held(oks),
    )


def enough_spread(sweeps: Sequence[Swept]) -> Finding:
    """Fig. 13: Σ_a had to be more than 105 squared cells for one pair, 74 for the other."""
    cells, told = [], []
    for swept in sweeps:
        metres = swept.settled_from()
        cells.append(0.0 if metres is None else (metres / swept.cell) ** 2)
        told.append(
            f"{swept.name}: nowhere"
            if metres is None
            else f"{swept.name}: from {cells[-1]:.0f} on ({metres:g} m)"
        )
    return Finding(
        "Σ_a is to be chosen above 105 and 74 squared cells, and by the environment (Fig. 13)",
        f"Squared cells from which on eq. (23) stays within {FLAT:g} of its best:{_each(told)}",
        held([50 < least < 230 for least in cells]),
    )


def particles(sweeps: Sequence[Swept]) -> Finding:
    """Fig. 14: the index increases with the number of particles."""
    oks, told = [], []
    for swept in sweeps:
        first, last = swept.ends()
        few, many = _known(first), _known(last)
        oks.append(many.mean - few.mean > NEXT_TO_NOTHING)
        told.append(
            f"{swept.name}: {few.mean:.3f} ± {few.deviation:.3f} with {first.x}, "
            f"{many.mean:.3f} ± {many.deviation:.3f} with {last.x}"
        )
    return Finding("More particles, a higher index (Fig. 14)", f"Eq. (23):{_each(told)}", held(oks))


def luck(sweeps: Sequence[Swept]) -> Finding:
    """Not in the paper: more particles, less difference between the seeds."""
    oks, told = [], []
    for swept in sweeps:
        few, many = (_known(point) for point in swept.ends())
        oks.append(many.deviation < few.deviation)
        told.append(
            f"{swept.name}: ± {few.deviation:.4f} with the fewest, ± {many.deviation:.4f} with the most"
        )
    return Finding(
        "More particles, less difference between seeds (not in the paper)",
        f"Standard deviation of eq. (23) over the seeds:{_each(told)}",
        held(oks),
    )


def enough_particles(sweeps: Sequence[Swept]) -> Finding:
    """Fig. 14: more than 400 are proper."""
    needed = {swept.name: swept.settled_from() for swept in sweeps}
    told = [f"{name}: " + ("nowhere" if n is None else f"from {n:g} on") for name, n in needed.items()]
    return Finding(
        "More than 400 particles are proper (Fig. 14)",
        f"Particles from which on the mean of eq. (23) stays within {FLAT:g} of its best:{_each(told)}",
        held([n is not None and 200 <= n <= 800 for n in needed.values()]),
    )


def time(sweeps: Sequence[Swept]) -> Finding:
    """Fig. 14: the time increases with the number of particles."""
    oks, told = [], []
    for swept in sweeps:
        first, last = swept.ends()
        oks.append(last.seconds.median > first.seconds.median)
        told.append(
            f"{swept.name}: {first.seconds.median:.2f} s with {first.x}, "
            f"{last.seconds.median:.2f} s with {last.x}"
        )
    return Finding("More particles, more time (Fig. 14)", f"Median of a merge:{_each(told)}", held(oks))


def best_index(rows: Mapping[str, MethodTotals], ours: str, known_as: str, rivals: Sequence[str]) -> Finding:
    """Fig. 17: the proposed method has a higher index than the others.

    known_as : which of the ways to read the paper this method is
    """
    mine = rows[ours].index or 0.0
    beaten = {name: (rows[name].index or 0.0) < mine for name in rivals if rows[name].index is not None}
    told = [f"{name} {rows[name].index or 0.0:.3f}" for name in beaten]
    return Finding(
        f"The proposed method, {known_as}, has a higher index than SMM only, MSE, Harris, Shi–Tomasi and "
        "SURF (Fig. 17)",
        f"Mean of eq. (23) over the pairs: {ours} {mine:.3f}<br>{', '.join(told)}",
        held(list(beaten.values())),
    )


def slower(rows: Mapping[str, MethodTotals], ours: str, rivals: Sequence[str]) -> Finding:
    """Section IV-C: the proposed method takes longer than the others."""
    mine = rows[ours].seconds or 0.0
    others = {name: rows[name].seconds or 0.0 for name in rivals if rows[name].seconds is not None}
    told = [f"{name} {seconds:.2f}" for name, seconds in others.items()]
    return Finding(
        "The proposed method takes longer than the others (section IV-C)",
        f"Median seconds of a merge: {ours} {mine:.2f}<br>{', '.join(told)}",
        held([seconds < mine for seconds in others.values()]),
    )


# ---- sentences that need no claim of the paper


def deceptive(scores: Sequence[ComparedRun]) -> str:
    """How high eq. (23) gets where the transform is wrong."""
    wrong = [score for score in scores if score.trial.wrong and score.trial.index is not None]
    if not wrong:
        return "No method gave a wrong transform on these pairs."
    worst = max(wrong, key=lambda score: score.trial.index or 0.0)
    right = [score.trial.index for score in scores if score.trial.right and score.trial.index is not None]
    lowest = f", as right ones do from {min(right):.3f} on" if right else ""
    return (
        f"Eq. (23) alone does not tell right from wrong: {worst.method} on {worst.case} reaches "
        f"{worst.trial.index:.3f} with a transform {_off(worst.trial)} off{lowest}. "
        "Most of an overlap is floor, and floor on floor agrees."
    )


def _off(trial: MethodRun) -> str:
    if trial.distance is None or trial.angle is None:
        return "far"
    return f"{trial.distance:.1f} m and {degrees(trial.angle):.0f}°"


def ranking(scores: Sequence[ComparedRun]) -> str:
    """Who is right how often, best first."""
    rows = tally(scores)
    counts: dict[tuple[int, int], list[str]] = {}
    for name, row in rows.items():
        if row.judged:
            counts.setdefault((row.right, row.judged), []).append(name)
    ordered = sorted(counts, key=lambda key: (-key[0] / key[1], -key[0]))
    parts = [f"{right} of {judged}: {', '.join(counts[right, judged])}" for right, judged in ordered]
    return f"Right transforms, {'; '.join(parts)}."


def let_pass(scores: Sequence[ComparedRun]) -> str:
    """What the verdict made of the wrong transforms."""
    wrong = [score for score in scores if score.trial.wrong]
    passed = [score for score in wrong if score.trial.accepted]
    told = f"The verdict refused {len(wrong) - len(passed)} of the {len(wrong)} wrong transforms"
    if passed:
        told += f" and accepted {', '.join(f'{score.method} on {score.case}' for score in passed)}"
    right = [score for score in scores if score.trial.right and score.trial.T_ref_mov is not None]
    lost = sum(not score.trial.accepted for score in right)
    return f"{told}; of the {len(right)} right ones it refused {lost}."


def spread_rows(swept: Swept) -> list[list[str]]:
    """A table of a sweep over spread and intensity: a row per spread."""
    assert swept.plan.y is not None
    rows = [["Σ_a (squared cells)", "spread (m)", *(f"I_a = {value:g}" for value in swept.plan.y.values)]]
    at = {(point.x, point.y): point for point in swept.points}
    for x in swept.plan.x.values:
        cells = [f"{(x / swept.cell) ** 2:.0f}", f"{x:g}"]
        for y in swept.plan.y.values:
            index = at[x, y].index
            cells.append("–" if index is None else f"{index.mean:.3f} ± {index.deviation:.3f}")
        rows.append(cells)
    return rows


def particle_rows(swept: Swept) -> list[list[str]]:
    """A table of a sweep over the number of particles."""
    rows = [["particles", "eq. (23)", "right", "median time (s)"]]
    for point in in_order(swept.plan, swept.points):
        index = "–" if point.index is None else f"{point.index.mean:.3f} ± {point.index.deviation:.3f}"
        rows.append(
            [f"{point.x}", index, f"{point.right} of {len(point.trials)}", f"{point.seconds.median:.2f}"]
        )
    return rows
