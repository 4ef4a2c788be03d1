"""The file of a trained detector: plain numbers in an .npz, read without pickle."""

from __future__ import annotations

import zipfile
from functools import cache
from io import BytesIO
from pathlib import Path

import numpy as np

from algorithms.common.errors import InputFileError, SettingError
from algorithms.detection.hog_grid import WindowShape
from algorithms.detection.svm_detector import DetectorModel
from algorithms.files.map_file import read_bytes

VERSION = 2
NUMBERS = ("weights", "biases", "calibration", "class_weights", "class_biases")
ARRAYS = ("version", "window", "labels", *NUMBERS)
MOST_BYTES = 16 * 2**20  # of all arrays together; ours have 24,000
MOST_CELLS, MOST_PIXELS = 32, 32  # of a window, and of a cell, a side
REMEDY = "give a model that mapmeld detect train wrote"
SHIPPED = Path(__file__).with_name("paper_board_robot.npz")


@cache
def shipped_model() -> DetectorModel:
    """The model that comes with mapmeld: robots with paper boards, trained on rendered images."""
    return read_model(SHIPPED)


def read_model(path: Path | str) -> DetectorModel:
    """Read a model; raises InputFileError."""
    return model_from_bytes(str(path), read_bytes(Path(path), "a detector's model", MOST_BYTES))


def model_from_bytes(name: str, data: bytes) -> DetectorModel:
    """What a file or an upload holds; raises InputFileError. Nothing in it is ever run."""
    if data[:1] == b"\x80":
        raise InputFileError(name, "is a pickle, which could run anything, and is not read", REMEDY)
    if data[:2] != b"PK":
        raise InputFileError(name, "is not a detector's model (.npz)", REMEDY)
    try:
        with zipfile.ZipFile(BytesIO(data)) as archive:
            names = {info.filename: info.file_size for info in archive.infolist()}
        missing = [array for array in ARRAYS if f"{array}.npy" not in names]
        if missing:
            raise InputFileError(name, f"lacks {', '.join(missing)}", REMEDY)
        if sum(names.values()) > MOST_BYTES:
            raise InputFileError(name, f"unpacks to more than {MOST_BYTES // 2**20} MB", REMEDY)
        with np.load(BytesIO(data), allow_pickle=False) as arrays:
            found = {array: arrays[array] for array in ARRAYS}
        return _model(name, found)
    except InputFileError:
        raise
    except SettingError as error:
        raise InputFileError(name, str(error), REMEDY) from error
    except Exception as error:  # whatever a damaged zip or array makes zipfile, zlib and numpy raise
        first = (str(error) or type(error).__name__).splitlines()[0][:120]
        raise InputFileError(name, f"is damaged ({first})", REMEDY) from error


def _model(name: str, found: dict[str, np.ndarray]) -> DetectorModel:
    version = found["version"]
    if version.shape != () or version.dtype.kind not in "iu":
        raise InputFileError(name, "does not say its version", REMEDY)
    if int(version) != VERSION:
        raise InputFileError(name, f"is of version {int(version)}; known is {VERSION}", REMEDY)
    rows, cols, cell, border = (float(value) for value in found["window"].reshape(4))
    whole = all(value.is_integer() for value in (rows, cols, cell))
    if not whole or not (2 <= min(rows, cols) <= max(rows, cols) <= MOST_CELLS and 2 <= cell <= MOST_PIXELS):
        raise InputFileError(name, f"has a window of {rows:g} × {cols:g} cells of {cell:g} pixels", REMEDY)
    if not 0 <= border <= (min(rows, cols) - 1) / 2:
        raise InputFileError(name, f"has a border of {border:g} cells", REMEDY)
    if found["labels"].dtype.kind != "U" or found["labels"].ndim != 1:
        raise InputFileError(name, "has classes without names", REMEDY)
    return DetectorModel(
        WindowShape(int(rows), int(cols), int(cell), border),
        tuple(str(label) for label in found["labels"]),
        *(np.asarray(found[array], dtype=np.float32) for array in NUMBERS),
    )


def model_to_bytes(model: DetectorModel) -> bytes:
    """The content of a model's file; equal models give equal bytes."""
    shape = model.shape
    arrays = {
        "version": np.array(VERSION),
        "window": np.array([shape.rows, shape.cols, shape.cell, shape.border]),
        "labels": np.array(model.labels),
        **{array: getattr(model, array) for array in NUMBERS},
    }
    data = BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for array in ARRAYS:
            part = BytesIO()
            np.lib.format.write_array(part, arrays[array], allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{array}.npy"), part.getvalue(), zipfile.ZIP_DEFLATED)
    return data.getvalue()
