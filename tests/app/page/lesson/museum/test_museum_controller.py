"""The museum: every exhibit fails as it says, with its method and settings, and its cure merges."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi, radians
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from tabs import noting_tab

from algorithms.common.errors import InputFileError
from algorithms.common.pose import pose_error, wrap_angle
from algorithms.files.observation_file import read_known
from algorithms.fleets.fleet_merge import merge_fleet
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, merge
from app.model.merge_inputs import MergeInputs
from app.model.verdict_text import remedy
from app.page.inputs_controller import InputsController
from app.page.lesson.lesson_texts import files, with_settings
from app.page.lesson.museum import museum_controller
from app.page.lesson.museum.exhibit_samples import exhibit_fleet, exhibit_inputs, exhibit_picture
from app.page.lesson.museum.exhibit_texts import Exhibit, museum_folder, read_exhibit
from app.page.lesson.museum.museum_controller import MuseumController, changes, rows
from app.page.lesson.sighting_look import LookThread, look
from app.page.run_controller import RunController
from app.page.undo.undo_controller import UndoController
from app.system import data_paths as paths

POSTER = 8  # its place among the exhibits
GOOD = """\
---
title: Mine
case: office_r2_r1
method: spectra-swarm
settings: {candidates.twins: false}
why: It was the twin.
cure: {button: Twins, settings: {candidates.twins: true}}
cured: Now it is there.
---
Press Merge.
"""


@cache
def failed(exhibit: Exhibit) -> tuple[bool, MergeResult]:
    """Whether an exhibit's merge is wrong by the truth, and its result."""
    return _merged(exhibit_inputs(exhibit)[0], exhibit.method, exhibit.settings)


@cache
def cured(exhibit: Exhibit) -> tuple[bool, MergeResult]:
    """The same of its cure."""
    settings = (*exhibit.settings, *exhibit.cure_settings)
    return _merged(exhibit_inputs(exhibit)[1], exhibit.cure_method, settings)


def _merged(pair: MergeInputs, method: str, settings) -> tuple[bool, MergeResult]:
    config = with_settings(METHODS[method].defaults, settings)
    result = merge(pair.ref, pair.mov, pair.known, method, config)
    distance, angle = pose_error(result.T_ref_mov, pair.truth.T_ref_mov, result.pivot)
    return not pair.truth.allows(distance, angle), result


@pytest.fixture(scope="module", params=files(museum_folder()), ids=lambda path: path.stem)
def exhibit(request) -> Exhibit:
    return read_exhibit(request.param)


def test_an_exhibit_fails_as_it_says_and_a_search_without_a_proof_is_not_told_to_doubt_the_maps(exhibit):
    wrong, result = failed(exhibit)
    assert wrong
    if not result.verdict.accepted and exhibit.method == "spectra-swarm":
        assert "take the default one" in remedy(result)


def test_its_cure_merges_and_is_accepted(exhibit):
    if exhibit.sighting:
        found = merge_fleet(exhibit_fleet(exhibit))
        assert [each.number for each in found.left_out] == [exhibit.sighting - 1]
        return
    wrong, result = cured(exhibit)
    assert not wrong
    assert result.verdict.accepted


def test_without_a_sighting_more_wall_agrees_at_the_twin_than_at_the_truth_and_the_verdict_refuses_it():
    exhibit = read_exhibit(museum_folder() / "07-own-twin.md")
    (_, twin), (_, right) = failed(exhibit), cured(exhibit)
    assert twin.encounters == ()
    turned = wrap_angle(twin.T_ref_mov.theta - right.T_ref_mov.theta)
    assert abs(turned) == pytest.approx(pi, abs=radians(3))
    assert twin.weighed[0].evidence.agreeing > 3 * right.weighed[0].evidence.agreeing
    assert not twin.verdict.accepted


def test_the_failures_that_everyone_should_know_are_there():
    shown = {path.stem.split("-", 1)[1] for path in files(museum_folder())}
    assert {"twin", "one-aisle-on", "too-near-sighted", "too-sure"} <= shown


