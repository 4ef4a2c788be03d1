"""The report to read, and what leaves the page: whole, escaped, nothing fetched, refused on top."""

from __future__ import annotations

import hashlib
import io
import json
import re
import zipfile
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import yaml

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import WORDS, RobotNames
from algorithms.files.case_folder import read_case
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import observations_from_bytes
from algorithms.maps.map_fusion import fuse
from algorithms.methods.baselines.base import BaselineConfig
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, merge
from algorithms.methods.shared_stages import Found, finish_merge
from algorithms.observations.pair_problem import PairProblem
from algorithms.verdict.decision import Outcome
from algorithms.verdict.probability_model import Fit, quantities_of, shipped_model
from algorithms.verdict.wall_evidence import Evidence
from app.model.merge_inputs import MergeInputs
from app.page.panels.html_widgets import box
from app.report.html_report import report_page
from app.report.json_report import report_of
from app.report.result_files import ACTED_UPON, ALONE, ResultFiles, zip_bytes
from app.report.ros_transform import publish_command

DEFAULTS = METHODS[DEFAULT_METHOD].defaults
VOID = {"meta"}


def page_of(result: MergeResult, inputs: MergeInputs, config=DEFAULTS, **named: str) -> str:
    return report_page(result, inputs, config, report_of(result, config, inputs=named)).decode()


@pytest.fixture(scope="module")
def page(result, inputs) -> str:
    """The page of the sample's merge."""
    return page_of(result, inputs)


def refused(result: MergeResult) -> MergeResult:
    verdict = replace(
        result.verdict, accepted=False, outcome=Outcome.REFUSED, reason="Refused: the maps disagree."
    )
    return replace(result, verdict=verdict)


