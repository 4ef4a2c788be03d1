"""What of a large map is drawn in cells of their own: what is seen, no more than can be, where it belongs."""

from __future__ import annotations

import base64
import io
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.spectra.augmented_map import augment
from algorithms.verdict.cell_agreement import WallLookup
from algorithms.verdict.contradictions import find_conflicts, near_walls
from app.drawing import grid_pixels as render
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import LIGHT
from app.drawing.scene.grid_image import Size
from app.drawing.scene.map_layers import MapLayers
from app.drawing.scene.zoom_crop import MOST_EXCERPT, CameraView, ZoomCrop, looked_at
from app.drawing.scene_layout import SceneLayout
from app.report.replay.image_recorder import PictureScene

SIDES = st.integers(1, 20_000)
PLACES = st.floats(-3000, 23_000)
CELL = 0.1
SIZE = Size(whole=40, pooled=20)  # so that the test maps are large ones


def speckled(rows: int, cols: int, seed: int = 0) -> GridMap:
    values = np.random.default_rng(seed).choice([UNKNOWN, FREE, FREE, OCCUPIED], (rows, cols))
    return GridMap(values.astype(np.int8), CELL, Pose2(1.0, -2.0, 0.3 * seed))


# --- which cells --------------------------------------------------------------------------------------


@given(SIDES, SIDES, PLACES, PLACES, st.floats(0.1, 20_000), st.floats(0.1, 20_000), st.floats(0.01, 30))
def test_an_excerpt_holds_all_that_is_seen_and_is_bounded(rows, cols, x, y, wide, high, fine):
    seen = np.array([[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]])
    found = looked_at(seen, (rows, cols), fine)
    overlaps = x < cols and x + wide > 0 and y < rows and y + high > 0
    assert (found is not None) == overlaps
    if found is None:
        return
    bare, excerpt = found
    assert excerpt.serves(bare)
    assert excerpt.most <= MOST_EXCERPT
    assert excerpt.pooled >= round(fine)  # never finer than the screen
    assert 0 <= excerpt.top <= max(0.0, y)
    assert min(rows, y + high) <= excerpt.bottom <= rows
    assert 0 <= excerpt.left <= max(0.0, x)
    assert min(cols, x + wide) <= excerpt.right <= cols


def test_a_small_move_of_the_camera_needs_no_other_excerpt_and_a_closer_look_does():
    def seen(x, wide):
        return np.array([[x, 0.0], [x + wide, 0.0], [x + wide, wide], [x, wide]])

    _, excerpt = looked_at(seen(1000.0, 2000.0), (9000, 9000), 2.0)
    assert excerpt.serves(looked_at(seen(1100.0, 2000.0), (9000, 9000), 2.0)[0])
    assert not excerpt.serves(looked_at(seen(2000.0, 2000.0), (9000, 9000), 2.0)[0])
    assert not excerpt.serves(looked_at(seen(1500.0, 500.0), (9000, 9000), 0.5)[0])


# --- their pictures -----------------------------------------------------------------------------------


def drawings():
    """Everything that is drawn of a grid, with the grid's shape."""
    ref, mov = speckled(50, 70), speckled(60, 45, seed=1)
    fusion = fuse((ref, mov), (Pose2(), Pose2(0.5, 1.0, 0.4)))
    walls = WallLookup(ref), WallLookup(mov)
    lifted = augment(ref, ref.origin.apply(np.array([3.0, 2.0])), np.eye(2), 100.0)
    told = walls[0].agreement_with(walls[1], Pose2(0.5, 1.0, 0.4).inverse())
    whole, merged = ref.cells.shape, fusion.merged.cells.shape
    return {
        "floor": (partial(render.floor, ref.cells, LIGHT), whole),
        "walls": (partial(render.walls, ref.cells, LIGHT.ref), whole),
        "levels": (partial(render.levels, lifted, LIGHT), whole),
        "touches": (partial(render.touches, walls[0], told, LIGHT), whole),
        "merged floor": (partial(render.merged_floor, fusion, LIGHT), merged),
        "merged walls": (partial(render.merged_walls, fusion, near_walls(fusion), LIGHT), merged),
        "denied": (partial(render.denied_walls, fusion, find_conflicts(fusion), LIGHT), merged),
    }


