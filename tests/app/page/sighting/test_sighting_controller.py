"""A look, another box, and what is used of it; a refused one is not."""

from __future__ import annotations

from math import hypot
from time import monotonic, sleep
from unittest.mock import Mock

import pytest
from tabs import event, noting_tab
from tagged_pictures import ASIDE, NEAR, sighting_files

from algorithms.common.errors import MapMergeError
from app.drawing.palette import DARK
from app.jobs.executor import LostTask, SerialExecutor
from app.model.merge_inputs import MergeInputs, Upload
from app.model.sighting.look_settings import LookSettings
from app.page.inputs_controller import InputsController
from app.page.run_controller import RunController
from app.page.sighting.sighting_controller import LABEL, STALE, SightingController
from app.page.tab import Tab

LOOK = LookSettings("tags", use_map=False)


class OneAnswer(SerialExecutor):
    """Gives this in place of what was asked for."""

    def __init__(self, answer) -> None:
        self.answer = answer

    def run(self, work, tasks, stop=None):
        if isinstance(self.answer, Exception):
            raise self.answer
        yield 0, self.answer


@pytest.fixture
def tab(inputs) -> Tab:
    made = noting_tab(inputs)
    made.panels.sensors.settings = LOOK
    return made


@pytest.fixture
def executor() -> Mock:
    return Mock(side_effect=lambda jobs: SerialExecutor())


@pytest.fixture
def runs() -> Mock:
    return Mock(RunController, thread=Mock())


@pytest.fixture
def seeing(tab, runs, executor):
    loads = Mock(InputsController)

    def show(inputs: MergeInputs) -> bool:
        tab.modes.close()
        tab.state.update(inputs=inputs, goal=None)
        return True

    loads.show = show
    made = SightingController(tab, runs, loads, executor, dict)
    yield made
    made.close()


def load(tab: Tab, *robots, **how) -> None:
    """The files of a moment come from the browser."""
    for name, content in sighting_files(*robots, **how).items():
        tab.panels.sensors.connect.call_args.args[0](Upload(name, content))
        take, upload = tab.events.then.call_args.args
        take(upload)


def settle(check) -> None:
    end = monotonic() + 60
    while not check():
        assert monotonic() < end
        sleep(0.02)


def look(tab: Tab) -> None:
    """Press Look, and wait for what comes of it."""
    dock, told = tab.panels.sighting, tab.panels.sighting.show.call_count
    tab.panels.sensors.connect_look.call_args.args[2]()
    settle(lambda: dock.show.call_count > told or dock.fail.called)


def page(tab: Tab):
    """What the dock shows."""
    return tab.panels.sighting.show.call_args.args[0]


def choose(tab: Tab, n: int) -> None:
    event(tab, "box")(n=n)


def test_nothing_is_looked_at_before_all_files_are_there(seeing, tab, executor):
    seeing.look()
    executor.assert_not_called()
    assert tab.panels.sensors.possible.call_args.args[0] is False


def test_a_look_opens_the_dock_in_place_of_the_charts_and_shows_what_was_found(seeing, tab, runs):
    load(tab, NEAR)
    look(tab)
    assert seeing.active
    tab.panels.charts.visible.assert_called_with(False)
    tab.panels.sighting.visible.assert_called_with(True)
    runs.thread.stop.assert_called()
    shown = page(tab)
    assert shown.outcome.startswith("The robot is 2.5")
    assert (shown.mood, shown.usable, shown.cannot) == ("accepted", True, "")
    assert "data-mm-box" in shown.picture
    assert "<svg" in shown.scan
    assert shown.gradients == ""


def test_close_brings_the_charts_back_and_the_look_can_be_shown_again(seeing, tab):
    load(tab, NEAR)
    look(tab)
    tab.panels.sighting.connect.call_args.args[1]()
    assert not seeing.active
    tab.panels.charts.visible.assert_called_with(True)
    assert tab.panels.sensors.possible.call_args.args == (True, False, True)
    tab.panels.sensors.connect_look.call_args.args[4]()
    assert seeing.active


def test_a_reloaded_tab_takes_up_files_places_and_what_was_seen(seeing, tab, inputs, runs, executor):
    load(tab, NEAR, ASIDE)
    look(tab)
    choose(tab, 1)
    seeing.sensors.typed("x1", 1.5)
    left, shown = seeing.left, page(tab)

    reloaded = noting_tab(inputs)
    reloaded.panels.sensors.settings = LOOK
    again = SightingController(reloaded, runs, Mock(InputsController), executor, dict)
    again.resume(left)
    reloaded.panels.sensors.take_settings.assert_called_once_with(LOOK)
    assert again.sensors.place == seeing.sensors.place
    again.open()
    assert page(reloaded) == shown
    assert page(reloaded).usable

    other = noting_tab(MergeInputs.pair(inputs.mov, inputs.ref))
    elsewhere = SightingController(other, runs, Mock(InputsController), executor, dict)
    elsewhere.resume(left)
    assert not elsewhere.sensors.files.any