class Reader(HTMLParser):
    """What a page holds: its tags, whether each is closed, what it would fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.open: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        self.links += [value for name, value in attrs if name in ("href", "src", "srcset", "action")]

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        self.open.remove(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert reader.open == []
    return reader


def test_the_page_is_whole_and_fetches_nothing(page):
    told = read(page)
    assert "script" not in told.tags
    assert told.links  # the pictures are in it
    assert all(link.startswith("data:image/png;base64,") for link in told.links)
    assert "default-src 'none'" in page
    assert not re.search(r"url\(|@import|\bon\w+=", page)
    assert told.tags.count("svg") == 5  # sources, merge, contradictions, proof, what speaks for it


def test_the_verdict_comes_first_then_pictures_then_numbers(page, result):
    order = [
        result.verdict.reason,
        "Pictures",
        "place by place",
        "<h2>The numbers",
        "Is there a better place?",
    ]
    order += [
        "What was known",
        "How it was merged",
        publish_command(result.T_ref_mov, "map1", "map2"),
        "Made with mapmeld",
    ]
    assert sorted(order, key=page.index) == order
    assert "REFUSED" not in page


def test_a_refused_merge_says_so_at_the_top_and_offers_nothing_to_publish(result, inputs):
    page = page_of(refused(result), inputs)
    assert page.index("<strong>REFUSED</strong>") < page.index("The maps disagree.") < page.index("Pictures")
    assert "<title>Refused: " in page
    assert "static_transform_publisher" not in page
    assert "map_server" not in page


def test_every_name_is_words_and_never_html(result, inputs):
    nasty = "<img src=x onerror=alert(1)>\"'&"
    named = replace(inputs, name=nasty)
    page = page_of(replace(result, method=nasty), named, map1=nasty)
    assert "<img" not in page
    assert page.count("&lt;img src=x onerror=alert(1)&gt;") >= 4  # title, heading, method, file
    read(page)


def test_a_setting_that_was_changed_tells_what_it_usually_is(page, result, inputs):
    assert "usually" not in page
    changed = replace(DEFAULTS, augment=replace(DEFAULTS.augment, spread=2.5))
    assert "<td>2.5 (usually 4)</td>" in page_of(result, inputs, changed)


@pytest.mark.parametrize("method", ["spectra-swarm", "bilateral"])
def test_a_method_without_a_proof_has_a_page_without_one(inputs, method):
    config = METHODS[method].defaults
    page = page_of(merge(inputs.ref, inputs.mov, inputs.observations, method), inputs, config)
    assert "Is there a better place?" not in page
    read(page)


def test_a_proof_that_met_nothing_and_settings_that_are_not_known_still_make_a_page(result, inputs):
    nothing = replace(
        result.proof,
        best=None,
        best_value=-np.inf,
        proven=False,
        stopped="none",
        empty=True,
        rivals=np.zeros((0, 3)),
        rival_values=np.zeros(0),
        **dict.fromkeys(("turns", "ceilings", "found"), np.zeros(0)),
    )
    page = page_of(replace(refused(result), proof=nothing, value=None), inputs, None)
    assert "No transform agrees with every sighting" in page
    assert read(page).tags.count("svg") == 4


def test_maps_that_do_not_touch_make_a_page_that_says_that_nothing_is_shared(page, result, inputs):
    far, nothing = Pose2(30.0, 0.0) @ result.T_ref_mov, Evidence(0.0, 0.0, 0.0, 0.0)
    quantities = quantities_of(Fit(nothing, 50.0))
    named = replace(
        result.weighed[0],
        T_ref_mov=far,
        evidence=nothing,
        quantities=quantities,
        score=shipped_model().score(quantities),
    )
    problem = PairProblem(inputs.ref, inputs.mov, inputs.observations)
    found = Found(named, None, result.covariance, result.answers, None)
    fusion = fuse((inputs.ref, inputs.mov), (Pose2(), far))
    ended = finish_merge(problem, found, fusion, BaselineConfig(), result.method, 0, {})
    told = page_of(ended, inputs)
    read(told)
    assert told.index("<strong>REFUSED</strong>") < told.lower().index("no wall was seen by both robots")
    assert "no wall was seen by both robots" not in page.lower()
    rows = dict(re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]><td[^>]*>([^<]*)</td>", told))
    assert rows["wall in view of both"] == "0.0 m"


def test_the_page_is_the_same_for_the_same_result_and_date(result, inputs, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    page = page_of(result, inputs)
    assert page_of(result, inputs) == page
    assert '<p class="made">2023-11-14T22:13:20Z, mapmeld ' in page
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000001")
    assert page_of(result, inputs) == page.replace("22:13:20Z", "22:13:21Z")


def test_the_page_tells_the_files_by_their_hashes_and_what_is_no_default(page, result, case_folder):
    assert "All settings are the method&#x27;s defaults." in page
    pair = replace(MergeInputs.of(read_case(case_folder)), names=RobotNames("Bob", "Alice"))
    changed = replace(DEFAULTS, augment=replace(DEFAULTS.augment, spread=2.5))
    told = report_page(result, pair, changed, report_of(result, changed, pair=pair)).decode()
    read(told)
    assert "1 setting differs from the method&#x27;s defaults: σ_aug spread (m)." in told
    image = hashlib.sha256((case_folder / "map2.pgm").read_bytes()).hexdigest()
    assert f"<td>Alice&#x27;s map</td><td>map2.pgm</td><td>{image}</td>" in told
    assert "<h1>flat_1: Bob saw Alice</h1>" in told


def test_the_archive_reads_back_to_what_was_merged(result, inputs, tmp_path):
    harvest = ResultFiles(result, inputs, DEFAULTS)
    with zipfile.ZipFile(io.BytesIO(zip_bytes(harvest.files))) as packed:
        assert set(packed.namelist()) == set(ALONE)
        assert set(ACTED_UPON) < set(ALONE)
        packed.extractall(tmp_path)
    merged = read_map(tmp_path / "merged.yaml")
    assert np.array_equal(merged.cells, result.fusion.merged.cells)
    told = yaml.safe_load((tmp_path / "transform.yaml").read_text())
    assert Pose2(**told["T_ref_mov"]) == result.T_ref_mov
    seen = observations_from_bytes("o.yaml", (tmp_path / "observation.yaml").read_bytes())
    again = merge(inputs.ref, inputs.mov, seen)
    assert again.T_ref_mov.x == pytest.approx(result.T_ref_mov.x, abs=1e-3)
    assert inputs.name in (tmp_path / "report.json").read_text("utf-8")


def test_a_sentence_that_is_out_of_date_is_greyed():
    assert "opacity:.4" in box("Out of date.", "plain", faded=True)


def test_the_files_of_a_fleets_pair_name_its_robots(result, inputs):
    known = replace(inputs, names=RobotNames("Bob", "<Alice>"))
    cause = "Mirrored, map 2 agrees on 90% of 20 m of wall: is its lidar mounted upside down?"
    for each in (result, refused(result).with_hint(cause)):
        files = {
            name: data.decode()
            for name, data in ResultFiles(each, known, DEFAULTS).files.items()
            if name.endswith((".html", ".json", "transform.yaml", "observation.yaml"))
        }
        for name, text in files.items():
            assert WORDS.search(re.sub(r'base64,[^"]*', "", text)) is None, name
        assert "<Alice>" not in files["report.html"]
        assert "what Bob saw of &lt;Alice&gt;" in files["report.html"]
        assert "# of <Alice>, as Bob saw it" in files["observation.yaml"]
        assert observations_from_bytes("o.yaml", files["observation.yaml"].encode()) == inputs.observations
    assert "Mirrored, &lt;Alice&gt;&#x27;s map agrees" in files["report.html"]
    told = yaml.safe_load(ResultFiles(result, known, DEFAULTS).files["transform.yaml"])
    assert told["publish"].endswith("--frame-id bob/map --child-frame-id '<alice>/map'")
    report = json.loads(files["report.json"])
    assert (report["inputs"]["robot1"], report["inputs"]["robot2"]) == ("Bob", "<Alice>")
    assert "Alice" in report["verdict"]["hint"]
