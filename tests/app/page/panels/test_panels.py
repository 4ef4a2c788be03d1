"""What the panels say about inputs and results, without a browser."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import known_to_bytes
from algorithms.files.truth_file import Truth
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, merge, run
from algorithms.methods.steps import CandidatesDetail, HoughDetail
from algorithms.verdict.decision import Outcome
from app.model import chart_data as charts
from app.model.files.map_slots import inputs_of
from app.model.merge_inputs import MergeInputs, Upload
from app.model.run_state import RunState
from app.model.status_text import progress, sentence, typeset
from app.page.editing.observation_panel import observations_html
from app.page.panels.html_widgets import box, table
from app.page.panels.result_panel import result_html
from app.report.result_rows import numbers, times

DEFAULTS = METHODS[DEFAULT_METHOD].defaults


def test_what_is_missing_is_said_in_the_order_of_the_work(inputs):
    assert MergeInputs().missing().startswith("Choose a sample")
    assert "Load map 2" in MergeInputs.pair(ref=inputs.ref).missing()
    assert "Load map 1" in MergeInputs.pair(mov=inputs.mov).missing()
    maps = MergeInputs.pair(inputs.ref, inputs.mov)
    assert maps.missing() == ""  # the walls alone may do
    assert maps.complete
    assert "Place the robots" in maps.knowing((), "sighting").missing()
    assert not maps.knowing((), "initial").complete
    assert "two maps" in MergeInputs.pair(observations=inputs.observations).missing()
    assert inputs.missing() == ""
    assert inputs.complete


def test_a_robot_outside_its_map_is_told_with_the_key_to_check(inputs):
    assert inputs.doubt() == ""
    lost = replace(inputs, observations=(replace(inputs.observations[0], observed_x=1e4),))
    assert "Robot 2" in lost.doubt()
    assert "outside map 2" in lost.doubt()
    assert "observed.pose" in lost.doubt()


def test_of_several_sightings_each_odd_one_is_told_with_its_number(inputs):
    (seen,) = inputs.observations
    lost, astray = replace(seen, observed_x=1e4), replace(seen, observer=Pose2(1e4, 0.0))
    several = replace(inputs, observations=(seen, lost, seen, astray))
    assert several.doubts()[0] == several.doubts()[2] == ""
    assert "Check observed.pose in observation 2." in several.doubt()
    assert "Check observer.pose in observation 4." in several.doubt()


def test_the_panel_has_a_table_per_sighting_and_counts_them_where_there_are_several(inputs):
    assert observations_html(MergeInputs()) == ""
    assert "Observation 1" not in observations_html(inputs)
    near, far = (replace(inputs.observations[0], range=metres) for metres in (1.25, 3.75))
    page = observations_html(replace(inputs, observations=(near, far)))
    told = ["Observation 1 of 2", "1.250 ±", "Observation 2 of 2", "3.750 ±"]
    assert sorted(told, key=page.index) == told


def test_an_odd_sighting_is_told_above_its_own_table(inputs):
    lost = replace(inputs.observations[0], observed_x=1e4)
    page = observations_html(replace(inputs, observations=(inputs.observations[0], lost)))
    assert page.index("Observation 1 of 2") < page.index("outside map 2") < page.index("Observation 2 of 2")


def test_uploads_become_inputs_as_far_as_they_go(inputs):
    files = map_to_bytes(inputs.ref, "m")
    uploads = {"yaml1": Upload("m.yaml", files["m.yaml"])}
    assert inputs_of(uploads).ref is None
    uploads["image1"] = Upload("m.pgm", files["m.pgm"])
    assert np.array_equal(inputs_of(uploads).ref.cells, inputs.ref.cells)
    uploads["observation"] = Upload("o.yaml", known_to_bytes(inputs.observations))
    assert inputs_of(uploads).observations == inputs.observations


def test_a_bad_upload_is_named(inputs):
    with pytest.raises(InputFileError, match=r"o\.yaml: .*; "):
        inputs_of({"observation": Upload("o.yaml", b"range: 3")})


def test_why_comes_before_the_numbers_and_the_sentence_is_repeated_only_where_it_is_out_of_date(
    result, inputs
):
    page = result_html(result, inputs)
    assert page.index("Why ") < page.index("T: Δx") < page.index("time per stage")
    assert result.verdict.reason not in page
    assert "opacity:.4" not in page
    faded = result_html(result, inputs, faded=True)
    assert faded.index(result.verdict.reason) < faded.index("Out of date") < faded.index("Why ")


def test_what_would_help_a_refused_merge_comes_first(result, inputs):
    against = replace(result.verdict, accepted=False, outcome=Outcome.REFUSED, hint="Look again.")
    refused = replace(result, verdict=against)
    page = result_html(refused, inputs)
    assert page.index("Look again.") < page.index("<summary")


def test_eq_23_says_which_overlap_it_is_over(result, inputs):
    with_truth = dict(numbers(result, replace(inputs, truth=Truth(result.T_ref_mov))))
    assert "eq. (23), over the true overlap" in with_truth
    assert with_truth["error to the truth"] == "0.000 m, 0.00°"
    without = dict(numbers(result, replace(inputs, truth=None)))
    assert "eq. (23), at the estimated T" in without
    assert "error to the truth" not in without


def test_the_numbers_say_what_the_verdict_rests_on(result, inputs):
    told = dict(numbers(result, inputs, DEFAULTS))
    assert told["agreement (m of wall)"] == f"{result.value:.2f}"
    assert told["wall in view of both"].endswith(" m")
    assert told["contradicted, patches slipped"].endswith("%")
    assert told["contradicted, as the maps are"].endswith("%")
    assert told["optimum"] == "proven"
    assert told["found by the search"] == "yes"
    assert "rival in doubt" not in told
    assert dict(times(result))["proof"]


def test_a_method_without_a_proof_is_told_by_gamma_and_says_nothing_of_an_optimum(inputs):
    unproven = merge(inputs.ref, inputs.mov, inputs.observations, "spectra-swarm")
    told = dict(numbers(unproven, inputs, METHODS["spectra-swarm"].defaults))
    assert float(told["Γ, eq. (17)"]) == pytest.approx(unproven.value, rel=1e-3)
    assert not {"optimum", "found by the search", "agreement (m of wall)"} & set(told)


def test_a_rival_in_doubt_has_a_row_of_its_own(result, inputs):
    doubted = replace(result, verdict=replace(result.verdict, probability=0.5, ambiguity=0.9, rival=Pose2()))
    told = dict(numbers(doubted, inputs, DEFAULTS))
    assert told["next best place"] == "90% as likely"
    assert "turned" in told["rival in doubt"]


def test_long_words_in_a_table_may_break_and_numbers_may_not():
    assert "white-space:normal" in table([("optimum", "not proven: not all searched: 3,000,000 blocks")])
    assert "white-space:normal" not in table([("T: Δx", "14.634 m")])


def test_words_in_tables_are_never_html():
    assert "<img" not in table([("<img src=x>", "<b>")]) + box("<img src=x>", "plain", "<img>")


def test_every_step_of_a_run_has_a_sentence_and_progress_never_falls(inputs):
    story, shares = RunState(), []
    for step in run("spectra-swarm", inputs.ref, inputs.mov, inputs.observations):
        story.add(step)
        assert sentence(story) != "Starting."
        shares.append(progress(story))
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_a_run_with_several_sightings_says_how_many(inputs):
    several = inputs.observations * 3
    story = RunState()
    story.add(next(run("spectra-swarm", inputs.ref, inputs.mov, several)))
    assert sentence(story) == "Robot 1 saw robot 2 at 3 places: they are in both maps."


def test_the_curves_share_one_axis_and_mark_what_was_chosen(inputs):
    story = RunState()
    for step in run("spectra-swarm", inputs.ref, inputs.mov, inputs.observations):
        story.add(step)
    match, best = story.get(HoughDetail).match, story.get(CandidatesDetail).candidates[0]
    angles, correlation, marks, chosen = charts.turn_correlation(match, best.T_ref_mov.theta).columns
    assert len(angles) == len(correlation) == len(marks) == len(chosen)
    assert np.isfinite(marks).sum() == len(set(np.round(np.mod(match.turns, np.pi), 6)))
    assert np.isfinite(chosen).sum() == 1
    for axis in (best.x, best.y):
        x, window, curve, mark = charts.shift_correlation(axis).columns
        assert (np.diff(x) >= 0).all()
        inside = window > 0
        assert inside.any()
        assert x[inside].min() == pytest.approx(axis.low)
        assert x[inside].max() == pytest.approx(axis.high)
        assert axis.low - 0.1 <= x[np.isfinite(mark)][0] <= axis.high + 0.1
        assert np.isfinite(curve).all()
        x, ref, mov = charts.shift_spectra(axis).columns
        assert len(x) == len(ref) == len(mov)
        assert max(ref.max(), mov.max()) <= 1.0


def test_a_yaml_file_is_read_as_soon_as_it_is_there_and_its_image_asked_for_by_name(inputs):
    files = map_to_bytes(inputs.ref, "floor")
    text = Upload("floor.yaml", files["floor.yaml"].replace(b"floor.pgm", b"../maps/floor.pgm"))
    assert inputs_of({"yaml2": text}).missing() == (
        "Map 2's YAML file is here. Load its image, too: floor.pgm."
    )
    with pytest.raises(InputFileError, match=r"broken\.yaml"):
        inputs_of({"yaml2": Upload("broken.yaml", b"origin: [0,0")})


@given(st.floats(-1e4, 1e4, allow_nan=False))
def test_a_negative_number_has_a_minus_sign_and_nothing_else_changes(value):
    text = f"{value:.3f} m"
    assert typeset(text).replace("−", "-") == text
    assert "-" not in typeset(text)


def test_a_hyphen_in_a_name_stays_one():
    for name in ("map-1.yaml", "floor 2-3", "2026-11-22", "well-known"):
        assert typeset(name) == name
    assert typeset("-1.5, -2 m") == "−1.5, −2 m"


def test_a_map_that_was_read_is_not_read_again_when_another_file_comes(inputs):
    files = map_to_bytes(inputs.ref, "m")
    uploads = {"yaml1": Upload("m.yaml", files["m.yaml"]), "image1": Upload("m.pgm", files["m.pgm"])}
    known = {}
    first = inputs_of(uploads, known).ref
    uploads["observation"] = Upload("o.yaml", b"range: 3")
    with pytest.raises(InputFileError):
        inputs_of(uploads, known)
    uploads["observation"] = Upload("o.yaml", known_to_bytes(inputs.observations))
    assert inputs_of(uploads, known).ref is first
    uploads["yaml1"] = Upload("m.yaml", files["m.yaml"].replace(b"0.05", b"0.1"))
    assert inputs_of(uploads, known).ref.resolution == 0.1
