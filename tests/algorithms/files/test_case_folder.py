"""Observation, truth and case folder: round trips, and every misspelling told by name."""

from __future__ import annotations

import errno
import os
from math import pi, radians
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files.case_folder import case_folders, read_case
from algorithms.files.map_file import write_map
from algorithms.files.observation_file import (
    MOST_OBSERVATIONS,
    known_to_bytes,
    observations_from_bytes,
    read_observations,
    write_observations,
)
from algorithms.files.truth_file import Truth, read_truth, truth_to_bytes
from algorithms.maps.grid_map import FARTHEST, GridMap
from algorithms.observations.observation import (
    MOST_RANGE,
    SIGMA_BEARING,
    SIGMA_BEARINGS,
    SIGMA_RANGE,
    SIGMA_RANGES,
    Observation,
)

finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=0, exclude_min=True, allow_nan=False, allow_infinity=False)
bearings = st.floats(-6.28, 6.28)
maybe = st.one_of(st.none(), finite)
places, turns = st.floats(-FARTHEST, FARTHEST), st.floats(-2 * pi, 2 * pi)
poses = st.builds(Pose2, places, places, turns)
observations = st.builds(
    Observation,
    observer=poses,
    observed_x=places,
    observed_y=places,
    range=st.floats(0, MOST_RANGE),
    bearing=bearings,
    observed_heading=st.one_of(st.none(), turns),
    sigma_range=st.floats(*SIGMA_RANGES),
    sigma_bearing=st.floats(*SIGMA_BEARINGS),
    bearing_back=st.one_of(st.none(), bearings),
)
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=30).map(str.strip)
truths = st.builds(
    Truth,
    T_ref_mov=poses,
    tolerance_m=positive,
    tolerance_rad=positive,
    expected=st.sampled_from(["merge", "refuse"]),
    overlap=maybe,
    truth_rms=maybe,
    source=texts,
    licence=texts,
)

OBSERVATION = """\
observer: {pose: [1.0, 2.0, 3.0]}
observed: {pose: [4.0, 5.0, 6.0]}
measurement:
  range: 2.5
  bearing: -0.5
  sigma_range: 0.1
  sigma_bearing: 0.2
  bearing_back: 1.2
"""


lists = st.lists(observations, min_size=1, max_size=5)


def changed(old: str, new: str) -> bytes:
    assert old in OBSERVATION
    return OBSERVATION.replace(old, new).encode()


def as_list(*entries: bytes) -> bytes:
    """A YAML list of mappings, each given as a file of its own."""
    return b"".join(b"- " + entry.strip().replace(b"\n", b"\n  ") + b"\n" for entry in entries)


# --- observation ---


@given(several=lists)
def test_a_list_of_observations_reads_back_to_the_list_written(several):
    assert observations_from_bytes("o.yaml", known_to_bytes(several)) == tuple(several)


@given(observation=observations)
def test_an_observation_alone_is_a_mapping_and_a_list_of_it_reads_the_same(observation):
    alone = known_to_bytes([observation])
    assert alone.startswith(b"observer: ")
    assert observations_from_bytes("o.yaml", as_list(alone)) == observations_from_bytes("o.yaml", alone)


@pytest.mark.parametrize("number", [1, 2, MOST_OBSERVATIONS])
def test_observations_on_disk_read_back_the_same(tmp_path, number):
    several = tuple(Observation(Pose2(k, 2, 3), 4, 5, range=2.5, bearing=-0.5) for k in range(number))
    write_observations(tmp_path / "new" / "o.yaml", several)
    assert read_observations(tmp_path / "new" / "o.yaml") == several


@pytest.mark.parametrize("number", [0, MOST_OBSERVATIONS + 1])
def test_as_many_observations_as_no_file_may_hold_are_not_written(number):
    with pytest.raises(SettingError, match=f"1 to {MOST_OBSERVATIONS} observations, not {number}"):
        known_to_bytes([Observation(Pose2(), 4, 5, range=2.5, bearing=-0.5)] * number)


