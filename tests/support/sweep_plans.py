"""A small sweep, and runs of methods as hypothesis draws them."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import strategies as st

from algorithms.methods.registry import METHODS
from app.evaluation.method_run import MethodRun
from app.evaluation.sweep.parameter_sweep import SweepAxis, SweepPlan

METHOD = "spectra-swarm"

SPREAD, INTENSITY = ("augment", "spread"), ("augment", "intensity")

numbers = st.floats(allow_nan=False, allow_infinity=False)

SMALL = replace(
    METHODS[METHOD].defaults,
    swarm=replace(METHODS[METHOD].defaults.swarm, particles=20, iterations=5),
    refine=replace(METHODS[METHOD].defaults.refine, candidates=1),
)


def plan(**more):
    both = {
        "x": SweepAxis(SPREAD, (0.5, 1.0, 3.0)),
        "y": SweepAxis(INTENSITY, (10.0, 100.0)),
        "seeds": (0, 1),
    }
    return SweepPlan(METHOD, SMALL, **{**both, **more})


def untimed(points):
    return [(point.x, point.y, [replace(trial, seconds=0.0) for trial in point.trials]) for point in points]


trials = st.builds(
    MethodRun,
    T_ref_mov=st.none() | st.tuples(numbers, numbers, numbers),
    accepted=st.booleans(),
    reason=st.text(),
    index=st.none() | st.floats(0, 1),
    distance=st.none() | numbers,
    angle=st.none() | numbers,
    right=st.none() | st.booleans(),
    fine=st.none() | st.booleans(),
    seconds=st.floats(0, 1e6),
    failed=st.booleans(),
)
