"""A scan's file is what ROS prints: written, it reads back equal; it is read fast, whatever stands in it."""

from __future__ import annotations

import time
from math import inf, isnan, nan, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from readers import SLOWER

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.scan_file import MOST_BYTES, read_scan, scan_from_bytes, scan_to_bytes
from algorithms.files.yaml_fields import WIDEST_ROBOT
from algorithms.sensors.laser_scan import MOST_BEAMS, LaserScan

# What ros2 topic echo --once --full-length /scan prints of a small scanner, a TurtleBot's with 36 beams.
HEAD = """\
header:
  stamp:
    sec: 1718029365
    nanosec: 483920013
  frame_id: base_scan
angle_min: 0.0
angle_max: 6.28318977355957
angle_increment: 0.17951971292495728
time_increment: 0.0
scan_time: 0.20000000298023224
range_min: 0.11999999731779099
range_max: 3.5
"""
RANGES = [
    *(1.2253750562667847, 1.2446939945220947, 1.2785520553588867, inf, inf, 2.9070451259613037),
    *(2.826, 2.775, 2.7520132064819336, 2.757, 2.791, 2.856, inf, 0.0, 0.0, inf, inf, nan, 0.614, 0.5871),
    *(0.5803, 0.59, 0.6186, inf, 3.4998, 3.5, 4.5, inf, 1.9, 1.83, 1.7839, 1.75, 1.21, 1.209, 1.213, 1.2182),
]


def spelt(value: float) -> str:
    return ".nan" if isnan(value) else ".inf" if value == inf else repr(value)


ECHO = (
    HEAD
    + "ranges:\n"
    + "".join(f"- {spelt(value)}\n" for value in RANGES)
    + "intensities:\n"
    + "".join(f"- {4.0 * k}\n" for k in range(36))
    + "---\n"
)
ECHO_OF_ROS_1 = (
    HEAD.replace("    sec", "    secs").replace("    nanosec", "    nsecs")
    + f"ranges: [{', '.join(repr(value) for value in RANGES)}]\n"
    + f"intensities: [{', '.join(['0.0'] * 36)}]\n---\n"
)

METRES, RADIANS = st.floats(-WIDEST_ROBOT, WIDEST_ROBOT), st.floats(-2 * pi, 2 * pi)


@st.composite
def scans(draw: st.DrawFn) -> LaserScan:
    """Any scan of a scanner, its beams in either order, with anything among the ranges."""
    n = draw(st.integers(8, 60))
    step = draw(st.floats(1e-6, 2 * pi / (n - 1))) * draw(st.sampled_from([1, -1]))
    value = st.one_of(st.floats(0, 500), st.sampled_from([inf, nan, -inf, 0.0, -1.0]))
    ranges = np.array(draw(st.lists(value, min_size=n, max_size=n)))
    nearest = draw(st.floats(0, 1))
    farthest = draw(st.one_of(st.just(inf), st.floats(2, 500)))
    mounting = Pose2(draw(METRES), draw(METRES), draw(RADIANS))
    return LaserScan(draw(RADIANS), step, ranges, nearest, farthest, mounting)


def assert_equal(scan: LaserScan, other: LaserScan) -> None:
    np.testing.assert_array_equal(scan.ranges, other.ranges)
    for name in ("angle_min", "angle_increment", "range_min", "range_max", "mounting"):
        assert getattr(scan, name) == getattr(other, name)


@given(scans())
def test_a_scan_that_was_written_reads_back_equal(scan):
    assert_equal(scan_from_bytes("s.yaml", scan_to_bytes(scan)), scan)


@given(scans(), st.sampled_from([", ", ",", ",\n  "]), st.sampled_from(["", ","]))
def test_a_list_in_brackets_says_the_same_as_one_in_lines(scan, between, last):
    head, lines = scan_to_bytes(scan).decode().split("ranges:\n")
    items = lines.replace("- ", "", 1).rstrip().split("\n- ")
    text = f"{head}ranges: [{between.join(items)}{last}]\n"
    assert_equal(scan_from_bytes("s.yaml", text.encode()), scan)


AS_IT_COMES = {
    "ROS 2": ECHO.encode(),
    "ROS 1": ECHO_OF_ROS_1.encode(),
    "the other end of lines": ECHO.replace("\n", "\r\n").encode(),
    "a recording": (ECHO * 3).encode(),
    "a recording that ends in the middle": (ECHO * 2).encode()[:-700],
    "a document that begins": ("%YAML 1.2\n---\n" + ECHO).encode(),
    "several beginnings": ("---\n\n---\n# a scan\n---\n" + ECHO).encode(),
    "Windows' shell": ECHO.encode("utf-16"),
    "a mark at the start": ECHO.encode("utf-8-sig"),
    "indented lists": ECHO.replace("\n- ", "\n  - ").encode(),
    "comments": ECHO.replace("ranges:\n", "ranges:  # metres\n")
    .replace("2.826\n", "2.826  # a chair\n")
    .encode(),
    "quotes": ECHO_OF_ROS_1.replace("inf", '"inf"').replace("nan", "'NaN'").encode(),
    "capitals": ECHO_OF_ROS_1.replace("inf", "Infinity").replace("nan", "NaN").encode(),
    "YAML's capitals": ECHO.replace(".inf", "+.INF").replace(".nan", ".NaN").encode(),
    "nulls": ECHO.replace(".nan", "null").encode(),
    "a list that comes last": (HEAD + ECHO[len(HEAD) :].split("intensities")[0].rstrip("\n")).encode(),
    "other keys": (f"topic: /scan\n{ECHO}").encode(),
}


