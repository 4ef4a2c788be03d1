"""What is trained is found, what is not is left alone; one seed, one model."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from drawn_robots import BARS, CROSS, examples, room, with_board

from algorithms.common.errors import SettingError
from algorithms.detection.detection import overlaps
from algorithms.detection.hog_grid import WindowShape, grey, hog_grid, scores, window_features
from algorithms.detection.model_file import NUMBERS, model_to_bytes
from algorithms.detection.svm_detector import DetectorModel, SvmDetector
from algorithms.detection.svm_training import RobotExample, Training, TrainingStep, train, window_shape


@cache
def trained(seed: int = 0) -> Training:
    *steps, result = train(*examples(16), seed=seed)
    assert all(isinstance(step, TrainingStep) for step in steps)
    assert isinstance(result, Training)
    return result


def test_a_board_that_was_never_seen_is_found_where_it_is():
    detector, rng = SvmDetector(trained().model), np.random.default_rng(99)
    for _ in range(10):
        picture, box = with_board(rng, int(rng.integers(44, 80)))
        found = detector.detect(picture)
        assert found
        joint, _ = overlaps(np.array([found[0].box()]), box)
        assert joint[0] > 0.3  # it has learned sixteen boards


def test_boards_of_two_classes_are_found_and_told_apart():
    rng, classes = np.random.default_rng(3), {"cross": CROSS, "bars": BARS}
    robots = [
        RobotExample(*with_board(rng, int(rng.integers(40, 90)), lines), label)
        for _ in range(16)
        for label, lines in classes.items()
    ]
    *_, result = train(robots, examples(16)[1])
    detector, right = SvmDetector(result.model), 0
    for label, lines in [*classes.items()] * 8:
        picture, box = with_board(rng, int(rng.integers(44, 80)), lines)
        found = detector.detect(picture)
        on_it = overlaps(np.array([one.box() for one in found]).reshape(-1, 4), box)[0] > 0.3
        right += any(on and one.label == label for on, one in zip(on_it, found, strict=True))
    assert right >= 14


def test_rooms_without_a_board_are_left_alone():
    detector, rng = SvmDetector(trained().model), np.random.default_rng(98)
    false = sum(bool(detector.detect(room(rng))) for _ in range(10))
    assert false <= 1


def test_a_board_twice_as_large_in_a_picture_twice_as_large_is_found_as_well():
    rng = np.random.default_rng(5)
    picture, _ = with_board(rng, 60)
    larger = np.kron(picture, np.ones((2, 2, 1), np.uint8))
    one, other = (SvmDetector(trained().model).detect(image)[0] for image in (picture, larger))
    assert np.array(other.box()) / 2 == pytest.approx(np.array(one.box()), abs=0.12 * one.width)


def test_one_seed_gives_one_model():
    again = list(train(*examples(16)))[-1]
    assert model_to_bytes(again.model) == model_to_bytes(trained().model)


def test_the_score_is_that_of_pictures_kept_from_the_training():
    (score,) = trained().scores
    assert score.label == "robot"
    assert 0.9 <= score.precision <= 1
    assert 0.9 <= score.recall <= 1
    assert score.robots == 96


def test_steps_count_up_to_their_total():
    steps = [step for step in train(*examples(10)) if isinstance(step, TrainingStep)]
    assert [step.done for step in steps] == list(range(steps[0].total))


@pytest.mark.parametrize("empty", [0, 1])
def test_too_few_pictures_are_told(empty):
    given = list(examples(12))
    given[empty] = given[empty][:3]
    with pytest.raises(SettingError, match="there are 3 pictures"):
        next(train(*given))


def test_the_window_has_the_shape_of_the_robots():
    high = np.array([[0, 0, 20, 40]] * 3, dtype=float)
    assert (window_shape(high).rows, window_shape(high).cols) == (7, 4)
    assert window_shape(high[:, [1, 0, 3, 2]]).rows == 4
    assert window_shape(np.array([[0, 0, 30.0, 30.0]])) == WindowShape(7, 7, 6)


def test_a_window_cut_out_has_the_numbers_of_the_same_window_in_the_whole_image():
    shape, image = WindowShape(7, 7, 6), grey(room(np.random.default_rng(3)))
    grid = hog_grid(image, shape.cell)
    top, left = 5, 9  # cells
    edge = shape.border * shape.cell
    high, wide = shape.body
    box = np.array([left * 6 + edge, top * 6 + edge, left * 6 + edge + wide, top * 6 + edge + high])
    alone = window_features(image, box, shape)
    rows, cols = shape.blocks
    assert alone == pytest.approx(grid[top : top + rows, left : left + cols].reshape(-1), abs=1e-4)


def test_sliding_a_window_is_the_product_with_every_window():
    rng = np.random.default_rng(0)
    shape = WindowShape(4, 5, 6)
    grid = rng.normal(size=(8, 9, 36)).astype(np.float32)
    weights = rng.normal(size=(2, shape.length)).astype(np.float32)
    found = scores(grid, shape, weights)
    rows, cols = shape.blocks
    assert found.shape == (8 - rows + 1, 9 - cols + 1, 2)
    assert found[2, 3] == pytest.approx(weights @ grid[2 : 2 + rows, 3 : 3 + cols].ravel(), abs=1e-3)
    assert scores(grid[:2], shape, weights).size == 0


@pytest.mark.parametrize("wrong", NUMBERS)
def test_a_model_whose_numbers_do_not_fit_its_window_is_refused(wrong):
    model = trained().model
    parts = {name: getattr(model, name) for name in ("shape", "labels", *NUMBERS)}
    with pytest.raises(SettingError, match=wrong):
        DetectorModel(**{**parts, wrong: parts[wrong][..., :-1]})
    with pytest.raises(SettingError, match=wrong):
        DetectorModel(**{**parts, wrong: parts[wrong] * np.nan})


def test_a_picture_smaller_than_the_window_holds_no_robot():
    assert SvmDetector(trained().model).detect(np.zeros((40, 40, 3), np.uint8)) == ()


@pytest.mark.parametrize("probability", [0.0, 1.0, np.nan])
def test_a_least_probability_is_one(probability):
    with pytest.raises(SettingError, match="least probability"):
        SvmDetector(trained().model, probability)
