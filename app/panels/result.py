"""The answer: a sentence first, then the numbers it rests on."""

from __future__ import annotations

from math import degrees, sqrt

from algorithms.fuse import fuse
from algorithms.pose import pose_error
from algorithms.steps import MergeResult
from app import words
from app.inputs import Inputs
from app.panels.tables import box, table

STAGES = {
    "observe": "observation",
    "augment": "augmentation",
    "spectra": "Hough spectra",
    "search": "candidates",
    "refine": "swarm",
    "fuse": "merged cells",
    "verdict": "verdict",
}


def result_html(result: MergeResult, inputs: Inputs, faded: bool = False) -> str:
    """HTML of the whole result; faded where it is out of date."""
    verdict = result.verdict
    mood = "accepted" if verdict.accepted else "refused"
    note = "Out of date: a setting was changed." if faded else words.remedy(result)
    return (
        box(verdict.reason, mood, note, faded)
        + table(numbers(result, inputs), faded=faded)
        + table(times(result), ("time per stage", "ms"), faded)
    )


def numbers(result: MergeResult, inputs: Inputs) -> list[tuple[str, ...]]:
    """The transform with its standard deviations, Γ, and the figures of merit."""
    T, verdict = result.T_ref_mov, result.verdict
    sx, sy, st = (sqrt(max(0.0, float(result.covariance[k, k]))) for k in range(3))
    rows = [
        ("T: Δx", f"{T.x:.3f} ± {sx:.3f} m"),
        ("T: Δy", f"{T.y:.3f} ± {sy:.3f} m"),
        ("T: Δθ", f"{degrees(T.theta):.2f} ± {degrees(st):.2f}°"),
        ("Γ, eq. (17)", f"{result.value:.5g}"),
    ]
    truth = inputs.truth.T_ref_mov if inputs.truth else None
    if truth is not None and inputs.ref is not None and inputs.mov is not None:
        true_overlap = fuse(inputs.ref, inputs.mov, truth).overlap
        share = min(1.0, result.fusion.agreed / true_overlap) if true_overlap else 0.0
        rows.append(("eq. (23), over the true overlap", f"{share:.1%}"))
        apart, turned = pose_error(result.T_ref_mov, truth, result.encounter.x_mov)
        rows.append(("error to the truth", f"{apart:.3f} m, {degrees(turned):.2f}°"))
    else:
        rows.append(("eq. (23), at the estimated T", f"{verdict.acceptance_index:.1%}"))
    rows += [
        ("acceptance index", f"{verdict.acceptance_index:.1%}"),
        ("area known to both", f"{verdict.overlap_area:.1f} m²"),
        ("contradicting cells", f"{verdict.conflicting_cells}"),
        ("next best Γ", f"{verdict.ambiguity:.0%} of the best"),
        ("robot 2 off its sighting", f"{verdict.deviation:.1f} σ"),
        ("optimum", "proven" if result.proven_optimal else "best found"),
        ("seed", f"{result.seed}"),
    ]
    return rows


def times(result: MergeResult) -> list[tuple[str, ...]]:
    """Milliseconds per stage, and their sum."""
    rows = [
        (STAGES.get(stage, stage), f"{1000 * seconds:.1f}") for stage, seconds in result.timings_s.items()
    ]
    return [*rows, ("all", f"{1000 * sum(result.timings_s.values()):.1f}")]
