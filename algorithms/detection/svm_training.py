"""Training a detector: HOG windows of robots and of everything else, hard ones mined; scikit-learn's SVM."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray
from algorithms.detection.detection import Picture, overlaps
from algorithms.detection.hog_grid import Features, WindowShape, grey, window_features
from algorithms.detection.svm_detector import DetectorModel, SvmDetector

CELL = 6  # pixels; with seven cells a robot is found from 36 pixels on, 0.45 m at 6 m of a usual camera
LONG_SIDE = 7  # cells of the longer side of a window
SHIFT, GROWTH = 0.07, 0.08  # of a robot's box: windows lie on a grid, and sizes of the pyramid are steps
TIMES = 3  # windows made of one robot: as it is, and shifted and grown at random
FIRST_WINDOWS = 12  # of every background, before any is mined
ROUNDS = 2  # of mining
PER_IMAGE = 25  # windows mined of one background in one round, at most
MINED_FROM = 0.2  # probability, from which a window of the background is a hard one
APART = 0.25  # a window that shares more with a robot is neither robot nor background
FOLDS = 3  # of the cross-validation
LEAST = 10  # robots and backgrounds; with fewer nothing can be said of what is learned
PENALTY = 0.01  # of the SVM: soft, since rendered robots are not all robots


@dataclass(frozen=True, eq=False)
class RobotExample:
    """A robot in a picture.

    box   : (4,) left, top, right, bottom; pixels
    label : of its class
    """

    picture: Picture
    box: FloatArray
    label: str


@dataclass(frozen=True, eq=False)
class Background:
    """A picture in which everything but the robots' boxes, (N, 4) pixels, is no robot."""

    picture: Picture
    robots: FloatArray = field(default_factory=lambda: np.zeros((0, 4)))


@dataclass(frozen=True)
class TrainingStep:
    """How far the training is; what is done now, in words."""

    done: int
    total: int
    doing: str


@dataclass(frozen=True)
class ClassScore:
    """What cross-validation gives a class, at a probability of one half.

    robots, windows : of that class, and of backgrounds, hard ones among them
    """

    label: str
    precision: float
    recall: float
    robots: int
    windows: int


@dataclass(frozen=True, eq=False)
class Training:
    """A trained detector and how good it is on pictures that were kept from it."""

    model: DetectorModel
    scores: tuple[ClassScore, ...]


def window_shape(boxes: FloatArray) -> WindowShape:
    """The window that fits (N, 4) boxes of robots best."""
    ratio = float(np.median((boxes[:, 2] - boxes[:, 0]) / (boxes[:, 3] - boxes[:, 1])))
    short = max(4, round(LONG_SIDE * min(ratio, 1 / ratio)))
    return WindowShape(LONG_SIDE, short, CELL) if ratio < 1 else WindowShape(short, LONG_SIDE, CELL)


def train(
    robots: Sequence[RobotExample], backgrounds: Sequence[Background], seed: int = 0
) -> Iterator[TrainingStep | Training]:
    """Train a detector; steps, and the ``Training`` in the end. One seed, one model.

    raises : SettingError where there are too few pictures
    """
    for count, what in ((len(robots), "pictures of robots"), (len(backgrounds), "pictures without robots")):
        if count < LEAST:
            raise SettingError(f"there are {count} {what}; give at least {LEAST}")
    rng = np.random.default_rng(seed)
    shape = window_shape(np.array([one.box for one in robots]))
    total = len(robots) + len(backgrounds) * (ROUNDS + 1)
    done = 0
    rows: list[Features] = []
    labels: list[str] = []
    groups: list[int] = []  # windows of one picture stay on one side of the cross-validation
    for number, one in enumerate(robots):
        yield TrainingStep(done, total, "robots")
        for window in _windows_of(one, shape, rng):
            rows.append(window)
            labels.append(one.label)
            groups.append(number)
        done += 1
    for number, background in enumerate(backgrounds):
        yield TrainingStep(done, total, "backgrounds")
        image = grey(background.picture)
        for box in _random_boxes(background, shape, rng):
            rows.append(window_features(image, box, shape))
            labels.append("")
            groups.append(len(robots) + number)
        done += 1
    for round_ in range(ROUNDS):
        model, _ = _fit(rows, labels, groups, shape, seed, tested=False)
        detector = SvmDetector(model, MINED_FROM)
        for number, background in enumerate(backgrounds):
            yield TrainingStep(done, total, f"hard backgrounds, round {round_ + 1} of {ROUNDS}")
            image = grey(background.picture)
            for box in _hard_boxes(background, detector):
                rows.append(window_features(image, box, shape))
                labels.append("")
                groups.append(len(robots) + number)
            done += 1
    yield Training(*_fit(rows, labels, groups, shape, seed))


