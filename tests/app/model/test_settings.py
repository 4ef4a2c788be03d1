"""Settings of a config as a panel shows them."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated, Literal

import pytest

from algorithms.common.errors import SettingError
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.methods.registry import METHODS
from algorithms.methods.spectra_config import PipelineConfig
from app.model.settings import field_docs, in_cells, settings_of, value_at, with_value, word_for
from app.page.panels.settings_panel import idle


class Rule(str, Enum):
    FIRST = "first-wins"
    LAST = "last-wins"


@dataclass(frozen=True)
class Inner(CheckedConfig):
    """A stage."""

    width: Annotated[float, Bounds(0.5, 2.0, 0.1, "m", "σ_w", "width")] = 1.0
    """How wide. Wider
    takes longer."""
    count: Annotated[int, Bounds(1, 9, 1)] = 3
    plain: bool = True
    """On or off."""


@dataclass(frozen=True)
class Outer:
    """Everything."""

    inner: Inner = field(default_factory=Inner)
    rule: Rule = Rule.FIRST
    """Who wins."""
    kind: Literal["pso", "mco"] = "pso"


def named(config):
    return {".".join(setting.path): setting for setting in settings_of(config)}


def test_a_field_with_bounds_becomes_a_slider_with_symbol_unit_and_hint():
    setting = named(Outer())["inner.width"]
    assert setting.label == "σ_w width (m)"
    assert setting.hint == "How wide. Wider takes longer."
    assert setting.bounds == Bounds(0.5, 2.0, 0.1, "m", "σ_w", "width")
    assert not setting.whole


def test_a_bare_number_is_named_after_its_field():
    setting = named(Outer())["inner.count"]
    assert (setting.label, setting.hint, setting.whole) == ("count", "", True)


def test_switches_enums_and_literals_become_choices():
    settings = named(Outer())
    assert settings["inner.plain"].choices is None
    assert settings["rule"].choices == {"first-wins": Rule.FIRST, "last-wins": Rule.LAST}
    assert settings["kind"].choices == {"PSO": "pso", "MCO": "mco"}
    assert word_for(settings["kind"], "mco") == "MCO"


def test_a_choice_of_words_reads_like_words_and_a_kind_says_of_what():
    window = named(PipelineConfig())["window.kind"]
    assert set(window.choices) == {"Coupled", "Encounter", "Origin"}
    assert window.label == "window kind"


@pytest.mark.parametrize("name", METHODS)
def test_no_method_shows_a_setting_that_does_nothing_in_it(name):
    config = METHODS[name].defaults
    shown = {s.path[0] for s in settings_of(config) if not idle(config, s.path)}
    assert ("agreement" in shown) == (name == "spectra-proven")
    proofs = [s.path[-1] for s in settings_of(config) if s.path[0] == "proof" and not idle(config, s.path)]
    usual = ["whole_circle"] if isinstance(config, PipelineConfig) else []
    whole = {"spectra-proven": ["whole_circle", "angle", "distance", "patience"]}
    assert proofs == whole.get(name, usual)
    windows = [s.path for s in settings_of(config) if s.path == ("window", "kind")]
    assert [path for path in windows if not idle(config, path)] == windows * isinstance(
        config, PipelineConfig
    )
    assert ("swarm" in shown) == ("box" in shown) == (bool(usual) and name != "smm-window")


def test_a_setting_comes_back_with_the_one_it_belongs_to():
    config = METHODS["spectra-swarm"].defaults
    assert idle(config, ("agreement", "blur"))
    assert not idle(with_value(config, ("refine", "objective"), "agreement"), ("agreement", "blur"))
    assert not idle(with_value(config, ("proof", "whole_circle"), True), ("proof", "patience"))
    assert not idle(config, ("swarm", "tau"))
    assert idle(with_value(config, ("refine", "optimiser"), "mco"), ("swarm", "tau"))


def test_a_value_is_changed_wherever_it_is_nested():
    config = with_value(Outer(), ("inner", "width"), 1.5)
    assert value_at(config, ("inner", "width")) == 1.5
    assert with_value(config, ("rule",), Rule.LAST).rule is Rule.LAST
    assert Outer().inner.width == 1.0


def test_a_value_out_of_bounds_is_refused_by_name():
    with pytest.raises(SettingError, match=r"Inner.width is 9 m; it must lie in \[0.5, 2\] m"):
        with_value(Outer(), ("inner", "width"), 9.0)


@pytest.mark.parametrize("name", METHODS)
def test_every_setting_of_every_method_can_be_shown(name):
    settings = list(settings_of(METHODS[name].defaults))
    assert len({setting.path for setting in settings}) == len(settings)
    for setting in settings:
        assert setting.label
        assert setting.bounds is None or setting.bounds.low <= setting.default <= setting.bounds.high


@pytest.mark.parametrize("name", METHODS)
def test_every_setting_of_a_method_has_a_hint(name):
    assert [s.path for s in settings_of(METHODS[name].defaults) if not s.hint] == []


def test_docs_of_a_class_without_source_are_empty():
    assert field_docs(type("Made", (), {})) == {}


def test_a_length_is_told_in_cells_of_both_maps_only_where_they_differ():
    assert in_cells(3.0, 0.05, 0.05) == "60 cells"
    assert in_cells(3.0, 0.05, 0.04) == "60 / 75 cells"
