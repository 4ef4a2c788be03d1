"""The walls as heights: as high as their level says, around the meeting place, gone when they are hidden."""

from __future__ import annotations

from unittest.mock import Mock

import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given
from hypothesis import strategies as st

from algorithms.maps.grid_map import FREE, GridMap
from algorithms.methods.steps import AugmentDetail
from algorithms.observations.observation import encounter
from algorithms.spectra.augmented_map import augment
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import DARK, LIGHT
from app.drawing.scene.height_view import FEW, VISIBLE, HeightsView, bars, linear

REF, MOV, SEEN, _ = flat_pair()
AT = encounter(SEEN)


def lifted(grid, x_hat, spread=2.0):
    return augment(grid, x_hat, np.eye(2) * spread**2, 100.0)


DETAIL = AugmentDetail(lifted(REF, AT.x_ref), lifted(MOV, AT.x_mov))
EMPTY = GridMap(np.full((40, 40), FREE, dtype=np.int8), 0.05)
BARE = AugmentDetail(lifted(EMPTY, np.ones(2)), lifted(EMPTY, np.ones(2)))


class Notes(BrowserMessages):
    """Keeps what is sent to the page."""

    def __init__(self):
        super().__init__()
        self.sent = {}

    def send(self, message):
        for name, what in message.items():
            self.sent[name] = {**self.sent.get(name, {}), **what} if isinstance(what, dict) else what


@pytest.fixture
def notes():
    return Notes()


@pytest.fixture
def scene():
    return Mock()


@pytest.fixture
def view(scene, notes):
    return HeightsView(Mock(scene=scene), notes)


def stems(scene):
    """(N, 2, 3) foot and top of each stem of either map."""
    return [call.args[1] for call in scene.add_line_segments.call_args_list]


@given(st.floats(0.3, 10.0), st.integers(1, 400))
def test_bars_are_shares_of_the_peak_at_their_walls_and_no_more_than_are_wanted(spread, most):
    augmented = lifted(REF, AT.x_ref, spread)
    where, share = bars(augmented, most)
    assert len(where) == len(share) <= most
    standing = int((augmented.levels >= VISIBLE * augmented.peak).sum())
    assert (share >= VISIBLE).all() == (standing > FEW or standing == len(augmented.levels))
    assert (share <= 1 + 1e-9).all()
    expected = np.exp(-0.5 * (where**2).sum(axis=1) / spread**2)  # eq. (4), over its peak
    assert np.allclose(share, expected)


def test_where_hardly_any_wall_stands_out_the_others_are_drawn_flat(view, scene):
    low = lifted(REF, AT.x_ref, 0.3)
    _, share = bars(low)
    assert (share >= VISIBLE).sum() <= FEW < len(share) == len(low.levels)
    view.show(AugmentDetail(low, low), LIGHT, look=True)
    heights = stems(scene)[0][:, 1, 1]
    assert heights.min() > 0
    assert np.ptp(heights[share < VISIBLE]) == 0


def test_all_walls_that_can_be_seen_have_a_bar_where_there_are_not_too_many():
    where, _ = bars(DETAIL.ref)
    assert len(where) == (DETAIL.ref.levels >= VISIBLE * DETAIL.ref.peak).sum()


@given(st.integers(0, 255))
def test_the_renderer_makes_the_colour_that_was_meant_of_what_it_is_given(level):
    given_to_it = linear(np.array([[level] * 3], dtype=np.uint8))[0, 0] / 255
    shown = 255 * given_to_it ** (1 / 2.2)
    assert shown == pytest.approx(level, abs=14 if level < 40 else 3)  # eight bits are few for the dark


def test_each_map_stands_in_its_own_half_around_its_meeting_place(view, scene, notes):
    view.show(DETAIL, LIGHT, look=True)
    notes.flush()
    behind, before = stems(scene)
    assert behind[:, :, 2].max() < before[:, :, 2].min()
    for segments, augmented in ((behind, DETAIL.ref), (before, DETAIL.mov)):
        where, share = bars(augmented)
        foot, top = segments[:, 0], segments[:, 1]
        assert (foot[:, 1] == 0).all()
        assert foot[:, 0] == pytest.approx(where[:, 0], abs=1e-5)
        assert np.ptp(foot[:, 2] + where[:, 1]) == pytest.approx(0, abs=1e-5)  # y of the map goes back
        assert np.corrcoef(top[:, 1], share)[0, 1] == pytest.approx(1)
        assert (foot[:, [0, 2]] == top[:, [0, 2]]).all()
    assert len(notes.sent["layers"]["floor"]) == 4
    assert notes.sent["look"]["view"] == "heights"


def test_the_camera_goes_before_the_first_heights_there_are_and_stays_where_a_person_has_put_it(view, notes):
    view.show(None, LIGHT, look=True)  # the view was chosen before there was anything to be seen
    view.show(DETAIL, LIGHT, look=False)
    notes.flush()
    assert notes.sent.pop("look")["view"] == "heights"
    view.show(None, LIGHT, look=False)  # a run of the same maps begins anew
    view.show(DETAIL, LIGHT, look=False)
    notes.flush()
    assert "look" not in notes.sent
    assert "floor" in notes.sent["layers"]
    view.hide()
    view.show(DETAIL, LIGHT, look=False)
    notes.flush()
    assert "look" in notes.sent


def test_the_same_heights_are_drawn_once_and_others_take_their_place_and_so_do_other_colours(view, scene):
    for times, (detail, palette) in enumerate(
        [(DETAIL, LIGHT), (DETAIL, DARK), (AugmentDetail(DETAIL.mov, DETAIL.ref), DARK)], 1
    ):
        view.show(detail, palette, look=False)
        view.show(detail, palette, look=False)
        assert scene.add_line_segments.call_count == 2 * times
        assert scene.add_line_segments.return_value.remove.call_count == 2 * (times - 1)


@pytest.mark.parametrize("end", [lambda view: view.hide(), lambda view: view.show(None, LIGHT, True)])
def test_what_is_hidden_is_gone_with_its_floor_and_comes_back_when_it_is_shown_again(view, scene, notes, end):
    view.show(DETAIL, LIGHT, look=True)
    end(view)
    notes.flush()
    assert scene.add_line_segments.return_value.remove.call_count == 2
    assert notes.sent["layers"]["floor"] is None
    view.show(DETAIL, LIGHT, look=True)
    assert scene.add_line_segments.call_count == 4


def test_maps_without_walls_have_a_floor_and_no_stems(view, scene, notes):
    view.show(BARE, LIGHT, look=True)
    notes.flush()
    assert stems(scene) == []
    assert len(notes.sent["layers"]["floor"]) == 4