@pytest.mark.parametrize("name", drawings())
def test_a_part_that_is_drawn_alone_is_that_part_of_the_whole_picture(name):
    draw, (rows, cols) = drawings()[name]
    whole = draw(most=1000, part=render.WHOLE).pixels
    assert whole.shape == (rows, cols, 4)
    assert len(np.unique(whole.reshape(-1, 4), axis=0)) > 1
    part = slice(7, rows - 3), slice(5, cols - 9)
    assert (draw(most=1000, part=part).pixels == whole[part]).all()
    pooled = draw(most=-(-rows // 3), part=(slice(0, rows), slice(0, 9)))
    assert pooled.pooled == 3
    assert pooled.pixels.shape == (-(-rows // 3), 3, 4)


# --- where they lie -----------------------------------------------------------------------------------


class Page(BrowserMessages):
    """Keeps the excerpts that a tab would show."""

    def __init__(self) -> None:
        super().__init__()
        self.laid = {}

    def send(self, message):
        for name, excerpt in message.get("closer", {}).items():
            self.laid.pop(name, None)
            if excerpt is not None:
                self.laid[name] = excerpt


def alpha(excerpt) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(excerpt["png"]))))[..., 3]


@pytest.fixture
def page():
    return Page()


@pytest.fixture
def maps():
    return speckled(90, 110), speckled(100, 80, seed=1)


@pytest.fixture
def ground(page, maps):
    ground = MapLayers(PictureScene(), SIZE, page)
    layout = SceneLayout((np.array([2.0, 3.0]), np.array([4.0, 1.0])), beside=(Pose2(), Pose2(30.0, 0.0)))
    ground.load(*maps, layout, LIGHT)
    return ground


def look(ground: MapLayers, page: Page, at, mov: Pose2 = Pose2(30.0, 0.0), half: float = 0.6) -> None:  # noqa: B008
    """Have a view of 20 px per cell about a place of the scene sharpened."""
    x, y = at
    for closer in ground.closer(CameraView((x - half, y - half, x + half, y + half), mov, 20 / CELL)):
        closer.image.lay(closer, closer.picture())
    page.flush()


def test_what_is_looked_at_closely_is_sent_cell_by_cell_for_the_place_where_it_lies(ground, page, maps):
    at = maps[0].origin.apply(np.array([50, 40]) * CELL) - (2.0, 3.0)  # map 2 is far off
    look(ground, page, at)
    assert set(page.laid) == {"/world/map1/free", "/world/map1/walls"}
    excerpt = page.laid["/world/map1/walls"]
    left, top, right, bottom = np.array(excerpt["hole"]) * (114, 90, 114, 90)  # its pixels are six cells
    cols, rows = slice(round(left), round(right)), slice(round(top), round(bottom))
    assert rows.start < 40 < rows.stop
    assert cols.start < 50 < cols.stop
    assert (alpha(excerpt) == np.where(maps[0].occupied[rows, cols], 255, 0)).all()


def test_the_excerpt_of_map_2_is_the_same_wherever_map_2_lies(ground, page, maps):
    place = maps[1].origin.apply(np.array([40, 60]) * CELL) - (4.0, 1.0)
    sent = []
    for mov in (Pose2(30.0, 0.0), Pose2(-50.0, 7.0, 1.0)):
        look(ground, page, mov.apply(place), mov)
        sent.append(page.laid["/world/map2/walls"]["hole"])
        assert "/world/map1/walls" not in page.laid
    assert sent[0] == sent[1]  # what lies there serves for both


def test_nothing_is_sent_twice_nor_from_afar_and_a_far_look_lays_the_picture_bare(ground, page, maps):
    at = maps[0].origin.apply(np.array([50, 40]) * CELL) - (2.0, 3.0)
    view = CameraView((*(at - 0.6).tolist(), *(at + 0.6).tolist()), Pose2(30.0), 20 / CELL)
    far = CameraView((*(at - 9.0).tolist(), *(at + 9.0).tolist()), Pose2(30.0), 0.1 / CELL)
    assert ground.closer(far) == []
    look(ground, page, at)
    assert ground.closer(view) == []
    assert {closer.excerpt for closer in ground.closer(far)} == {None}
    for closer in ground.closer(far):
        closer.image.lay(closer, closer.picture())
    page.flush()
    assert page.laid == {}


def test_other_maps_lay_the_page_bare_and_an_excerpt_of_the_last_ones_comes_too_late(ground, page, maps):
    at = maps[0].origin.apply(np.array([50, 40]) * CELL) - (2.0, 3.0)
    view = CameraView((*(at - 0.6).tolist(), *(at + 0.6).tolist()), Pose2(30.0), 20 / CELL)
    late = ground.closer(view)
    assert late
    look(ground, page, at)
    ground.load(maps[1], maps[0], SceneLayout((np.zeros(2), np.zeros(2))), LIGHT)
    page.flush()
    assert page.laid == {}
    for closer in late:
        closer.image.lay(closer, closer.picture())
    page.flush()
    assert page.laid == {}


def test_a_map_that_is_sent_whole_has_no_excerpts(page, maps):
    ground = MapLayers(PictureScene(), Size(whole=200, pooled=20), page)
    ground.load(*maps, SceneLayout((np.zeros(2), np.zeros(2))), LIGHT)
    assert ground.closer(CameraView((-5.0, -5.0, 5.0, 5.0), Pose2(), 1000.0)) == []


def test_one_excerpt_serves_another_only_if_it_is_as_fine_and_as_large():
    excerpt = ZoomCrop(10, 10, 50, 50, 2)
    assert excerpt.serves(ZoomCrop(10, 20, 50, 40, 3))
    assert not excerpt.serves(ZoomCrop(20, 20, 40, 40, 1))
    assert not excerpt.serves(ZoomCrop(9, 20, 40, 40, 2))
