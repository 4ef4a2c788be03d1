"""The file of a camera: a calibration as ROS's camera_calibration saves it, or a CameraInfo message."""

from __future__ import annotations

from dataclasses import replace
from math import atan, degrees, pi, radians
from pathlib import Path
from typing import Any

from algorithms.common.errors import InputFileError, SettingError
from algorithms.files import yaml_fields as fields
from algorithms.files.map_file import read_bytes
from algorithms.files.yaml_fields import Fields, as_number, mounting, mounting_text, number_text, shown
from algorithms.sensors.camera import Camera, check_image_size

CAMERA_FILE = "camera.yaml"
WHAT = "a camera's YAML file"
FORMS = "give ost.yaml of camera_calibration, or what ros2 topic echo --once prints of a camera_info topic"
PIXELS = "give the size of the camera's images in whole pixels"
NINE = "give f_x, 0, c_x, 0, f_y, c_y, 0, 0, 1, row by row"
ONLY_FIELD = "or, where there is no calibration, field_of_view: rad, the horizontal one"
NO_SKEW = 0.001  # times the focal length: what is less moves a bearing by less than a pixel
LEAST_FOCAL = 1 / 50  # times the width: a field of view of 175°
OST_TXT = b"# oST version"  # of the other file that camera_calibration saves
# How many coefficients each model of a lens has; 0: nothing is distorted.
PLUMB_BOB, RATIONAL, NO_MODEL = "plumb_bob", "rational_polynomial", "none"
COUNTS = {PLUMB_BOB: (0, 4, 5), RATIONAL: (0, 8), NO_MODEL: (0,)}
FISHEYES = ("fisheye", "equidistant", "kannala", "omni", "mei", "double_sphere", "eucm", "fov", "scaramuzza")


def read_camera(path: Path | str) -> Camera:
    """Read a camera's file; raises InputFileError."""
    path = Path(path)
    return camera_from_bytes(str(path), read_bytes(path, "a camera", instead=FORMS))


def camera_from_bytes(name: str, data: bytes) -> Camera:
    """A camera from the content of its file.

    Keys of ours, beside ROS's: ``mounting: {x: m, y: m, yaw: rad}``, T_robot_camera, x along the camera's
    axis; and ``field_of_view``, horizontal, radians, which is used where there is no calibration. Others'
    keys are passed over, and so are the matrices of a rectified image: it is the raw image that counts.

    name   : of the file, as the user knows it
    raises : InputFileError
    """
    if data[:100].lstrip().startswith(OST_TXT):
        raise InputFileError(name, "is the text that camera_calibration saves", "give ost.yaml beside it")
    f = fields.parse(name, data, WHAT, first_only=True, instead=FORMS)
    ours = {key: value for key, value in f.values.items() if key not in ROS_KEYS}
    Fields(name, ours).refuse_unknown("mounting", "field_of_view", near_only=True)
    width, height = (_pixels(f, _found(f, f"image_{side}", side)) for side in ("width", "height"))
    on_robot = mounting(f)
    try:
        check_image_size(width, height, "the camera's image")
        matrix = _matrix(f)
        if matrix is None:
            return Camera.counting_pixels(width, height, _field_of_view(f), on_robot)
        (f_x, _, c_x, _, f_y, c_y, *_), distortion = matrix, _distortion(f)
        for focal in (f_x, f_y):
            if 0 < focal < LEAST_FOCAL * width:
                seen = degrees(2 * atan(width / focal / 2))
                found = f"is {focal:g} pixels, which would be a field of view of {seen:.0f}°"
                raise InputFileError(name, f"the focal length {found}", "give pixels, not millimetres")
        return Camera(width, height, (f_x, f_y), (c_x, c_y), distortion, mounting=on_robot)
    except SettingError as error:
        found, _, remedy = str(error).partition("; ")
        raise InputFileError(name, found, remedy or NINE) from error


ROS_KEYS = frozenset(
    ("image_width", "image_height", "camera_name", "camera_matrix", "distortion_model")
    + ("distortion_coefficients", "rectification_matrix", "projection_matrix", "header", "width", "height")
    + ("d", "k", "r", "p", "D", "K", "R", "P", "binning_x", "binning_y", "roi")
)


def _found(f: Fields, *keys: str) -> str:
    """Under which of its names a thing is there; the first where it is not."""
    return next((key for key in keys if key in f.values), keys[0])


def _pixels(f: Fields, key: str) -> int:
    value = f.number(key, FORMS if key not in f.values else PIXELS)
    if not value.is_integer() or not 0 < value < 1e6:
        raise f.error(key, f"is {value:g} pixels", PIXELS)
    return int(value)


def _field_of_view(f: Fields) -> float:
    """Radians."""
    angle = f.number("field_of_view", "give radians")
    if not 0 < angle < pi:
        remedy = "give radians, between 0 and π"
        if pi <= angle < 180:
            remedy = f"it looks like degrees: give radians, {radians(angle):.4g}"
        raise f.error("field_of_view", f"is {angle:g} rad", remedy)
    return angle


