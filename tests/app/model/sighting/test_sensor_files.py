"""Files of a sighting come in any order; what is missing, and what does not fit, is a sentence."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from math import radians

import numpy as np
import pytest
from tagged_pictures import NEAR, sighting_files

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.camera_picture import picture_to_png
from algorithms.files.encounter_table import EncounterRow, encounters_to_bytes
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from app.model.merge_inputs import Upload
from app.model.sighting.look_settings import LookSettings
from app.model.sighting.sensor_files import SensorFiles

FILES = sighting_files(NEAR)
ROWS = [EncounterRow(f"{name}.png", "s.yaml", Pose2(k, 2, 0.5), 3.0, 4.0) for k, name in enumerate("ab")]


def loaded(*names: str, before: SensorFiles | None = None, **more: bytes) -> SensorFiles:
    files = before or SensorFiles()
    contents = {name: FILES[name] for name in names} | {
        name.replace("_", "."): data for name, data in more.items()
    }
    for name, content in contents.items():
        files, _ = files.with_file(Upload(name, content))
    return files


@pytest.mark.parametrize("order", list(permutations(FILES)))
def test_the_order_in_which_they_come_does_not_matter(order):
    files = loaded(*order)
    assert files.missing(LookSettings()) == ""
    assert files.fault() == ""
    told = files.told(LookSettings())
    assert told == {
        "Image": "seen.png, 640 × 480",
        "Camera": "camera.yaml, 63° wide",
        "Laser scan": "scan.yaml, 540 beams",
    }


def test_what_is_missing_is_told_one_after_the_other():
    settings = LookSettings()
    assert "JPEG or PNG" in SensorFiles().missing(settings)
    files = loaded("seen.png")
    assert "calibration, or give its field of view" in files.missing(settings)
    assert "laser's scan" in files.missing(replace(settings, field_of_view=radians(60)))
    assert files.told(replace(settings, field_of_view=radians(60)))["Camera"] == "field of view 60°"
    files = loaded("seen.png", "camera.yaml")
    assert "laser's scan" in files.missing(settings)


def test_only_tags_of_a_known_size_need_no_scan():
    files = loaded("seen.png", "camera.yaml")
    assert "or give the tag's size" in files.missing(LookSettings("tags"))
    assert files.missing(LookSettings("tags", tag_size=0.2)) == ""


def test_ones_own_detector_has_to_be_loaded():
    files = loaded(*FILES)
    assert ".npz" in files.missing(LookSettings("own"))
    assert files.told(LookSettings("own"))["Detector"] == ""


def test_a_calibration_of_another_size_is_told_and_another_image_mends_it():
    other = picture_to_png(np.zeros((240, 320, 3), np.uint8))
    files = loaded(*FILES, small_png=other)
    assert files.fault() == (
        "small.png is 320 × 240 pixels, and camera.yaml is for 640 × 480: load the calibration of this "
        "camera at this size."
    )
    assert loaded("seen.png", before=files).fault() == ""


def test_a_damaged_file_is_refused_and_what_was_there_stays():
    files = loaded(*FILES)
    with pytest.raises(InputFileError, match=r"cut\.png"):
        loaded(before=files, cut_png=FILES["seen.png"][:3000])
    assert files.picture is not None
    assert files.picture.file.name == "seen.png"


def test_the_encounter_is_the_line_that_names_the_image():
    table, image = encounters_to_bytes(ROWS), FILES["seen.png"]
    for files in (loaded(t_csv=table, b_png=image), loaded(b_png=image, t_csv=table)):
        assert files.encounter == ROWS[1]
        assert files.told(LookSettings())["Encounters"] == "t.csv, line 3"
    files = loaded("seen.png", t_csv=table)
    assert files.encounter is None
    assert "no line names the image" in files.told(LookSettings())["Encounters"]


def test_a_map_and_what_is_known_are_told_where_they_belong(small_case):
    map_yaml = map_to_bytes(small_case.ref, "map1")["map1.yaml"]
    known = known_to_bytes(small_case.observations)
    for content, found in ((map_yaml, "a map's YAML file"), (known, "what is known")):
        with pytest.raises(InputFileError, match=f"is {found}.*; drop it beside this panel"):
            SensorFiles().with_file(Upload("some.yaml", content))


def test_a_zip_that_is_no_detector_and_a_text_are_told_in_a_sentence():
    for content in (b"PK\x03\x04rest", b"Dear diary,\n"):
        with pytest.raises(InputFileError, match=r"^notes: "):
            SensorFiles().with_file(Upload("notes", content))
