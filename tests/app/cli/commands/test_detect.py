"""``mapmeld detect train``: pictures in, a model out that finds what they show."""

from __future__ import annotations

import numpy as np
import pytest
from commandline import usage_error
from drawn_robots import examples, with_board
from PIL import Image

from algorithms.detection.model_file import read_model
from algorithms.detection.svm_detector import SvmDetector
from app.cli.main import main


@pytest.fixture
def pictures(tmp_path):
    """Folders of boards cut out to their edges, and of rooms without one."""
    robots, backgrounds = examples(14)
    for name in ("crops", "rooms"):
        (tmp_path / name).mkdir()
    for k, one in enumerate(robots):
        left, top, right, bottom = (round(edge + 0.5) for edge in one.box)
        Image.fromarray(one.picture[top:bottom, left:right]).save(tmp_path / "crops" / f"{k}.png")
    for k, background in enumerate(backgrounds):
        Image.fromarray(background.picture).save(tmp_path / "rooms" / f"{k}.png")
    return tmp_path


def words(folder, *more):
    folders = [f"--positive={folder / 'crops'}", f"--negative={folder / 'rooms'}"]
    return ["detect", "train", *folders, f"--out={folder / 'model.npz'}", *more]


def test_a_model_is_trained_and_finds_what_it_was_shown(pictures, capsys):
    assert main(words(pictures)) == 0
    said = capsys.readouterr().out
    assert "precision" in said
    assert "robot" in said
    detector = SvmDetector(read_model(pictures / "model.npz"))
    rng = np.random.default_rng(77)
    found = sum(bool(detector.detect(with_board(rng, 60)[0])) for _ in range(8))
    assert found >= 7


def test_folders_within_are_classes(pictures):
    crops = pictures / "crops"
    for name in ("side", "front_back"):
        (crops / name).mkdir()
    for k, file in enumerate(sorted(crops.glob("*.png"))):
        file.rename(crops / ("side" if k % 2 else "front_back") / file.name)
    assert main(words(pictures)) == 0
    assert read_model(pictures / "model.npz").labels == ("front_back", "side")


def test_too_few_pictures_are_told_and_nothing_is_written(pictures, capsys):
    for file in sorted((pictures / "crops").iterdir())[3:]:
        file.unlink()
    assert main(words(pictures)) == 2
    assert "there are 3 pictures of robots; give at least 10" in capsys.readouterr().err
    assert not (pictures / "model.npz").exists()


@pytest.mark.parametrize(("name", "said"), [("crops", "holds no pictures"), ("rooms", "holds no pictures")])
def test_an_empty_folder_is_told(pictures, capsys, name, said):
    for file in (pictures / name).iterdir():
        file.unlink()
    assert main(words(pictures)) == 2
    assert said in capsys.readouterr().err


def test_a_folder_that_is_none_and_a_picture_that_is_none_are_told(pictures, capsys):
    assert main([*words(pictures)[:2], "--positive=nowhere", *words(pictures)[3:]]) == 2
    assert "nowhere: is no folder" in capsys.readouterr().err
    (pictures / "rooms" / "torn.png").write_bytes(b"no picture")
    assert main(words(pictures)) == 2
    assert "torn.png" in capsys.readouterr().err


def test_there_is_nothing_to_do_but_to_train(pictures):
    assert usage_error("detect", "look", *words(pictures)[2:]) == 2
