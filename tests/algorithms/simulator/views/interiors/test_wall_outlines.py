import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from algorithms.simulator.buildings.floor_plan import DARK, WALL, FloorPlan
from algorithms.simulator.views.interiors.wall_outlines import STAIR, wall_faces

rasters = st.integers(0, 2**32 - 1).map(
    lambda seed: (ndimage.uniform_filter(np.random.default_rng(seed).random((40, 50)), 5) > 0.53).astype(
        np.uint8
    )
)


@settings(max_examples=40)
@given(rasters)
def test_faces_lie_where_solid_cells_end(raster):
    faces = wall_faces(raster, 1.0)
    solid = np.pad(raster != 0, 2)
    edge = ndimage.binary_dilation(solid, np.ones((3, 3))) & ~ndimage.binary_erosion(solid, np.ones((3, 3)))
    far = ndimage.distance_transform_edt(~edge)
    for share in (0.1, 0.5, 0.9):
        at = faces.ends[:, :2] + share * (faces.ends[:, 2:] - faces.ends[:, :2])
        col, row = np.clip(np.floor(at).astype(int).T + 2, 0, [[53], [43]])
        assert far[row, col].max(initial=0) <= STAIR + 1


@settings(max_examples=40)
@given(rasters)
def test_their_outlines_hold_about_as_much_as_the_cells(raster):
    faces = wall_faces(raster, 1.0)
    x0, y0, x1, y1 = faces.ends.T
    area = float((x0 * y1 - x1 * y0).sum()) / 2  # counter-clockwise around what is solid
    assert abs(area - raster.sum()) <= STAIR * faces.lengths().sum() / 2 + 1


def test_a_box_has_four_exact_faces_that_look_outwards():
    plan = FloorPlan(4.0, 3.0, 0.05)
    plan.box(1.0, 1.0, 3.0, 2.0)
    faces = wall_faces(plan.finish("box").surface, 0.05)
    assert sorted(np.round(faces.lengths(), 9)) == [1.0, 1.0, 2.0, 2.0]
    middles = (faces.ends[:, :2] + faces.ends[:, 2:]) / 2 - [2.0, 1.5]
    assert (np.round((middles * faces.normals()).sum(axis=1), 6) > 0).all()


def test_a_slanted_wall_is_two_long_faces_and_glass_begins_where_it_begins():
    plan = FloorPlan(6.0, 4.0, 0.025)
    plan.line(1.0, 1.0, 5.0, 2.5, 0.2)
    lengths = np.sort(wall_faces(plan.cells, 0.025).lengths())
    assert lengths[-2] > 3.5
    glazed = FloorPlan(6.0, 4.0, 0.025)
    glazed.box(1.0, 1.0, 5.0, 1.3)
    glazed.box(2.0, 1.0, 3.2, 1.3, DARK)
    faces = wall_faces(glazed.cells, 0.025)
    assert sorted(np.round(faces.lengths()[faces.kind == DARK], 6)) == [1.2, 1.2]
    assert (faces.kind[faces.kind != DARK] == WALL).all()
