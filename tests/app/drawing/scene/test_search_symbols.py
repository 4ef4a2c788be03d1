"""What a search shows over the map, as data."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import T_REF_MOV, flat_pair
from hypothesis import given
from hypothesis import strategies as st
from proofs import proof_state

from algorithms.common.pose import Pose2, rotation
from algorithms.methods.steps import WindowDetail
from algorithms.observations.observation import Observation, encounter
from algorithms.observations.search_window import WindowConfig, coupled_window, paper_window
from app.drawing.palette import LIGHT
from app.drawing.scene.search_symbols import discs, proof, rival, windows
from app.drawing.scene_layout import known_hull, lay_out

REF, MOV, SEEN, _ = flat_pair()
AT = encounter(SEEN)
LAYOUT = lay_out(REF, MOV, AT)
VIEW = (-10.0, -10.0, 10.0, 10.0)


def both_windows(kind: str, turn: float = 0.0, view=VIEW, **config):
    """What is drawn of the windows: the paper's first, then the coupled one's disc."""
    settings = WindowConfig(kind, **config)
    coupled, printed = coupled_window([AT], settings), paper_window(AT, WindowConfig("origin", 0.1))
    used = coupled if kind == "coupled" else paper_window(AT, settings)
    return windows(WindowDetail(used, coupled, printed), turn, LAYOUT, LIGHT, view)


@pytest.mark.parametrize(("kind", "strong"), [("coupled", 1), ("encounter", 0), ("origin", 0)])
def test_both_windows_are_drawn_and_the_one_in_use_is_the_strong_one(kind, strong):
    items = both_windows(kind)
    assert [item["t"].split(",")[0] for item in items] == ["paper's window", "coupled window"]
    assert [item["c"].startswith("#") for item in items] == [strong == 0, strong == 1]
    assert all(item["tc"].startswith("#") for item in items)  # words are never faint
    assert "d" in items[0]  # the paper's is dashed


def test_the_disc_reaches_k_deviations_from_the_meeting_place():
    for k in (1.0, 3.5):
        disc = both_windows("coupled", deviations=k)[1]
        assert disc["t"] == f"coupled window, {k:g} σ"
        window = coupled_window([AT], WindowConfig("coupled", deviations=k))
        off = (np.array(disc["p"]) @ window.whitening[0].T) ** 2
        assert np.sqrt(off.sum(axis=1)) == pytest.approx(k)


@given(st.floats(-np.pi, np.pi))
def test_the_printed_window_is_drawn_where_robot_2_would_be_put_and_holds_where_it_was_seen(turn):
    corners = np.array(both_windows("coupled", turn)[0]["p"])
    assert (corners.min(axis=0) < 0).all()
    assert (corners.max(axis=0) > 0).all()
    w = paper_window(AT, WindowConfig("origin", 0.1))
    middle = (w.low + w.high) / 2 + rotation(turn) @ AT.x_mov - AT.x_ref
    assert corners.mean(axis=0) == pytest.approx(middle)


@pytest.mark.parametrize("half", [0.5, 25.0, 500.0])
def test_the_size_of_the_printed_window_is_told_where_it_can_be_read(half):
    label = both_windows("coupled", view=(-half, -half, half, half))[0]
    assert " m × " in label["t"]
    assert ("beyond this view" in label["t"]) == (half == 0.5)
    assert (np.abs(label["tp"]) <= max(half, 30)).all()
    if half == 0.5:
        assert (np.abs(label["tp"]) <= half).all()


def test_of_several_sightings_each_has_its_disc_and_one_its_name():
    items = discs(coupled_window([AT, AT], WindowConfig("coupled")), LAYOUT, LIGHT)
    assert len(items) == 2
    assert ["t" in item for item in items] == [True, False]


def test_the_proof_marks_its_best_and_its_rivals():
    items = proof(proof_state(), LAYOUT, LIGHT)
    assert [item["s"] for item in items] == ["dot", "star"]
    assert items[1]["p"] == pytest.approx(LAYOUT.placed(Pose2(1.0, 2.0, 0.5)).xy)
    assert proof(proof_state(best=None, rivals=np.zeros((0, 3))), LAYOUT, LIGHT) == []


def test_the_rival_lies_where_its_transform_puts_map_2_with_its_words_below():
    hull = known_hull(MOV) - LAYOUT.anchor_mov
    seen = Observation(Pose2(), 0.0, 0.0, 1.0, 0.0, observed_heading=0.4)
    outline, robot = rival(LAYOUT.placed(T_REF_MOV), hull, seen, "180° turned, 98%", LIGHT)
    assert outline["t"] == "rival: 180° turned, 98%"
    assert outline["p"] + LAYOUT.anchor_ref == pytest.approx(T_REF_MOV.apply(known_hull(MOV)))
    assert outline["tp"][1] == pytest.approx(outline["p"][:, 1].min())
    assert robot["s"] == "robot"
    assert robot["a"] == pytest.approx(0.4 + T_REF_MOV.theta)
    assert (
        len(rival(LAYOUT.placed(T_REF_MOV), hull, None, "7 m away", LIGHT)) == 1
    )  # nobody knows where it stood


def test_the_outline_of_a_map_holds_every_known_cell_and_no_more_than_its_corners():
    hull = known_hull(MOV)
    assert len(hull) >= 4
    rows, cols = np.nonzero(MOV.cells >= 0)
    for axis in (0, 1):
        places = MOV.centres(rows, cols)[:, axis]
        assert places.min() == pytest.approx(hull[:, axis].min(), abs=MOV.resolution)
        assert places.max() == pytest.approx(hull[:, axis].max(), abs=MOV.resolution)