@pytest.mark.parametrize("form", AS_IT_COMES)
def test_a_scan_is_read_as_it_is_printed(form):
    scan = scan_from_bytes("scan.yaml", AS_IT_COMES[form])
    np.testing.assert_array_equal(scan.ranges, RANGES)
    assert scan.angle_increment == 0.17951971292495728
    assert (scan.range_min, scan.range_max) == (0.11999999731779099, 3.5)
    assert scan.mounting == Pose2()


def test_what_drivers_write_for_nothing_is_not_valid():
    valid = scan_from_bytes("scan.yaml", ECHO.encode()).valid
    nothing = [k for k, value in enumerate(RANGES) if not 0.12 < value < 3.5]
    assert len(nothing) == 12
    assert np.flatnonzero(~valid).tolist() == nothing


def test_where_the_scanner_is_on_its_robot_is_ours_to_add():
    for text in (
        f"mounting: {{x: 0.1, y: -0.2, yaw: 3.1}}\n{ECHO}",
        f"{ECHO[:-4]}mounting: {{x: 0.1, y: -0.2, yaw: 3.1}}",
    ):
        assert scan_from_bytes("scan.yaml", text.encode()).mounting == Pose2(0.1, -0.2, 3.1)


def test_limits_may_be_left_out_and_the_last_angle_too():
    text = "\n".join(line for line in ECHO.split("\n") if not line.startswith(("range_", "angle_max")))
    scan = scan_from_bytes("scan.yaml", text.encode())
    assert (scan.range_min, scan.range_max) == (0, inf)


@pytest.mark.parametrize("beams", [10_000, MOST_BEAMS])
def test_a_large_scan_is_read_in_less_than_a_second(beams):
    scan = LaserScan(-pi, 2 * pi / beams, np.random.default_rng(1).uniform(0.1, 30, beams), 0.05, 40.0)
    data = scan_to_bytes(scan) + b"intensities:\n" + b"- 1234.5\n" * beams + b"---\n"
    began = time.thread_time()
    read = scan_from_bytes("scan.yaml", data)
    assert time.thread_time() - began < SLOWER
    assert_equal(read, scan)


def changed(old: str, new: str, text: str = ECHO) -> bytes:
    assert old in text
    return text.replace(old, new).encode()


def with_ranges(ranges: str) -> bytes:
    return f"{HEAD}ranges: {ranges}\n".encode()


