"""A screen that is touched, as a tablet's."""

from __future__ import annotations

from math import dist

import pytest
from driver import SCALE, Tab, field, settle

pytestmark = pytest.mark.browser

Point = tuple[float, float]

MIDDLE = """() => {
    const hull = mapmeld.hand.mov.hull, mean = (k) => hull.reduce((sum, p) => sum + p[k], 0) / hull.length;
    return mapmeld.pixel([mean(0), mean(1)], "map2");
}"""  # of map 2, in the window


class Hand:
    """Up to two fingers."""

    def __init__(self, tab: Tab) -> None:
        self._screen = tab.context.new_cdp_session(tab.page)

    def _touch(self, kind: str, points: list[Point]) -> None:
        fingers = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)]
        self._screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    def move(self, *ways: tuple[Point, Point], steps: int = 6) -> None:
        """Each finger from one point to another, all at a time, in a straight line."""
        self._touch("touchStart", [begin for begin, _ in ways])
        for k in range(1, steps + 1):
            at = [(a[0] + (b[0] - a[0]) * k / steps, a[1] + (b[1] - a[1]) * k / steps) for a, b in ways]
            self._touch("touchMove", at)
        self._touch("touchEnd", [])


def places(tab: Tab) -> list[Point]:
    """Where two points of the floor are in the window, once the camera rests."""
    tab.at_rest()
    return [tuple(tab.page.evaluate("(p) => mapmeld.pixel(p)", p)[:2]) for p in ([0, 0], [7, 4])]


def test_a_finger_drags_the_map_two_zoom_it_and_map_2_goes_along_with_a_finger(open_tab):
    tab = open_tab(touch=True, smooth=True)
    hand = Hand(tab)
    x, y = 500.0, 450.0

    before = places(tab)
    hand.move(((x, y), (x + 80, y - 60)))
    dragged = places(tab)
    for was, now in zip(before, dragged, strict=True):
        assert now == pytest.approx((was[0] + 80, was[1] - 60), abs=2)

    for apart, then in ((90, 240), (260, 120)):  # px between the fingers
        before = places(tab)
        hand.move(((x - apart / 2, y), (x - then / 2, y)), ((x + apart / 2, y), (x + then / 2, y)))
        after = places(tab)
        assert dist(*after) / dist(*before) == pytest.approx(then / apart, rel=0.1)

    tab.page.get_by_role("button", name="Instant", exact=True).tap()
    tab.page.get_by_role("button", name="Merge", exact=True).tap()
    tab.wait_for("accepted")
    tab.page.get_by_role("button", name="Move map 2 by hand").tap()
    settle(lambda: tab.page.evaluate("() => !!window.mapmeld.hand?.mov"), "map 2 to be taken hold of")
    tab.at_rest()
    before = field(tab, "x in map 1 (m)")
    begin = tuple(tab.page.evaluate(MIDDLE)[:2])
    end = (begin[0] - 40, begin[1] - 30)
    hand.move((begin, end))
    settle(lambda: tab.page.evaluate(MIDDLE)[:2] == pytest.approx(end, abs=2), "map 2 under the finger")
    way = -40 / tab.page.evaluate(SCALE)
    settle(lambda: field(tab, "x in map 1 (m)") == pytest.approx(before + way, abs=0.1), "the server to know")
