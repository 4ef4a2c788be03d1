"""Maps of different buildings without a sighting: ``make unrelated`` merges pairs and tells what it accepts.

The pairs are those of ``training_pairs`` whose buildings are different ones, from seeds to which the model of
the verdict was not fitted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import count, islice

from training_pairs import TrainingPair, training_pairs

from algorithms.common.errors import MapMergeError
from algorithms.methods.registry import merge
from app.cli.executor_flags import executor_for
from app.jobs.executor import LostTask, Task

FIRST = 20_000  # seed; the model is fitted to lower ones
LIKELIEST = 10  # of them are told by name
AT_A_TIME = 10  # buildings

Told = tuple[str, float, bool]
"""Name of a pair, probability of the answer, whether it was accepted."""


def main(words: Sequence[str] | None = None) -> int:
    """Merge, tell; 1 where any pair was accepted."""
    parser = argparse.ArgumentParser(prog="make unrelated", description=__doc__)
    parser.add_argument("--pairs", type=int, default=1000, help="how many are merged; default: %(default)s")
    parser.add_argument("--first", type=int, default=FIRST, help="seed of the first building")
    parser.add_argument("--jobs", type=int, default=None, help="processes; one per core")
    args = parser.parse_args(words)
    told: list[Told] = []
    for one in islice(_merged(args.first, args.jobs), args.pairs):
        told.append(one)
        if one[2] or len(told) % 50 == 0:
            accepted = sum(each[2] for each in told)
            print(f"{len(told):,} pairs, {accepted} accepted; {one[0]}: P {one[1]:.3f}", flush=True)
    for name, likely, accepted in sorted(told, key=lambda one: -one[1])[:LIKELIEST]:
        print(f"  P {likely:.3f} {'ACCEPTED' if accepted else 'refused '} {name}")
    wrong = sum(accepted for *_, accepted in told)
    print(f"{len(told):,} pairs of unrelated maps without a sighting: {wrong} accepted")
    return 1 if wrong else 0


def _merged(first: int, jobs: int | None) -> Iterator[Told]:
    """All pairs of one building after another, without an end."""
    executor = executor_for(jobs)
    for start in count(first, AT_A_TIME):
        tasks = [Task(seed) for seed in range(start, start + AT_A_TIME)]
        answers = dict(executor.run(told_of, tasks))
        for number in sorted(answers):
            answer = answers[number]
            if isinstance(answer, LostTask):
                sys.stderr.write(f"left out: building {start + number}: {answer.reason}\n")
            else:
                yield from answer


def told_of(_: None, seed: int) -> list[Told]:
    """What becomes of the pairs of one building with others."""
    return [_told(pair) for pair in training_pairs(seed) if pair.kind == "other building"]


def _told(pair: TrainingPair) -> Told:
    case = pair.case
    name = f"{case.name} ({case.source})"
    try:
        verdict = merge(case.ref, case.mov).verdict
    except MapMergeError:
        return name, 0.0, False
    return name, verdict.probability, verdict.accepted


if __name__ == "__main__":
    sys.exit(main())