SHORT = "\n".join(["ranges:", *["- 1.5"] * 36])
# name -> the file, and what is said of it
BAD = {
    "empty": (b"", "is empty; give a laser scan's YAML file"),
    "only ends": (b"---\n---\n", "is empty"),
    "a list": (b"- 1\n", "holds no keys"),
    "binary": (bytes(range(256)), "is not YAML"),
    "a bag": (
        b"#ROSBAG V2.0\n",
        "is a recording of ROS 1 (a bag); give one LaserScan message, as ros2 topic",
    ),
    "no angle": (
        changed("angle_min: 0.0\n", ""),
        "angle_min is missing; give one LaserScan message, as ros2",
    ),
    "no ranges": (HEAD.encode(), "ranges is missing; give one LaserScan message"),
    "an empty list": (with_ranges("[]"), "ranges holds 0 numbers; a scan has 8 to 100,000 beams"),
    "one beam": (with_ranges("\n- 1.5"), "ranges holds 1 number; a scan has 8"),
    "too many beams": (
        with_ranges("[" + "1," * 100_001 + "]"),
        "ranges holds 100,001 numbers; 100,000 beams",
    ),
    "a text for ranges": (
        with_ranges("'<sequence type: float, length: 360>'"),
        "ranges is '<sequence type: float, length: 360>', not a list of numbers; give one LaserScan",
    ),
    "text among the numbers": (
        changed("- 2.826\n", "- wall\n"),
        "ranges has 'wall' as number 7, which is no number",
    ),
    "a list among the numbers": (
        changed("- 2.826\n", "- [1]\n"),
        "ranges has '[1]' as number 7, which is no",
    ),
    "a mapping among the numbers": (
        changed("- 2.826\n", "- echoes: [1, 2]\n"),
        "as number 7, which is no number",
    ),
    "a line under the numbers": (
        with_ranges("\n- 1_000" + "\n- 1" * 20),
        "ranges has '1_000' as number 1, which",
    ),
    "what ros2 leaves out": (
        with_ranges("\n" + "- 1.5\n" * 128 + "- '...'"),
        "ranges is cut off after 128 numbers; print it with ros2 topic echo --once --full-length /scan",
    ),
    "ranges twice": (f"{HEAD}{SHORT}\n{SHORT}\n".encode(), "the key ranges stands there twice"),
    "ranges in two ways": (
        f"{HEAD}{SHORT}\nranges: 7\n".encode(),
        "the key ranges stands there twice, line 50",
    ),
    "degrees": (
        changed("angle_min: 0.0", "angle_min: -180"),
        "angle_min is -180 rad, more than a whole turn; it looks like degrees: give radians, -3.142",
    ),
    "a last angle in degrees": (
        changed("6.28318977355957", "360"),
        "angle_max is 360 rad, more than a whole turn",
    ),
    "steps of many degrees": (
        changed("0.17951971292495728", "10"),
        "angle_increment is 10 rad, more than a whole",
    ),
    "steps in degrees": (
        changed("0.17951971292495728", "0.5"),
        "angle_increment is 0.5 rad, with which 36 beams span more than a whole turn; give radians from",
    ),
    "no step": (changed("0.17951971292495728", "0"), "angle_increment is 0; give radians"),
    "a step that is none": (
        changed("0.17951971292495728", ".nan"),
        "angle_increment is '.nan', not a finite",
    ),
    "another last angle": (
        changed("6.28318977355957", "5.9"),
        "angle_max is 5.9 rad, but 36 beams from 0 rad on, 0.1795 rad apart, end at 6.2832 rad",
    ),
    "beams in the other order": (changed("0.179519", "-0.179519"), "end at -6.2832 rad"),
    "limits the wrong way round": (
        changed("3.5\nranges", "0.1\nranges"),
        "range_min is 0.12 m and range_max 0.1 m",
    ),
    "a negative limit": (
        changed("0.11999999731779099", "-1"),
        "range_min is -1 m and range_max 3.5 m; give what",
    ),
    "a limit that is none": (changed("3.5\nranges", ".nan\nranges"), "range_max is '.nan', not a number"),
    "a limit that is a list": (changed("3.5\nranges", "[3]\nranges"), "range_max is [3], not a number"),
    "millimetres": (
        b"angle_min: 0\nangle_increment: 0.1\nranges: [" + b"2310.0, " * 40 + b"]",
        "ranges are 2310 m in the middle, further than a scanner sees; they look like millimetres",
    ),
    "a misspelt mounting": (
        f"mouning: {{x: 1}}\n{ECHO}".encode(),
        "mouning is not a known key; did you mean mounting",
    ),
    "a mounting in degrees": (
        f"mounting: {{yaw: 90}}\n{ECHO}".encode(),
        "it looks like degrees: give radians, 1.57",
    ),
    "much beside": (f"note: {'x' * 9000}\n{ECHO}".encode(), "holds more than 8,192 bytes beside its ranges"),
    "much of nothing": (b"\n" * MOST_BYTES, "bytes beside its ranges; give one LaserScan message"),
    "a message of 7 MB": (b"a: " + b"x" * 7_000_000, "has a message of more than 6 MB"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_refused_in_words(case):
    data, said = BAD[case]
    with pytest.raises(InputFileError) as told:
        scan_from_bytes("s.yaml", data)
    message = str(told.value)
    assert message.startswith("s.yaml: ")
    assert said in message
    assert "\n" not in message
    assert len(message) < 400
    assert told.value.remedy


@pytest.mark.parametrize("form", [ECHO, ECHO_OF_ROS_1, ECHO_OF_ROS_1.replace(", ", ",\n")])
def test_a_line_that_is_no_yaml_is_told_by_its_number_in_the_file(form):
    text = form.replace("---\n", "") + "mounting: {x: 1\ny: : 2}\n"
    line = text.split("\n").index("y: : 2}") + 1
    with pytest.raises(InputFileError, match=rf"is not YAML \(.*, line {line}\)"):
        scan_from_bytes("s.yaml", text.encode())


def test_of_a_long_recording_the_first_message_is_read_from_disk(tmp_path):
    path = tmp_path / "scan.yaml"
    path.write_text(ECHO * (MOST_BYTES // len(ECHO) + 2))
    np.testing.assert_array_equal(read_scan(path).ranges, RANGES)
    with pytest.raises(InputFileError, match=r"no\.yaml: no such file; give the YAML file of a laser scan"):
        read_scan(tmp_path / "no.yaml")
    with pytest.raises(InputFileError, match="is a folder"):
        read_scan(tmp_path)
