"""Gradients as a picture: edges are drawn along themselves, flat places stay dark."""

from __future__ import annotations

import numpy as np

from algorithms.detection.detection import Detection
from algorithms.detection.hog_grid import WindowShape
from app.drawing.hog_picture import hog_picture

SHAPE = WindowShape(7, 7, 6)


def drawn(image):
    return hog_picture(image, Detection(100, 60, 160, 120, 0.9, "robot"), SHAPE)


def test_both_pictures_have_one_size_and_the_box_in_the_middle():
    image = np.zeros((200, 260, 3), np.uint8)
    image[60:121, 100:161] = 255
    part, edges = drawn(image)
    assert part.shape == edges.shape
    rows, cols = np.nonzero(part[..., 0] > 127)
    middle = np.array(part.shape[:2]) / 2
    assert abs(rows.mean() - middle[0]) < 8
    assert abs(cols.mean() - middle[1]) < 8


def test_a_flat_image_is_dark_and_an_edge_is_bright_where_it_is():
    image = np.full((200, 260, 3), 120, np.uint8)
    assert drawn(image)[1].max() == 0
    image[:, 130:] = 200
    _, edges = drawn(image)
    columns = edges[..., 0].sum(axis=0).astype(float)
    at = (np.arange(len(columns)) * columns).sum() / columns.sum()
    assert abs(at - len(columns) / 2) < 24


def test_an_upright_edge_is_drawn_upright():
    image = np.full((200, 260, 3), 120, np.uint8)
    image[:, 130:] = 200
    _, upright = drawn(image)
    bright = upright[..., 0] > 127
    assert bright.any(axis=1).mean() > 2 * bright.any(axis=0).mean()
