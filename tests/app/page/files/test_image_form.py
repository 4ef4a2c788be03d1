"""An image without a YAML file: what is filled in makes one, and from there on it is a map like any other."""

from __future__ import annotations

from math import degrees

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mapfiles import image_map_from_bytes
from panels import FilesDesk

from algorithms.common.pose import Pose2
from algorithms.files.images.thresholds import MODES, Shading
from algorithms.files.map_file import MapMeta, meta_to_bytes, parse_meta
from algorithms.maps.grid_map import COARSEST, FINEST, FREE, MOST_TURN, OCCUPIED, UNKNOWN
from app.model.merge_inputs import Files
from app.page.files.image_form import doubt_about, shares

# 3 x 2 pixels: white, grey, black above; black, white, white below
IMAGE = b"P5\n3 2\n255\n" + bytes([254, 205, 0, 0, 254, 254])
YAML = (
    b"image: a.pgm\nresolution: 0.2\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
)

places = st.floats(-1e4, 1e4, allow_nan=False)
names = st.text(st.characters(categories=("L", "N", "P", "S", "Zs")), min_size=1).filter(str.strip)
shadings = st.builds(
    Shading, st.booleans(), st.floats(0.5, 1.0), st.floats(0.0, 0.49), st.sampled_from(MODES)
)


@pytest.fixture
def desk(server):
    return FilesDesk(server.gui)


# ---- laws


@given(names, st.floats(FINEST, COARSEST), places, places, st.floats(-MOST_TURN, MOST_TURN), shadings)
def test_what_a_yaml_file_says_reads_back_to_the_bit(image, resolution, x, y, theta, shading):
    meta = MapMeta(image, resolution, Pose2(x, y, theta), shading)
    assert parse_meta("m.yaml", meta_to_bytes(meta)) == meta


@given(st.lists(st.integers(-1, 100), min_size=1, max_size=40))
def test_the_shares_of_wall_free_and_unknown_are_the_whole(values):
    wall, free, unknown = shares(np.array([values], dtype=np.int8))
    assert min(wall, free) >= 0
    assert unknown >= -1e-12
    assert wall + free + unknown == pytest.approx(1)


@pytest.mark.parametrize(
    ("cells", "shading", "words"),
    [
        ([OCCUPIED, OCCUPIED, FREE], Shading(), "Then tick negate"),
        ([OCCUPIED, OCCUPIED, FREE], Shading(negate=True), "take negate away"),
        ([FREE, FREE, UNKNOWN], Shading(), "Move “wall from” to the left"),
        ([OCCUPIED, UNKNOWN, UNKNOWN], Shading(), "Move “free up to” to the right"),
        ([OCCUPIED, UNKNOWN, UNKNOWN], Shading(mode="raw"), "Try another mode"),
        ([OCCUPIED, FREE, FREE, UNKNOWN], Shading(), ""),
    ],
)
def test_an_odd_reading_is_doubted_with_what_would_mend_it(cells, shading, words):
    doubt = doubt_about(shares(np.array([cells], dtype=np.int8)), shading)
    assert words in doubt
    assert bool(doubt) == bool(words)


# ---- the form


def test_an_image_alone_is_asked_about_and_used_as_it_was_filled_in(desk):
    desk.open({"a.pgm": IMAGE})
    assert desk.inputs.ref is None
    assert "fill in the form" in desk.inputs.missing()
    form = desk.panel._forms[1]
    assert form._folder.visible
    assert not desk.panel._forms[2]._folder.visible
    assert "wall 33.3%" in form._says.content
    assert "free 50.0%" in form._says.content
    form._resolution.value, form._x.value, form._yaw.value = 0.1, -3.5, 90.0
    assert "0.3 m × 0.2 m" in form._says.content
    form._taken()
    grid = desk.inputs.ref
    expected = image_map_from_bytes("a.pgm", IMAGE, 0.1, Pose2(-3.5, 0.0, np.pi / 2))
    assert np.array_equal(grid.cells, expected.cells)
    assert (grid.resolution, grid.origin) == (expected.resolution, expected.origin)
    assert "Load map 2" in desk.inputs.missing()
    assert "In use." in form._says.content
    assert form._go.disabled


