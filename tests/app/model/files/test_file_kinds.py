"""A file of a sighting is known by what it holds; one that is none is told where it belongs."""

from __future__ import annotations

import numpy as np
import pytest
from tagged_pictures import NEAR, sighting_files

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.camera_picture import picture_to_jpeg
from algorithms.files.encounter_table import EncounterRow, encounters_to_bytes
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from app.model.sighting.file_kinds import kind_of_file

FILES = sighting_files(NEAR)
ROW = EncounterRow("seen.png", "scan.yaml", Pose2(1, 2, 0.5), 3.0, 4.0)
ROS2_CAMERA = b"header:\n  frame_id: camera\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nd: []\n"


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (FILES["seen.png"], "picture"),
        (picture_to_jpeg(np.zeros((40, 40, 3), np.uint8)), "picture"),
        (b"P5\n40 40\n255\n", "picture"),
        (FILES["camera.yaml"], "camera"),
        (ROS2_CAMERA, "camera"),
        (b"image_width: 640\nimage_height: 480\nfield_of_view: 1.1\n", "camera"),
        (b"# oST version 5.0 parameters\n", "camera"),
        (FILES["scan.yaml"], "scan"),
        (FILES["scan.yaml"].decode().encode("utf-16"), "scan"),
        (b"---\nheader: {}\nangle_min: -1.5\nangle_increment: 0.01\nranges: [1, 2]\n", "scan"),
        (encounters_to_bytes([ROW]), "encounters"),
        (b"sep=;\nimage;scan;observer_x\n", "encounters"),
        (b"PK\x03\x04rest", "model"),
        (b"\x80\x04pickled", "model"),
    ],
)
def test_a_file_is_what_it_holds_whatever_it_is_called(content, kind):
    assert kind_of_file("some.file", content) == kind


def test_a_map_and_an_observation_are_told_where_they_belong(small_case):
    map_yaml = map_to_bytes(small_case.ref, "map1")["map1.yaml"]
    with pytest.raises(InputFileError, match="is a map's YAML file; load it under Maps"):
        kind_of_file("map1.yaml", map_yaml)
    with pytest.raises(InputFileError, match="load it under Maps, Upload your own, What is known"):
        kind_of_file("observation.yaml", known_to_bytes(small_case.observations))
    with pytest.raises(InputFileError, match="fleet"):
        kind_of_file("fleet.yaml", b"robots:\n  r1: {map: r1.yaml}\n")


@pytest.mark.parametrize("content", [b"", b"Dear diary,\n", b"GIF89a\x01\x00", b"\x00" * 100, b"%PDF-1.7"])
def test_what_is_none_of_them_is_told_in_a_sentence(content):
    with pytest.raises(InputFileError, match=r"^notes: is .*; give a JPEG or PNG, the camera's camera.yaml"):
        kind_of_file("notes", content)
