"""The file of a detector: plain numbers, and nothing in it is ever run."""

from __future__ import annotations

import pickle
import zipfile
from contextlib import suppress
from io import BytesIO

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.detection.hog_grid import WindowShape
from algorithms.detection.model_file import (
    ARRAYS,
    NUMBERS,
    model_from_bytes,
    model_to_bytes,
    read_model,
    shipped_model,
)
from algorithms.detection.svm_detector import DetectorModel


def made(rows=5, cols=6, classes=2, seed=0):
    shape, rng = WindowShape(rows, cols, 6), np.random.default_rng(seed)
    machines = (classes, shape.length), classes
    arrays = [rng.normal(size=size).astype(np.float32) for size in (*machines, (classes, 2), *machines)]
    return DetectorModel(shape, tuple(f"class_{k}" for k in range(classes)), *arrays)


@given(st.integers(2, 9), st.integers(2, 9), st.integers(1, 3))
def test_a_model_comes_back_as_it_was_written(rows, cols, classes):
    model = made(rows, cols, classes)
    data = model_to_bytes(model)
    back = model_from_bytes("m.npz", data)
    assert (back.shape, back.labels) == (model.shape, model.labels)
    for name in NUMBERS:
        assert np.array_equal(getattr(back, name), getattr(model, name))
    assert model_to_bytes(back) == data


class Bomb:
    """What runs when it is unpickled."""

    ran = False

    def __reduce__(self):
        return setattr, (Bomb, "ran", True)


def test_a_pickle_is_refused_unread():
    for data in (pickle.dumps(Bomb()), npz(weights=np.array([Bomb()], dtype=object))):
        with pytest.raises(InputFileError):
            model_from_bytes("m.npz", data)
    assert not Bomb.ran
    with pytest.raises(InputFileError, match="is a pickle"):
        model_from_bytes("m.npz", pickle.dumps({"weights": 1}))


def npz(**changed):
    """The file of a good model with some arrays changed; None leaves one out."""
    with np.load(BytesIO(model_to_bytes(made()))) as good:
        arrays = {**{name: good[name] for name in good.files}, **changed}
    data = BytesIO()
    np.savez(data, **{name: value for name, value in arrays.items() if value is not None})
    return data.getvalue()


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "not a detector's model"),
        (b"weights: 1", "not a detector's model"),
        (b"PK\x03\x04 torn", "damaged"),
        (npz(weights=None), "lacks weights"),
        (npz(version=np.array(9)), "version 9"),
        (npz(version=np.array("1")), "version"),
        (npz(window=np.array([900, 6, 6, 0.5])), "900 × 6 cells"),
        (npz(window=np.array([5, 6, np.nan, 0.5])), "cells"),
        (npz(window=np.array([5, 6, 6, 4.0])), "border"),
        (npz(window=np.arange(3)), "damaged"),
        (npz(labels=np.array([1, 2])), "without names"),
        (npz(labels=np.array(["a"])), "weights"),
        (npz(weights=np.full((2, 20 * 36), np.inf, np.float32)), "finite"),
        (npz(extra=np.zeros(3_000_000)), "unpacks to more"),
    ],
)
def test_what_is_no_model_is_told(data, said):
    with pytest.raises(InputFileError, match=said):
        model_from_bytes("m.npz", data)


@given(st.integers(0, 10**6), st.integers(0, 255))
def test_a_changed_byte_is_read_or_told(place, value):
    data = bytearray(model_to_bytes(made()))
    data[place % len(data)] = value
    with suppress(InputFileError):
        model_from_bytes("m.npz", bytes(data))


def test_a_zip_that_lies_about_its_size_is_told(tmp_path):
    file = tmp_path / "bomb.npz"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ARRAYS:
            archive.writestr(f"{name}.npy", bytes(4_000_000))
    with pytest.raises(InputFileError, match="unpacks to more"):
        read_model(file)


def test_the_model_that_ships_knows_front_and_side():
    assert shipped_model().labels == ("front_back", "side")
