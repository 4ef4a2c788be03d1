"""The scan from above: straight ahead is up, left is left, and the centre lies behind the surface."""

from __future__ import annotations

import re

import numpy as np
import pytest
from looked_at import CAMERA, looked_at

from algorithms.common.pose import Pose2
from app.drawing.palette import LIGHT, css
from app.drawing.svg.scan_plot import draw_scan, scan_svg
from app.drawing.svg.svg_canvas import SvgCanvas, SvgPlot


def dots(svg, colour):
    """(N, 2) middles of the filled dots of a colour."""
    found = re.findall(
        rf'<circle cx="([-\d.]+)" cy="([-\d.]+)" r="[\d.]+" fill="{re.escape(css(colour))}"', svg
    )
    return np.array([[float(x), float(y)] for x, y in found]).reshape(-1, 2)


@pytest.mark.parametrize("y", [0.8, -0.8])
def test_what_is_ahead_and_to_the_left_is_above_and_to_the_left(y):
    seen, view = looked_at(Pose2(2.5, y, 0.3))
    svg = scan_svg(view, seen.sighted[0], CAMERA, LIGHT)
    observer = dots(svg, LIGHT.maps[0])[0]
    robot = dots(svg, LIGHT.maps[1])[:-1]  # the last one is the legend's
    assert len(robot) == len(seen.sighted[0].cluster.beams)
    assert (robot[:, 1] < observer[1]).all()
    assert (robot[:, 0].mean() < observer[0]) == (y > 0)


def test_the_sector_of_the_box_holds_the_points_on_the_robot():
    seen, view = looked_at(Pose2(2.5, 0.4, 0.3))
    svg = scan_svg(view, seen.sighted[0], CAMERA, LIGHT)
    way = re.search(rf'<path d="M([^"]+)Z" fill="{re.escape(css(LIGHT.particle))}"', svg).group(1)
    sector = np.array([[float(v) for v in point.split()] for point in way.split("L")])
    edges = np.roll(sector, -1, axis=0) - sector
    normals = np.column_stack([-edges[:, 1], edges[:, 0]]) / np.hypot(*edges.T)[:, None]
    for point in dots(svg, LIGHT.maps[1])[:-1]:
        off = ((point - sector) * normals).sum(axis=1)  # pixels from every edge, inside on one side of all
        assert off.min() > -4 or off.max() < 4


def test_from_near_by_nothing_is_drawn_outside_of_the_plot():
    seen, view = looked_at(Pose2(2.5, 0.4, 0.3))
    sheet = SvgCanvas(400)
    plot = SvgPlot(sheet, 50, 60, 100, 100, (-0.8, 0.2), (2.0, 3.0))
    draw_scan(plot, view, seen.sighted[0], CAMERA, LIGHT)
    drawn = sheet.svg("near by")
    middles = np.array(re.findall(r'<circle cx="([-\d.]+)" cy="([-\d.]+)"', drawn), dtype=float)
    ends = [
        [float(v) for v in point.split()]
        for way in re.findall(r'd="M([^"Z]+)', drawn)
        for point in way.split("L")
    ]
    for points in (middles, np.array(ends)):
        assert (points >= (50 - 6, 60 - 6)).all()  # a sign of some pixels may stand on the edge
        assert (points <= (150 + 6, 160 + 6)).all()
    assert not plot.holds(np.zeros(2))  # where the observer is
    assert len(dots(drawn, LIGHT.maps[1])) == len(seen.sighted[0].cluster.beams)


def test_numbers_of_the_centre_are_those_of_the_sighting():
    seen, view = looked_at(Pose2(2.5, 0.4, 0.3))
    svg = scan_svg(view, seen.sighted[0], CAMERA, LIGHT)
    assert f"{seen.position.range:.3f} ± {seen.position.sigma_range:.3f} m" in svg


def test_a_refused_box_shows_why_instead_of_a_centre():
    seen, view = looked_at(Pose2(2.5, 0.0, 0.3), wall=2.4)
    svg = scan_svg(view, seen.sighted[0], CAMERA, LIGHT)
    assert "no centre: " in svg
    assert "centre: 2" not in svg


def test_a_scan_alone_is_drawn_without_a_box():
    _, view = looked_at(Pose2(2.5, 0.4, 0.3))
    assert "direction" not in scan_svg(view, None, CAMERA, LIGHT)
