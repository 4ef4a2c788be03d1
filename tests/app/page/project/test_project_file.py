"""A project is what it was once it is opened again, and a damaged one is refused in words."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError, MapMergeError, TooLargeError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import RobotNames
from algorithms.common.source_file import SourceFile
from algorithms.files.truth_file import Truth
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_corrections import Corrections, Edit
from algorithms.maps.map_fusion import ConflictRule
from algorithms.methods.merge_result import BY_HAND, CHOSEN
from algorithms.methods.registry import METHODS
from algorithms.observations.fleet import Fleet, FleetPrior, FleetSighting
from algorithms.observations.observation import Observation
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from app.model.fleet_state import FleetState
from app.model.knowledge import CHOICES
from app.model.merge_inputs import Files, MapSlot, MergeInputs, OtherFile, Upload
from app.model.settings import settings_of, with_value
from app.page.project import project_file, project_parts
from app.page.project.project_file import project_from_bytes, project_name, project_to_bytes
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_history import SavedTab, UndoStep
from app.report.export_frame import ExportFrame

RANDOM = np.random.default_rng(5)
MAPS = [
    GridMap(
        RANDOM.choice([UNKNOWN, FREE, 40, OCCUPIED], (7, 9)).astype(np.int8), 0.05, Pose2(-1.5, 1 / 3, 0.1)
    ),
    GridMap(
        np.full((4, 3), FREE, dtype=np.int8), 0.1, name="hall", remarks=("it is odd; see to it",),
        files=(SourceFile.of("hall.yaml", b"x"),), made=1.7e9,
    ),
    GridMap(np.full((4, 3), FREE, dtype=np.int8), 0.1, Pose2(1e6, -1e6, -3.0), "the same, elsewhere"),
]  # fmt: skip
SEEN = Observation(Pose2(0.1, 0.2, 0.3), 1.0, 2.0, 2.5, -0.4, bearing_back=1.0)
UPLOADS = [
    Upload("hall.pgm", b"P5"),
    Upload("hall.yaml", b"image: hall.pgm", by_form=True, folder="maps", modified=1.7e9),
]

metres, radians = st.floats(-100, 100), st.floats(-3, 3)
poses = st.builds(Pose2, metres, metres, radians)
known = st.one_of(
    st.builds(Observation, poses, metres, metres, st.floats(0, 50), radians, st.none() | radians),
    st.builds(InitialPose, poses, about_x=metres),
    st.builds(TurnPrior, radians),
    st.builds(NearPlace, metres, metres, metres, metres),
)
names = st.sampled_from([RobotNames(), RobotNames("Bob", "Ålice's 2nd")])


@st.composite
def configs(draw: st.DrawFn) -> tuple[str, Any]:
    """A method, and settings that it may have."""
    method = draw(st.sampled_from(sorted(METHODS)))
    config = METHODS[method].defaults
    for each in draw(st.lists(st.sampled_from(list(settings_of(config))), max_size=4)):
        if each.choices is not None:
            value = draw(st.sampled_from(list(each.choices.values())))
        elif each.bounds is None:
            value = draw(st.booleans())
        else:
            low, high = each.bounds.low, each.bounds.high
            value = draw(st.integers(int(low) + 1, int(high)) if each.whole else st.floats(low, high))
        config = with_value(config, each.path, value)
    return method, config


@st.composite
def inputs(draw: st.DrawFn) -> MergeInputs:
    slots = (MapSlot(missing="load it", doubt="odd"), *map(MapSlot, MAPS))
    pair = MergeInputs(
        (draw(st.sampled_from(slots)), draw(st.sampled_from(slots))), name=draw(st.text("ab "))
    )
    pair = replace(pair, names=draw(names), truth=draw(st.none() | st.builds(Truth, poses)))
    told = draw(st.lists(known, max_size=3))
    pair = pair.knowing(told, draw(st.none() | st.sampled_from(sorted(CHOICES))))
    return pair.read_from(SourceFile.of("seen.yaml", b"y")) if draw(st.booleans()) else pair


@st.composite
def fleets(draw: st.DrawFn) -> FleetState:
    fleet = Fleet(
        {"a": MAPS[0], "b": MAPS[1], "c": MAPS[2]},
        (FleetSighting("a", "b", SEEN),),
        (FleetPrior("b", "c", TurnPrior(0.5)),),
        draw(st.sampled_from("abc")),
    )
    state = FleetState(fleet, "three", frozenset(draw(st.sets(st.sampled_from("abc")))))
    orders = [PairOrder("a", "b", (0,)), PairOrder("b", "c", ()), PairOrder("a", "c", ())]
    for order in draw(st.lists(st.sampled_from(orders), max_size=3)):
        answer = Hypothesis(draw(poses), RANDOM.random((3, 3)), draw(st.floats(0, 1)), draw(metres))
        state = state.with_finding(PairFinding(order, RANDOM.random(2), (answer,), "map 1 and map 2 lie so"))
    return replace(state, opened=draw(st.none() | st.sampled_from(orders)), again=draw(st.booleans()))


uploads = st.dictionaries(st.sampled_from(["yaml1", "image1", "known"]), st.sampled_from(UPLOADS))
other = st.builds(
    OtherFile, st.just("a"), st.just("waits"), st.booleans(), st.none() | st.sampled_from(UPLOADS)
)
others = st.tuples(other)
frames = st.builds(
    ExportFrame, st.sampled_from(["ref", "mov"]) | poses, st.booleans(), st.none() | st.floats(0.01, 1)
)

edits = st.builds(
    Edit,
    st.sampled_from(["map1", "unknown", "erase", "keep-out"]),
    st.tuples(st.tuples(metres, metres), st.tuples(metres, metres)),
    st.floats(0, 2),
    st.booleans(),
)
corrections = st.builds(
    Corrections,
    st.none() | st.sampled_from(ConflictRule),
    st.tuples() | st.tuples(edits, edits),
    st.booleans(),
)


@st.composite
def snapshots(draw: st.DrawFn) -> PageSnapshot:
    return PageSnapshot(
        draw(inputs()),
        Files(draw(st.sampled_from(["", "office"])), draw(uploads), draw(others)),
        *draw(configs()),
        draw(st.integers(0, 2**31 - 1)),
        draw(st.sampled_from([None, "merge", "candidates"])),
        draw(st.none() | poses),
        fleet=draw(st.none() | fleets()),
        export=draw(frames),
        taken=draw(st.sampled_from(["", BY_HAND, CHOSEN])),
        corrections=draw(corrections),
    )


@st.composite
def tabs(draw: st.DrawFn) -> SavedTab:
    """Steps of which some share their inputs and files, as those of a history do."""
    first = draw(st.lists(snapshots(), min_size=1, max_size=3))
    shared = [replace(each, seed=7) for each in first]
    steps = [UndoStep(draw(st.text("load ", max_size=9)), each) for each in (*first, *shared)]
    return SavedTab(tuple(steps), draw(st.integers(0, len(steps) - 1)), draw(st.booleans()), "Normal")


def plain(value: Any) -> Any:
    """A value as texts, lists and numbers that can be compared."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if is_dataclass(value) and not isinstance(value, type):
        return [type(value), *(plain(getattr(value, each.name)) for each in fields(value))]
    if isinstance(value, dict):
        return [(plain(key), plain(each)) for key, each in value.items()]
    if isinstance(value, (tuple, list)):
        return [plain(each) for each in value]
    return repr(value) if isinstance(value, Enum) else value