def test_every_key_of_an_observation_counts():
    (read,) = observations_from_bytes("o.yaml", OBSERVATION.encode())
    assert read == Observation(
        observer=Pose2(1, 2, 3),
        observed_x=4,
        observed_y=5,
        observed_heading=6,
        range=2.5,
        bearing=-0.5,
        sigma_range=0.1,
        sigma_bearing=0.2,
        bearing_back=1.2,
    )


def test_what_may_be_left_out_has_its_default():
    text = b"observer: {pose: [1, 2, 3]}\nobserved: {pose: [4, 5]}\n"
    (o,) = observations_from_bytes("o.yaml", text + b"measurement: {range: 1e0, bearing: 0}\n")
    assert (o.sigma_range, o.sigma_bearing) == (SIGMA_RANGE, SIGMA_BEARING)
    assert o.observed_heading is None
    assert o.bearing_back is None


BAD_OBSERVATION = {
    "empty": (b"", "is empty"),
    "not YAML": (b"observer: {pose: [1, 2", "not YAML"),
    "a number": (b"1\n", "holds no keys"),
    "an empty list": (b"[]\n", "is an empty list; give 1 to 64 observations"),
    "a list of numbers": (b"- 1\n", "observation 1 is '1', not a mapping"),
    "a list too long": (b"- 1\n" * 65, "holds 65 observations; give 1 to 64"),
    "no observer": (changed("observer: {pose: [1.0, 2.0, 3.0]}\n", ""), "observer is missing"),
    "no observed": (changed("observed: {pose: [4.0, 5.0, 6.0]}\n", ""), "observed is missing"),
    "no measurement": (OBSERVATION.split("measurement")[0].encode(), "measurement is missing"),
    "no observer pose": (changed("{pose: [1.0, 2.0, 3.0]}", "{}"), "observer.pose is missing"),
    "no range": (changed("  range: 2.5\n", ""), "measurement.range is missing"),
    "no bearing": (changed("  bearing: -0.5\n", ""), "measurement.bearing is missing"),
    "observer without yaw": (changed("[1.0, 2.0, 3.0]", "[1, 2]"), "observer.pose is [1, 2]"),
    "observed with one": (changed("[4.0, 5.0, 6.0]", "[4]"), "observed.pose is [4], not 2 or 3"),
    "observer a list": (changed("{pose: [1.0, 2.0, 3.0]}", "[1, 2, 3]"), "observer is"),
    "a word in a pose": (changed("[1.0, 2.0, 3.0]", "[1, two, 3]"), "[1, two, 3]"),
    "NaN in a pose": (changed("[1.0, 2.0, 3.0]", "[1, .nan, 3]"), "observer.pose"),
    "range negative": (changed("2.5", "-2.5"), "measurement.range is -2.5 m"),
    "range infinite": (changed("2.5", ".inf"), "measurement.range is '.inf'"),
    "range a word": (changed("2.5", "near"), "measurement.range is 'near'"),
    "range empty": (changed("2.5", ""), "measurement.range is empty"),
    "bearing in degrees": (
        changed("-0.5", "73.5"),
        "measurement.bearing is 73.5 rad, more than a whole turn",
    ),
    "bearing_back in degrees": (changed("1.2", "-90"), "measurement.bearing_back is -90 rad"),
    "sigma zero": (changed("0.1", "0"), "measurement.sigma_range is 0 m"),
    "sigma negative": (changed("0.2", "-0.2"), "measurement.sigma_bearing is -0.2 rad"),
    "bearing_back a word": (changed("1.2", "left"), "measurement.bearing_back is 'left'"),
    "sigma tiny": (changed("0.1", "1e-320"), "sigma_range is 9.99989e-321 m; it must be 1e-06 to 100 m"),
    "sigma huge": (changed("0.2", "1e300"), "sigma_bearing is 1e+300 rad; it must be 1e-06 to 3.1416 rad"),
    "range huge": (changed("2.5", "1e308"), "measurement.range is 1e+308 m; give metres; 100,000 m"),
    "observer far away": (
        changed("1.0", "-1e308"),
        "observer.pose is [-1e308, 2.0, 3.0], which is more than",
    ),
    "observed far away": (changed("5.0", "1e15"), "observed.pose is [4.0, 1e15, 6.0], which is more than"),
    "observed turned round and round": (changed("6.0", "1e300"), "turns by more than 1,000 rad"),
    "misspelt": (changed("sigma_bearing", "sigma_bearnig"), "did you mean sigma_bearing?"),
    "capitals": (changed("observer", "Observer"), "did you mean observer?"),
    "pose misspelt": (changed("observed: {pose", "observed: {poes"), "did you mean pose?"),
    "a key of its own": (OBSERVATION.encode() + b"comment: hi\n", "comment is not a known key"),
    "twice": (OBSERVATION.encode() + b"  range: 3\n", "range stands there twice"),
}