def _windows_of(one: RobotExample, shape: WindowShape, rng: np.random.Generator) -> Iterator[Features]:
    """The windows made of one robot, each also seen in a mirror."""
    image = grey(one.picture)
    size = np.array([one.box[2] - one.box[0], one.box[3] - one.box[1]])
    high, wide = shape.body
    # as wide and high as the window's body is, around the same middle: what is detected has that shape
    scale = max(size[0] / wide, size[1] / high)
    middle = np.array([one.box[0] + one.box[2], one.box[1] + one.box[3]]) / 2
    for k in range(TIMES):
        moved, grown = rng.uniform(-1, 1, 2) * SHIFT * (k > 0), 1 + rng.uniform(-1, 1) * GROWTH * (k > 0)
        half = np.array([wide, high]) * scale * grown / 2
        centre = middle + moved * 2 * half
        box = np.concatenate([centre - half, centre + half])
        yield window_features(image, box, shape)
        flipped = np.array([image.shape[1] - 1 - box[2], box[1], image.shape[1] - 1 - box[0], box[3]])
        yield window_features(np.ascontiguousarray(image[:, ::-1]), flipped, shape)


def _random_boxes(background: Background, shape: WindowShape, rng: np.random.Generator) -> list[FloatArray]:
    """Boxes anywhere, of any size, that are no robot."""
    height, width = background.picture.shape[:2]
    high, wide = shape.body
    largest = min(height / high, width / wide)
    boxes = []
    for _ in range(FIRST_WINDOWS):
        scale = min(1.0, largest) * max(1.0, largest) ** rng.uniform(0, 1)
        left, top = rng.uniform(0, 1) * (width - wide * scale), rng.uniform(0, 1) * (height - high * scale)
        box = np.array([left, top, left + wide * scale, top + high * scale])
        if _is_apart(background, box):
            boxes.append(box)
    return boxes


def _hard_boxes(background: Background, detector: SvmDetector) -> list[FloatArray]:
    """Boxes that the detector takes for robots, and that are none."""
    boxes = []
    found = [one for one in detector.windows(background.picture) if one.probability >= MINED_FROM]
    for one in sorted(found, key=lambda one: -one.probability):
        box = np.array(one.box())
        if _is_apart(background, box):
            boxes.append(box)
    return boxes[:PER_IMAGE]


def _is_apart(background: Background, box: FloatArray) -> bool:
    return not len(background.robots) or bool((overlaps(background.robots, box)[0] < APART).all())


def _fit(
    rows: Sequence[Features],
    labels: Sequence[str],
    groups: Sequence[int],
    shape: WindowShape,
    seed: int,
    tested: bool = True,
) -> tuple[DetectorModel, tuple[ClassScore, ...]]:
    """One SVM per class against all backgrounds, its probability from its values (Platt); one more per class
    against the other classes.

    tested : whether those are the values of windows kept from the training; the probabilities are true then
    """
    from sklearn.linear_model import LogisticRegression  # only who trains needs scikit-learn
    from sklearn.model_selection import GroupKFold, cross_val_predict
    from sklearn.svm import LinearSVC

    def machine() -> Any:
        return LinearSVC(C=PENALTY, class_weight="balanced", random_state=seed, max_iter=5000)

    data, names, of = np.stack(rows), np.array(labels), np.array(groups)
    robots, classes = names != "", sorted(set(labels) - {""})
    weights, biases, calibration, results = [], [], [], []
    class_weights, class_biases = np.zeros((len(classes), data.shape[1])), np.zeros(len(classes))
    for k, label in enumerate(classes):
        used = (names == label) | ~robots
        x, y = data[used], names[used] == label
        fitted = machine().fit(x, y)
        values = fitted.decision_function(x)
        if tested:
            folds = GroupKFold(min(FOLDS, len(set(of[used & (names == label)]))))
            values = cross_val_predict(machine(), x, y, groups=of[used], cv=folds, method="decision_function")
        if len(classes) > 1:
            told = machine().fit(data[robots], names[robots] == label)
            class_weights[k], class_biases[k] = told.coef_[0], told.intercept_[0]
        line = LogisticRegression(C=1e6).fit(values[:, None], y)
        weights.append(fitted.coef_[0])
        biases.append(fitted.intercept_[0])
        calibration.append([line.coef_[0, 0], line.intercept_[0]])
        said = line.predict(values[:, None])
        right = int((said & y).sum())
        results.append(
            ClassScore(
                label, right / max(1, int(said.sum())), right / int(y.sum()), int(y.sum()), int((~y).sum())
            )
        )
    parts = weights, biases, calibration, class_weights, class_biases
    arrays = (np.array(part, dtype=np.float32) for part in parts)
    model = DetectorModel(shape, tuple(classes), *arrays)
    return model, tuple(results)