@given(tabs())
@settings(max_examples=60)
def test_a_project_that_is_opened_is_what_was_saved(saved):
    opened = project_from_bytes("p", project_to_bytes(saved))
    assert plain(opened) == plain(saved)
    shared = len({id(step.snapshot.inputs) for step in saved.steps})
    assert len({id(step.snapshot.inputs) for step in opened.steps}) == shared  # undo goes by that
    grids = [grid for step in opened.steps for grid in step.snapshot.inputs.grids]
    assert len({id(grid) for grid in grids}) == len({(grid.name, grid.origin) for grid in grids})


START = PageSnapshot(
    MergeInputs.pair(MAPS[0], MAPS[1], (SEEN,), "two rooms"),
    Files("", {"image2": UPLOADS[0]}),
    "spectra-swarm",
    with_value(METHODS["spectra-swarm"].defaults, ("augment", "spread"), 4.5),
    3,
)
SAVED = SavedTab((UndoStep("load", START), UndoStep("merge", replace(START, goal="merge"))), 1)
GOOD = project_to_bytes(SAVED)


META = b"image: m.pgm"


def changed(change: Callable[[dict[str, Any]], object], *more: bytes) -> bytes:
    """The good project with another document, and with more files."""

    def packed(name: str, content: bytes) -> bytes:
        if name != "project.json":
            return content
        document = json.loads(content)
        change(document)
        return json.dumps(document).encode()

    files = {f"files/{Upload('', each).digest}": each for each in more}
    return zipped({name: packed(name, content) for name, content in unzipped(GOOD).items()} | files)


