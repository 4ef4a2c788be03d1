"""The model of the verdict, fitted anew: ``make verdict``.

There are two models: of answers near a sighting, found by the default method, and of answers from all that a
rough pose, a rough turn or nothing leaves of the plane. Either method merges pairs of simulated buildings,
right and wrong ones; the weights are fitted to what the whole maps say of its answers, and tried on buildings
that were left out. Cases with a known truth can be
added with --cases: they are not fitted to, but tell how the model does on other buildings, and a model fitted
to them alone tells the reverse.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import exp, log, pi, radians
from pathlib import Path
from typing import Any, get_args

import numpy as np
from markdown_table import markdown
from model_fit import Example, Forecast, cross_validated, fit, most_likely_wrong, predict
from reliability_figure import reliability_figure
from training_pairs import training_pairs

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.files.atomic_write import write_files
from algorithms.files.case_folder import Case, case_folders, group_of, name_in
from algorithms.files.truth_file import Truth
from algorithms.methods import registry as methods
from algorithms.methods.refusal_causes import NO_SWARM
from algorithms.observations.pair_problem import Known
from algorithms.simulator.portable_random import pick, stream, uniform
from algorithms.simulator.rough_priors import met_at, rough_prior
from algorithms.simulator.scenario import SimulatedCase
from algorithms.verdict.calibration import brier_score, calibration_error
from algorithms.verdict.probability_model import MODEL_FILE, ModelKind, VerdictModel
from app.cli.executor_flags import executor_for
from app.cli.progress_bar import bar
from app.evaluation.case_knowledge import known_of
from app.evaluation.crossed_pairs import Crossing, Pair, building_of, crossings, read_pair
from app.evaluation.dataset_evaluation import rough_folders
from app.evaluation.table_files import aligned
from app.jobs.executor import Executor, LostTask, Task
from app.system import data_paths

FIRST = 8000  # seed; the tests and the samples use lower ones
BUILDINGS = 300
LEAST_BUILDINGS = 20  # with fewer, leaving a fold out leaves next to nothing
LEAST_KNOWN = 3  # buildings of the cases: two are left out at a time, and something must be left
PATIENCE = 4  # of the proof, in 10⁵ nodes: wrong pairs would take it all
NEVER_BELOW = 0.6  # what is right six times in ten is no merge to build on
LOG_XY = log(0.3), log(5.0)  # of metres; what a rough pose is known to
YAW = 3.0, 30.0  # degrees; likewise its turn
OTHER_KNOWLEDGE = ("none", "turn", "initial")
STEP = 0.01  # of the probability from which on merges are accepted
FIGURES = data_paths.static() / "results"


@dataclass(frozen=True, eq=False)
class Labelled:
    """An example and what it is: "right", or a kind of wrong pair; "fine" and "rough" of the cases."""

    example: Example
    kind: str


def main(words: Sequence[str] | None = None) -> int:
    """Make the pairs, fit, try, write; the exit status."""
    args = _arguments(words)
    try:
        return _train(args)
    except MapMergeError as error:
        sys.stderr.write(f"make verdict: {error}\n")
        return 2


def _train(args: argparse.Namespace) -> int:
    executor = executor_for(args.jobs)
    real = [] if args.cases is None else list(_cases(args, executor))
    seeds = range(args.first, args.first + args.buildings)
    made = list(_all(executor, _simulated, [Task((seed, args.model)) for seed in seeds], "building"))
    examples = [each.example for each in made]
    told = cross_validated(examples, args.model)
    accept_from = _accept_from(_of_kind(told, made, "other building"))
    kinds = list(dict.fromkeys(each.kind for each in made))
    words = f"--model {args.model} --buildings {args.buildings} --first {args.first}"
    made_of = {
        "command": f"make verdict ARGS='{words}'",
        "buildings": args.buildings,
        "pairs": {kind: sum(each.kind == kind for each in made) for kind in kinds},
        "wrong_accepted_when_left_out": {
            kind: int(_wrongly(_of_kind(told, made, kind), accept_from)) for kind in kinds
        },
    }
    model = fit(examples, args.model, accept_from, made_of)
    rows = [
        ["fitted to", "tried on", "merges", "right", "right and accepted", "wrong accepted", "ECE", "Brier"],
        _row("simulated buildings", "the others of them", told, accept_from),
    ]
    rows += [
        _row("simulated buildings", f"the others of them, {kind}", _of_kind(told, made, kind), accept_from)
        for kind in kinds
    ]
    pictures = {"simulated buildings, left out in turn": told}
    if args.cases is not None:
        tried = predict(model, [each.example for each in real])
        rows += [_row("simulated buildings", "the cases", tried, accept_from)]
        rows += [
            _row("simulated buildings", f"the cases, {kind}", _of_kind(tried, real, kind), accept_from)
            for kind in dict.fromkeys(each.kind for each in real)
        ]
        own = [each.example for each in real]
        if len({building for each in own for building in each.buildings}) >= LEAST_KNOWN:
            rows += [
                _row("the cases", "the others of them", cross_validated(own, args.model), accept_from),
                _row(
                    "the cases", "simulated buildings", predict(fit(own, args.model), examples), accept_from
                ),
            ]
        pictures["cases, fitted to simulated buildings"] = tried
    for line in aligned(rows):
        print(line)
    print(f"accepted from {accept_from:g}, none of the pairs of other buildings being accepted from there")
    _write(args, model, rows, pictures)
    return 0


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make verdict", description=__doc__)
    parser.add_argument("--model", choices=get_args(ModelKind), default="sighting", help="which of the two")
    parser.add_argument("--buildings", type=int, default=BUILDINGS, help="how many are simulated")
    parser.add_argument("--first", type=int, default=FIRST, help="seed of the first")
    parser.add_argument("--cases", type=Path, help="folder of cases with a known truth, to try it on")
    parser.add_argument("--wrong-pairs", type=int, default=700, help="crossed pairs of these cases")
    parser.add_argument("--out", type=Path, default=MODEL_FILE, help="the model's file")
    parser.add_argument("--figures", type=Path, default=FIGURES, help="folder of the diagram and the table")
    parser.add_argument("--jobs", type=int, default=None, help="processes; one per core")
    args = parser.parse_args(words)
    if args.buildings < LEAST_BUILDINGS:
        parser.error(f"--buildings {args.buildings} is too few; give {LEAST_BUILDINGS} at least")
    return args


def _accept_from(told: Forecast) -> float:
    """The lowest round probability from which on none of these wrong pairs was accepted, each of them left
    out of the fit.
    """
    safe = np.ceil(most_likely_wrong(told) / STEP + 1e-9) * STEP
    return round(float(min(max(safe, NEVER_BELOW), 0.99)), 2)


def _row(fitted: str, tried: str, told: Forecast, accept_from: float) -> list[str]:
    accepted = told.probabilities >= accept_from
    right = int(told.right.sum())
    return [
        fitted,
        tried,
        f"{len(told.right):,}",
        f"{right:,}",
        f"{int((accepted & told.right).sum()) / right:.1%}" if right else "–",
        str(_wrongly(told, accept_from)),
        f"{calibration_error(told.probabilities, told.right):.3f}",
        f"{brier_score(told.probabilities, told.right):.3f}",
    ]


def _wrongly(told: Forecast, accept_from: float) -> int:
    return int(np.count_nonzero(~told.right & (told.probabilities >= accept_from)))


def _of_kind(told: Forecast, of: Sequence[Labelled], kind: str) -> Forecast:
    mine = np.array([each.kind == kind for each in of])
    return Forecast(told.probabilities[mine], told.right[mine])


def _write(
    args: argparse.Namespace,
    model: VerdictModel,
    rows: Sequence[Sequence[str]],
    pictures: dict[str, Forecast],
) -> None:
    plain = json.loads(args.out.read_bytes()) if args.out.exists() else {}
    plain[args.model] = {
        "weights": {name: round(weight, 4) for name, weight in model.weights.items()},
        "bias": round(model.bias, 4),
        "typical": {name: round(value, 4) for name, value in model.typical.items()},
        "accept_from": model.accept_from,
        "made_of": model.made_of,
    }
    text = json.dumps(plain, indent=2, ensure_ascii=False) + "\n"
    files = {args.out: text.encode()}
    name = "verdict" if args.model == "sighting" else f"verdict_{args.model}"
    files[args.figures / f"{name}.md"] = (markdown(rows) + "\n").encode()
    for suffix, data in reliability_figure(pictures).items():
        files[args.figures / f"{name}{suffix}"] = data
    write_files(files)
    print(f"written: {', '.join(str(path) for path in files)}")


# ---- merges ------------------------------------------------------------------------------------------


def _all(executor: Executor, work: Any, tasks: Iterable[Task], unit: str) -> Iterator[Labelled]:
    """What came of all tasks, in their order: who did them, and when, must not matter to the fit."""
    listed = list(tasks)
    answers: dict[int, list[Labelled]] = {}
    for number, answer in bar(iterable=executor.run(work, listed), total=len(listed), unit=unit):
        if isinstance(answer, LostTask):
            sys.stderr.write(f"left out: {unit} {number}: {answer.reason}\n")
        else:
            answers[number] = answer
    for number in sorted(answers):
        yield from answers[number]


def _simulated(_: None, given: tuple[int, ModelKind]) -> list[Labelled]:
    """The merges of all pairs of one building."""
    seed, model = given
    rng, out = stream(seed, "knowledge"), list[Labelled]()
    for pair in training_pairs(seed):
        case = pair.case
        truth = None
        if pair.kind == "right":
            bent = case.truth_rms > 0.1
            truth = Truth(case.T_ref_mov, max(0.5, 2 * case.truth_rms), radians(6 if bent else 3))
        if model == "sighting":
            knowledge: Sequence[tuple[Known, ...]] = [pair.observations]
        elif pair.kind == "wrong sighting":
            continue
        else:
            knowledge = [(), _drawn_prior(case, rng)]
        for known in knowledge:
            example = _example(case, known, truth, pair.buildings, model)
            out += [] if example is None else [Labelled(example, pair.kind)]
    return out


def _drawn_prior(case: SimulatedCase, rng: np.random.Generator) -> tuple[Known, ...]:
    """A rough turn, or a rough initial pose as narrow or wide as people know it; of a wrong pair one of those
    that put robot 2 where it was seen.
    """
    T = case.T_ref_mov or met_at(case.observations[0], uniform(rng, -pi, pi))
    sigma_xy, sigma_yaw = exp(uniform(rng, *LOG_XY)), radians(uniform(rng, *YAW))
    return rough_prior(T, pick(rng, ("turn", "initial")), rng, sigma_xy, sigma_yaw)


def _cases(args: argparse.Namespace, executor: Executor) -> Iterator[Labelled]:
    """The cases of a folder with either observation, or all other knowledge, and wrong pairs of them."""
    root, both = args.cases, set(rough_folders(args.cases))
    pairs: list[tuple[Pair, str]] = []
    for folder in case_folders(root):
        ways = ("fine", "rough")[: 1 + (folder in both)] if args.model == "sighting" else OTHER_KNOWLEDGE
        pairs += [(folder, way) for way in ways]
    ways = ("fine", "rough") if args.model == "sighting" else OTHER_KNOWLEDGE
    wrong = crossings(root, args.wrong_pairs) if args.wrong_pairs else []
    pairs += [(crossing, ways[number % len(ways)]) for number, crossing in enumerate(wrong)]
    yield from _all(executor, _real, [Task((root, *pair)) for pair in pairs], "case")


def _real(_: None, given: tuple[Path, Pair, Any]) -> list[Labelled]:
    root, pair, way = given
    case = read_pair(pair, way == "rough")
    if case.truth is None:
        return []
    buildings: tuple[str, ...]
    if isinstance(pair, Crossing):
        buildings = pair.buildings
    else:
        buildings = (building_of(group_of(name_in(root, pair)), case.truth),)
    shared = case.truth.expected == "merge"
    kind = way if shared else "wrong pair"
    truth = case.truth if shared else None
    known: tuple[Known, ...] = case.observations
    model: ModelKind = "sighting"
    if way in OTHER_KNOWLEDGE:
        known, model = known_of(case, way), "plane"
    example = _example(case, known, truth, buildings, model)
    return [] if example is None else [Labelled(example, kind)]


def _example(
    case: Case | SimulatedCase,
    known: tuple[Known, ...],
    truth: Truth | None,
    buildings: tuple[str, ...],
    model: ModelKind,
) -> Example | None:
    """What a method's answers are worth, and which are right; None where it cannot be run."""
    method = methods.DEFAULT_METHOD if model == "sighting" else methods.PLANE_METHOD
    config = methods.METHODS[method].defaults
    if model == "sighting":
        config = replace(config, swarm=NO_SWARM, proof=replace(config.proof, patience=PATIENCE))
    try:
        result = methods.merge(case.ref, case.mov, known, method, config)
    except MapMergeError:
        return None
    rows = [list(each.quantities.values()) for each in result.weighed]
    first = case.observations[0]
    at = np.array([first.observed_x, first.observed_y])
    right = [_is_right(each.T_ref_mov, truth, at) for each in result.weighed]
    return Example(np.array(rows), np.array(right, dtype=np.bool_), buildings)


def _is_right(T: Pose2, truth: Truth | None, at: FloatArray) -> bool:
    if truth is None or truth.T_ref_mov is None:
        return False
    return truth.allows(*pose_error(T, truth.T_ref_mov, at))


if __name__ == "__main__":
    sys.exit(main())
