"""Ranges of a setting as a person writes them."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.registry import METHODS
from algorithms.observations.search_window import WindowConfig
from app.evaluation.sweep import sweep_axes as axes
from app.evaluation.sweep.sweep_axes import axis_from, setting_named, spaced
from app.model.settings import settings_of, with_value

CONFIG = METHODS["spectra-swarm"].defaults
NUMBERS = [setting for setting in settings_of(CONFIG) if setting.bounds is not None]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("augment.spread=1:8:8", (1, 2, 3, 4, 5, 6, 7, 8)),
        ("augment.spread=0.5:8:5:log", (0.5, 1, 2, 4, 8)),
        ("augment.spread=3,1,3", (3, 1)),
        ("swarm.particles=10:13:8", (10, 11, 12, 13)),  # whole numbers, each once
        ("swarm.particles=200", (200,)),
        ("refine.optimiser=pso,mco", ("pso", "mco")),
        ("candidates.twins=yes,no", (True, False)),
        ("conflict=map1-wins", (ConflictRule.REF_WINS,)),
        ("box.sigma-x=1,2", (1.0, 2.0)),
        ("box.sigma_x=1,2", (1.0, 2.0)),
    ],
)
def test_a_range_is_read_as_it_is_written(text, values):
    assert axis_from(text, CONFIG).values == values


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("augment.spread", "write NAME=V1,V2"),
        ("augment.spread=", "write NAME=V1,V2"),
        ("augment.spred=1,2", "did you mean augment.spread?"),
        ("zebra=1", "known are augment.intensity"),
        ("augment.spread=1:99:5", "must lie in [0.2, 20] m"),
        ("augment.spread=nan", "nan is no number"),
        ("augment.spread=1,,2", "nothing is no number"),
        ("augment.spread=1:2:x", "is no range"),
        ("augment.spread=1:2:3:4", "is no range"),
        ("augment.spread=1:2:1", "let it be 2 to 200"),
        ("augment.spread=1:2:900", "let it be 2 to 200"),
        ("augment.spread=5:2:4", "let it go up"),
        ("verdict.bent_from=0:1:4:log", "start above 0"),
        ("swarm.particles=12.5", "is no whole number"),
        ("refine.optimiser=psi", "psi is none of pso, mco"),
        ("refine.optimiser=1:2:3", "is none of pso, mco"),
        ("candidates.twins=maybe", "maybe is none of yes, no"),
    ],
)
def test_what_is_no_range_is_refused_with_a_remedy(text, remedy):
    with pytest.raises(SettingError) as refused:
        axis_from(text, CONFIG)
    assert remedy in str(refused.value)


@given(st.sampled_from(NUMBERS), st.data())
def test_a_range_within_the_bounds_is_legal_goes_up_and_keeps_its_ends(setting, data):
    low, high = setting.bounds.low, setting.bounds.high
    if setting.whole:
        low, high = sorted(
            data.draw(st.lists(st.integers(int(low), int(high)), min_size=2, max_size=2, unique=True))
        )
    by_factor = low > 0 and data.draw(st.booleans())
    values = spaced(setting, low, high, data.draw(st.integers(2, 50)), by_factor)
    assert list(values) == sorted(set(values))
    assert (values[0], values[-1]) == (low, high)
    assert all(isinstance(value, int) == setting.whole for value in values)
    for value in values:
        with_value(CONFIG, setting.path, value)


@pytest.mark.parametrize("cell", [0.02, 0.05, 0.1, 0.5])
def test_the_papers_sweeps_are_legal_in_maps_of_any_cells(cell):
    both = axes.intensity_and_spread("spectra-swarm", CONFIG, cell)
    assert (both.x.path, both.y.path) == (axes.SPREAD, axes.INTENSITY)
    assert len(both.x.values) >= 3
    assert len(both.seeds) == 10
    assert axes.particles("spectra-swarm", CONFIG).y is None


def test_squared_cells_become_a_standard_deviation_in_metres():
    assert axes.in_metres(100, 0.05) == pytest.approx(0.5)
    spreads = axes.intensity_and_spread("spectra-swarm", CONFIG, 0.05).x.values
    assert axes.in_metres(105, 0.05) in spreads
    assert axes.in_metres(74, 0.05) in spreads


def test_a_setting_is_found_by_the_name_of_its_flag():
    assert setting_named("box.sigma-theta", CONFIG).path == ("box", "sigma_theta")
    other = replace(CONFIG, window=WindowConfig(kind="coupled"))
    assert setting_named("window.kind", other).default == "coupled"
