"""A camera's file is ROS's: what is written reads back equal, what cannot be used is told with a remedy."""

from __future__ import annotations

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError, SettingError
from algorithms.common.pose import Pose2
from algorithms.files.camera_file import LEAST_FOCAL, camera_from_bytes, camera_to_bytes, read_camera
from algorithms.files.yaml_fields import WIDEST_ROBOT
from algorithms.sensors.camera import Camera

OST = """\
image_width: 640
image_height: 480
camera_name: head_camera
camera_matrix:
  rows: 3
  cols: 3
  data: [514.96842,   0.     , 318.45677,
           0.     , 515.41291, 243.80412,
           0.     ,   0.     ,   1.     ]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.031627, -0.081462, 0.001219, -0.000733, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1., 0., 0.,
         0., 1., 0.,
         0., 0., 1.]
projection_matrix:
  rows: 3
  cols: 4
  data: [512.42133,   0.     , 317.66321,   0.     ,
           0.     , 515.92834, 244.10339,   0.     ,
           0.     ,   0.     ,   1.     ,   0.     ]
"""
INFO = """\
header:
  stamp:
    sec: 1718029365
    nanosec: 483920013
  frame_id: camera_color_optical_frame
height: 480
width: 640
distortion_model: plumb_bob
d:
- 0.031627
- -0.081462
- 0.001219
- -0.000733
- 0.0
k:
- 514.96842
- 0.0
- 318.45677
- 0.0
- 515.41291
- 243.80412
- 0.0
- 0.0
- 1.0
r:
- 1.0
- 0.0
- 0.0
- 0.0
- 1.0
- 0.0
- 0.0
- 0.0
- 1.0
p:
- 512.42133
- 0.0
- 317.66321
- 0.0
- 0.0
- 515.92834
- 244.10339
- 0.0
- 0.0
- 0.0
- 1.0
- 0.0
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: false
---
"""
ROS_1 = """\
header:
  seq: 12
  stamp:
    secs: 1600000000
    nsecs: 120000000
  frame_id: "camera"
height: 480
width: 640
distortion_model: "plumb_bob"
D: [0.031627, -0.081462, 0.001219, -0.000733, 0.0]
K: [514.96842, 0.0, 318.45677, 0.0, 515.41291, 243.80412, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [512.42133, 0.0, 317.66321, 0.0, 0.0, 515.92834, 244.10339, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
---
header:
  seq: 13
---
"""
OPENCV = """\
%YAML:1.0
---
calibration_time: "Mon 03 Jun 2024 10:12:41"
image_width: 640
image_height: 480
board_width: 9
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 514.96842, 0., 318.45677, 0., 515.41291, 243.80412, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ 0.031627, -0.081462, 0.001219, -0.000733, 0. ]
avg_reprojection_error: 2.1e-01
"""
SAME = Camera(
    640, 480, (514.96842, 515.41291), (318.45677, 243.80412), (0.031627, -0.081462, 0.001219, -0.000733, 0)
)
MATRIX = OST[OST.index("[") : OST.index("]") + 1]

NUMBER = st.floats(-1e3, 1e3)
METRES, RADIANS = st.floats(-WIDEST_ROBOT, WIDEST_ROBOT), st.floats(-2 * pi, 2 * pi)
MOUNTINGS = st.builds(Pose2, METRES, METRES, RADIANS)


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    """Any camera that a robot may have, calibrated or not."""
    width, height = draw(st.integers(32, 4000)), draw(st.integers(32, 4000))
    mounting = draw(MOUNTINGS)
    if draw(st.booleans()):
        field_of_view = draw(st.floats(0, pi, exclude_min=True, exclude_max=True))
        return Camera.counting_pixels(width, height, field_of_view, mounting)
    count = draw(st.sampled_from([0, 4, 5, 8]))
    # with strong distortion a lens of a short focal length folds its image over, which no camera has
    lengths = st.floats((20 if count else LEAST_FOCAL) * width, 2e5)
    return Camera(
        width,
        height,
        (draw(lengths), draw(lengths)),
        (draw(st.floats(0, width)), draw(st.floats(0, height))),
        tuple(draw(st.lists(st.floats(-1, 1), min_size=count, max_size=count))),
        mounting=mounting,
    )


@given(cameras())
def test_a_camera_that_was_written_reads_back_equal(camera):
    assert camera_from_bytes("c.yaml", camera_to_bytes(camera)) == camera


@pytest.mark.parametrize("text", [OST, INFO, ROS_1, OPENCV, OST.replace(":", ":\t").replace("\n", "\r\n")])
def test_every_form_that_ros_and_opencv_give_one_calibration_is_read_alike(text):
    assert camera_from_bytes("ost.yaml", text.encode()) == SAME


@pytest.mark.parametrize(
    "rows", [MATRIX, "[[514.96842, 0, 318.45677], [0, 515.41291, 243.80412], [0, 0, 1]]"]
)
def test_a_matrix_may_stand_there_without_its_sides(rows):
    start, end = OST.index("camera_matrix"), OST.index("distortion_model")
    assert (
        camera_from_bytes("c.yaml", (OST[:start] + f"camera_matrix: {rows}\n" + OST[end:]).encode()) == SAME
    )


