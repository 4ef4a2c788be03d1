"""The legend names what is drawn, in the colour that it is drawn in, and nothing that is not there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from proofs import proof_state

from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, PLANE_METHOD, run
from algorithms.methods.steps import (
    AugmentDetail,
    CandidatesDetail,
    MatchesDetail,
    ObservationDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    Step,
)
from app.drawing.legend import in_hand, legend, level_scale
from app.drawing.palette import DARK, LIGHT, css
from app.model.run_state import RunState

PROVEN = METHODS["spectra-proven"].defaults


@pytest.fixture(scope="module")
def steps(small_case) -> list[Step]:
    """A whole run of the method that shows most."""
    return list(run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, PROVEN))


def story_of(steps: list[Step]) -> RunState:
    story = RunState(PROVEN)
    for step in steps:
        story.add(step)
    return story


def until(steps: list[Step], kind: type) -> RunState:
    """The run when the last step of a kind has just come."""
    last = max(n for n, step in enumerate(steps) if isinstance(step.detail, kind))
    return story_of(steps[: last + 1])


def words(entries) -> list[str]:
    return [entry["t"] for entry in entries]


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("view", ["Map", "Heights", "Swarm space"])
def test_at_every_step_each_entry_is_named_once_and_has_a_colour_of_its_palette(steps, palette, view):
    others = (colour for name, colour in vars(palette).items() if name not in ("dark", "maps"))
    colours = {css(colour) for colour in (*palette.maps, *others)}
    for kind in {type(step.detail) for step in steps}:
        entries = legend(palette, view, until(steps, kind))
        assert len(set(words(entries))) == len(entries)
        assert {entry["c"] for entry in entries if entry["s"] != "scale"} <= colours


def test_the_colours_of_the_two_maps_are_told_whenever_both_maps_are_drawn(steps):
    for kind in (ObservationDetail, CandidatesDetail, RefineDetail, ProofDetail, Fusion, MergeResult):
        entries = {entry["t"]: entry["c"] for entry in legend(LIGHT, "Map", until(steps, kind))}
        assert entries["map 1"] == css(LIGHT.ref)
        assert entries["map 2"] == css(LIGHT.mov)


def test_before_anything_has_run_there_are_two_maps_and_no_more():
    assert words(legend(LIGHT, "Map", RunState())) == ["map 1", "map 2"]
    assert legend(LIGHT, "Heights", RunState()) == []


def test_what_the_walls_are_coloured_by_is_told_from_the_levels_on(steps):
    story = until(steps, AugmentDetail)
    (scale,) = legend(LIGHT, "Heights", story)
    assert scale == level_scale(story.get(AugmentDetail), LIGHT)
    assert (scale["s"], scale["low"]) == ("scale", "0")
    assert float(scale["high"]) == pytest.approx(story.get(AugmentDetail).ref.peak, rel=0.005)
    assert len(set(scale["c"])) == len(scale["c"]) > 4


def test_merged_cells_have_a_colour_for_what_agrees_and_one_for_what_contradicts(steps, result):
    told = words(legend(LIGHT, "Map", until(steps, Fusion)))
    assert {"both", "contradiction", "robot 2"} <= set(told)
    assert "rival" not in told
    doubtful = replace(result, verdict=replace(result.verdict, rival=result.T_ref_mov))
    story = story_of([*steps, Step("verdict", doubtful, 0.0)])
    assert "rival" in words(legend(LIGHT, "Map", story))


def test_without_a_sighting_no_place_is_called_a_robots(small_case):
    story, told = RunState(METHODS[PLANE_METHOD].defaults), set()
    for step in run(PLANE_METHOD, small_case.ref, small_case.mov):
        story.add(step)
        told |= set(words(legend(LIGHT, "Map", story)))
    assert {"best place so far", "other places", "answer"} <= told
    assert not any("robot" in entry for entry in told)


@pytest.mark.parametrize(
    ("changes", "star", "rival"),
    [
        ({}, "proven optimum", True),
        ({"proven": False, "stopped": None}, "best so far", True),
        ({"rivals": np.zeros((0, 3)), "rival_values": np.zeros(0)}, "proven optimum", False),
    ],
)
def test_a_best_is_only_called_proven_once_it_is_and_a_rival_told_where_there_is_one(
    steps, changes, star, rival
):
    detail = ProofDetail(proof_state(**changes), until(steps, ProofDetail).get(ProofDetail).window)
    told = legend(LIGHT, "Map", story_of([Step("prove", detail, 0.0)]))
    (named,) = (entry["t"] for entry in told if entry["s"] == "star")
    assert named == star
    assert ("rival" in words(told)) is rival


def test_a_search_has_its_particles_and_its_star_once_the_proof_has_ended(steps):
    assert {"particle", "swarm best", "box"} <= set(words(legend(LIGHT, "Map", until(steps, RefineDetail))))
    assert "proven optimum" not in words(legend(LIGHT, "Swarm space", until(steps, RefineDetail)))
    assert "proven optimum" in words(legend(LIGHT, "Swarm space", until(steps, ProvenDetail)))


def test_matches_are_told_apart_from_those_that_agree_once_any_does():
    at = np.zeros((3, 2))

    def told(inliers):
        return words(
            legend(LIGHT, "Map", story_of([Step("match", MatchesDetail(at, at, at, at, inliers), 0)]))
        )

    assert "match" in told(np.zeros(3, dtype=bool))
    assert {"matches that agree", "other matches"} <= set(told(np.array([True, False, False])))


def test_each_way_of_comparing_two_maps_has_the_legend_of_what_it_shows(steps):
    story = until(steps, Fusion)
    for mode in ("blink", "curtain"):
        assert words(legend(LIGHT, "Map", story, mode=mode)) == ["map 1", "map 2"]
    assert words(legend(LIGHT, "Map", story, mode="result")) == ["wall", "free floor", "unknown"]
    difference = legend(LIGHT, "Map", story, mode="difference")
    assert words(difference)[:2] == ["map 1 alone", "map 2 alone"]
    assert len({entry["c"] for entry in difference}) == len(difference)


def test_in_a_persons_hand_the_map_is_coloured_as_when_it_is_merged(steps):
    merged = {entry["t"]: entry["c"] for entry in legend(DARK, "Map", until(steps, Fusion))}
    held = {entry["t"]: entry["c"] for entry in in_hand(DARK)}
    assert held == {name: merged[name] for name in held}
    assert "contradiction" in held
