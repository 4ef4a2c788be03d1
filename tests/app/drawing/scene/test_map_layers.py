"""Pictures of maps in the scene: a map that is there already is moved, not sent again."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import Case
from algorithms.maps.map_corrections import cropped
from algorithms.maps.map_fusion import fuse
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import DARK, LIGHT
from app.drawing.scene.map_layers import MapLayers
from app.drawing.scene_layout import lay_out
from app.model.merge_inputs import MergeInputs
from app.report.replay.image_recorder import PictureScene


class Page(BrowserMessages):
    """Keeps the line around the corrected map."""

    edge = None

    def send(self, message):
        if "edge" in message.get("layers", {}):
            self.edge = message["layers"]["edge"]


@pytest.fixture
def scene():
    return PictureScene()


def sent(scene: PictureScene) -> int:
    return len(scene.pictures)


def test_a_map_that_is_there_already_is_moved_and_not_sent_again(scene, small_case: Case):
    inputs = MergeInputs.of(small_case)
    ground = MapLayers(scene)
    ground.load(inputs.ref, inputs.mov, lay_out(inputs.ref, inputs.mov, None), LIGHT)
    before, seen = sent(scene), scene.seen
    layout = lay_out(inputs.ref, inputs.mov, inputs.at)  # the observation has come: other anchors
    ground.load(inputs.ref, inputs.mov, layout, LIGHT)
    assert sent(scene) == before
    assert scene.seen == seen
    grid = small_case.ref
    middle = grid.origin.apply(np.array([grid.width, grid.height]) * grid.resolution / 2)
    assert scene.shown[0].position[:2] == pytest.approx((middle - layout.anchor_ref).tolist())


def test_another_map_or_other_colours_are_sent(scene, small_case: Case):
    inputs = MergeInputs.of(small_case)
    layout = lay_out(inputs.ref, inputs.mov, inputs.at)
    ground = MapLayers(scene)
    ground.load(inputs.ref, inputs.mov, layout, LIGHT)
    first = sent(scene)
    ground.load(inputs.ref, inputs.ref, layout, LIGHT)
    assert sent(scene) == first + 2  # floor and walls of map 2
    assert len(scene.seen) == 4
    ground.load(inputs.ref, inputs.ref, layout, DARK)
    assert sent(scene) == first + 6
    ground.load(inputs.ref, None, layout, DARK)
    assert sent(scene) == first + 6
    assert len(scene.seen) == 2


def test_a_line_shows_where_the_corrected_map_ends_and_nothing_else_has_one(scene, small_case: Case):
    inputs, page = MergeInputs.of(small_case), Page()
    layout = lay_out(inputs.ref, inputs.mov, inputs.at)
    ground = MapLayers(scene, messages=page)
    fusion = fuse((inputs.ref, inputs.mov), (Pose2(), Pose2(3.0, 1.0, 0.2)))

    def edge():
        page.flush()
        return page.edge and np.array(page.edge[0]["p"]) + layout.anchor_ref

    grid = fusion.merged
    ground.corrected = lambda: grid
    ground.load(inputs.ref, inputs.mov, layout, LIGHT)
    ground.merge(fusion)
    assert edge() is None
    ground.compare("result", None)
    assert edge() == pytest.approx(grid.corners())
    grid = cropped(grid)
    ground.show("merged")
    assert edge() == pytest.approx(grid.corners())
    ground.hide()
    assert edge() is None
    ground.show("merged")
    assert edge() is not None
    ground.compare("overlay", None)
    assert edge() is None
