"""Figures: the numbers stand in them where they belong, and the same give the same file."""

import io
import re
import subprocess
import sys
from dataclasses import replace

import cv2
import numpy as np
import pytest
from model_fit import Forecast
from reliability_figure import reliability_figure
from repository import ROOT

from algorithms.methods.registry import METHODS
from app.evaluation.comparison_figure import NOTHING, RIGHT, WRONG, bars_figure, maps_figure
from app.evaluation.figure_style import COLOURS
from app.evaluation.method_comparison import ComparedRun
from app.evaluation.method_run import MethodRun
from app.evaluation.sweep.parameter_sweep import SweepPlan, SweepPoint
from app.evaluation.sweep.sweep_axes import axis_from
from app.evaluation.sweep.sweep_figure import sweep_figure

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
    """Height and width of the PNG; not one colour only."""
    assert set(files) == {".png", ".svg"}
    picture = cv2.imdecode(np.frombuffer(files[".png"], np.uint8), cv2.IMREAD_COLOR)
    assert np.ptp(picture) > 100
    return picture.shape[:2]


def words(files):
    """What stands in a figure; matplotlib notes it beside the letters that it draws as paths."""
    return [text.strip() for text in re.findall(r"<!--(.*?)-->", files[".svg"].decode(), re.DOTALL)]


def shapes(files, style):
    """(N, 2) corners of every path of a style, in points, y downwards."""
    found = re.findall(r'<path d="([^"]*)"[^>]*style="([^"]*)"', files[".svg"].decode())
    numbers = [re.findall(r"[ML] (-?[\d.]+) (-?[\d.]+)", path) for path, how in found if style in how]
    return [np.array(corners, dtype=float) for corners in numbers]


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
    files = sweep_figure(asked, points(asked), "flat of ours", 0.05)
    height, width = opened(files)
    assert width > 1.5 * height
    told = words(files)
    for axis in filter(None, (asked.x, asked.y)):
        assert asked.setting(axis).label in told
    assert any("flat of ours" in text for text in told)


def test_the_curve_of_a_sweep_goes_through_the_means_at_their_places():
    asked = plan("augment.spread=1,2,3,7")
    means = (0.9, 0.7, 0.8, 0.5)
    told = [
        SweepPoint(*place, (replace(TRIAL, index=mean),) * 2)
        for place, mean in zip(asked.places(), means, strict=True)
    ]
    files = sweep_figure(asked, told, "flat", 0.05)
    curves = [path for path in shapes(files, f"stroke: {COLOURS[0]}") if len(path) == 4]
    assert curves
    x, y = curves[0].T
    assert (x - x[0]) / (x[-1] - x[0]) == pytest.approx(np.array([0, 1, 2, 6]) / 6, abs=0.01)
    assert (y[0] - y) / (y[0] - y[-1]) == pytest.approx((0.9 - np.array(means)) / 0.4, abs=0.01)


def test_of_two_settings_each_pair_has_its_mean_in_the_field_and_each_value_its_curve():
    asked = plan("augment.spread=1,2", "refine.optimiser=pso,mco")
    told = words(sweep_figure(asked, points(asked), "flat", 0.05))
    for n in range(4):  # of two seeds
        assert f"{(n / 100 + TRIAL.index) / 2:.3f}".removeprefix("0") in told
    assert told.count("pso") == told.count("mco") == 2  # beside the field, and in the legend


def test_where_nothing_has_come_out_no_curve_is_drawn():
    asked = PLANS[0]
    failed = replace(TRIAL, index=None, right=None, failed=True)
    none = [SweepPoint(*place, (failed, failed)) for place in asked.places()]

    def curves(told):
        paths = shapes(sweep_figure(asked, told, "flat", 0.05), f"stroke: {COLOURS[0]}")
        return [path for path in paths if len(path) == len(told)]

    assert curves(points(asked))
    assert not curves(none)


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


def test_whatever_became_of_a_method_it_has_its_panel_with_what_that_was(small_case, scores):
    files = maps_figure(small_case, scores, "a flat of ours")
    opened(files)
    told = " ".join(words(files))  # a long title has two lines
    for score in scores:
        assert METHODS[score.method].title in told
    assert "could not be run" in told
    assert "no transform" in told
    assert "WRONG" in told
    assert "0.200" in told
    assert "a flat of ours" in told


def test_every_method_has_a_bar_as_long_as_its_number_in_the_colour_of_what_it_means(scores):
    files = bars_figure(scores)
    opened(files)
    told = words(files)
    assert {score.method for score in scores} <= set(told)
    assert {"0.90", "0.20", "no transform", "not run"} <= set(told)
    right, wrong, unknown = (
        max(np.ptp(path[:, 0]) for path in shapes(files, style) if np.ptp(path[:, 1]) > 8)
        for style in (f"fill: {RIGHT}", f"stroke: {WRONG}", f"fill: {NOTHING}")
    )
    assert right == pytest.approx(unknown)
    assert wrong == pytest.approx(right * 0.2 / TRIAL.index, rel=0.01)


def test_of_many_cases_each_method_has_its_mean_and_a_dot_for_each(scores):
    indexes = np.linspace(0.3, 0.8, 20)
    many = [
        replace(score, case=f"flat_{number}", trial=replace(score.trial, index=index))
        for number, index in enumerate(indexes)
        for score in scores[:1]
    ]
    files = bars_figure(many)
    opened(files)
    assert f"{indexes.mean():.3f}" in words(files)
    places = re.findall(r'<use [^>]*x="([\d.]+)" y="[\d.]+" style="fill: ' + RIGHT, files[".svg"].decode())
    assert len(places) == 20
    assert np.ptp(np.diff(sorted(map(float, places)))) < 0.01  # as far apart as their numbers


def test_a_reliability_diagram_tells_how_many_merges_each_point_stands_for():
    said = np.repeat([0.05, 0.95], [30, 70])
    right = np.r_[np.zeros(30, dtype=bool), np.ones(70, dtype=bool)]
    files = reliability_figure({"sample": Forecast(said, right)})
    opened(files)
    told = words(files)
    assert {"30", "70"} <= set(told)
    assert any("sample" in text and "100" in text and "0.050" in text for text in told)
    (curve,) = (path for path in shapes(files, f"stroke: {COLOURS[0]}") if len(path) == 2)
    assert curve[1, 0] > curve[0, 0]
    assert curve[1, 1] < curve[0, 1]
    badly = reliability_figure({"sample": Forecast(said, ~right)})
    assert any("0.950" in text for text in words(badly))


def test_no_figure_names_the_day_or_the_program_that_made_it(scores):
    files = bars_figure(scores)
    assert b"<dc:date>" not in files[".svg"]
    assert b"Software" not in files[".png"]


def test_matplotlib_is_loaded_where_a_figure_is_drawn_and_nowhere_else():
    code = (
        "import sys\n"
        "from app.evaluation import comparison_files, method_comparison\n"
        "from app.evaluation.sweep import parameter_sweep, sweep_axes, sweep_files\n"
        "print('matplotlib' in sys.modules)\n"
        "import app.evaluation.sweep.sweep_figure\n"
        "print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert told.stdout.split() == ["False", "True", "False"]
    assert io.StringIO(told.stderr).read() == ""