def _matrix(f: Fields) -> list[float] | None:
    """The nine numbers of K, row by row; None where there is no calibration, but a field of view."""
    key = _found(f, "camera_matrix", "k", "K")
    if key not in f.values:
        if "field_of_view" in f.values:
            return None
        raise f.error(key, "is missing", f"{FORMS}; {ONLY_FIELD}")
    matrix = _numbers(f, key, NINE)
    name = f.prefix + key
    if len(matrix) != 9:
        raise InputFileError(f.source, f"{name} holds {len(matrix)} numbers, not 3 × 3", NINE)
    if not any(matrix):  # so a message says that there is no calibration
        if "field_of_view" in f.values:
            return None
        found = f"{name} is all 0: the camera is not calibrated"
        raise InputFileError(f.source, found, f"calibrate it with camera_calibration; {ONLY_FIELD}")
    f_x, skew, _, below, f_y, _, *bottom = matrix
    if bottom != [0.0, 0.0, 1.0]:
        found = f"the bottom row of {name} is {_listed(bottom)}, not [0, 0, 1]"
        raise InputFileError(f.source, found, NINE)
    if below != 0.0 or abs(skew) > NO_SKEW * abs(f_x):
        found = f"{name} has {skew:g} and {below:g} where no skew is 0"
        raise InputFileError(f.source, found, f"calibrate without skew; {NINE}")
    for axis, focal in (("x", f_x), ("y", f_y)):
        if focal <= 0:
            found = f"the focal length f_{axis} in {name} is {focal:g} pixels"
            raise InputFileError(f.source, found, f"it must be positive; {NINE}")
    return matrix


def _distortion(f: Fields) -> tuple[float, ...]:
    """The coefficients of the lens, in the order of OpenCV; none where nothing is distorted."""
    key = _found(f, "distortion_coefficients", "d", "D")
    remedy = "give k_1, k_2, p_1, p_2, k_3, as camera_calibration finds them"
    coefficients = _numbers(f, key, remedy) if key in f.values else []
    model = f.values.get("distortion_model", PLUMB_BOB if len(coefficients) < 8 else RATIONAL)
    word = model.strip().lower() if isinstance(model, str) else None
    if word and word.startswith(FISHEYES):
        remedy = f"rectify the images and give the camera of those, or calibrate it as {PLUMB_BOB}"
        raise f.error("distortion_model", f"is {shown(model)}, a fisheye's, which is not read", remedy)
    counts = COUNTS.get(NO_MODEL if word == "" else word or "?")
    if counts is None:
        remedy = f"give {PLUMB_BOB} or {RATIONAL}, and the coefficients that belong to it"
        raise f.error("distortion_model", f"is {shown(model)}", remedy)
    if len(coefficients) not in counts:
        if not any(coefficients):
            return ()
        found = f"holds {len(coefficients)} numbers, and distortion_model is {word or 'empty'}"
        raise f.error(key, found, f"a {PLUMB_BOB} has 4 or 5, a {RATIONAL} 8")
    return tuple(coefficients)


def _numbers(f: Fields, key: str, remedy: str) -> list[float]:
    """The finite numbers of a matrix: {rows, cols, data}, a list, or a list of rows."""
    value: Any = f.values[key]
    sides: list[float] = []
    if isinstance(value, dict):
        part = f.section(key, remedy)
        value = part.get("data", remedy)
        sides = [
            part.number(side, "give a number of them") for side in ("rows", "cols") if side in part.values
        ]
        f, key = part, "data"
    if not isinstance(value, list):
        raise f.error(key, f"is {shown(value)}, not a list of numbers", remedy)
    if value and all(isinstance(row, list) for row in value):
        value = [number for row in value for number in row]
    numbers = []
    for position, item in enumerate(value, 1):
        number = as_number(item)
        if number is None:
            raise f.error(key, f"has {shown(item)} as number {position}, which is no finite number", remedy)
        numbers.append(number)
    if len(sides) == 2 and sides[0] * sides[1] != len(numbers):
        found = f"holds {len(numbers)} numbers, and rows and cols are {sides[0]:g} and {sides[1]:g}"
        raise f.error(key, found, remedy)
    return numbers


def camera_to_bytes(camera: Camera) -> bytes:
    """The content of a camera's file, as ROS loads it, too; it reads back to an equal camera.

    raises : SettingError for a camera without calibration whose axis is not in the middle: no file says that
    """
    if camera.calibrated:
        plain = replace(camera, field_of_view=0.0)
    else:
        plain = Camera.counting_pixels(camera.width, camera.height, camera.field_of_view, camera.mounting)
    if plain != camera:
        raise SettingError(
            "a camera's file holds a calibration, or a field of view about the middle of the image; give one"
        )
    lines = [f"image_width: {camera.width}", f"image_height: {camera.height}"]
    if camera.focal is None:
        lines.append(f"field_of_view: {number_text(camera.field_of_view)}  # rad, horizontal; no calibration")
    else:
        k = camera.matrix().ravel().tolist()
        p = [*k[:3], 0.0, *k[3:6], 0.0, *k[6:], 0.0]
        d, turned = list(camera.distortion), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        model = next(name for name in (NO_MODEL, PLUMB_BOB, RATIONAL) if len(d) in COUNTS[name])
        lines += ["camera_name: camera", _written("camera_matrix", 3, 3, k), f"distortion_model: {model}"]
        lines.append(_written("distortion_coefficients", 1, len(d), d))
        lines += [_written("rectification_matrix", 3, 3, turned), _written("projection_matrix", 3, 4, p)]
    lines.append(mounting_text(camera.mounting))
    return ("\n".join(lines) + "\n").encode()


def _written(key: str, rows: int, cols: int, data: list[float]) -> str:
    return f"{key}: {{rows: {rows}, cols: {cols}, data: {_listed(data, number_text)}}}"


def _listed(numbers: list[float], text: Any = "{:g}".format) -> str:
    return f"[{', '.join(text(number) for number in numbers)}]"