@pytest.mark.parametrize("case", BAD_OBSERVATION)
def test_a_bad_observation_is_refused_in_words(case):
    data, words = BAD_OBSERVATION[case]
    with pytest.raises(InputFileError) as caught:
        observations_from_bytes("o.yaml", data)
    message = str(caught.value)
    assert message.startswith("o.yaml: ")
    assert words in message
    assert len(message.splitlines()) == 1
    assert caught.value.remedy


# what is wrong with one entry, and not with the YAML around it
BAD_ENTRY = {
    case: data for case, (data, _) in BAD_OBSERVATION.items() if data.startswith((b"obser", b"Obser"))
}
del BAD_ENTRY["not YAML"], BAD_ENTRY["twice"]


@given(case=st.sampled_from(list(BAD_ENTRY)), before=st.integers(0, 3), after=st.integers(0, 3))
def test_what_is_wrong_in_a_list_is_told_with_the_number_of_the_entry(case, before, after):
    good = OBSERVATION.encode()
    data = as_list(*[good] * before, BAD_ENTRY[case], *[good] * after)
    with pytest.raises(InputFileError) as alone:
        observations_from_bytes("o.yaml", BAD_ENTRY[case])
    with pytest.raises(InputFileError) as caught:
        observations_from_bytes("o.yaml", data)
    assert caught.value.found == f"observation {before + 1}: {alone.value.found}"
    assert caught.value.remedy == alone.value.remedy


def test_an_entry_of_a_list_that_is_no_mapping_is_told_with_its_number():
    with pytest.raises(InputFileError, match="observation 2 is empty, not a mapping"):
        observations_from_bytes("o.yaml", as_list(OBSERVATION.encode()) + b"-\n")


def test_an_unknown_key_is_answered_with_the_known_ones():
    with pytest.raises(InputFileError, match="known are observer, observed, measurement"):
        observations_from_bytes("o.yaml", OBSERVATION.encode() + b"zzz: hi\n")


@given(data=st.binary(max_size=200))
def test_any_bytes_for_an_observation_are_refused_and_nothing_else(data):
    with pytest.raises(InputFileError):
        observations_from_bytes("o.yaml", data)


# --- truth ---


def truth_of(folder: Path, data: bytes) -> Truth:
    path = folder / "truth.yaml"
    path.write_bytes(data)
    return read_truth(path)


@given(truth=truths)
def test_a_truth_reads_back_the_same(truth, tmp_path_factory):
    assert truth_of(tmp_path_factory.getbasetemp(), truth_to_bytes(truth)) == truth


def test_a_truth_may_say_little(tmp_path):
    truth = truth_of(tmp_path, b"T_ref_mov: {x: 1, y: 2, theta: 3}\n")
    assert truth == Truth(Pose2(1, 2, 3), 0.5, radians(3), "merge")


def test_maps_that_share_no_place_have_no_transform(tmp_path):
    truth = truth_of(tmp_path, b"expected: refuse\nnoted_by: a person\n")
    assert truth.T_ref_mov is None
    assert truth.expected == "refuse"
    assert truth_of(tmp_path, truth_to_bytes(truth)) == truth


def test_a_truth_that_expects_a_merge_has_a_transform():
    with pytest.raises(SettingError, match="T_ref_mov"):
        Truth(None)


