"""Methods to compare with, in the page: what is seen of them, and how a refusal without a place looks."""

from __future__ import annotations

from dataclasses import replace

import pytest
from driver import settle

from algorithms.methods.baselines.feature_detectors import OrbConfig
from algorithms.methods.baselines.feature_matching import FeatureConfig, MatchConfig
from algorithms.methods.registry import METHODS
from app.drawing.palette import LIGHT, css
from app.page.page_state import PageState

pytestmark = pytest.mark.browser


def test_matched_features_are_drawn_and_those_that_agree_run_side_by_side(tab):
    tab.choose("Method", METHODS["sift"].title)
    tab.press("Slow")
    tab.press("Merge")
    settle(lambda: "look alike" in tab.state, "the matches")
    settle(lambda: len(tab.layer("matches")) > 50, "their lines")
    settle(lambda: "agree on one transform" in tab.state, "the transform")

    def agreeing():
        strong = css(LIGHT.best, 0.9)
        paths = [item for item in tab.layer("matches") if item["k"] == "path"]
        return [path["p"] for path in paths if path["c"] == strong]

    settle(lambda: len(agreeing()) > 20, "the lines that agree")
    ways = [(b[0] - a[0], b[1] - a[1]) for a, b in agreeing()]
    for axis in (0, 1):
        along = [way[axis] for way in ways]
        assert max(along) - min(along) < 1.3  # twice the tolerance, and what a turn leaves; metres
    tab.press("Instant")
    tab.wait_for("accepted")
    assert tab.layer("matches") == []
    settle(lambda: tab.number("matches that agree") not in {"", "0"}, "their number")


def test_a_method_without_an_answer_refuses_and_takes_the_old_answer_away(tab, monkeypatch):
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    assert "Difference" in tab.text

    job = PageState.job
    blind = FeatureConfig(detector=OrbConfig(contrast=100), match=MatchConfig(least=50))
    monkeypatch.setattr(PageState, "job", lambda page, **how: replace(job(page, **how), config=blind))
    tab.choose("Method", METHODS["orb"].title)
    tab.wait_for("refused")
    said = tab.state
    assert said.startswith("Refused: ")
    assert "agree on a transform, and 50 must" in said
    settle(lambda: "Difference" not in tab.text, "the comparison to go")
    settle(lambda: "After a merge it can be taken away" in tab.text, "nothing to take away")
    settle(lambda: tab.text.count(said) == 3, "the reason, once of them for screen readers alone")
    tab.page.get_by_role("button", name="Undo").click()
    tab.wait_for("accepted")
