"""Files in any order and number become what they make up: a pair, a fleet, robots more, a sighting."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from bags import bag_bytes, grid_message, transform_message
from hypothesis import given, settings
from hypothesis import strategies as st
from tagged_pictures import NEAR, sighting_files

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.fleet_archive import fleet_to_files
from algorithms.files.map_file import map_from_bytes, map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.observations.fleet import Fleet
from algorithms.observations.observation import Observation
from app.model.files import bag_maps, file_reader
from app.model.files.file_reader import FileReader, OpenedFiles, upload_at
from app.model.files.file_roles import swapped, with_other
from app.model.merge_inputs import Files, MergeInputs
from app.report.result_files import zip_bytes
from app.system.cancellation import Cancelled

SEEN = Observation(Pose2(0.5, 0.5, 0.0), 0.3, 0.3, 0.2, 0.0)
FIRST, SECOND, THIRD = (
    GridMap(np.where(np.arange(100).reshape(10, 10) % k == 0, OCCUPIED, FREE).astype(np.int8), 0.1)
    for k in (3, 4, 7)
)
MAP_1, MAP_2, ROBOT_3 = map_to_bytes(FIRST, "map1"), map_to_bytes(SECOND, "map2"), map_to_bytes(THIRD, "r3")
KNOWN = {"observation.yaml": known_to_bytes([SEEN])}
CASE = {**MAP_1, **MAP_2, **KNOWN}
NOTHING = Files()


class Page:
    """What the page shows, file by file."""

    def __init__(self, sample: str = "", inputs: MergeInputs | None = None, fleet: bool = False) -> None:
        self.reader, self.files, self.inputs = FileReader(), Files(sample), inputs or MergeInputs()
        self.fleet = fleet

    def open(self, files: dict[str, bytes]) -> OpenedFiles:
        uploads = [upload_at(path, content) for path, content in files.items()]
        opened = self.reader.open(self.files, uploads, self.inputs, self.fleet)
        return self.show(opened)

    def show(self, opened: OpenedFiles) -> OpenedFiles:
        self.files, self.inputs = opened.files, opened.inputs or self.inputs
        return opened

    @property
    def cells(self) -> list[list[int] | None]:
        """Of map 1 and map 2."""
        return [None if slot.grid is None else slot.grid.cells.ravel().tolist() for slot in self.inputs.maps]

    @property
    def doubts(self) -> str:
        """Whether files belong together."""
        return "".join(slot.doubt for slot in self.inputs.maps)

    @property
    def others(self) -> dict[str, str]:
        return {other.name: other.told for other in self.files.others}


def cells_of(*maps: GridMap | None) -> list[list[int] | None]:
    return [None if grid is None else grid.cells.ravel().tolist() for grid in maps]


@pytest.mark.parametrize("order", list(permutations(CASE))[::7])
def test_five_files_at_once_and_one_by_one_in_any_order_are_the_same_pair(order):
    at_once, one_by_one = Page(), Page()
    at_once.open({name: CASE[name] for name in order})
    for name in order:
        assert not one_by_one.open({name: CASE[name]}).errors
    for page in (at_once, one_by_one):
        assert page.cells == cells_of(FIRST, SECOND)
        assert page.inputs.observations == (SEEN,)
        assert page.doubts == ""
        assert page.others == {}


@pytest.mark.parametrize("as_zip", [True, False], ids=["zip", "folder"])
def test_a_case_folder_is_a_pair_and_what_else_lies_in_it_is_told(as_zip):
    files = {
        **CASE,
        "observation_rough.yaml": known_to_bytes([replace(SEEN, range=0.3)]),
        "truth.yaml": b"expected: refuse\n",
        "notes.txt": b"Dear diary",
        **sighting_files(NEAR),
    }
    page = Page()
    given = (
        {"case.zip": zip_bytes(files)} if as_zip else {f"case/{name}": data for name, data in files.items()}
    )
    opened = page.open(given)
    assert page.cells == cells_of(FIRST, SECOND)
    assert page.inputs.observations == (SEEN,)
    assert opened.errors == ()  # a diary may lie in a folder
    assert page.others["observation_rough.yaml"] == "not used: observation.yaml was taken"
    assert page.others["truth.yaml"].startswith("not used: a known answer")
    assert page.others["notes.txt"].startswith("cannot be used: is nothing that is known here")
    assert sorted(upload.name for upload in opened.sighting) == ["camera.yaml", "scan.yaml", "seen.png"]
    assert page.others["seen.png"] == "a camera's image: see From camera and scan"


def test_which_map_is_the_first_is_said_by_the_numbers_in_their_names_else_by_their_order():
    page = Page()
    page.open({**MAP_2, **MAP_1})
    assert page.cells == cells_of(FIRST, SECOND)
    page = Page()
    page.open({**map_to_bytes(SECOND, "bob"), **map_to_bytes(FIRST, "alice")})
    assert page.cells == cells_of(SECOND, FIRST)
    page.show(page.reader.pair_of(swapped(page.files), page.inputs))
    assert page.cells == cells_of(FIRST, SECOND)
    page = Page()
    page.open(MAP_2)
    assert page.cells == cells_of(None, SECOND)


def test_an_image_that_was_moved_or_is_named_otherwise_is_found_and_doubted_where_it_may_be_wrong():
    moved = MAP_1["map1.yaml"].replace(b"map1.pgm", b"/home/robot/maps/map1.pgm")
    page = Page()
    page.open({"a/map1.yaml": moved, "b/map1.pgm": MAP_1["map1.pgm"]})
    assert page.cells == cells_of(FIRST, None)
    assert page.doubts == ""
    page = Page()
    opened = page.open({"map1.yaml": MAP_1["map1.yaml"], "scan of the floor.pgm": MAP_1["map1.pgm"]})
    assert opened.errors == ()
    assert page.cells == cells_of(FIRST, None)
    assert "names the image map1.pgm; loaded is scan of the floor.pgm" in page.inputs.doubt()


@pytest.mark.parametrize("folders", [("a/", "b/"), ("a/", ""), ("", "")])
def test_maps_of_two_robots_that_are_called_alike_are_two_maps(folders):
    one, two = (
        {f"{folder}{name}": data for name, data in map_to_bytes(grid, "map").items()}
        for folder, grid in zip(folders, (FIRST, SECOND), strict=True)
    )
    page = Page()
    page.open(one)
    page.open(two)
    assert page.cells == cells_of(FIRST, SECOND)
    page.open(two)  # once more
    assert page.cells == cells_of(FIRST, SECOND)
    if len(one | two) == 4:
        page = Page()
        page.open(one | two)
        assert page.cells == cells_of(FIRST, SECOND)


def test_a_map_that_comes_from_its_folder_again_takes_its_own_place():
    page = Page()
    page.open({f"a/{name}": data for name, data in map_to_bytes(FIRST, "map").items()})
    page.open({f"a/{name}": data for name, data in map_to_bytes(THIRD, "map").items()})
    assert page.cells == cells_of(THIRD, None)


def test_a_second_yaml_file_never_comes_with_the_image_of_the_first():
    page = Page()
    page.open(CASE)
    page.open({"map1.yaml": map_to_bytes(THIRD, "other")["other.yaml"]})
    assert page.cells == cells_of(None, SECOND)
    assert "Load its image, too: other.pgm" in page.inputs.missing()
    page.open({"other.pgm": map_to_bytes(THIRD, "other")["other.pgm"]})
    assert page.cells == cells_of(THIRD, SECOND)


def test_a_corrected_file_takes_the_place_of_the_one_of_its_name():
    page = Page()
    page.open(CASE)
    page.open({"map2.yaml": MAP_2["map2.yaml"].replace(b"0.1", b"0.2", 1)})
    assert page.inputs.mov.resolution == 0.2
    page.open({"map2.pgm": map_to_bytes(THIRD, "map2")["map2.pgm"]})
    assert page.cells == cells_of(FIRST, THIRD)
    assert page.inputs.observations == (SEEN,)


def test_a_third_map_is_not_used_before_it_is_chosen_and_the_other_one_can_come_back():
    page = Page()
    page.open(CASE)
    assert page.open(ROBOT_3).inputs is None
    assert page.others == dict.fromkeys(("r3.yaml", "r3.pgm"), "not used: two maps are there already")
    page.show(page.reader.pair_of(with_other(page.files, 0, 2), page.inputs))
    assert page.cells == cells_of(FIRST, THIRD)
    assert set(page.others) == {"map2.yaml", "map2.pgm"}
    page.show(page.reader.pair_of(with_other(page.files, 0, 2), page.inputs))
    assert page.cells == cells_of(FIRST, SECOND)


def test_two_further_maps_at_once_begin_anew():
    page = Page()
    page.open(CASE)
    page.open({**map_to_bytes(THIRD, "a"), **map_to_bytes(FIRST, "b")})
    assert page.cells == cells_of(THIRD, FIRST)
    assert page.inputs.observations == ()


def test_of_two_files_of_what_is_known_the_other_one_can_be_used():
    page, rough = Page(), replace(SEEN, range=0.3)
    page.open({**CASE, "observation_rough.yaml": known_to_bytes([rough])})
    page.show(page.reader.pair_of(with_other(page.files, 0, 1), page.inputs))
    assert page.inputs.observations == (rough,)
    assert page.others == {"observation.yaml": "not used: observation_rough.yaml was taken"}


def test_what_is_known_is_known_of_the_sample_that_is_on_the_page_and_leaves_with_it():
    page = Page("sample", MergeInputs.pair(FIRST, SECOND))
    page.open(KNOWN)
    assert page.cells == cells_of(FIRST, SECOND)
    assert page.inputs.observations == (SEEN,)
    assert page.files.sample == "sample"
    page.open(map_to_bytes(THIRD, "mine"))
    assert page.cells == cells_of(THIRD, None)
    assert page.inputs.observations == ()
    assert page.files.sample == ""


def test_a_map_that_cannot_be_read_is_told_and_the_other_files_are_used():
    page = Page()
    opened = page.open({**CASE, "map2.pgm": b"P5\n10 10\n255\nshort"})
    assert page.cells == cells_of(FIRST, None)
    assert page.inputs.observations == (SEEN,)
    (error,) = opened.errors
    assert str(error).startswith("map2.pgm: ")
    assert page.others["map2.pgm"].startswith("cannot be used: ")
    page.open(CASE)
    assert page.cells == cells_of(FIRST, SECOND)
    assert page.open({"map1.pgm": b"P5\n10 10\n255\nshort"}).inputs is None  # what was there stays
    assert page.cells == cells_of(FIRST, SECOND)


def test_several_images_of_which_no_yaml_file_is_there_are_asked_about():
    page = Page()
    opened = page.open({"b.pgm": MAP_2["map2.pgm"], "a.pgm": MAP_1["map1.pgm"], "c.pgm": ROBOT_3["r3.pgm"]})
    assert [upload.name for upload in opened.greys] == ["b.pgm", "a.pgm"]
    assert "fill in the form" in page.inputs.missing()
    assert page.others == {"c.pgm": "not used: two maps are there already"}


def test_a_fleet_waits_for_its_maps_and_is_loaded_once_all_of_them_are_there():
    fleet = Fleet({"r1": FIRST, "r2": SECOND, "r3": THIRD})
    files = fleet_to_files(fleet)
    page = Page()
    late = {name: files.pop(name) for name in ("robot_2.pgm", "robot_3.yaml")}
    opened = page.open(files)
    assert opened.fleet is None
    assert opened.inputs is None
    assert isinstance(opened.errors[0], InputFileError)
    assert page.others["fleet.yaml"].startswith("names robot_2.pgm, which is not there")
    assert page.others["robot_1.yaml"] == "waits for its fleet"
    name, loaded = page.open(late).fleet
    assert name == "fleet"
    assert [grid.cells.tolist() for grid in loaded.maps.values()] == [
        grid.cells.tolist() for grid in fleet.maps.values()
    ]
    assert page.others["fleet.yaml"] == "a fleet of 3 robots"
    assert page.others["robot_2.yaml + robot_2.pgm"] == "robot r2"


def test_while_a_fleet_is_shown_maps_become_robots_and_a_pair_with_what_is_known_takes_its_place():
    page = Page(fleet=True)
    assert page.open({"r3.yaml": ROBOT_3["r3.yaml"]}).robots == ()
    assert page.others == {"r3.yaml": "a robot: its image is missing"}
    opened = page.open({"r3.pgm": ROBOT_3["r3.pgm"], **MAP_1, "truth.yaml": b"expected: refuse\n"})
    assert [name for name, _ in opened.robots] == ["map1", "r3"]
    assert page.others["r3.pgm"] == "robot r3"
    assert page.open(KNOWN).inputs is None
    assert page.others["observation.yaml"].startswith("not used: open a pair")
    page.open(CASE)
    assert page.cells == cells_of(FIRST, SECOND)


def test_of_several_moments_one_is_looked_at():
    sensed = sighting_files(NEAR)
    opened = Page().open(
        {
            "seen_10.png": sensed["seen.png"],
            "seen_2.png": sensed["seen.png"],
            "scan_2.yaml": sensed["scan.yaml"],
            "camera.yaml": sensed["camera.yaml"],
        }
    )
    assert {upload.name for upload in opened.sighting} == {"seen_2.png", "scan_2.yaml", "camera.yaml"}
    assert "seen_2.png was taken" in {other.name: other.told for other in opened.files.others}["seen_10.png"]


def test_an_image_that_a_map_waits_for_is_no_camera_image_whatever_comes_with_it():
    page = Page()
    page.open({"map1.yaml": MAP_1["map1.yaml"]})
    opened = page.open({"camera.yaml": sighting_files(NEAR)["camera.yaml"], "map1.pgm": MAP_1["map1.pgm"]})
    assert page.cells == cells_of(FIRST, None)
    assert [upload.name for upload in opened.sighting] == ["camera.yaml"]


def test_files_that_wait_are_bounded_and_of_one_path_the_newest_is_kept(monkeypatch):
    monkeypatch.setattr(file_reader, "MOST_UNPACKED", 1000)
    page = Page()
    page.open(CASE)
    for _ in range(3):
        page.open(ROBOT_3)
    for k in range(9):
        page.open(map_to_bytes(THIRD, f"more{k}"))
    assert [other.name for other in page.files.others if other.upload is not None][:2] == [
        "more8.yaml",
        "more8.pgm",
    ]
    kept = [other.upload for other in page.files.others if other.upload is not None]
    assert sum(len(upload.content) for upload in kept) <= 1000


@pytest.mark.parametrize("kind", ["ros1", "db3", "mcap"])
def test_the_maps_of_recordings_are_taken_as_files_are(monkeypatch, kind):
    costs = grid_message(THIRD, 0.0, "/local_costmap/costmap")
    both = [grid_message(FIRST, 1.0, "/robot1/map"), grid_message(SECOND, 1.0, "/robot2/map"), costs]
    one, two = Page(), Page()
    one.open({"both.any": bag_bytes(kind, both), **KNOWN})
    assert one.cells == [FIRST.cells.ravel().tolist(), SECOND.cells.ravel().tolist()]
    two.open({"robot2.bag": bag_bytes(kind, [grid_message(SECOND, 1.0)])})
    two.open({"robot1.bag": bag_bytes(kind, [grid_message(FIRST, 1.0), costs])})
    assert two.cells == one.cells
    assert two.files.uploads["yaml1"].name == "robot1.yaml"
    (error,) = two.open({"empty.bag": bag_bytes(kind, [transform_message("a", "b", 0.0, (0, 0, 0))])}).errors
    assert str(error).startswith("empty.bag: is ")
    assert "holds no map; record a map topic" in str(error)
    monkeypatch.setattr(bag_maps, "MOST_UNPACKED", 10)
    (error,) = Page().open({"both.bag": bag_bytes(kind, both)}).errors
    assert "its 2 maps are more than" in str(error)


def test_of_very_many_maps_but_so_many_are_read(monkeypatch):
    monkeypatch.setattr(file_reader, "MOST_TEXTS", 3)
    page = Page()
    page.open({f"m{k}.yaml": MAP_1["map1.yaml"] for k in range(5)} | {"map1.pgm": MAP_1["map1.pgm"]})
    assert page.cells == cells_of(FIRST, FIRST)
    assert [told for told in page.others.values() if "are read at once" in told] == [file_reader.TOO_MANY] * 2


def test_a_zip_in_a_zip_is_told_and_stop_leaves_everything():
    page = Page()
    page.open({"a.zip": zip_bytes({"b.zip": zip_bytes(CASE)})})
    assert page.inputs.grids == ()

    def stopped(done: float | None = None, /) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        page.reader.open(page.files, [upload_at("map1.pgm", b"P5")], page.inputs, check=stopped)


def test_paths_are_shown_short_and_lead_nowhere():
    upload = upload_at("../../etc/" + "x" * 300 + "\u202e.yaml", b"")
    assert len(upload.name) == 80
    assert upload_at("C:\\maps\\a.yaml", b"").path == "C:/maps/a.yaml"
    assert upload_at("", b"").name == "file"


POOL = {
    **CASE,
    **ROBOT_3,
    **fleet_to_files(Fleet({"r1": FIRST, "r2": SECOND})),
    **sighting_files(NEAR),
    "plain.pgm": ROBOT_3["r3.pgm"],
    "cut.pgm": ROBOT_3["r3.pgm"][:40],
    "bad.yaml": MAP_1["map1.yaml"][:60],
    "empty.yaml": b"",
    "truth.yaml": b"expected: refuse\n",
    "all.zip": zip_bytes({**MAP_1, "x/observation.yaml": KNOWN["observation.yaml"]}),
}


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.lists(st.sampled_from(sorted(POOL)), min_size=1, max_size=6, unique=True), max_size=6),
    st.sampled_from(["", "a", "a/b"]),
    st.booleans(),
)
def test_whatever_comes_in_whatever_order_every_file_is_told_of_and_no_map_has_anothers_image(
    choices, folder, fleet
):
    page = Page(fleet=fleet)
    for names in choices:
        opened = page.open({f"{folder}/{name}" if folder else name: POOL[name] for name in names})
        told = {upload.name for upload in page.files.uploads.values()}
        told |= {name for other in page.files.others for name in other.name.split(" + ")}
        assert set(names) - {"all.zip"} <= told
        texts = (page.files.uploads.get(f"yaml{number}") for number in (1, 2))
        for slot, text, number in zip(page.inputs.maps, texts, (1, 2), strict=True):
            if slot.grid is not None and text is not None and not opened.fleet:
                image = page.files.uploads[f"image{number}"]
                alone = map_from_bytes(text.name, text.content, image.name, image.content)
                assert np.array_equal(slot.grid.cells, alone.cells)
                assert slot.doubt or text.meta.image == image.name
