"""The dock shows what was found, offers to use it where that can be, and says as what."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest
import viser
from controls import Controls

from app.page.sighting.sighting_dock import NEXT, SightingDock, SightingPage, places

FOUND = SightingPage(
    "The robot is there.", "accepted", True, "", False, 0, "<p>P</p>", "<p>B</p>", "<p>S</p>", ""
)


class Dock:
    """With what is pressed in it."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.controls = Controls(server.gui)
        client = SimpleNamespace(gui=self.controls, camera=SimpleNamespace(image_width=640))
        self.dock, self.used = SightingDock(client), []
        self.dock.connect(lambda: None, lambda: None, self.used.append)

    def use(self) -> None:
        self.controls.find("Use this sighting").value = True


@pytest.fixture
def dock(server) -> Dock:
    return Dock(server)


def test_what_was_found_is_shown_from_the_outcome_to_the_gradients(dock):
    dock.dock.show(replace(FOUND, gradients="<p>G</p>"))
    text = dock.controls.text()
    order = [text.index(part) for part in ("The robot is there.", "<p>P", "<p>B", "<p>S", "<p>G")]
    assert order == sorted(order)
    assert not dock.controls.find("Use this sighting").disabled


def test_what_cannot_be_used_says_why(dock):
    dock.dock.show(replace(FOUND, usable=False, cannot="Look again.", old=True))
    assert dock.controls.text().count("mm-outdated") == 3
    assert dock.controls.find("Use this sighting").disabled
    assert "Look again." in dock.controls.text()
    dock.dock.show(FOUND)
    assert "Look again." not in dock.controls.text()
    assert "mm-outdated" not in dock.controls.text()


def test_a_failed_look_and_a_cleared_dock_offer_nothing(dock):
    dock.dock.show(FOUND)
    dock.dock.clear()
    assert not dock.controls.find("Use this sighting").visible
    assert "<p>" not in dock.controls.text()
    dock.dock.fail("No such <file>.")
    assert "No such &lt;file&gt;." in dock.controls.text()


@pytest.mark.parametrize(
    ("count", "choice", "used"), [(0, 0, None), (1, 0, 0), (1, 1, None), (3, 2, 2), (3, 3, None)]
)
def test_it_takes_the_place_of_an_observation_or_is_one_more(dock, count, choice, used):
    dock.dock.show(replace(FOUND, observations=count))
    menu = dock.controls.find("Use it")
    assert menu.visible == (count > 0)
    assert menu.options == places(count)
    menu.value = places(count)[choice]
    dock.use()
    assert dock.used == [used]


def test_the_choice_stays_while_other_boxes_are_looked_at(dock):
    dock.dock.show(replace(FOUND, observations=2))
    dock.controls.find("Use it").value = NEXT
    dock.dock.show(replace(FOUND, observations=2, outcome="Another."))
    assert dock.controls.find("Use it").value == NEXT