def test_a_cure_of_the_same_method_changes_what_the_exhibit_has_set(tmp_path):
    read = exhibit_of(tmp_path, GOOD)
    assert read.cure_method == read.method
    assert read.settings == ((("candidates", "twins"), False),)
    assert read.cure_settings == ((("candidates", "twins"), True),)


def test_what_is_set_for_an_exhibit_is_told_in_the_words_of_the_panel(tmp_path):
    read = exhibit_of(tmp_path, GOOD.replace("case:", "rough: true\ncase:"))
    config = with_settings(METHODS[read.method].defaults, read.settings)
    assert rows(read, config) == [
        ("sample", "office_r2_r1, badly measured"),
        ("method", METHODS["spectra-swarm"].title),
        ("twins", "off"),
    ]


@pytest.mark.parametrize("path", files(museum_folder()), ids=lambda path: path.stem)
def test_what_a_cure_changes_is_told_with_what_it_was_before(path):
    read = read_exhibit(path)
    failing = with_settings(METHODS[read.method].defaults, read.settings)
    cured = with_settings(METHODS[read.cure_method].defaults, (*read.settings, *read.cure_settings))
    before, after = dict(rows(read, failing)), dict(changes(read, failing, cured))
    assert before.keys() <= after.keys()
    assert any("→" in words for words in after.values())
    for name, words in before.items():
        assert after[name].split(" → ")[0] == words


def exhibit_of(folder: Path, text: str) -> Exhibit:
    path = folder / "07-mine.md"
    path.write_text(text, encoding="utf-8")
    return read_exhibit(path)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("case: office_r2_r1", "case: castle", "case is 'castle'; known are"),
        ("method: spectra-swarm", "method: magic", "method is 'magic'; known are"),
        ("why: It was the twin.\n", "", "why is missing"),
        ("{candidates.twins: false}", "{candidates.twins: maybe}", "candidates.twins is 'maybe'"),
        ("button: Twins, ", "", "cure.button is missing"),
        ("title: Mine", "titel: Mine", "did you mean title"),
        ("method:", "known: everything\nmethod:", "known is 'everything'; known are sighting, nothing"),
        ("method:", "known: nothing\nmethod:", "known is nothing; the method spectra-swarm needs a sighting"),
        ("method:", "picture: office_r2_r1\nmethod:", "picture is 'office_r2_r1'; known are office_poster"),
        ("Press Merge.", "", "no text below"),
    ],
)
def test_what_is_wrong_with_an_exhibit_is_told_with_its_file(tmp_path, old, new, said):
    assert old in GOOD
    with pytest.raises(InputFileError, match=said) as told:
        exhibit_of(tmp_path, GOOD.replace(old, new, 1))
    assert "07-mine.md" in str(told.value)


@pytest.fixture
def tab():
    return noting_tab()


@pytest.fixture
def museum(tab, monkeypatch) -> MuseumController:
    """A museum whose exhibits are put on the page at once."""
    runs, loads = Mock(RunController, thread=Mock()), Mock(InputsController)
    runs.set_method = lambda method, config, seed: tab.state.update(method=method, config=config, seed=seed)

    def show(inputs) -> bool:
        tab.state.update(inputs=inputs, result=None)
        return True

    loads.show = show
    monkeypatch.setattr(museum_controller, "LookThread", lambda *_: Mock(LookThread))
    return MuseumController(tab, Mock(UndoController, history=tab.history), runs, loads, Mock())


def merged(tab, result, right: bool) -> None:
    """A merge of what is on the page has ended, rightly or not."""
    true = tab.state.inputs.truth.T_ref_mov
    T = true if right else replace(true, theta=true.theta + 1.0)
    found = replace(result, T_ref_mov=T, method=tab.state.method)
    tab.state.update(result=found, result_config=tab.state.config)


