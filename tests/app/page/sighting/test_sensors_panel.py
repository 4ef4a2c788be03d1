"""The folder's widgets: which of them are there, what they say, and what they make of a person's words."""

from __future__ import annotations

from math import pi, radians

import pytest
from controls import Controls

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.detection.footprint import Footprint
from app.model.observation_draft import ObservationDraft
from app.model.sighting.look_settings import LookSettings
from app.page.sighting.sensors_panel import FINDERS, SensorsPanel, files_html, where_html

STOOD = ObservationDraft(Pose2(-28.07, -53.8, pi / 6), observed=(42.4, -39.2))


@pytest.fixture
def controls(server) -> Controls:
    return Controls(server.gui)


@pytest.fixture
def panel(controls) -> SensorsPanel:
    return SensorsPanel(controls)


def test_the_settings_begin_as_they_are_by_default(panel):
    assert panel.settings == LookSettings()


def test_settings_are_read_as_the_widgets_stand(panel, controls):
    for label, value in {
        "detector": "Tags (AprilTag, ArUco)",
        "tag family": "25h9",
        "tag size (m)": 0.16,
        "robot 2 is": "round",
        "radius (m)": 0.175,
        "use map 1": False,
        "field of view (°)": 60.0,
    }.items():
        controls.find(label).value = value
    assert panel.settings == LookSettings(
        "tags", 0.5, "25h9", 0.16, Footprint.disc(0.175), False, pytest.approx(radians(60))
    )


@pytest.mark.parametrize(
    "settings",
    [
        LookSettings(),
        LookSettings("tags", 0.3, "25h9", 0.16, Footprint.disc(0.175), False, radians(60)),
        LookSettings("own", body=Footprint(0.7, 0.3)),
    ],
)
def test_settings_that_are_taken_up_are_those_that_are_read(panel, settings):
    panel.take_settings(LookSettings("tags", 0.9, body=Footprint.disc(1.0), field_of_view=1.0))
    panel.take_settings(settings)
    assert panel.settings == settings


def test_only_what_does_something_is_shown(panel, controls):
    def shown(*labels):
        panel.show_settings()
        return [controls.find(label).visible for label in labels]

    labels = "least probability", "tag family", "tag size (m)", "length (m)", "radius (m)"
    assert shown(*labels) == [True, False, False, True, False]
    controls.find("detector").value = next(name for name, finder in FINDERS.items() if finder == "tags")
    controls.find("robot 2 is").value = "round"
    assert shown(*labels) == [False, True, True, False, True]


def test_places_are_shown_in_metres_and_degrees(panel, controls):
    panel.show_places(STOOD, "as in <b>", UNNAMED)
    assert controls.find("robot 1, heading (°)").value == pytest.approx(30)
    assert controls.find("robot 2, y (m)").value == -39.2
    html = where_html(STOOD, "as in <b>", UNNAMED)
    assert "−28.07, −53.80 m, 30.0°" in html
    assert "as in &lt;b&gt;" in html
    assert where_html(ObservationDraft(), "", UNNAMED).count("not known yet") == 2


def test_robots_are_called_by_their_names(panel, controls):
    names = RobotNames("Bob", "Al <i>")
    panel.name(names)
    assert "Bob&#x27;s image, camera and laser scan" in controls.text()
    assert "finds Al &lt;i&gt;, the laser" in controls.text()
    assert controls.find("robot 1, x (m)").label == "Bob, x (m)"
    assert "Al &lt;i&gt; in Al &lt;i&gt;&#x27;s map" in where_html(STOOD, "", names)


def test_files_are_listed_with_their_names_escaped_and_what_is_missing_is_said():
    html = files_html({"Image": "<img>, 640 × 480", "Camera": ""}, "id")
    assert "&lt;img&gt;" in html
    assert html.count("data-missing") == 1
    assert 'data-mm-files="id"' in html


def test_a_fault_is_told_and_the_field_of_view_asked_for_without_a_calibration(panel, controls):
    panel.show_files({"Image": ""}, "Load the image.", bad=False, any_=False, calibrated=False)
    assert "Load the image." in controls.text()
    assert controls.find("field of view (°)").visible
    panel.show_files({"Image": "a"}, "", bad=False, any_=True, calibrated=True)
    assert "Load the image." not in controls.text()
    assert not controls.find("field of view (°)").visible
    assert controls.find("Forget these files").visible


def test_several_encounters_can_be_chosen_among(panel, controls):
    panel.offer(sample=True, rows=1, row=0)
    assert not controls.find("Encounter").visible
    panel.offer(sample=True, rows=3, row=1)
    assert controls.find("Encounter").visible
    assert controls.find("Encounter").options == ("1", "2", "3")
    assert controls.find("Encounter").value == "2"


def test_look_gives_way_to_stop_while_it_looks(panel, controls):
    panel.possible(look=True, busy=True, seen=False)
    assert not controls.find("Look").visible
    assert controls.find("Stop looking").visible
    panel.possible(look=False, busy=False, seen=True)
    assert controls.find("Look").disabled
    assert controls.find("Show what was seen").visible


def test_the_folder_is_there_where_there_are_two_maps(panel, controls):
    (folder, *_) = controls.of_kind("folder")
    assert not folder.visible
    panel.visible(True)
    assert folder.visible