def unzipped(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as packed:
        return {name: packed.read(name) for name in packed.namelist()}


def zipped(files: dict[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as target:
        for name, content in files.items():
            target.writestr(name, content)
    return packed.getvalue()


def put(*keys: Any, value: Any) -> Callable[[dict[str, Any]], object]:
    def change(document: Any) -> None:
        for key in keys[:-1]:
            document = document[key]
        document[keys[-1]] = value

    return change


BAD = {
    "no zip": (b"hello", "is no zip"),
    "half of it": (GOOD[: len(GOOD) // 2], "is no zip"),
    "another zip": (zipped({"map.pgm": b"x"}), "is no project: it has no project.json"),
    "no document": (zipped({"project.json": b"[1, 2"}), "is no project that can be read"),
    "another format": (
        changed(lambda d: d.update(format=2, mapmeld="9.0", more=1)),
        "is of format 2, which mapmeld 9.0 wrote; open it with that version; this one reads 1",
    ),
    "a key that is not known": (changed(lambda d: d.update(more=1)), "unknown field `more`"),
    "a file is missing": (zipped({"project.json": unzipped(GOOD)["project.json"]}), "lacks the file "),
    "a file has changed": (
        zipped({k: v if k == "project.json" else v + b"\n" for k, v in unzipped(GOOD).items()}),
        "that has changed",
    ),
    "another file's name": (changed(put("maps", 0, "image", value="../x")), "$.maps[0].image"),
    "a map that is not there": (changed(put("inputs", 0, "maps", 1, "map", value=9)), "names map 9, which"),
    "a place below 0": (changed(put("steps", 0, "inputs", value=-1)), "$.steps[0].inputs"),
    "inputs that are not there": (changed(put("steps", 0, "inputs", value=1)), "names inputs 1, which"),
    "a step that is not there": (changed(put("position", value=2)), "names step 2, which is not there"),
    "no steps": (changed(put("steps", value=[])), "$.steps"),
    "a method": (changed(put("steps", 0, "method", value="magic")), "merges by magic, a method that"),
    "a setting": (
        changed(put("steps", 0, "settings", value={"augment.sprad": 1})),
        "no setting augment.sprad; did you mean augment.spread?",
    ),
    "its value": (changed(put("steps", 0, "settings", value={"augment.spread": 1e9})), "must lie in"),
    "its kind": (changed(put("steps", 0, "settings", value={"augment.spread": True})), "which it cannot be"),
    "what is known": (changed(put("inputs", 0, "known", value=["observer: 1"])), "observer is"),
    "robots of one name": (changed(put("inputs", 0, "names", value={"ref": "A", "mov": "A"})), "both robots"),
    "a number that is none": (changed(put("steps", 0, "hand", value={"x": "far"})), "$.steps[0].hand"),
    "another file for an image": (
        changed(put("maps", 0, "image", value=Upload("m.yaml", META).digest), META),
        "for the image of a map, which it is not",
    ),
    "a place too far": (changed(put("steps", 0, "hand", value={"x": 1e300})), "no frame lies at 1e+300"),
    "cells of nothing": (changed(put("steps", 0, "export", value={"resolution": 0})), "in cells of 0 m"),
    "a map's size": (changed(put("maps", 0, "text", value="image: a")), "resolution is missing"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_project_that_cannot_be_used_is_refused_in_one_line_that_names_it(case):
    content, words = BAD[case]
    with pytest.raises(MapMergeError) as caught:
        project_from_bytes("rooms.mapmeld", content)
    assert str(caught.value).startswith("rooms.mapmeld: ")
    assert words in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1
    assert isinstance(caught.value, InputFileError)


def test_a_history_that_is_too_large_is_left_out_and_a_page_that_is_too_large_is_told(monkeypatch):
    monkeypatch.setattr(project_parts, "MOST_DOCUMENT", len(unzipped(GOOD)["project.json"]) - 1)
    opened = project_from_bytes("p", project_to_bytes(SAVED))
    assert [step.label for step in opened.steps] == ["merge"]
    monkeypatch.setattr(project_file, "MOST_UNPACKED", 100)
    with pytest.raises(TooLargeError, match="more than 0 MB"):
        project_to_bytes(SAVED)


def test_its_file_is_called_after_the_pair():
    assert project_name("two rooms: Bob/Ålice") == "two_rooms_Bob_Ålice.mapmeld"
    assert project_name("../") == "project.mapmeld"