def test_an_exhibit_says_what_went_wrong_once_it_has_and_its_cure_that_it_helped(museum, tab, result):
    panel = tab.panels.museum
    museum.enter()
    merged(tab, result, right=True)  # it did not go wrong this time
    panel.failed.assert_not_called()
    merged(tab, result, right=False)
    assert "from the truth" in panel.failed.call_args.args[1]
    failing = tab.state.method, tab.state.config
    museum.cure()
    assert museum._runs.merge.called
    assert (tab.state.method, tab.state.config) != failing
    merged(tab, result, right=True)
    assert panel.cured.called


def test_a_cure_that_is_to_know_more_merges_the_same_maps_with_it(museum, tab, result):
    museum.enter()
    museum.pick(6)
    assert tab.state.inputs.known == ()
    assert len(tab.state.inputs.aside) == 1  # the sighting is put aside, not gone
    merged(tab, result, right=False)
    assert tab.panels.museum.failed.called
    before = tab.state.inputs
    museum.cure()
    assert len(tab.state.inputs.observations) == 1
    assert tab.state.inputs.maps == before.maps
    tab.panels.museum.cured.assert_not_called()
    merged(tab, result, right=True)
    assert tab.panels.museum.cured.called


def test_the_poster_is_seen_by_the_detector_alone_until_a_merge_has_failed(museum, tab, result):
    panel, look_at_it = tab.panels.museum, museum._looks.ask
    museum.enter()
    museum.pick(POSTER)
    task, pair, _ = look_at_it.call_args.args
    assert pair is tab.state.inputs
    assert "detector looks" in panel.picture.call_args.args[0]
    museum._seen(look(task.folder, task.maps))
    picture, said = panel.picture.call_args.args
    assert picture.startswith("<svg")
    assert [who for who, _ in said] == ["the detector"]
    merged(tab, result, right=False)
    _, said = panel.picture.call_args.args
    assert [who for who, _ in said] == ["the detector", "the laser", "robot 1's map"]
    museum.cure()
    assert tab.state.inputs.known == ()
    merged(tab, result, right=True)
    assert panel.cured.called
    pictures = panel.picture.call_count
    museum.pick(0)
    tab.state.update(palette=tab.state.palette)
    assert panel.picture.call_count == pictures  # the poster is gone
    assert museum._looks.stop.called


def test_what_the_poster_is_taken_for_is_what_section_iii_a_would_measure():
    """The mean of the laser points in the box of the shipped detector, whatever stands there."""
    (folder,) = paths.pictures().values()
    seen = look(folder, paths.samples()["office_r2_r1"])
    box, columns = seen.calibrated.one.detection, seen.calibrated.view.columns
    with np.errstate(invalid="ignore"):
        inside = (columns > box.left) & (columns < box.right) & seen.scan.valid
    x, y = seen.scan.points()[inside].mean(axis=0)
    (shipped,) = read_known(folder / "observation.yaml")
    assert shipped.observer == seen.observer
    assert shipped.range == pytest.approx(np.hypot(x, y), abs=0.25)
    assert shipped.bearing == pytest.approx(np.arctan2(y, x), abs=radians(5))


def test_nobody_knows_of_the_poster_but_its_sighting(exhibit):
    if exhibit.picture:
        wrong, result = failed(exhibit)
        assert wrong
        assert not result.verdict.accepted
        pair, cure = exhibit_inputs(exhibit)
        assert len(pair.observations) == 1
        assert cure.known == ()
        assert exhibit_picture(exhibit).maps == paths.samples()[exhibit.case]


def test_what_is_merged_on_other_maps_is_none_of_the_museums_business(museum, tab, result, inputs):
    museum.enter()
    tab.state.update(inputs=inputs)
    merged(tab, result, right=False)
    tab.panels.museum.failed.assert_not_called()


def test_leaving_puts_back_what_was_there_before_the_visit(museum, tab, inputs):
    tab.state.update(inputs=inputs)
    tab.history.note(tab.state.snapshot())
    before = tab.history.snapshot
    museum.toggle()
    assert tab.state.inputs is not inputs
    museum.toggle()
    museum._undo.go_to.assert_called_once_with(before, "leave the museum")
