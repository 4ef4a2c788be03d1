"""A sighting in words and as data."""

from __future__ import annotations

import json

from looked_at import looked_at

from algorithms.common.pose import Pose2
from app.model.sighting.sighting_text import as_data, box_text, class_name, outcome_text


def test_left_and_right_are_told_apart():
    left, right = (looked_at(Pose2(2.5, y, 0.3))[0] for y in (0.5, -0.5))
    assert "to the left" in outcome_text(left)
    assert "to the right" in outcome_text(right)


def test_a_refusal_gives_its_reason_as_a_sentence():
    refused, _ = looked_at(Pose2(2.5, 0.0, 0.3), wall=2.4)
    assert outcome_text(refused).startswith("No sighting: ")
    assert refused.sighted[0].why_not in box_text(1, refused.sighted[0])


def test_data_are_plain_and_hold_what_was_measured():
    seen, _ = looked_at(Pose2(2.5, 0.5, 0.3))
    told = json.loads(json.dumps(as_data(seen)))
    assert told["measurement"]["range"] == seen.position.range
    assert told["boxes"][0]["class"] == "front_back"
    assert told["chosen"] == 1


def test_classes_have_names_for_people():
    assert class_name("front_back") == "front or back"
    assert class_name("my_robot") == "my robot"
