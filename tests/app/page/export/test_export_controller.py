"""The frame of the merged map: chosen, clicked on the map, undone; and what is said of its cells."""

from __future__ import annotations

from dataclasses import replace
from math import atan2
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from controls import Controls
from tabs import event, noting_tab

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import RobotNames
from algorithms.methods.steps import Step
from app.drawing.palette import LIGHT
from app.drawing.scene import frame_symbols
from app.drawing.scene_layout import lay_out
from app.model.run_state import RunState
from app.page.export.export_controller import ExportController
from app.page.export.export_panel import line_html
from app.page.export.frame_panel import FramePanel
from app.page.inputs_controller import InputsController
from app.page.run_controller import RunController
from app.report.export_frame import AS_MERGED, ExportFrame
from app.report.result_files import ResultFiles
from app.web.cell_quota import CellQuota


@pytest.fixture
def gui(server) -> Controls:
    return Controls(server.gui)


class Panel(SimpleNamespace):
    """The export's panel, but for its downloads."""

    def reframe(self, harvest: ResultFiles) -> None:
        self.harvest = harvest


@pytest.fixture
def tab(inputs, result, gui):
    """A tab with an answer that can be taken away."""
    tab = noting_tab(inputs)
    tab.events.then.side_effect = lambda callback, *args: callback(*args)
    tab.panels.export = Panel(frame=FramePanel(gui), harvest=ResultFiles(result, inputs, None))
    tab.display.messages.said.return_value = {"state": "Merged.", "mood": "accepted"}
    run = RunState(tab.state.config)
    run.add(Step("verdict", result, 0.0))
    tab.state.update(run=run, result=result)
    tab.history.record("merge", replace(tab.state.snapshot(), goal="merge", outcome=run))
    return tab


@pytest.fixture
def export(tab) -> ExportController:
    made = ExportController(tab)
    tab.panels.export.offered()
    return made


def choose(gui, label, value):
    """As a person does: viser tells the callbacks who it was."""
    handle = gui.find(label)
    handle.value = value
    for callback in handle._impl.update_cb:
        callback(SimpleNamespace(client_id=0, target=handle))


def clicks(tab, *points, heading=()):
    """Clicks at places of map 1's frame."""
    drop = next(
        call.args[1]
        for call in tab.events.on.call_args_list
        if call.args[0] == "drop" and "frame_axis" in call.kwargs["id"]
    )
    for id_, point in zip(("frame_origin", "frame_axis"), points, strict=False):
        at = (np.array(point) - tab.display.views.map.layout.anchor_ref).tolist()
        drop(id=id_, at=at, heading=list(heading))


def test_a_frame_and_cells_are_steps_of_their_own_that_keep_the_answer(gui, tab, export):
    choose(gui, "Frame", "map 2's")
    assert tab.state.export == tab.panels.export.harvest.frame == ExportFrame("mov")
    assert tab.history.steps[-1].label == "export: map 2's frame"
    assert tab.history.snapshot.outcome is tab.state.run
    choose(gui, "Without yaw", True)
    assert tab.state.export == ExportFrame("mov", yaw=False)
    assert "cells changed" in gui.text()
    choose(gui, "Cell size (m)", 0.1)
    assert tab.state.export == ExportFrame("mov", yaw=False, resolution=0.1)
    choose(gui, "Cell size (m)", 0.05)  # as they were merged
    assert tab.state.export == ExportFrame("mov", yaw=False)
    choose(gui, "Without yaw", False)
    assert "cells changed" not in gui.text()


def test_two_clicks_make_a_frame_with_the_second_on_its_x_axis(gui, tab, export):
    choose(gui, "Frame", "one that I choose")
    assert tab.modes.current is not None
    clicks(tab, (1.0, 2.0), (3.0, 3.0))
    assert tab.modes.current is None
    frame = tab.state.export.frame
    assert frame.array() == pytest.approx([1.0, 2.0, atan2(1, 2)])
    assert "At x 1.00 m, y 2.00 m in map 1, turned by 26.6°." in gui.text()
    assert tab.display.messages.hud.call_args.kwargs == {"state": "Merged.", "mood": "accepted"}