@given(MOUNTINGS)
def test_where_the_camera_is_on_its_robot_is_ours_to_add(mounting):
    x, y, yaw = mounting.array().tolist()
    text = f"{OST}mounting: {{x: {x!r}, y: {y!r}, yaw: {yaw!r}}}\n"
    assert camera_from_bytes("c.yaml", text.encode()).mounting == mounting


def test_what_a_mounting_leaves_out_is_0():
    assert camera_from_bytes("c.yaml", f"{OST}mounting: {{yaw: 1.5}}".encode()).mounting == Pose2(0, 0, 1.5)


def test_a_camera_without_calibration_has_a_field_of_view():
    camera = camera_from_bytes("c.yaml", b"image_width: 320\nimage_height: 240\nfield_of_view: 1.2\n")
    assert camera == Camera.counting_pixels(320, 240, 1.2, Pose2())
    zero = INFO.replace("514.96842", "0.0").replace("318.45677", "0.0").replace("243.80412", "0.0")
    zero = zero.replace("515.41291", "0.0").replace("- 1.0", "- 0.0").replace("plumb_bob", "''")
    assert not camera_from_bytes("c.yaml", f"field_of_view: 1.2\n{zero}".encode()).calibrated
    with pytest.raises(InputFileError, match=r"k is all 0: the camera is not calibrated; calibrate it"):
        camera_from_bytes("c.yaml", zero.encode())


def test_a_field_of_view_beside_a_calibration_is_passed_over():
    assert camera_from_bytes("c.yaml", f"field_of_view: 1.2\n{OST}".encode()) == SAME


@pytest.mark.parametrize("model", ["none", "''", "plumb_bob", "rational_polynomial"])
@pytest.mark.parametrize("zeros", ["[]", "[0, 0, 0, 0, 0, 0]"])
def test_coefficients_that_are_all_0_and_belong_to_no_model_are_none(model, zeros):
    text = ROS_1.replace('"plumb_bob"', model).replace(
        "[0.031627, -0.081462, 0.001219, -0.000733, 0.0]", zeros
    )
    assert camera_from_bytes("c.yaml", text.encode()).distortion == ()


def test_eight_coefficients_are_a_rational_polynomial_where_no_model_is_named():
    text = ROS_1.replace('distortion_model: "plumb_bob"\n', "").replace(
        "-0.000733, 0.0]", "0, 0.1, 0.01, 0.02, 0.03]"
    )
    assert camera_from_bytes("c.yaml", text.encode()).distortion == (
        0.031627,
        -0.081462,
        0.001219,
        0,
        0.1,
        0.01,
        0.02,
        0.03,
    )


def changed(old: str, new: str) -> str:
    assert old in OST
    return OST.replace(old, new)