def test_of_two_robots_a_person_chooses_and_that_one_is_used(seeing, tab, inputs):
    load(tab, NEAR, ASIDE)
    look(tab)
    assert "2 robots are in view" in page(tab).outcome
    assert not page(tab).usable
    seeing.use(0)
    assert tab.state.inputs is inputs
    choose(tab, 1)
    assert page(tab).usable
    seeing.use(0)
    (made,) = tab.state.inputs.observations
    assert made.range == pytest.approx(hypot(*NEAR), abs=0.03)
    choose(tab, 99)  # from a browser anything may come


def test_what_is_used_is_as_if_it_were_typed_and_its_window_is_shown(seeing, tab, inputs, runs):
    load(tab, NEAR)
    look(tab)
    seeing.use(0)
    (made,), (before,) = tab.state.inputs.observations, inputs.observations
    assert made.observer == before.observer
    assert (made.observed_x, made.observed_y) == (before.observed_x, before.observed_y)
    assert made.sigma_range < before.sigma_range
    assert tab.history.steps[-1].label == LABEL
    assert tab.history.steps[-1].snapshot.inputs is tab.state.inputs
    (job,) = runs.thread.request.call_args.args
    assert job.goal == "candidates"
    assert job.known == (made,)
    assert not seeing.active


def test_a_sighting_may_be_one_more_and_what_else_is_known_stays_aside(seeing, tab, inputs):
    load(tab, NEAR)
    look(tab)
    assert page(tab).observations == 1
    seeing.use(None)
    assert len(tab.state.inputs.observations) == 2
    assert tab.state.inputs.observations[0] == inputs.observations[0]


def test_where_nothing_was_known_a_sighting_is_what_is_known_now(seeing, tab, inputs):
    tab.state.update(inputs=MergeInputs.pair(inputs.ref, inputs.mov))
    load(tab, NEAR)
    look(tab)
    assert "robot 1 stood in map 1 and where robot 2 stood in map 2" in page(tab).cannot
    seeing.use(None)
    assert tab.state.inputs.observations == ()
    for name in ("x1", "x2"):
        seeing.sensors.typed(name, 1.0)
    assert page(tab).usable
    seeing.use(None)
    assert tab.state.inputs.choice == "sighting"
    assert tab.state.inputs.complete


@pytest.mark.parametrize(
    ("robots", "how", "why"),
    [((NEAR,), {"on_wall": True}, "no step in depth"), ((), {}, "no robot is found in the image")],
)
def test_a_poster_and_an_empty_room_are_refused_with_the_reason(seeing, tab, inputs, robots, how, why):
    load(tab, *robots, **how)
    look(tab)
    assert why in page(tab).outcome
    assert (page(tab).mood, page(tab).usable) == ("refused", False)
    choose(tab, 0)
    seeing.use(0)
    assert tab.state.inputs is inputs


def test_what_was_seen_is_out_of_date_with_other_settings_and_not_used(seeing, tab, inputs):
    load(tab, NEAR)
    look(tab)
    tab.panels.sensors.settings = LookSettings("tags", tag_size=0.2, use_map=False)
    tab.panels.sensors.connect_look.call_args.args[1]()
    assert page(tab).cannot == STALE
    assert not page(tab).usable
    seeing.use(0)
    assert tab.state.inputs is inputs
    tab.panels.sensors.settings = LOOK
    tab.panels.sensors.connect_look.call_args.args[1]()
    assert page(tab).usable


def test_other_maps_forget_what_was_seen_and_other_colours_draw_it_anew(seeing, tab, inputs):
    load(tab, NEAR)
    look(tab)
    before = page(tab).picture
    tab.state.update(palette=DARK)
    assert page(tab).picture != before
    tab.state.update(inputs=MergeInputs.pair(inputs.mov, inputs.ref))
    tab.panels.sighting.clear.assert_called()
    choose(tab, 0)
    seeing.use(None)
    assert tab.state.inputs.observations == ()


@pytest.mark.parametrize(
    ("answer", "why"),
    [(LostTask(), "Nothing was looked at: the process that ran it ended"), (MapMergeError("No."), "No.")],
)
def test_why_it_could_not_be_looked_is_told(seeing, tab, executor, answer, why):
    executor.side_effect = lambda jobs: OneAnswer(answer)
    load(tab, NEAR)
    look(tab)
    assert tab.panels.sighting.fail.call_args.args[0].startswith(why)


def test_a_look_can_be_stopped(seeing, tab):
    load(tab, NEAR)
    tab.panels.sensors.connect_look.call_args.args[2]()
    tab.panels.sensors.connect_look.call_args.args[3]()
    told = tab.panels.sighting.show.call_count
    sleep(0.3)
    assert tab.panels.sighting.show.call_count == told
    assert tab.panels.sensors.possible.call_args.args[1] is False
