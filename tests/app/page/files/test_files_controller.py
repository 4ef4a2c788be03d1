"""Files that come to a tab: taken together once all of a choice are there, listed, swapped, removed."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
import viser
from panels import FilesDesk
from tabs import event

from algorithms.common.errors import TooLargeError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.files.fleet_archive import fleet_to_files
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from algorithms.observations.fleet import Fleet
from algorithms.observations.observation import Observation
from app.model.merge_inputs import Files, MergeInputs, OtherFile, Upload
from app.page.files import files_controller
from app.page.files.files_html import MOST_ROWS, files_html, rows_of
from app.page.page_state import PageState

SEEN = Observation(Pose2(2.0, 2.0, 0.0), 3.0, 2.0, 1.0, 0.0)


@pytest.fixture
def desk(server):
    return FilesDesk(server.gui)


@pytest.fixture(scope="module")
def case(small_case) -> dict[str, bytes]:
    maps = {**map_to_bytes(small_case.ref, "map1"), **map_to_bytes(small_case.mov, "map2")}
    return {**maps, "observation.yaml": known_to_bytes([SEEN])}


def arrive(desk: FilesDesk, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        desk.controller._gather(viser.UploadedFile(name, content))


def sent(desk: FilesDesk, count: int, whole: bool = True, button: str = "") -> None:
    event(desk.tab, "sent")(button=button or desk.panel.button, count=count, whole=whole, days=[])


def lines(files: Files) -> list[str]:
    return [f"{row.name}: {row.told}" for row in rows_of(files)]


def test_what_was_chosen_at_once_is_one_action_and_is_listed_with_what_it_was_taken_for(desk, case):
    arrive(desk, case)
    assert desk.loaded == []
    sent(desk, 5)
    assert desk.inputs.sighted
    assert desk.labels == ["load map1.pgm and 4 more"]
    desk.open({f"flat/{name}": content for name, content in case.items()})
    assert desk.labels[1] == "load flat"
    assert lines(desk.panel.files) == [
        "map1.yaml: map 1",
        "map1.pgm: image of map 1",
        "map2.yaml: map 2",
        "map2.pgm: image of map 2",
        "observation.yaml: what is known",
    ]
    assert desk.tab.state.files is desk.panel.files


def test_a_choice_that_was_left_or_is_another_buttons_opens_nothing_and_the_next_one_is_whole(desk, case):
    arrive(desk, case)
    sent(desk, 5, button="another")
    assert desk.loaded == []
    sent(desk, 3, whole=False)
    arrive(desk, {"map1.yaml": case["map1.yaml"]})
    sent(desk, 1)
    assert lines(desk.panel.files) == ["map1.yaml: map 1", "map1.pgm: image of map 1: missing"]


def test_a_choice_that_came_while_another_one_was_read_is_a_choice_of_its_own(desk, case):
    arrive(
        desk, {"map1.yaml": case["map1.yaml"], "map1.pgm": case["map1.pgm"], "map2.yaml": case["map2.yaml"]}
    )
    sent(desk, 2)
    assert desk.inputs.missing().startswith("Map 1 is here")
    sent(desk, 1)
    assert "Load its image, too: map2.pgm" in desk.inputs.missing()


def test_more_than_a_tab_may_hold_is_told(desk, case, monkeypatch):
    monkeypatch.setattr(files_controller, "MAX_UPLOADS", len(case["map1.pgm"]) + 10)
    arrive(desk, {"map1.pgm": case["map1.pgm"], "map1.yaml": case["map1.yaml"]})
    sent(desk, 2)
    assert lines(desk.panel.files)[-1] == "map1.pgm: image of map 1"
    assert str(desk.reports[-1]).startswith("These files: hold more than ")


def test_a_file_that_cannot_be_used_is_told_and_what_is_loaded_stays(desk, case):
    desk.open(case)
    desk.open({"mine.yaml": b"image: mine.pgm\n"})
    assert len(desk.loaded) == 1
    assert "mine.yaml" in str(desk.reports[0])
    assert lines(desk.panel.files)[-1].startswith("mine.yaml: cannot be used: resolution is missing")
    desk.open({"observation.yaml": case["observation.yaml"]})
    assert "cannot be used" not in desk.panel._list.content


def test_maps_are_swapped_replaced_and_removed_by_the_buttons_of_their_lines(desk, case, small_case):
    desk.open(case)
    first, second = desk.inputs.grids
    desk.press("swap")
    assert desk.inputs.grids == (second, first)
    assert desk.labels[-1] == "swap the maps"
    desk.press("swap")
    third = map_to_bytes(replace(small_case.ref, resolution=0.2), "third")
    desk.open(third)
    assert desk.inputs.grids == (first, second)
    assert [row.told for row in rows_of(desk.panel.files)][5:] == ["not used: two maps are there already"] * 2
    desk.press("map1", 5)
    assert desk.inputs.ref.resolution == 0.2
    assert desk.inputs.mov is second
    desk.press("remove", 2)  # the YAML file of map 2
    assert desk.inputs.mov is None
    assert desk.panel._forms[2]._folder.visible  # its image is asked about
    desk.press("remove", 99)
    desk.press("use", 0)  # which its line does not offer
    assert desk.labels[-1] == "remove map2.yaml"
    desk.controller._forget()
    assert desk.inputs.grids == ()
    assert lines(desk.panel.files) == []


def test_a_sample_lists_no_files_and_gives_way_to_them(desk, case):
    desk.controller.take_sample("office_r2_r1")
    assert lines(desk.panel.files) == []
    assert "missing" not in desk.panel._list.content
    assert "drop them anywhere" in desk.panel._list.content
    desk.open({"observation.yaml": case["observation.yaml"]})
    assert desk.inputs.observations == (SEEN,)
    assert len(desk.inputs.grids) == 2
    desk.controller._forget()
    assert desk.inputs.observations == ()
    assert len(desk.inputs.grids) == 2
    desk.open({name: case[name] for name in ("map1.yaml", "map1.pgm")})
    assert len(desk.inputs.grids) == 1
    assert desk.panel._sample.value == "(choose)"


def test_what_an_earlier_step_shows_is_shown_again_and_loads_nothing(desk, case):
    desk.open(case)
    kept, count = desk.panel.files, len(desk.loaded)
    desk.controller._forget()
    desk.panel.show(kept)
    assert lines(desk.panel.files)[0] == "map1.yaml: map 1"
    assert len(desk.loaded) == count + 1


def test_maps_too_large_for_the_page_leave_the_list_as_it_was(desk, case):
    desk.open({"map1.yaml": case["map1.yaml"], "map1.pgm": case["map1.pgm"]})
    desk.controller._load = lambda inputs, label: None  # as for maps for which there is no room
    desk.open({"map2.yaml": case["map2.yaml"], "map2.pgm": case["map2.pgm"]})
    assert lines(desk.panel.files) == ["map1.yaml: map 1", "map1.pgm: image of map 1"]


def test_fleets_robots_and_what_a_robot_saw_go_where_they_belong(desk, small_case, case):
    fleet = Fleet({"r1": small_case.ref, "r2": small_case.mov})
    desk.open(fleet_to_files(fleet))
    loaded, name = desk.fleet.load.call_args.args
    assert set(loaded.maps) == {"r1", "r2"}
    assert name == "fleet"
    desk.fleet.shown = object()
    desk.open({"map1.yaml": case["map1.yaml"], "map1.pgm": case["map1.pgm"]})
    ((robot, grid),) = desk.fleet.add_robots.call_args.args[0]
    assert robot == "map1"
    assert grid.cells.shape == small_case.ref.cells.shape
    desk.open({"scan.yaml": b"angle_min: -1.5\nangle_increment: 0.01\nranges: [1, 2]\n"})
    assert [upload.name for upload in desk.seen] == ["scan.yaml"]


# ---- the list


def test_names_of_files_and_robots_are_words():
    nasty = Upload(
        "<img src=x>.yaml",
        b"image: <b>.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n"
        b"occupied_thresh: 0.6\nfree_thresh: 0.2\n",
    )
    files = Files("", {"yaml1": nasty}, (OtherFile("<i>", "not used: <u>"),))
    page = files_html(files, RobotNames("<s>Bob", "Alice"))
    assert re.findall(r"<(?:img|b>\.|i>|u>|s>)", page.replace("<i>·", "")) == []
    assert "Bob&#x27;s map" in page


def test_a_button_has_the_number_of_its_line_among_those_with_buttons():
    form = replace(Upload("a.yaml", b""), by_form=True)
    uploads = {"yaml1": form, "image1": Upload("a.pgm", b""), "observation": Upload("o.yaml", b"")}
    others = (
        OtherFile("t.yaml", "not used"),
        OtherFile("r.yaml", "not used", upload=Upload("r.yaml", b""), kind="known"),
    )
    page = files_html(Files("", uploads, others), UNNAMED)
    assert re.findall(r'data-mm-file="(\w+)" data-n="(\d)"', page) == [
        ("remove", "0"),
        ("remove", "1"),
        ("use", "2"),
        ("remove", "2"),
    ]
    assert "the form below" in page


def test_an_image_that_is_not_where_its_yaml_file_says_is_told_beside_it(desk, case):
    moved = case["map1.yaml"].replace(b"map1.pgm", b"/home/robot/map1.pgm")
    desk.open({"map1.yaml": moved, "map1.pgm": case["map1.pgm"]})
    assert lines(desk.panel.files)[1] == (
        "map1.pgm: image of map 1, found by its name: it is not at /home/robot/map1.pgm"
    )
    desk.open({"map2.yaml": case["map2.yaml"], "floor.pgm": case["map2.pgm"]})
    assert lines(desk.panel.files)[3] == "floor.pgm: image of map 2; but map2.yaml names map2.pgm"


def test_of_very_many_files_a_part_is_listed():
    files = Files("", {}, tuple(OtherFile(f"{k}.txt", "not used") for k in range(MOST_ROWS + 1200)))
    page = files_html(files, UNNAMED)
    assert page.count("<li") == MOST_ROWS + 1
    assert "and 1,200 more" in page


def test_a_page_without_files_has_no_list():
    assert PageState(MergeInputs()).files.others == ()
    assert "<ul" not in files_html(Files("sample"), UNNAMED)


def test_a_project_is_opened_alone_and_one_that_cannot_be_read_is_told(desk, case):
    desk.open({"a.mapmeld": b"PK", **case})
    assert str(desk.reports.pop()) == (
        "a.mapmeld: is a project, and other files came with it; open it by itself"
    )
    desk.projects.read.assert_not_called()
    desk.open({"a.mapmeld": b"PK"})
    desk.projects.open.assert_called_once_with(desk.projects.read.return_value)
    desk.projects.read.side_effect = TooLargeError("too much")
    desk.open({"called_otherwise.zip": b"PK" + bytes(24) + b"\x0c" + bytes(3) + b"project.json"})
    assert str(desk.reports.pop()) == "too much"
    assert desk.projects.open.call_count == 1
    assert desk.loaded == []
