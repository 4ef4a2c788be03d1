"""A table of encounters reads back as it was written; any spreadsheet's is read; a fault has its line."""

from __future__ import annotations

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files.encounter_table import (
    CONTROL,
    EncounterRow,
    encounters_from_bytes,
    encounters_to_bytes,
    read_encounters,
)
from algorithms.files.observation_file import MOST_OBSERVATIONS
from algorithms.maps.grid_map import FARTHEST

HEADER = "image,scan,observer_x,observer_y,observer_yaw,observed_x,observed_y,observed_yaw\n"
TABLE = HEADER + "a.jpg,a.yaml,1.5,-2,0.25,7,8e-1,-3.1\nimages/b c.png,scans/b.yaml,0,0,0,1,2,\n"
ROWS = (
    EncounterRow("a.jpg", "a.yaml", Pose2(1.5, -2, 0.25), 7.0, 0.8, -3.1),
    EncounterRow("images/b c.png", "scans/b.yaml", Pose2(), 1.0, 2.0),
)

METRES, RADIANS = st.floats(-FARTHEST, FARTHEST), st.floats(-2 * pi, 2 * pi)
PATHS = st.text(st.characters(exclude_categories=["Cc", "Cs"]), min_size=1, max_size=30)
PATHS = PATHS.map(str.strip).filter(bool)
ENCOUNTERS = st.builds(
    EncounterRow, PATHS, PATHS, st.builds(Pose2, METRES, METRES, RADIANS), METRES, METRES, st.none() | RADIANS
)


@given(st.lists(ENCOUNTERS, min_size=1, max_size=8))
def test_rows_that_were_written_read_back_equal(rows):
    assert encounters_from_bytes("e.csv", encounters_to_bytes(rows)) == tuple(rows)


@given(st.permutations(range(8)), st.sampled_from(",;\t"), st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]))
def test_neither_the_order_of_columns_nor_what_separates_them_changes_anything(order, separator, encoding):
    lines = [line.split(",") for line in TABLE.splitlines()]
    text = "\n".join(separator.join(line[k] for k in order) for line in lines)
    assert encounters_from_bytes("e.csv", text.encode(encoding)) == ROWS


AS_IT_COMES = {
    "plain": TABLE,
    "the other end of lines": TABLE.replace("\n", "\r\n"),
    "an old end of lines": TABLE.replace("\n", "\r"),
    "no end of the last line": TABLE.rstrip("\n"),
    "blanks": TABLE.replace(",", " , "),
    "capitals": TABLE.replace("observer_x", "Observer_X"),
    "quotes": '"' + TABLE.replace(",", '","').rstrip("\n").replace("\n", '"\n"') + '"\n',
    "empty lines": TABLE.replace("\n", "\n\n") + ",,,,,,,\n",
    "points that are commas": TABLE.replace(",", ";").replace("1.5", "1,5").replace("0.25", "0,25"),
    "a separator that is named": "sep=;\n" + TABLE.replace(",", ";"),
    "a column of another's": TABLE.replace("yaw\n", "yaw,note\n").replace("3.1\n", '3.1,"near, seen well"\n'),
    "a column that is left empty": TABLE.replace("yaw\n", "yaw,\n"),
    "without the last cell": TABLE.replace("2,\n", "2\n"),
}


@pytest.mark.parametrize("form", AS_IT_COMES)
def test_a_table_is_read_as_programs_and_spreadsheets_write_it(form):
    assert encounters_from_bytes("e.csv", AS_IT_COMES[form].encode()) == ROWS


def test_the_heading_of_the_seen_robot_may_have_no_column():
    text = HEADER.replace(",observed_yaw", "") + "a.jpg,a.yaml,1,2,3,4,5\n"
    (row,) = encounters_from_bytes("e.csv", text.encode())
    assert row == EncounterRow("a.jpg", "a.yaml", Pose2(1, 2, 3), 4, 5, None)