BAD_TRUTH = {
    "empty": (b"", "is empty"),
    "no transform": (b"expected: merge\n", "T_ref_mov is missing"),
    "no theta": (b"T_ref_mov: {x: 1, y: 2}\n", "T_ref_mov.theta is missing"),
    "theta misspelt": (b"T_ref_mov: {x: 1, y: 2, thet: 3}\n", "did you mean theta?"),
    "expectation unknown": (b"expected: hope\n", "expected is 'hope'"),
    "misspelt": (b"expected: refuse\ntolerence: {distance: 1}\n", "did you mean tolerance?"),
    "tolerance negative": (b"expected: refuse\ntolerance: {distance: -1}\n", "tolerance.distance"),
    "tolerance a number": (b"expected: refuse\ntolerance: 1\n", "tolerance is '1'"),
    "overlap a word": (b"expected: refuse\noverlap: much\n", "overlap is 'much'"),
}


@pytest.mark.parametrize("case", BAD_TRUTH)
def test_a_bad_truth_is_refused_in_words(tmp_path, case):
    data, words = BAD_TRUTH[case]
    with pytest.raises(InputFileError) as caught:
        truth_of(tmp_path, data)
    assert words in str(caught.value)


# --- case ---


def make_case(folder: Path, truth: bool = True) -> None:
    for i, name in enumerate(("map1.yaml", "map2.yaml")):
        write_map(folder / name, GridMap(np.full((2, 3), 100 * i, dtype=np.int8), 0.05))
    o = Observation(Pose2(1, 2, 3), 4, 5, range=2.5, bearing=-0.5)
    write_observations(folder / "observation.yaml", [o])
    if truth:
        (folder / "truth.yaml").write_bytes(truth_to_bytes(Truth(Pose2(1, 2, 3))))


def test_a_case_is_its_two_maps_the_sighting_and_the_truth(tmp_path):
    make_case(tmp_path / "home_1")
    case = read_case(tmp_path / "home_1")
    assert case.name == "home_1"
    assert case.ref.cells.tolist() == [[0] * 3] * 2
    assert case.mov.cells.tolist() == [[100] * 3] * 2
    assert [observation.range for observation in case.observations] == [2.5]
    assert case.observation_file == "observation.yaml"
    assert case.truth == Truth(Pose2(1, 2, 3))


def test_a_case_may_have_no_truth(tmp_path):
    make_case(tmp_path, truth=False)
    assert read_case(tmp_path).truth is None


def test_the_rough_observation_is_read_where_asked_for(tmp_path):
    make_case(tmp_path)
    with pytest.raises(InputFileError, match=r"observation_rough\.yaml: no such file"):
        read_case(tmp_path, rough=True)
    rough = Observation(Pose2(1, 2, 3), 4, 5, range=2.9, bearing=-0.4)
    write_observations(tmp_path / "observation_rough.yaml", [rough, rough])
    case = read_case(tmp_path, rough=True)
    assert (case.observations, case.observation_file) == ((rough, rough), "observation_rough.yaml")


def test_the_cases_under_a_folder_are_found_in_order(tmp_path):
    for name in ("b", "a", "deep/c"):
        make_case(tmp_path / name)
    (tmp_path / "empty").mkdir()
    assert case_folders(tmp_path) == [tmp_path / name for name in ("a", "b", "deep/c")]
    assert case_folders(tmp_path / "a") == [tmp_path / "a"]


def test_a_folder_without_cases_is_refused(tmp_path):
    with pytest.raises(InputFileError, match=r"map1\.yaml"):
        case_folders(tmp_path)
    with pytest.raises(InputFileError, match="not a folder"):
        case_folders(tmp_path / "none")


def test_a_folder_that_nobody_may_look_into_is_named_not_passed_over(tmp_path, monkeypatch):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "map1.yaml").touch()
    assert case_folders(tmp_path) == [tmp_path / "a", tmp_path / "b"]
    look = os.scandir

    def locked(folder):  # as a mode does for all but root
        if Path(folder).name == "b":
            raise PermissionError(errno.EACCES, "Permission denied", str(folder))
        return look(folder)

    monkeypatch.setattr(os, "scandir", locked)
    with pytest.raises(
        InputFileError, match=r"b: cannot be read \(Permission denied\); see that you may read"
    ):
        case_folders(tmp_path)
