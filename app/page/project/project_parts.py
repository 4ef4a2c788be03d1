"""What a project's document says, in plain values of checked types; metres and radians.

What several steps share is written once, in a list, and named by its place there.
"""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.common.source_file import SourceFile
from algorithms.files.truth_file import Truth
from algorithms.fleets.pair_hypotheses import ACCEPT_FROM, PairOrder
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrections
from app.model.knowledge import Choice
from app.page.undo.undo_history import MOST
from app.report.export_frame import AS_MERGED, ExportFrame

FORMAT = 1
MOST_DOCUMENT = 16_000_000  # bytes

Text = Annotated[str, Meta(max_length=4000)]
Name = Annotated[str, Meta(max_length=400)]
Digest = Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
Place = Annotated[int, Meta(ge=0)]
Seed = Annotated[int, Meta(ge=0, lt=2**31)]
Share = Annotated[float, Meta(ge=0, le=1)]
Date = Annotated[float, Meta(ge=0, lt=1e11)]  # seconds since 1970
Three = tuple[float, float, float]


class Part(Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A key that is not known is an error: what it meant would be lost."""


class MapPart(Part):
    """image : the SHA-256 of the image that ``text``, a map's YAML file, is about"""

    image: Digest
    text: Text
    name: Name
    remarks: tuple[Text, ...] = ()
    files: tuple[SourceFile, ...] = ()
    made: Date | None = None


class UploadPart(Part):
    """content : its SHA-256"""

    name: Name
    content: Digest
    by_form: bool = False
    folder: Name = ""
    modified: Date | None = None


class OtherPart(Part):
    name: Name
    told: Text
    used: bool = False
    upload: UploadPart | None = None
    kind: Name = ""


class FilesPart(Part):
    sample: Name = ""
    uploads: dict[Name, UploadPart] = {}
    others: tuple[OtherPart, ...] = ()


class SlotPart(Part):
    map: Place | None = None
    missing: Text = ""
    doubt: Text = ""


class ReadPart(Part):
    """known : all that stood in the file, each as in an observation file"""

    file: SourceFile
    known: tuple[Text, ...]


class InputsPart(Part):
    """known, aside : what is used of what is known, and what is not; each as in an observation file"""

    maps: tuple[SlotPart, SlotPart]
    name: Name = ""
    known: tuple[Text, ...] = ()
    aside: tuple[Text, ...] = ()
    choice: Choice = "nothing"
    truth: Truth | None = None
    names: RobotNames = UNNAMED
    read: ReadPart | None = None


class HypothesisPart(Part):
    T_ref_mov: Pose2
    covariance: tuple[Three, Three, Three]
    probability: Share
    weight: float


class FindingPart(Part):
    """ref, mov, known : the maps that were merged, and with what; each as in an observation file"""

    ref: Place
    mov: Place
    order: PairOrder
    pivot: tuple[float, float]
    reason: Text
    known: tuple[Text, ...] = ()
    hypotheses: tuple[HypothesisPart, ...] = ()
    accepted: bool = False
    accept_from: float = ACCEPT_FROM
    failed: bool = False


class FleetPart(Part):
    """text    : the fleet's YAML file, where maps are named by their places
    findings : places of what was found of its pairs
    merged   : all of them were put together
    """

    text: str
    name: Name = ""
    hidden: tuple[Name, ...] = ()
    findings: tuple[Place, ...] = ()
    merged: bool = False
    opened: PairOrder | None = None


class StepPart(Part):
    """settings : those that are not the method's defaults, by the names of their flags"""

    label: Text
    inputs: Place
    files: Place
    method: Name
    settings: dict[Name, bool | int | float | Name] = {}
    seed: Seed = 0
    goal: Literal["merge", "candidates"] | None = None
    hand: Pose2 | None = None
    taken: Literal["", "by hand", "chosen by you"] = ""
    fleet: Place | None = None
    export: ExportFrame = AS_MERGED
    corrections: Corrections = NO_CORRECTIONS


class ProjectPart(Part, omit_defaults=False):
    """mapmeld : the version that wrote it"""

    format: int
    mapmeld: Name
    position: Place
    steps: Annotated[tuple[StepPart, ...], Meta(min_length=1, max_length=MOST)]
    inputs: Annotated[tuple[InputsPart, ...], Meta(max_length=MOST)]
    files: Annotated[tuple[FilesPart, ...], Meta(max_length=MOST)]
    fleets: Annotated[tuple[FleetPart, ...], Meta(max_length=MOST)]
    findings: tuple[FindingPart, ...]
    maps: tuple[MapPart, ...]
    dark: bool = False
    speed: Name = ""


class Head(Struct):
    """What every format says."""

    format: int
    mapmeld: Name = ""