# name -> the file, and what is said of it
BAD = {
    "empty": ("", "is empty; give a camera's YAML file"),
    "a list": ("- 1\n", "holds no keys"),
    "not YAML": (OST.replace("]", "", 1), "is not YAML"),
    "two matrices": (OST + "camera_matrix: 1\n", "the key camera_matrix stands there twice"),
    "the other file of the calibration": (
        "# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n640\n",
        "is the text that camera_calibration saves; give ost.yaml beside it",
    ),
    "a bag": ("#ROSBAG V2.0\n", "is a recording of ROS 1 (a bag); give ost.yaml of camera_calibration, or"),
    "no width": (changed("image_width: 640\n", ""), "image_width is missing; give ost.yaml"),
    "a fraction of a pixel": (changed("640", "640.5"), "image_width is 640.5 pixels; give the size"),
    "a negative height": (changed("480", "-480"), "image_height is -480 pixels; give the size"),
    "a width beyond sense": (changed("640", "1e300"), "image_width is 1e+300 pixels"),
    "a width that is a word": (changed("640", "wide"), "image_width is 'wide', not a finite number"),
    "a tiny image": (changed("640", "16"), "the camera's image is 16 × 480 pixels; give an image"),
    "a huge image": (changed("640", "40000"), "the camera's image is 40000 × 480 pixels; give an image"),
    "no matrix": (
        OST.replace("camera_matrix", "cam_mat"),
        "or, where there is no calibration, field_of_view: rad",
    ),
    "8 numbers": (
        changed(MATRIX, "[1, 0, 3, 0, 5, 6, 0, 0]").replace("rows: 3\n  cols: 3\n", "", 1),
        "camera_matrix holds 8 numbers, not 3 × 3; give f_x, 0, c_x",
    ),
    "sides that do not fit": (
        changed("rows: 3", "rows: 2"),
        "camera_matrix.data holds 9 numbers, and rows and cols are 2 and 3",
    ),
    "a word in the matrix": (changed("515.41291", "fy"), "camera_matrix.data has 'fy' as number 5, which"),
    "no data": (changed("  data: [514.", "  dota: [514."), "camera_matrix.data is missing"),
    "a matrix that is a word": (
        ROS_1.replace("K: [514.96842, 0.0, 318.45677, 0.0, 515.41291, 243.80412, 0.0, 0.0, 1.0]", "K: none"),
        "K is 'none', not a list of numbers",
    ),
    "a focal length of 0": (changed("514.96842", "0"), "the focal length f_x in camera_matrix is 0 pixels"),
    "a negative focal length": (
        changed("515.41291", "-515"),
        "the focal length f_y in camera_matrix is -515 pixels; it must be positive",
    ),
    "a focal length that is none": (changed("514.96842", ".nan"), "has '.nan' as number 1, which is no"),
    "an infinite focal length": (changed("514.96842", "inf"), "has 'inf' as number 1, which is no finite"),
    "millimetres": (
        changed("514.96842", "3.6"),
        "is 3.6 pixels, which would be a field of view of 179°; give pixels, not millimetres",
    ),
    "skew": (changed("514.96842,   0. ", "514.96842,   7.5"), "has 7.5 and 0 where no skew is 0"),
    "columns for rows": (
        changed(MATRIX, "[514.9, 0, 0, 0, 515.4, 0, 318, 243, 1]"),
        "the bottom row of camera_matrix is [318, 243, 1], not [0, 0, 1]; give f_x, 0, c_x",
    ),
    "a centre far outside": (changed("318.45677", "3184.5"), "far outside of it"),
    "a fisheye": (
        changed("plumb_bob", "equidistant"),
        "distortion_model is 'equidistant', a fisheye's, which is not read; rectify the images",
    ),
    "another fisheye": (changed("plumb_bob", "fisheye"), "calibrate it as plumb_bob"),
    "a model nobody knows": (changed("plumb_bob", "wobbly"), "is 'wobbly'; give plumb_bob or rational"),
    "a model that is a list": (changed("plumb_bob", "[1]"), "distortion_model is [1]; give plumb_bob"),
    "coefficients of another model": (
        changed("plumb_bob", "rational_polynomial"),
        "distortion_coefficients holds 5 numbers, and distortion_model is rational_polynomial; a",
    ),
    "coefficients without a model": (changed("plumb_bob", "none"), "5 numbers, and distortion_model is none"),
    "a coefficient too many": (
        changed("cols: 5\n  data: [", "cols: 6\n  data: [1, "),
        "distortion_coefficients holds 6 numbers",
    ),
    "a misspelt mounting": (OST + "mountig: {x: 1}\n", "mountig is not a known key; did you mean mounting?"),
    "a mounting in three dimensions": (OST + "mounting: {x: 1, z: 1}\n", "mounting.z is not a known key"),
    "a mounting that is a list": (OST + "mounting: [1, 2, 3]\n", "mounting is [1, 2, 3], not a mapping"),
    "a mounting in degrees": (
        OST + "mounting: {yaw: 90}\n",
        "mounting.yaw is 90 rad, more than a whole turn; it looks like degrees: give radians, 1.571",
    ),
    "a mounting in millimetres": (OST + "mounting: {x: 250}\n", "x is 250 m, which is beside any robot"),
    "a mounting without numbers": (OST + "mounting: {x: .inf}\n", "mounting.x is '.inf', not a finite"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_refused_in_words(case):
    text, said = BAD[case]
    with pytest.raises(InputFileError) as told:
        camera_from_bytes("c.yaml", text.encode())
    message = str(told.value)
    assert message.startswith("c.yaml: ")
    assert said in message
    assert "\n" not in message
    assert told.value.remedy


@pytest.mark.parametrize(
    ("angle", "said"),
    [
        ("62", "is 62 rad; it looks like degrees: give radians, 1.082"),
        ("0", "is 0 rad; give radians, between 0 and π"),
        ("-1", "is -1 rad; give radians, between"),
        ("360", "is 360 rad; give radians, between"),
        (".nan", "is '.nan', not a finite number"),
    ],
)
def test_a_field_of_view_that_is_none_is_told(angle, said):
    with pytest.raises(InputFileError) as told:
        camera_from_bytes("c.yaml", f"width: 320\nheight: 240\nfield_of_view: {angle}\n".encode())
    assert said in str(told.value)


def test_a_camera_that_no_file_can_say_is_not_written():
    for camera in (
        Camera(640, 480, None, (1.0, 2.0), (), 1.2),
        Camera(640, 480, (500.0, 500.0), (320.0, 240.0), (), 1.2),
    ):
        with pytest.raises(SettingError, match="or a field of view about the middle of the image; give one"):
            camera_to_bytes(camera)


def test_a_file_is_read_from_disk_and_a_missing_one_and_a_folder_are_named(tmp_path):
    (tmp_path / "ost.yaml").write_text(OST)
    assert read_camera(tmp_path / "ost.yaml") == SAME
    with pytest.raises(InputFileError, match=r"no\.yaml: no such file; give the YAML file of a camera"):
        read_camera(tmp_path / "no.yaml")
    with pytest.raises(InputFileError, match="is a folder"):
        read_camera(tmp_path)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information:\n")
    with pytest.raises(InputFileError, match=r"\(a rosbag2 folder\); give ost.yaml of camera_calibration"):
        read_camera(tmp_path)
