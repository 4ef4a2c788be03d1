"""RESULTS.md says of the paper's claims what the numbers say, and nothing else."""

import re
from dataclasses import replace

import findings
import pytest
from findings import Swept
from hypothesis import given
from hypothesis import strategies as st
from repository import ROOT

from algorithms.methods.registry import METHODS
from app.evaluation.method_comparison import ComparedRun, tally
from app.evaluation.method_run import MethodRun
from app.evaluation.sweep import sweep_axes as axes
from app.evaluation.sweep.parameter_sweep import SweepAxis, SweepPlan, SweepPoint

CONFIG = METHODS["spectra-swarm"].defaults
TRIAL = MethodRun((0.0, 0.0, 0.0), True, "Merged.", 0.9, 0.1, 0.01, True, True, 0.5)


def swept(index, x=axes.PARTICLES, xs=(10, 100, 400), y=None, ys=(None,), seconds=None):
    """A sweep whose trials have the index (x, y, seed) tells."""
    plan = SweepPlan(
        "spectra-swarm", CONFIG, SweepAxis(x, xs), None if y is None else SweepAxis(y, ys), (0, 1)
    )
    points = [
        SweepPoint(
            *place,
            tuple(
                replace(TRIAL, index=index(*place, seed), seconds=seconds(place[0]) if seconds else 0.1)
                for seed in (0, 1)
            ),
        )
        for place in plan.places()
    ]
    return Swept("flat", 0.05, plan, tuple(reversed(points)))


def over_both(index):
    return swept(index, axes.SPREAD, (0.5, 1.0, 4.0), axes.INTENSITY, (1.0, 1000.0))


def test_an_intensity_without_influence_reproduces_and_one_with_influence_does_not():
    still = over_both(lambda x, y, seed: 0.9 + 0.01 * x)
    moving = over_both(lambda x, y, seed: 0.9 if y == 1.0 else 0.8)
    assert findings.intensity([still]).holds == "yes"
    assert findings.intensity([moving]).holds == "no"
    assert findings.intensity([still, moving]).holds == "partly"
    assert "0.1000" in findings.intensity([moving]).here


def test_a_spread_with_influence_reproduces_and_one_without_does_not():
    assert findings.spread([over_both(lambda x, y, seed: 0.8 + 0.04 * x)]).holds == "yes"
    assert findings.spread([over_both(lambda x, y, seed: 0.9)]).holds == "no"


def test_more_particles_help_only_where_the_index_rises():
    rising = swept(lambda x, y, seed: 0.8 + x / 4000, seconds=lambda x: x / 100)
    falling = swept(lambda x, y, seed: 0.9 - x / 4000, seconds=lambda x: 1.0)
    assert findings.particles([rising]).holds == "yes"
    assert findings.particles([falling]).holds == "no"
    assert findings.time([rising]).holds == "yes"
    assert findings.time([falling]).holds == "no"


def test_luck_is_how_far_the_seeds_lie_apart():
    steadier = swept(lambda x, y, seed: 0.9 + seed / x)
    assert findings.luck([steadier]).holds == "yes"
    assert steadier.luck() == pytest.approx(0.05)


def test_a_curve_has_settled_from_where_it_stays_near_its_best():
    values = {10: 0.7, 100: 0.905, 400: 0.9}
    assert swept(lambda x, y, seed: values[x]).settled_from() == 100
    assert swept(lambda x, y, seed: -values[x] + 1).settled_from() is None  # it ends far below its best
    assert "nowhere" in findings.enough_particles([swept(lambda x, y, seed: 1 - values[x])]).here


@given(st.dictionaries(st.sampled_from((10, 100, 400)), st.floats(0, 1), min_size=3))
def test_from_there_on_every_value_is_near_the_best_and_the_one_before_is_not(values):
    found = swept(lambda x, y, seed: values[x])
    least, means = found.settled_from(), found.along_x()
    near = {x for x in means if means[x] >= max(means.values()) - findings.FLAT}
    if least is None:
        assert 400 not in near
    else:
        assert {x for x in means if x >= least} <= near
        assert not [x for x in means if x < least] or max(x for x in means if x < least) not in near


def scored(**trials):
    return [
        ComparedRun(f"case_{number}", method.replace("_", "-"), trial)
        for method, found in trials.items()
        for number, trial in enumerate(found)
    ]


WRONG = replace(TRIAL, right=False, fine=False, accepted=False, index=0.97, distance=9.0, angle=3.14)


def test_the_proposed_method_wins_only_where_its_index_is_higher():
    scores = scored(spectra_swarm=[TRIAL], paper_argmax=[replace(WRONG, index=0.5)], bilateral=[WRONG])
    rows = tally(scores)
    assert findings.best_index(rows, "spectra-swarm", "as printed", ["paper-argmax"]).holds == "yes"
    assert (
        findings.best_index(rows, "spectra-swarm", "as printed", ["paper-argmax", "bilateral"]).holds
        == "partly"
    )
    assert findings.slower(rows, "spectra-swarm", ["paper-argmax"]).holds == "no"


def test_what_is_said_of_right_and_wrong_is_counted():
    scores = scored(spectra_swarm=[TRIAL, TRIAL], paper_argmax=[WRONG, replace(WRONG, accepted=True)])
    assert findings.ranking(scores) == "Right transforms, 2 of 2: spectra-swarm; 0 of 2: paper-argmax."
    told = findings.let_pass(scores)
    assert "refused 1 of the 2 wrong transforms and accepted paper-argmax on case_1" in told
    assert "0.970 with a transform 9.0 m and 180° off" in findings.deceptive(scores)
    assert "No method gave a wrong transform" in findings.deceptive(scores[:2])


def test_everything_that_the_results_show_is_there():
    targets = re.findall(r"\]\(([^)#]+)\)", (ROOT / "RESULTS.md").read_text("utf-8"))
    assert len(targets) >= 5
    assert [name for name in targets if not (ROOT / name).is_file()] == []
