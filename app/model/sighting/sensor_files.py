"""What was loaded of the moment in which robot 1 saw robot 2, and what is missing or does not fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import degrees
from pathlib import PurePath
from typing import Generic, TypeVar

from algorithms.common.errors import InputFileError
from algorithms.detection.model_file import model_from_bytes
from algorithms.detection.svm_detector import DetectorModel
from algorithms.files.camera_file import camera_from_bytes
from algorithms.files.camera_picture import picture_from_bytes
from algorithms.files.encounter_table import EncounterRow, encounters_from_bytes
from algorithms.files.scan_file import scan_from_bytes
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from app.model.files.file_kinds import KINDS, UNKNOWN, FileKind, kind_of_file
from app.model.merge_inputs import Upload
from app.model.sighting.look_settings import LookSettings

T = TypeVar("T")

NONE = "is neither an image, nor a camera's calibration, nor a laser scan"
GIVE = "give a JPEG or PNG, the camera's camera.yaml, or the laser's scan.yaml"
# what else it may be here; whose reader tells of zips that are no detector
ALSO: Mapping[FileKind, FileKind] = {"image": "picture", "zip": "model"}


@dataclass(frozen=True, eq=False)
class ReadFile(Generic[T]):
    """A file of this name, and what it holds."""

    name: str
    holds: T


@dataclass(frozen=True, eq=False)
class CameraPicture:
    """An image as it came, which takes less memory than its pixels, and its size in pixels."""

    file: Upload
    width: int
    height: int

    @property
    def size(self) -> str:
        return f"{self.width} × {self.height}"


@dataclass(frozen=True, eq=False)
class SensorFiles:
    """None for what is not there.

    row : which line of the encounters belongs to the picture; None: none does
    """

    picture: CameraPicture | None = None
    camera: ReadFile[Camera] | None = None
    scan: ReadFile[LaserScan] | None = None
    model: ReadFile[DetectorModel] | None = None
    encounters: ReadFile[tuple[EncounterRow, ...]] | None = None
    row: int | None = None

    def with_file(self, upload: Upload) -> tuple[SensorFiles, FileKind]:
        """The same with one file more, and what it is, by its content; raises InputFileError."""
        name, content = upload.name, upload.content
        kind = _kind_of(name, content)
        if kind == "picture":
            height, width = picture_from_bytes(name, content).shape[:2]
            return _checked_together(replace(self, picture=CameraPicture(upload, width, height))), kind
        if kind == "camera":
            return replace(self, camera=ReadFile(name, camera_from_bytes(name, content))), kind
        if kind == "scan":
            return replace(self, scan=ReadFile(name, scan_from_bytes(name, content))), kind
        if kind == "model":
            return replace(self, model=ReadFile(name, model_from_bytes(name, content))), kind
        rows = encounters_from_bytes(name, content)
        return _checked_together(replace(self, encounters=ReadFile(name, rows))), kind

    @property
    def encounter(self) -> EncounterRow | None:
        """Where the robots stood, as the table has it."""
        return None if self.encounters is None or self.row is None else self.encounters.holds[self.row]

    @property
    def any(self) -> bool:
        """Whether anything is there."""
        return bool(self.picture or self.camera or self.scan or self.model or self.encounters)

    def told(self, settings: LookSettings) -> Mapping[str, str]:
        """What to say of each file; "" for what is missing. Those that nobody needs are left out."""
        fov = settings.field_of_view
        view = f"field of view {degrees(fov):g}°" if fov else ""
        told = {
            "Image": f"{self.picture.file.name}, {self.picture.size}" if self.picture else "",
            "Camera": f"{self.camera.name}, {self.camera.holds.degrees_wide():.0f}° wide"
            if self.camera
            else view,
            "Laser scan": f"{self.scan.name}, {len(self.scan.holds.ranges):,} beams" if self.scan else "",
        }
        if self.model is not None or settings.finder == "own":
            told["Detector"] = self.model.name if self.model else ""
        if self.encounters is not None:
            line = f", line {self.row + 2}" if self.row is not None else ", no line names the image"
            told["Encounters"] = self.encounters.name + line
        return told

    def fault(self) -> str:
        """What does not belong together, as a sentence; "" where all does."""
        if self.picture is None or self.camera is None:
            return ""
        camera = self.camera.holds
        if (camera.width, camera.height) == (self.picture.width, self.picture.height):
            return ""
        return (
            f"{self.picture.file.name} is {self.picture.size} pixels, and {self.camera.name} is for "
            f"{camera.width} × {camera.height}: load the calibration of this camera at this size."
        )

    def missing(self, settings: LookSettings) -> str:
        """What to load or to set next, as a sentence; "" where there is all that a look needs."""
        if self.picture is None:
            return "Load what robot 1's camera saw: a JPEG or PNG."
        if self.camera is None and not settings.field_of_view:
            return "Load the camera's calibration, or give its field of view."
        if self.scan is None and settings.needs_scan:
            if settings.finder == "tags":
                return "Load the laser's scan of the same moment, or give the tag's size."
            return "Load the laser's scan of the same moment."
        if settings.finder == "own" and self.model is None:
            return "Load your detector (.npz), or choose another one."
        return ""


def _kind_of(name: str, content: bytes) -> FileKind:
    """What a file is; any image is the camera's. Raises InputFileError where it is none of a sighting's."""
    try:
        kind = kind_of_file(name, content)
    except InputFileError as error:
        raise InputFileError(name, NONE if error.found == UNKNOWN else error.found, GIVE) from error
    if kind in ("known", "map", "fleet", "truth"):
        raise InputFileError(name, f"is {KINDS[kind]}", "drop it beside this panel, or press Open files…")
    return ALSO.get(kind, kind)


def _checked_together(files: SensorFiles) -> SensorFiles:
    """With the line of the encounters that names the picture: others are of other moments."""
    rows = files.encounters.holds if files.encounters else ()
    name = files.picture.file.name if files.picture else ""
    named = [k for k, row in enumerate(rows) if PurePath(row.image).name == name]
    return replace(files, row=named[0] if named else None)
