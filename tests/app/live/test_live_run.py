"""Robots on topics become one map that is told: simulated ones, by a link that is not there."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from explorers import SearchNow, exploration
from fake_link import WRITER, FakeLink
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2, pose_error, rotation
from algorithms.files.bags.message_types import SEEN
from algorithms.files.map_file import write_map
from algorithms.files.observation_file import write_observations
from algorithms.fleets.live_answer import CORRECTED, PLACED, RESTARTED, WITHDRAWN
from algorithms.simulator.fleets.exploration import SlamCorrection
from app.live.live_fleet_file import LiveFleet, read_live_fleet
from app.live.live_frames import LiveFrames
from app.live.live_publisher import MAP, LivePublisher
from app.live.live_run import REFUSED, SIGHTING, LiveRun
from app.live.map_source import TopicSource
from app.live.message_fields import ERROR, OK, grid_message, seen_message, transforms_message
from app.live.ros_link import TF, Topic, map_topic
from app.live.sighting_sources import sighting_of
from app.live.simulation import fleet_text, messages_of

SECOND = 1_000_000_000
CLOSE = 0.3, 0.03


class Demo:
    """Simulated robots, who listens to them, and what that publishes; a scan a second."""

    def __init__(
        self, folder: Path, correction: SlamCorrection | None = None, watched: Path | None = None
    ) -> None:
        """watched : a folder of sightings, in the place of the topics of sightings"""
        self.robots = exploration(correction)
        text = fleet_text(self.robots.names)
        (folder / "fleet.yaml").write_text(text if watched is None else re.sub(", sees: {[^}]*}", "", text))
        self.fleet = read_live_fleet(folder)
        self.link, self.search = FakeLink(), SearchNow()
        self.run = LiveRun(self.fleet, lambda address: self.link, self.search, watched)
        self.publisher = LivePublisher(self.link)
        self.ends: dict[Topic, object] = {}
        self.events: list[tuple[int, str, str]] = []

    def send(self, topic: Topic, fields: object) -> None:
        if topic not in self.ends:
            self.ends[topic] = self.link.advertise(topic)
        self.ends[topic].send(fields)

    def until(self, stop: int, start: int = 0, without: str = "") -> None:
        for scan in range(start, stop):
            for topic, fields in messages_of(self.robots, scan, scan * SECOND // 2):
                if not (without and topic.name.startswith(f"/{without}/")):
                    self.send(topic, fields)
            self.step(scan)
            self.check(scan)

    def step(self, at: float) -> None:
        update = self.run.step(float(at))
        told = (*update.events, *(update.answer.events if update.answer else ()))
        self.events += [(at, event.robot, event.kind) for event in told]
        self.publisher.publish(self.run, update.answer, float(at))

    def check(self, scan: int) -> None:
        """What was published last is right."""
        for name, T in self.transforms().items():
            off = pose_error(T, self.robots.true_transform(name, scan), self.robots.pose(name, scan).xy)
            assert off[0] < CLOSE[0], (scan, name)
            assert off[1] < CLOSE[1], (scan, name)

    def transforms(self) -> dict[str, Pose2]:
        """T_anchor_robot by robot, as the last message tells."""
        found = {}
        for message in self.link.sent("/tf_static")[-1:]:
            for each in message["transforms"]:
                assert each["header"]["frame_id"] == "r1/map"
                shift, q = each["transform"]["translation"], each["transform"]["rotation"]
                turn = 2 * np.arctan2(q["z"], q["w"])
                found[each["child_frame_id"].removesuffix("/map")] = Pose2(shift["x"], shift["y"], turn)
        return found

    def states(self) -> dict[str, tuple[int, str]]:
        status = self.link.sent("/diagnostics")[-1]["status"]
        return {each["name"].removeprefix("mapmeld: "): (each["level"], each["message"]) for each in status}


def test_three_robots_end_in_one_map_that_is_published_with_their_frames(tmp_path):
    demo = Demo(tmp_path)
    demo.until(35)
    assert set(demo.transforms()) == {"r2", "r3"}
    merged = demo.link.sent(MAP)[-1]
    assert merged["header"]["frame_id"] == "r1/map"
    result = demo.run.answer.result
    assert merged["info"]["width"] * merged["info"]["height"] == len(merged["data"])
    np.testing.assert_array_equal(merged["data"], result.islands[0].fusion.merged.cells.ravel())
    assert demo.states() == dict.fromkeys(("r1", "r2", "r3"), (OK, "placed"))
    kinds = [kind for _, _, kind in demo.events]
    assert (kinds.count(PLACED), kinds.count(SIGHTING)) == (2, 4)


def test_before_a_meeting_the_anchor_stands_alone(tmp_path):
    demo = Demo(tmp_path)
    demo.until(20)
    assert demo.transforms() == {}
    assert demo.states()["r2"][1] == "not placed yet"


def test_a_correction_by_slam_is_right_in_what_is_published_or_withdrawn_within_two_updates(tmp_path):
    demo = Demo(tmp_path, SlamCorrection("r2", 28, 3.0))
    demo.until(35)
    assert "r2" in demo.transforms()
    assert (28, "r2", CORRECTED) in demo.events


def test_a_robot_whose_frame_is_another_is_withdrawn_loudly_and_no_longer_published(tmp_path):
    demo = Demo(tmp_path)
    demo.until(30)
    grid = demo.robots.grid("r3", 30)
    demo.send(map_topic("/r3/map"), grid_message(grid, "another/map", 0))
    demo.step(31)
    assert set(demo.transforms()) == {"r2"}
    level, said = demo.states()["r3"]
    assert level == ERROR
    assert said.startswith("not placed")
    assert {(31, "r3", RESTARTED), (31, "r3", WITHDRAWN)} <= set(demo.events)
    assert demo.states()["r2"][0] == OK


def test_a_robot_that_floods_and_sends_rubbish_disturbs_nobody_else(tmp_path):
    demo = Demo(tmp_path)
    topic = map_topic("/r3/map")
    for scan in range(35):
        for _ in range(20):
            demo.send(topic, {"info": {"width": 31623, "height": 31623}})
        demo.until(scan + 1, scan, without="r3")
    assert set(demo.transforms()) == {"r2"}
    assert sum(kind == REFUSED and robot == "r3" for _, robot, kind in demo.events) == 1
    assert demo.states()["r3"][1] == "no map yet"


def test_a_robot_that_stops_keeps_its_place_and_is_told_stale_and_gone(tmp_path):
    demo = Demo(tmp_path)
    demo.until(30)
    demo.step(60)
    assert demo.states()["r2"][1] == "placed, and stale"
    demo.ends[map_topic("/r2/map")].leave()
    demo.step(62)
    assert demo.states()["r2"][1] == "placed, and gone"
    assert "r2" in demo.transforms()


def test_an_observation_file_that_is_put_into_the_folder_counts_as_a_sighting(tmp_path):
    (tmp_path / "seen").mkdir()
    demo = Demo(tmp_path, watched=tmp_path / "seen")
    seen = [each for n in range(24) for each in exploration().seen(n)]
    sighting = next(each for each in seen if (each.observer, each.observed) == ("r2", "r1"))
    demo.until(24)
    assert demo.transforms() == {}
    (tmp_path / "seen" / "r2_saw_r1_in_the_hall.yaml").write_text("observer: {pose: [")
    (tmp_path / "seen" / "walls.yaml").write_text("observer: {}")
    demo.step(25)
    assert sum(kind == REFUSED for _, _, kind in demo.events) == 2
    write_observations(tmp_path / "seen" / "r2_saw_r1_in_the_hall.yaml", [sighting.observation])
    demo.until(35, 26)
    assert set(demo.transforms()) == {"r2"}
    assert sum(kind == REFUSED for _, _, kind in demo.events) == 2  # told once for each version


def test_frames_that_two_robots_call_alike_are_told_by_the_robots_names(tmp_path):
    demo = Demo(tmp_path)
    for name in ("r1", "r2"):
        demo.send(map_topic(f"/{name}/map"), grid_message(demo.robots.grid(name, 5), "map", 0))
    demo.send(map_topic("/r3/map"), grid_message(demo.robots.grid("r3", 5), "robot3_map", 0))
    demo.step(0)
    assert demo.run.frames() == {"r1": "r1/map", "r2": "r2/map", "r3": "robot3_map"}


def test_a_sighting_of_nonsense_is_told_and_the_rest_goes_on(tmp_path):
    demo = Demo(tmp_path)
    seen = Topic("/r1/sees/r2", "geometry_msgs/msg/PoseWithCovarianceStamped", depth=20)
    for x in (float("nan"), 1e9, float("inf")):
        demo.until(3)
        fields = {"header": {"frame_id": "r1/base_link"}, "pose": {"pose": {"position": {"x": x}}}}
        demo.send(seen, fields)
    demo.send(seen, {"header": {"frame_id": "nowhere\x07"}})
    for at in (5, 6):
        demo.step(at)
    assert sum(kind == REFUSED for _, _, kind in demo.events) == 4
    demo.until(35, 7)
    assert set(demo.transforms()) == {"r2", "r3"}


@given(turn=st.floats(-3.0, 3.0), x=st.floats(0.5, 5.0), y=st.floats(-5.0, 5.0))
@settings(max_examples=20, deadline=None)
def test_a_sighting_comes_out_as_it_was_measured_in_whatever_frame_it_was_told(turn, x, y):
    link, sources = FakeLink(), []
    frames = LiveFrames(link)
    T_base_camera = Pose2(0.2, -0.1, turn)
    told = [("map", "base", Pose2(3.0, -2.0, 0.7)), ("base", "camera", T_base_camera)]
    link.advertise(Topic("/tf", TF)).send(transforms_message(told, 0))
    frames.poll()
    for name in ("one", "other"):
        link.advertise(map_topic(name)).send(grid_message(exploration().grid("r1", 5), "map", 0))
        sources.append(TopicSource(name, link, name, frames, "base"))
        sources[-1].poll(0.0)
    there, bearing = np.array([x, y]), np.arctan2(y, x)
    axes = rotation(bearing - turn)
    spread = axes @ np.diag([0.05**2, (0.03 * np.hypot(x, y)) ** 2]) @ axes.T
    place = T_base_camera.inverse().apply(there).tolist()
    message = WRITER.fill(SEEN, seen_message("camera", 0, *place, spread))
    seen = sighting_of("/it", message, *sources)
    o = seen.observation
    assert (seen.observer, seen.observed) == ("one", "other")
    assert (o.range, o.bearing) == pytest.approx((np.hypot(x, y), bearing))
    assert (o.sigma_range, o.sigma_bearing) == pytest.approx((0.05, 0.03))
    np.testing.assert_allclose(o.observer.array(), [3.0, -2.0, 0.7], atol=1e-9)


def test_a_robot_that_has_done_its_work_takes_part_with_its_file(tmp_path):
    demo = Demo(tmp_path)
    write_map(tmp_path / "r3.yaml", demo.robots.grid("r3", 34))
    text = fleet_text(demo.robots.names).splitlines()
    text[3] = "  r3: {map: r3.yaml}"
    (tmp_path / "fleet.yaml").write_text("\n".join(text))
    fleet: LiveFleet = read_live_fleet(tmp_path)
    run = LiveRun(fleet, lambda address: demo.link, SearchNow())
    answer = run.step(0.0).answer
    assert answer is not None
    assert run.frames() == {"r3": "r3/map"}


def test_a_folder_that_is_none_is_refused_before_anything_begins(tmp_path):
    with pytest.raises(InputFileError, match="is no folder"):
        Demo(tmp_path, watched=tmp_path / "none")
