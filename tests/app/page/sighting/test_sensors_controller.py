"""Files and places of a sighting: sent, from a table, the sample or the observation; other maps end them."""

from __future__ import annotations

from collections.abc import Callable
from math import radians
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from tabs import noting_tab
from tagged_pictures import ASIDE, NEAR, laid_down, sighting_files

from algorithms.common.pose import Pose2
from algorithms.files.camera_picture import picture_to_png
from algorithms.files.encounter_table import EncounterRow, encounters_to_bytes
from app.model.merge_inputs import Files, MergeInputs, Upload
from app.model.sighting.look_settings import LookSettings
from app.page.sighting.sensors_controller import SensorsController
from app.page.tab import Tab

FILES = sighting_files(NEAR)
ROWS = [
    EncounterRow("seen.png", "scan.yaml", Pose2(1.0, 2.0, 0.5), 3.0, 4.0),
    EncounterRow("seen_2.png", "scan_2.yaml", Pose2(5.0, 6.0, 0.7), 7.0, 8.0, 0.9),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A sample's, with two encounters."""
    laid_down(FILES, tmp_path)
    second = sighting_files(ASIDE)
    (tmp_path / "seen_2.png").write_bytes(second["seen.png"])
    (tmp_path / "scan_2.yaml").write_bytes(second["scan.yaml"])
    (tmp_path / "encounters.csv").write_bytes(encounters_to_bytes(ROWS))
    return tmp_path


@pytest.fixture
def tab(inputs) -> Tab:
    made = noting_tab(inputs)
    made.panels.sensors.settings = LookSettings("tags")
    return made


@pytest.fixture
def sensors(tab, folder) -> SensorsController:
    made = SensorsController(tab, lambda: {"sample": folder})
    made.changed = Mock()
    return made


def button(tab: Tab, which: int) -> Callable[..., None]:
    """What is called where a person asks: 1 the sample, 2 another encounter, 3 forget."""
    return tab.panels.sensors.connect.call_args.args[which]


def send(tab: Tab, **files: bytes) -> None:
    """Files come from the browser."""
    arrived = tab.panels.sensors.connect.call_args.args[0]
    for name, content in files.items():
        arrived(Upload(name.replace("_", ".", 1), content))
        take, upload = tab.events.then.call_args.args
        take(upload)


def send_all(tab: Tab) -> None:
    send(tab, **{name.replace(".", "_"): content for name, content in FILES.items()})


def said(tab: Tab) -> tuple[str, bool]:
    """What is missing or does not fit, and whether the latter."""
    return tab.panels.sensors.show_files.call_args.args[1:3]


def at_sample(tab: Tab) -> None:
    tab.state.update(files=Files("sample"), inputs=MergeInputs.pair(*tab.state.inputs.grids))


def test_there_is_something_to_look_at_once_all_files_are_there(sensors, tab):
    assert sensors.order() is None
    send_all(tab)
    order = sensors.order()
    assert order.picture.name == "seen.png"
    assert order.grid is tab.state.inputs.ref
    assert order.observer == tab.state.inputs.observations[0].observer
    sensors.changed.assert_called()


def test_map_1_is_asked_where_a_person_wants_it_and_the_place_is_known(sensors, tab):
    send_all(tab)
    tab.panels.sensors.settings = LookSettings("tags", use_map=False)
    assert sensors.order().grid is None
    tab.panels.sensors.settings = LookSettings("tags")
    tab.state.update(inputs=MergeInputs.pair(*tab.state.inputs.grids))
    assert sensors.order().grid is None
    assert sensors.unplaced.startswith("Give where robot 1 stood in map 1 and where robot 2")


def test_a_file_that_is_none_is_told_at_once_and_what_was_there_stays(sensors, tab):
    send_all(tab)
    send(tab, notes_txt=b"Dear diary")
    text, bad = said(tab)
    assert bad
    assert text.startswith("notes.txt: is neither an image, nor")
    (error,) = tab.notices.report.call_args.args
    assert str(error) == text
    assert sensors.order() is not None


def test_files_that_do_not_belong_together_are_told_and_not_looked_at(sensors, tab):
    send_all(tab)
    send(tab, small_png=picture_to_png(np.zeros((240, 320, 3), np.uint8)))
    text, bad = said(tab)
    assert bad
    assert "is for 640 × 480" in text
    assert sensors.order() is None


def test_the_robots_stand_as_the_observation_has_it_until_a_person_says_otherwise(sensors, tab):
    o = tab.state.inputs.observations[0]
    assert sensors.place.observer == o.observer
    assert sensors.place.observed == (o.observed_x, o.observed_y)
    sensors.typed("turn1", radians(10))
    sensors.typed("x2", 9.0)
    assert sensors.place.observer == Pose2(o.observer.x, o.observer.y, radians(10))
    assert sensors.place.observed == (9.0, o.observed_y)
    tab.state.update(inputs=MergeInputs.pair(*tab.state.inputs.grids))  # the observation goes
    assert sensors.place.observed == (9.0, o.observed_y)


def test_a_place_that_nobody_knows_is_begun_with_a_number(sensors, tab):
    tab.state.update(inputs=MergeInputs.pair(*tab.state.inputs.grids))
    assert sensors.place.observer is None
    sensors.typed("x1", 2.0)
    assert sensors.place.observer == Pose2(2.0, 0.0, 0.0)
    assert sensors.place.observed is None
    assert sensors.unplaced == "Give where robot 2 stood in map 2: under “Where the robots stood”."
    sensors.typed("y2", 3.0)
    assert sensors.unplaced == ""


def test_the_sample_brings_its_files_and_places_and_its_other_encounters(sensors, tab):
    at_sample(tab)
    assert tab.panels.sensors.offer.call_args.args[0]
    button(tab, 1)()
    assert sensors.order() is not None
    assert sensors.place.observer == ROWS[0].observer
    assert tab.panels.sensors.offer.call_args.args == (True, 2, 0)
    button(tab, 2)(1)
    assert sensors.order().picture.name == "seen_2.png"
    assert sensors.place.observer == ROWS[1].observer
    assert sensors.place.heading == 0.9
    assert tab.panels.sensors.show_places.call_args.args[1] == "as in encounters.csv"


def test_what_is_wrong_in_a_sample_is_told(sensors, tab, folder):
    (folder / "seen.png").write_bytes(b"no image")
    at_sample(tab)
    button(tab, 1)()
    tab.notices.report.assert_called_once()
    assert not sensors.files.any


def test_a_sample_without_them_offers_nothing(sensors, tab, folder):
    (folder / "encounters.csv").unlink()
    at_sample(tab)
    assert not tab.panels.sensors.offer.call_args.args[0]
    button(tab, 1)()
    assert not sensors.files.any


def test_a_table_that_is_sent_tells_where_the_robots_stood(sensors, tab):
    send(tab, encounters_csv=encounters_to_bytes(ROWS))
    before = sensors.place
    send(tab, seen_png=FILES["seen.png"])
    assert sensors.place.observer == ROWS[0].observer != before.observer
    send(tab, other_png=FILES["seen.png"])  # of another moment
    assert sensors.place == before


def test_other_maps_take_the_files_of_the_sample_along_and_leave_ones_own(sensors, tab, inputs):
    at_sample(tab)
    button(tab, 1)()
    others = MergeInputs.pair(inputs.mov, inputs.ref, inputs.observations)
    tab.state.update(files=Files(), inputs=others)
    assert not sensors.files.any
    assert sensors.place.observer == others.observations[0].observer
    send_all(tab)
    tab.state.update(inputs=inputs)
    assert sensors.files.picture is not None


def test_forgotten_files_are_gone_and_the_places_are_the_observations(sensors, tab):
    send_all(tab)
    sensors.typed("x1", 2.0)
    button(tab, 3)()
    assert sensors.order() is None
    assert sensors.place.observer == tab.state.inputs.observations[0].observer
