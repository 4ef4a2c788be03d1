"""YAML that Nav2 loads, this loads to the same numbers; images are found beside files that were moved."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.files.map_file import map_to_bytes, parse_meta, read_map
from algorithms.files.observation_file import known_from_bytes, known_to_bytes
from algorithms.maps.grid_map import remarks_on

LINES = {
    "image": "map1.pgm",
    "mode": "trinary",
    "resolution": "0.05",
    "origin": "[-12.85, -30.65, 0.25]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
PLAIN = "".join(f"{key}: {value}\n" for key, value in LINES.items()).encode()
BLANKS = st.text(" \t", max_size=4)


@given(st.data())
def test_tabs_after_a_colon_in_a_list_before_a_comment_and_at_a_lines_end_are_blanks(data):
    text = ""
    for key, value in LINES.items():
        before, after = data.draw(st.text(" \t", min_size=1, max_size=4)), data.draw(BLANKS)
        comment = data.draw(st.sampled_from(["", " # a remark", "\t#\ta\tremark"]))
        inside = value.replace(", ", "," + data.draw(BLANKS))
        text += (
            f"{key}:{before}{inside}{after}{comment}\n{data.draw(st.sampled_from(['', chr(9) + chr(10)]))}"
        )
    assert parse_meta("map.yaml", text.encode()) == parse_meta("map.yaml", PLAIN)


def test_a_tab_that_indents_is_an_error_as_it_is_for_everyone():
    with pytest.raises(InputFileError, match="is not YAML"):
        parse_meta("map.yaml", b"\timage: map1.pgm\n")


@pytest.mark.parametrize("header", [b"%YAML:1.0\n", b"%YAML:1.0\n---\n", b"\xef\xbb\xbf%YAML:1.0\r\n---\r\n"])
def test_the_header_of_opencvs_files_is_passed_over_in_maps_and_observations(header, small_case):
    assert parse_meta("map.yaml", header + PLAIN) == parse_meta("map.yaml", PLAIN)
    seen = known_to_bytes(small_case.observations)
    assert known_from_bytes("o.yaml", header + seen) == known_from_bytes("o.yaml", seen)


@pytest.mark.parametrize("second", [b"saved_by: survey\n", b"[1, 2", b"\t", b""])
def test_of_several_documents_the_first_is_taken_and_that_is_said(second):
    meta = parse_meta("map.yaml", b"---\n" + PLAIN + b"---\n" + second)
    assert meta.image == "map1.pgm"
    assert meta.remarks == ("its YAML file holds several documents; the first was taken",)
    assert parse_meta("map.yaml", b"---\n" + PLAIN + b"...\n").remarks == ()


def saved(folder: Path, grid, image: str) -> Path:
    """A map whose YAML file names its image otherwise than it is called."""
    files = map_to_bytes(grid, "map1")
    (folder / "map1.pgm").write_bytes(files["map1.pgm"])
    text = files["map1.yaml"].decode().replace("image: map1.pgm", f"image: '{image}'")
    (folder / "map1.yaml").write_text(text)
    return folder / "map1.yaml"


ELSEWHERE = "/home/robot/maps/map1.pgm", "~/map1.pgm", "C:\\maps\\map1.pgm", "old/map1.pgm", "~no/map1.pgm"


@pytest.mark.parametrize("image", ELSEWHERE)
def test_an_image_that_is_not_where_it_was_is_taken_from_beside_and_said(tmp_path, small_case, image):
    grid = read_map(saved(tmp_path, small_case.ref, image))
    assert (grid.cells == small_case.ref.cells).all()
    (said,) = remarks_on((grid,))
    assert f"its image {image} is not there; map1.pgm beside the YAML file was taken" in said


def test_the_home_folder_is_where_the_tilde_says(tmp_path, small_case, monkeypatch):
    home, away = tmp_path / "home", tmp_path / "away"
    home.mkdir()
    away.mkdir()
    path = saved(away, small_case.ref, "~/map1.pgm")
    (away / "map1.pgm").rename(home / "map1.pgm")
    monkeypatch.setenv("HOME", str(home))
    assert read_map(path).remarks == ()


def test_where_it_is_not_beside_it_either_both_places_are_named(tmp_path, small_case):
    path = saved(tmp_path, small_case.ref, "/home/robot/map1.pgm")
    (tmp_path / "map1.pgm").unlink()
    with pytest.raises(InputFileError, match=r"/home/robot/map1.pgm is not there, and no map1.pgm is beside"):
        read_map(path)