LINE = "a.jpg,a.yaml,1,2,3,4,5,6\n"
# name -> the file, and what is said of it
BAD = {
    "empty": (b"", "is empty; the first line must be image,scan,observer_x"),
    "blank": (b"\n ,\n", "is empty"),
    "only the first line": (HEADER.encode(), "holds no encounter; give a line for each"),
    "no first line": (LINE.encode(), "line 1 names no column image, scan, observer_x, observer_y"),
    "a column missing": (
        TABLE.replace("observed_y,", "seen,").encode(),
        "line 1 names no column observed_y; the",
    ),
    "a column misspelt": (
        TABLE.replace("observer_yaw", "observr_yaw").encode(),
        "line 1 names a column 'observr_yaw'; did you mean observer_yaw?",
    ),
    "a column twice": (TABLE.replace("image,", "image,image,").encode(), "line 1 names image twice"),
    "many columns": ((HEADER[:-1] + ",x" * 1000).encode(), "line 1 names 1,008 columns"),
    "no image": ((HEADER + LINE + ",a.yaml,1,2,3,4,5,6").encode(), "line 3: image is empty; give the name"),
    "no scan": ((HEADER + "\n\na.jpg, ,1,2,3,4,5,6").encode(), "line 4: scan is empty"),
    "a break in a path": (
        (HEADER + '"a\nb",a,1,2,3,4,5,6').encode(),
        "line 3: image is 'a\\nb'; a path has no line",
    ),
    "a quote without an end": (
        (HEADER + '"a.jpg,a,1,2,3\n' + LINE).encode(),
        "line 3: image is 'a.jpg,a,1,2,3\\n",
    ),
    "no number": (
        (HEADER + "a,b,1,2,3,4,,6").encode(),
        "line 2: observed_y is empty, not a finite number; give metres",
    ),
    "a word": (
        (HEADER + "a,b,1,2,east,4,5,6").encode(),
        "line 2: observer_yaw is 'east', not a finite number; give rad",
    ),
    "no finite number": (
        (HEADER + "a,b,nan,2,3,4,5,6").encode(),
        "line 2: observer_x is 'nan', not a finite",
    ),
    "thousands": (
        (HEADER + 'a,b,"1,500",2,3,4,5,6').encode(),
        "line 2: observer_x is '1,500', not a finite number",
    ),
    "commas in numbers": (
        (HEADER + "a,b,1,5,2,0,3,0,4,0,5,6").encode(),
        "line 2 has 12 cells, and the first line 8; put a path that holds the separator in quotes",
    ),
    "far away": (
        (HEADER + "a,b,1,2,3,2e7,5,6").encode(),
        "line 2: observed_x is 2e+07 m, which is more than 10,000 km",
    ),
    "degrees": (
        (HEADER + LINE + "a,b,1,2,90,4,5,6").encode(),
        "line 3: observer_yaw is 90 rad, more than a whole turn; it looks like degrees: give radians, 1.571",
    ),
    "a heading in degrees": ((HEADER + "a,b,1,2,3,4,5,-180").encode(), "line 2: observed_yaw is -180 rad"),
    "too many": ((HEADER + LINE * (MOST_OBSERVATIONS + 1)).encode(), "holds more than 64 encounters"),
    "too long": (
        (HEADER + LINE * 20_000).encode(),
        "has more than 200,000 bytes; give a table of at most 64",
    ),
    "a long cell": (
        (HEADER + "x" * 150_000).encode(),
        "line 2 is not CSV (field larger than field limit (131072))",
    ),
    "a workbook": (b"PK\x03\x04" + bytes(99), "is a zip; save it as CSV, UTF-8"),
    "another encoding": (
        (HEADER + LINE.replace("a", "ä")).encode("cp1252"),
        "is no text in UTF-8; save it as CSV",
    ),
    "half a wide character": (b"\xff\xfea", "is no text in UTF-8"),
    "a picture": (b"\x89PNG\r\n\x1a\n", "is no text in UTF-8"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_table_is_refused_in_words(case):
    data, said = BAD[case]
    with pytest.raises(InputFileError) as told:
        encounters_from_bytes("e.csv", data)
    message = str(told.value)
    assert message.startswith("e.csv: ")
    assert said in message
    assert not CONTROL.search(message)
    assert len(message) < 400
    assert told.value.remedy


@pytest.mark.parametrize("number", [0, MOST_OBSERVATIONS + 1])
def test_a_table_of_none_or_too_many_is_not_written(number):
    with pytest.raises(SettingError, match=f"1 to 64 encounters, not {number}"):
        encounters_to_bytes(ROWS[:1] * number)


def test_a_table_is_read_from_disk_and_a_missing_one_and_a_folder_are_named(tmp_path):
    (tmp_path / "e.csv").write_text(TABLE)
    assert read_encounters(tmp_path / "e.csv") == ROWS
    with pytest.raises(InputFileError, match=r"no\.csv: no such file; give the CSV file of the encounters"):
        read_encounters(tmp_path / "no.csv")
    with pytest.raises(InputFileError, match="is a folder"):
        read_encounters(tmp_path)
