"""What was corrected, in words."""

from __future__ import annotations

from dataclasses import replace

from drawn import drawn_map

from algorithms.common.pose import Pose2
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrections, Edit
from algorithms.maps.map_fusion import ConflictRule, fuse
from app.report.correction_text import RULES, said, step_label, why

ERASED = Edit("erase", ((0.0, 0.0),), 0.2)
LINE = Edit("keep-out", ((0.0, 0.0), (1.0, 0.0)))


def test_every_rule_has_words():
    assert set(RULES) == set(ConflictRule)


def test_all_that_was_corrected_is_told_in_one_sentence():
    made = Corrections(ConflictRule.REF_WINS, (ERASED, LINE, ERASED), crop=True)
    assert said(made, 1234) == (
        "Corrected by hand: where the maps contradict, map 1 counts, 2 parts erased, 1 keep-out line, "
        "cropped to what is known. 1,234 cells changed."
    )
    assert said(NO_CORRECTIONS, 0) == ""


def test_a_step_is_called_by_what_was_done():
    one = Corrections(edits=(ERASED,))
    assert step_label(NO_CORRECTIONS, one) == "part erased"
    assert step_label(one, replace(one, edits=(ERASED, LINE))) == "keep-out line"
    assert step_label(one, NO_CORRECTIONS) == "all corrections taken back"
    assert step_label(NO_CORRECTIONS, Corrections(ConflictRule.NEWER_WINS)) == (
        "contradictions: the newer map counts"
    )
    assert step_label(NO_CORRECTIONS, Corrections(crop=True)) == "crop to known"


def test_why_the_newer_map_counts_is_told_with_both_dates():
    one, two = (replace(drawn_map(Pose2()), made=day * 86_400.0) for day in (20_000, 20_010))
    told = why(ConflictRule.NEWER_WINS, fuse((one, two), (Pose2(), Pose2())))
    assert told == "Map 2 is newer: map 1 was written on 2024-10-04 00:00, map 2 on 2024-10-14 00:00."
    same = fuse((one, one), (Pose2(), Pose2()))
    assert "not known" in why(ConflictRule.NEWER_WINS, same)
    assert "how often" in why(ConflictRule.SURER_WINS, same)
    assert why(ConflictRule.REF_WINS, same) == ""
