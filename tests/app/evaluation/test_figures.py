"""Figures: the same numbers give the same file, whatever they are."""

import io
import subprocess
import sys
from dataclasses import replace

import cv2
import numpy as np
import pytest
from repository import ROOT

from algorithms.methods.registry import METHODS
from app.evaluation.comparison_figure import bars_figure, maps_figure
from app.evaluation.method_comparison import ComparedRun
from app.evaluation.method_run import MethodRun
from app.evaluation.parameter_sweep import SweepPlan, SweepPoint
from app.evaluation.sweep_axes import axis_from
from app.evaluation.sweep_figure import sweep_figure

CONFIG = METHODS["spectra-swarm"].defaults
TRIAL = MethodRun((0.0, 0.0, 0.0), True, "Merged.", 0.9, 0.1, 0.01, True, True, 0.5)


def plan(x, y=None):
    return SweepPlan(
        "spectra-swarm", CONFIG, axis_from(x, CONFIG), None if y is None else axis_from(y, CONFIG), (0, 1)
    )


def points(asked, trial=TRIAL):
    places = enumerate(asked.places())
    return [SweepPoint(*place, (replace(trial, index=n / 100), trial)) for n, place in places]


def opened(files):
    """Height and width of the PNG; the SVG must at least be one."""
    assert set(files) == {".png", ".svg"}
    assert b"<svg" in files[".svg"]
    return cv2.imdecode(np.frombuffer(files[".png"], np.uint8), cv2.IMREAD_COLOR).shape[:2]


PLANS = [
    plan("augment.spread=1:8:4"),
    plan("swarm.particles=10,2000"),
    plan("swarm.particles=10"),
    plan("refine.optimiser=pso,mco"),
    plan("candidates.twins=yes,no", "augment.spread=1,2"),
    plan("augment.spread=0.2:8:30:log", "augment.intensity=1:1000:9"),
    plan("augment.spread=1,2", "refine.optimiser=pso,mco"),
]


@pytest.mark.parametrize("asked", PLANS, ids=lambda asked: f"{asked.x.name}-{asked.y and asked.y.name}")
def test_a_sweep_over_anything_has_a_figure(asked):
    height, width = opened(sweep_figure(asked, points(asked), "flat", 0.05))
    assert width > 1.5 * height


@pytest.mark.parametrize(
    "trial", [replace(TRIAL, right=None, fine=None), replace(TRIAL, index=None, right=None, failed=True)]
)
def test_a_sweep_without_a_truth_or_without_any_result_has_a_figure_too(trial):
    for asked in (PLANS[0], PLANS[-1]):
        told = [SweepPoint(*place, (trial, trial)) for place in asked.places()]
        opened(sweep_figure(asked, told, "flat", 0.05))


def test_the_same_numbers_give_the_same_files_and_others_do_not():
    asked = PLANS[0]
    drawn = sweep_figure(asked, points(asked), "flat", 0.05)
    assert sweep_figure(asked, points(asked), "flat", 0.05) == drawn
    changed = points(asked)
    changed[0] = replace(changed[0], trials=(replace(TRIAL, index=0.5), TRIAL))
    assert sweep_figure(asked, changed, "flat", 0.05)[".svg"] != drawn[".svg"]


@pytest.fixture
def scores(small_case):
    T = small_case.truth.T_ref_mov
    names = list(METHODS)
    trials = [
        replace(TRIAL, T_ref_mov=(T.x, T.y, T.theta)),
        replace(TRIAL, T_ref_mov=(T.x + 40.0, T.y, T.theta), right=False, accepted=False, index=0.2),
        replace(
            TRIAL, T_ref_mov=None, right=False, accepted=False, index=0.0, reason="Refused: too few corners."
        ),
        MethodRun(None, False, "needs a bearing back", None, None, None, None, None, 0.0, failed=True),
        replace(TRIAL, T_ref_mov=(1e6, 1e6, 0.0), right=None),  # a merged map of that size is none
    ]
    return [ComparedRun("flat", name, trial) for name, trial in zip(names, trials, strict=False)]


def test_whatever_became_of_a_method_it_has_its_panel_and_its_bar(small_case, scores):
    opened(maps_figure(small_case, scores, "flat"))
    opened(bars_figure(scores))
    many = [replace(score, case=f"flat_{number}") for number in range(20) for score in scores]
    opened(bars_figure(many))


def test_no_figure_names_the_day_or_the_program_that_made_it(scores):
    files = bars_figure(scores)
    assert b"<dc:date>" not in files[".svg"]
    assert b"Software" not in files[".png"]


def test_matplotlib_is_loaded_where_a_figure_is_drawn_and_nowhere_else():
    code = (
        "import sys\n"
        "from app.evaluation import comparison_files, method_comparison, parameter_sweep\n"
        "from app.evaluation import sweep_axes, sweep_files\n"
        "print('matplotlib' in sys.modules)\n"
        "import app.evaluation.sweep_figure\n"
        "print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert told.stdout.split() == ["False", "True", "False"]
    assert io.StringIO(told.stderr).read() == ""
