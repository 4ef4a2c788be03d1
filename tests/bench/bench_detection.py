"""How fast a robot is looked for in an image: our sliding windows against scikit-image's, one by one.

`make bench`. What is pinned is the ratio against the reference in the same run; seconds are printed, too.
"""

from __future__ import annotations

from time import perf_counter

import cv2
import numpy as np
from skimage.feature import hog

from algorithms.detection.hog_grid import BLOCK, ORIENTATIONS, grey
from algorithms.detection.model_file import shipped_model
from algorithms.detection.svm_detector import SvmDetector
from algorithms.simulator.views.robot_views import draw_view

STRIDE = 12  # cells of the reference's windows are two of ours apart: every window would take minutes
TIMES_FASTER = 10  # than the reference would be at our stride


def one_by_one(image, shape, weights):
    """The largest value of a classifier over the windows of one size: the HOG of every window by itself."""
    high, wide = shape.rows * shape.cell, shape.cols * shape.cell
    best, count = -np.inf, 0
    for top in range(0, image.shape[0] - high + 1, STRIDE):
        for left in range(0, image.shape[1] - wide + 1, STRIDE):
            window = image[top : top + high, left : left + wide]
            numbers = hog(window, ORIENTATIONS, (shape.cell, shape.cell), (BLOCK, BLOCK), block_norm="L2-Hys")
            best = max(best, float(np.max(weights @ numbers)))
            count += 1
    return best, count


def bench_detection(benchmark):
    cv2.setNumThreads(1)
    picture = draw_view(24, "office", robot=True).image
    assert picture.shape == (480, 640, 3)
    model = shipped_model()
    detector = SvmDetector(model)
    found = detector.detect(picture)
    benchmark.pedantic(detector.detect, args=(picture,), rounds=5, warmup_rounds=1)
    ours = benchmark.stats.stats.median
    start = perf_counter()
    _, windows = one_by_one(grey(picture), model.shape, model.weights)
    theirs = (perf_counter() - start) * (STRIDE / model.shape.cell) ** 2  # one size of the pyramid alone
    benchmark.extra_info.update(seconds=ours, reference_seconds=theirs, windows=windows, boxes=len(found))
    assert ours * TIMES_FASTER < theirs
