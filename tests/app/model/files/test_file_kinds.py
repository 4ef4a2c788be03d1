"""A file is known by what it holds, whatever it is called; of what is none, a sentence says so."""

from __future__ import annotations

import io

import numpy as np
import pytest
from tagged_pictures import NEAR, sighting_files

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.camera_picture import picture_to_jpeg
from algorithms.files.encounter_table import EncounterRow, encounters_to_bytes
from algorithms.files.fleet_archive import fleet_to_files
from algorithms.files.fleet_file import FLEET_FILE
from algorithms.files.observation_file import known_to_bytes
from algorithms.files.truth_file import Truth, truth_to_bytes
from algorithms.observations.fleet import Fleet, FleetSighting
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from app.model.files.file_kinds import KINDS, kind_of_file
from app.report.result_files import zip_bytes
from app.system.data_paths import samples

SENSED = sighting_files(NEAR)
ROW = EncounterRow("seen.png", "scan.yaml", Pose2(1, 2, 0.5), 3.0, 4.0)
ROS2_CAMERA = b"header:\n  frame_id: camera\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nd: []\n"
PRIORS = [InitialPose(Pose2()), TurnPrior(0.1), NearPlace(1, 2, 3, 4)]


def npz() -> bytes:
    packed = io.BytesIO()
    np.savez(packed, weights=np.zeros(3))
    return packed.getvalue()


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (SENSED["seen.png"], "image"),
        (picture_to_jpeg(np.zeros((40, 40, 3), np.uint8)), "picture"),
        (b"P5\n40 40\n255\n", "image"),
        (SENSED["camera.yaml"], "camera"),
        (ROS2_CAMERA, "camera"),
        (b"image_width: 640\nimage_height: 480\nfield_of_view: 1.1\n", "camera"),
        (b"# oST version 5.0 parameters\n", "camera"),
        (SENSED["scan.yaml"], "scan"),
        (SENSED["scan.yaml"].decode().encode("utf-16"), "scan"),
        (b"---\nheader: {}\nangle_min: -1.5\nangle_increment: 0.01\nranges: [1, 2]\n", "scan"),
        (encounters_to_bytes([ROW]), "encounters"),
        (b"sep=;\nimage;scan;observer_x\n", "encounters"),
        (zip_bytes({"a": b"b"}), "zip"),
        (npz(), "model"),
        (b"\x80\x04pickled", "model"),
        *((known_to_bytes([prior]), "known") for prior in PRIORS),
        (known_to_bytes(PRIORS), "known"),
        (truth_to_bytes(Truth(Pose2())), "truth"),
        (b"expected: refuse\n", "truth"),
        (b"{image: m.pgm, resolution: 0.1}", "map"),
    ],
)
def test_a_file_is_what_it_holds_whatever_it_is_called(content, kind):
    assert kind_of_file("some.file", content) == kind


def test_a_fleet_with_sightings_is_no_observation(small_case):
    (seen,) = small_case.observations
    fleet = Fleet({"r1": small_case.ref, "r2": small_case.mov}, (FleetSighting("r1", "r2", seen),))
    files = fleet_to_files(fleet)
    assert kind_of_file("some.file", files[FLEET_FILE]) == "fleet"
    assert kind_of_file("some.file", known_to_bytes([seen])) == "known"


def test_every_file_of_the_samples_is_known():
    usual = {
        "map1.yaml": "map",
        "map2.pgm": "image",
        "truth.yaml": "truth",
        "observation_rough.yaml": "known",
    }
    for folder in samples().values():
        kinds = {path.name: kind_of_file(path.name, path.read_bytes()) for path in folder.iterdir()}
        assert usual.items() <= kinds.items()
        assert set(kinds.values()) <= set(KINDS)


@pytest.mark.parametrize("content", [b"", b"Dear diary,\n", b"GIF89a\x01\x00", b"\x00" * 100, b"%PDF-1.7"])
def test_what_is_none_of_them_is_told_in_a_sentence(content):
    with pytest.raises(InputFileError, match=r"^notes: is .*; give a map's YAML file or image"):
        kind_of_file("notes", content)


def test_the_maps_of_other_tools_are_told_how_to_come_by_one():
    with pytest.raises(InputFileError, match="is a state of Cartographer"):
        kind_of_file("walk.bag", b"\xdb\x01\xf5\x5b\x7b\x1f\x1d\x7b")
