"""The known answer of a test case, and reading and writing the file that holds it."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import Literal

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.files import yaml_fields as fields
from algorithms.files.map_file import read_bytes
from algorithms.files.yaml_fields import Fields, number_text, optional_number, positive_number, quoted

TRUTH_FILE = "truth.yaml"


@dataclass(frozen=True)
class Truth:
    """The known answer of a test case.

    T_ref_mov     : takes points of map 2's frame to map 1's; None where the maps share no place
    tolerance_m   : metres; how near counts as right, at the observed robot
    tolerance_rad : radians
    expected      : what a merge should end with
    overlap       : share of the smaller map's occupied cells that both maps hold; None: not known
    truth_rms     : metres; residual of the truth itself; None: not known
    """

    T_ref_mov: Pose2 | None
    tolerance_m: float = 0.5
    tolerance_rad: float = radians(3)
    expected: Literal["merge", "refuse"] = "merge"
    overlap: float | None = None
    truth_rms: float | None = None
    source: str = ""
    licence: str = ""

    def __post_init__(self) -> None:
        if self.expected == "merge" and self.T_ref_mov is None:
            raise SettingError("truth: a case that should merge needs its T_ref_mov")
        if not (self.tolerance_m > 0 and self.tolerance_rad > 0):
            raise SettingError("truth: both tolerances must be positive")

    def allows(self, distance: float, angle: float) -> bool:
        """Whether a transform that is off by so much is right; metres at the observed robot, radians."""
        return distance <= self.tolerance_m and angle <= self.tolerance_rad


def read_truth(path: Path) -> Truth:
    """Read a truth file; raises InputFileError.

    Keys that resemble none of ours are passed over: people note more about a case than we read.
    """
    path = Path(path)
    f = fields.parse(str(path), read_bytes(path, "a truth"), "a truth's YAML file")
    f.refuse_unknown(
        *("T_ref_mov", "tolerance", "expected", "overlap", "truth_rms", "source", "licence"),
        near_only=True,
    )
    expected: Literal["merge", "refuse"] = "merge"
    if f.values.get("expected") == "refuse":
        expected = "refuse"
    elif f.values.get("expected", "merge") != "merge":
        found = fields.shown(f.values["expected"])
        raise f.error("expected", f"is {found}", "give merge or refuse")
    T_ref_mov = None
    if expected == "merge" or "T_ref_mov" in f.values:
        t = f.section("T_ref_mov", "add T_ref_mov: {x: m, y: m, theta: rad}, or expected: refuse")
        t.refuse_unknown("x", "y", "theta")
        units = {"x": "metres", "y": "metres", "theta": "radians"}
        T_ref_mov = Pose2(*(t.number(key, f"give {unit}") for key, unit in units.items()))
    usual = Truth(None, expected="refuse")
    tolerance = Fields(f.source, {}, "tolerance.")
    if "tolerance" in f.values:
        tolerance = f.section("tolerance", "give {distance: m, angle: rad}")
        tolerance.refuse_unknown("distance", "angle")
    return Truth(
        T_ref_mov=T_ref_mov,
        tolerance_m=positive_number(tolerance, "distance", "m", usual.tolerance_m),
        tolerance_rad=positive_number(tolerance, "angle", "rad", usual.tolerance_rad),
        expected=expected,
        overlap=optional_number(f, "overlap", "give a share in [0, 1], or leave it out"),
        truth_rms=optional_number(f, "truth_rms", "give metres, or leave it out"),
        source=str(f.values.get("source", "")),
        licence=str(f.values.get("licence", "")),
    )


def truth_to_bytes(truth: Truth) -> bytes:
    """The content of a truth file; it reads back to an equal Truth."""
    n, T = number_text, truth.T_ref_mov
    values = {
        "T_ref_mov": T and f"{{x: {n(T.x)}, y: {n(T.y)}, theta: {n(T.theta)}}}",
        "tolerance": f"{{distance: {n(truth.tolerance_m)}, angle: {n(truth.tolerance_rad)}}}",
        "overlap": None if truth.overlap is None else n(truth.overlap),
        "truth_rms": None if truth.truth_rms is None else n(truth.truth_rms),
        "expected": truth.expected,
        "source": truth.source and quoted(truth.source),
        "licence": truth.licence and quoted(truth.licence),
    }
    return "".join(f"{key}: {value}\n" for key, value in values.items() if value).encode()
