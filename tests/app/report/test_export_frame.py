"""The frame of the merged map: whose it is, where it lies, and what is said of its cells."""

import numpy as np
import pytest
from drawn import poses
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import OCCUPIED, GridMap
from app.report.export_frame import ExportFrame

frames = st.one_of(st.sampled_from(["ref", "mov"]), poses)


@given(frames, poses, poses)
def test_a_wall_lies_where_it_was_whatever_the_frame(frame, T_ref_mov, origin):
    merged = GridMap(np.array([[0, OCCUPIED], [-1, 0]], dtype=np.int8), 0.05, origin)
    exported = ExportFrame(frame).given(merged, T_ref_mov)
    assert np.allclose(exported.T_ref_frame.apply(exported.cells.grid.points), merged.points, atol=1e-6)
    assert np.array_equal(exported.cells.grid.cells, merged.cells)


@given(poses, st.floats(0.1, 50))
def test_a_frame_that_was_clicked_has_the_second_place_on_its_x_axis(T, away):
    on_x = T.apply(np.array([away, 0.0]))
    made = ExportFrame.between((T.x, T.y), tuple(on_x.tolist()))
    assert made.inverse().apply(T.xy) == pytest.approx((0, 0), abs=1e-6)
    assert made.inverse().apply(on_x) == pytest.approx((away, 0), abs=1e-6)


def test_two_clicks_at_one_place_make_no_frame():
    with pytest.raises(SettingError, match="choose one farther away"):
        ExportFrame.between((1.0, 2.0), (1.0, 2.001))


@pytest.mark.parametrize("frame", [Pose2(np.nan, 0), Pose2(1e9, 0), Pose2(0, 0, np.inf)])
def test_a_frame_that_lies_nowhere_is_refused(frame):
    with pytest.raises(SettingError, match="no frame lies at"):
        ExportFrame(frame)


def test_what_was_done_to_the_cells_is_said_with_their_count():
    cells = np.full((4, 4), -1, dtype=np.int8)
    cells[:2], cells[0, 0], cells[3, 3] = 0, OCCUPIED, 0
    merged = GridMap(cells, 0.05)

    def said(*frame):
        return ExportFrame(*frame).given(merged, Pose2(1.0)).said

    assert said() == "The merged map is in map 1's frame."
    assert said("mov") == "The merged map is in map 2's frame."
    assert said(Pose2(), False) == (
        "The merged map is in the frame that was chosen, without yaw: none of 16 cells changed."
    )
    assert said("ref", True, 0.1) == (
        "The merged map is in map 1's frame, in cells of 0.1 m: 6 of 16 cells changed, "
        "3 are wall now and 3 free floor."
    )