def test_what_is_changed_after_use_is_not_in_use_before_it_is_used_again(desk):
    desk.open({"a.pgm": IMAGE})
    form = desk.panel._forms[1]
    form._taken()
    before = desk.inputs.ref
    form._negate.value = True
    assert "not in use yet" in form._says.content
    assert desk.inputs.ref is before
    form._taken()
    negated = image_map_from_bytes("a.pgm", IMAGE, 0.05, shading=Shading(negate=True))
    assert np.array_equal(desk.inputs.ref.cells, negated.cells)


def test_limits_that_cross_are_told_and_cannot_be_used(desk):
    desk.open({"a.pgm": IMAGE})
    form, told = desk.panel._forms[1], len(desk.loaded)
    form._free.value = 0.8
    assert "free_thresh must be the smaller one" in form._says.content
    assert form._go.disabled
    form._taken()
    assert len(desk.loaded) == told
    form._mode.value = "raw"  # has no limits
    assert not form._free.visible
    assert not form._go.disabled


def test_the_downloaded_yaml_makes_the_same_map(desk):
    desk.open({"a house.pgm": IMAGE})
    form = desk.panel._forms[1]
    form._yaw.value = 33.3
    form._download()
    form._taken()
    (name, content), *_ = desk.saved.items()
    assert name == "a house.yaml"
    meta = parse_meta(name, content)
    assert meta.image == "a house.pgm"
    assert (meta.resolution, meta.origin) == (desk.inputs.ref.resolution, desk.inputs.ref.origin)
    assert degrees(meta.origin.theta) == pytest.approx(33.3)


def test_a_yaml_file_that_comes_later_takes_the_place_of_the_form(desk):
    desk.open({"a.pgm": IMAGE})
    desk.panel._forms[1]._taken()
    desk.open({"a.yaml": YAML})
    assert not desk.panel._forms[1]._folder.visible
    assert desk.inputs.ref.resolution == 0.2


def test_the_same_image_with_other_pixels_is_asked_about_anew_and_a_further_one_is_map_2(desk):
    desk.open({"a.pgm": IMAGE})
    desk.panel._forms[1]._taken()
    desk.open({"b.pgm": IMAGE})
    assert desk.inputs.ref is not None
    assert "Map 2's image has no YAML file yet" in desk.inputs.missing()
    assert "b.pgm" in desk.panel._forms[2]._about.content
    desk.open({"a.pgm": IMAGE[:-1] + b"\0"})
    assert desk.inputs.ref is None
    assert "Not in use yet." in desk.panel._forms[1]._says.content


def test_an_image_that_cannot_be_read_is_told_at_once_and_what_was_there_stays(desk):
    desk.open({"a.pgm": IMAGE})
    desk.panel._forms[1]._taken()
    desk.open({"broken.png": b"\x89PNG\r\n\x1a\n nothing more"})
    assert "broken.png" in str(desk.reports[-1])
    assert desk.inputs.ref is not None
    assert "In use." in desk.panel._forms[1]._says.content


def test_undo_and_a_reload_bring_back_what_was_filled_in(desk, server):
    desk.open({"a.pgm": IMAGE})
    desk.panel._forms[1]._resolution.value = 0.25
    desk.panel._forms[1]._taken()
    kept = desk.panel.files
    other = FilesDesk(server.gui)
    other.panel.show(kept)
    assert other.panel._forms[1]._resolution.value == 0.25
    assert "In use." in other.panel._forms[1]._says.content
    other.panel.show(Files())
    assert not other.panel._forms[1]._folder.visible
    assert other.loaded == []


def test_the_name_of_an_image_is_shown_as_words(desk):
    desk.open({"<img src=x onerror=alert(1)>.pgm": IMAGE})
    assert "<img src=x" not in desk.panel._forms[1]._about.content