def test_a_drag_from_the_origin_along_the_x_axis_is_enough(gui, tab, export):
    gui.press("Choose it on the map")
    clicks(tab, (1.0, 2.0), heading=(0.5,))
    assert tab.state.export.frame == Pose2(1.0, 2.0, 0.5)


def test_two_clicks_at_one_place_are_told_and_the_second_is_asked_for_again(gui, tab, export):
    choose(gui, "Frame", "one that I choose")
    clicks(tab, (1.0, 2.0), (1.0, 2.0))
    assert "choose one farther away" in tab.display.messages.hud.call_args.kwargs["state"]
    assert tab.state.export == AS_MERGED
    assert tab.modes.current is not None


def test_escape_leaves_it_and_the_panel_says_what_holds(gui, tab, export):
    choose(gui, "Frame", "one that I choose")
    event(tab, "cancel")()
    assert tab.modes.current is None
    assert tab.state.export == AS_MERGED
    assert gui.find("Frame").value == "map 1's"
    clicks(tab, (1.0, 2.0), (3.0, 3.0))  # nobody asked for it
    assert tab.state.export == AS_MERGED


def test_cells_that_no_map_can_have_are_reported_and_nothing_changes(gui, tab, export):
    choose(gui, "Cell size (m)", 0.001)
    assert "cells" in str(tab.notices.report.call_args.args[0])
    assert tab.state.export == AS_MERGED
    assert gui.find("Cell size (m)").value == 0.05


def test_robots_that_have_names_own_the_frames(gui, tab, export, inputs):
    harvest = tab.panels.export.harvest
    tab.panels.export.harvest = replace(harvest, inputs=replace(inputs, names=RobotNames("Bob", "Alice")))
    tab.panels.export.offered()
    assert gui.find("Frame").options == ("Bob's", "Alice's", "one that I choose")
    choose(gui, "Frame", "Alice's")
    assert "--frame-id alice/map --child-frame-id bob/map" in line_html(tab.panels.export.harvest)


def test_a_chosen_frame_is_one_of_its_map_and_goes_with_it(tab, export, inputs):
    loads = InputsController(tab, Mock(RunController, thread=Mock()), CellQuota())
    tab.state.update(export=ExportFrame(Pose2(1.0), yaw=False))
    loads.load(replace(inputs, name="the same map 1"))
    assert tab.state.export.frame == Pose2(1.0)
    loads.load(replace(inputs, maps=inputs.maps[::-1]))
    assert tab.state.export == ExportFrame("ref", yaw=False)


def test_in_a_chosen_frame_two_lines_are_published_and_copied_together(result, inputs):
    html = line_html(ResultFiles(result, inputs, None, ExportFrame(Pose2(1.0))))
    assert html.count("<code>ros2 run") == 2
    assert "Copy the lines" in html
    copied = html.split('data-mm-copy="')[1].split('"')[0]
    assert [line.split("--frame-id ")[1] for line in copied.splitlines()] == [
        "map --child-frame-id map1",
        "map --child-frame-id map2",
    ]


def test_the_axes_are_drawn_from_the_origin_as_long_as_each_other_and_square(inputs):
    layout = lay_out(inputs.ref, inputs.mov, inputs.at)
    x, y, name = frame_symbols.axes(Pose2(1.0, 2.0, 0.3), layout, LIGHT, "map")
    along, up = (each["p"][1] - each["p"][0] for each in (x, y))
    assert along @ up == pytest.approx(0)
    assert np.hypot(*along) == pytest.approx(np.hypot(*up))
    assert atan2(along[1], along[0]) == pytest.approx(0.3)
    assert np.allclose(name["p"] + layout.anchor_ref, (1.0, 2.0))
