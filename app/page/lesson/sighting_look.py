"""What the front end of section III-A makes of a picture and a scan that lie beside a sample's maps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import radians
from pathlib import Path
from threading import RLock
from typing import Any

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.detection.detection import Picture
from algorithms.detection.footprint import Footprint
from algorithms.detection.hog_grid import WindowShape
from algorithms.detection.map_walls import MapWalls
from algorithms.detection.model_file import shipped_model
from algorithms.detection.robot_sighting import LaserView, Sighted, SightedRobots, shape_fault, sight
from algorithms.detection.scan_clusters import Cluster, clusters_of
from algorithms.detection.svm_detector import SvmDetector
from algorithms.files.camera_file import CAMERA_FILE, read_camera
from algorithms.files.camera_picture import picture_to_jpeg, read_picture
from algorithms.files.case_folder import FIRST_MAP_FILE
from algorithms.files.encounter_table import ENCOUNTER_TABLE, read_encounters
from algorithms.files.map_file import read_map
from algorithms.files.scan_file import read_scan
from algorithms.methods.steps import Step
from algorithms.observations.observation import Observation
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from app.drawing.hog_picture import hog_picture
from app.jobs.job_thread import JobThread
from app.jobs.runner import Runner, TappedRunner
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.page.lesson.side_runs import SideRun, SideRuns
from app.system import data_paths as paths

SIGHTING = "sighting"  # name of the picture
STAND_IN = "office_r2_r1"  # is looked at where the loaded maps have no picture
QUALITY = 88  # of the picture as it is shown
SAME_PLACE = 1e-3  # metres; files write places as exactly as that


@dataclass(frozen=True, eq=False)
class CameraReading:
    """What boxes and a scan say together where a camera is read in one way.

    camera : with its calibration, or counting pixels
    view   : the scan in its eyes
    seen   : what became of every box
    """

    camera: Camera
    view: LaserView
    seen: SightedRobots

    @property
    def one(self) -> Sighted | None:
        """The box that counts, or where none does the likeliest; None where there is none."""
        boxes = self.seen.sighted
        return boxes[self.seen.chosen or 0] if boxes else None

    def bearing(self, column: float, row: float) -> float:
        """Of a pixel from the robot's heading; radians, counter-clockwise."""
        from_axis = float(self.camera.bearings(np.array([column]), row)[0])
        return from_axis + self.camera.mounting.theta


@dataclass(frozen=True, eq=False)
class SightingLook:
    """One picture and one scan, and all that a student is shown of them.

    name       : of the sample that they belong to
    own        : whether that is of the maps that are loaded
    photo      : the picture as a JPEG
    observer   : T_map_robot, where robot 1 stood in map 1
    calibrated : by the camera's calibration; ``counted`` as section III-A does it, in pixels from the middle
    laser_alone : what became of every box where robot 1's map is not asked
    things     : all that the laser tells apart, walls among it, and ``robot_sized`` those as wide as a robot
                 may be: the laser alone, which knows no map
    window     : the image around the box in the detector's own size, and its gradients; None without a box
    """

    name: str
    own: bool
    photo: bytes
    observer: Pose2
    scan: LaserScan
    body: Footprint
    shape: WindowShape
    calibrated: CameraReading
    counted: CameraReading
    laser_alone: SightedRobots
    things: tuple[Cluster, ...]
    robot_sized: tuple[Cluster, ...]
    window: tuple[Picture, Picture] | None


@dataclass(frozen=True)
class SightingTask:
    """Looks at the first encounter of a folder; goes to another process.

    maps : folder of the case whose map 1 robot 1 stood in
    own  : whether those are the maps that are loaded
    """

    folder: Path
    maps: Path
    own: bool = True

    def __call__(self) -> Iterator[Step]:
        yield Step("observe", look(self.folder, self.maps, self.own), 0.0)  # type: ignore[arg-type]


def sighting_runs(inputs: MergeInputs, config: Any) -> SideRuns:
    """One look at the picture that belongs to a pair of maps; where none does, at that of another sample."""
    assert inputs.ref is not None
    assert inputs.mov is not None
    samples = paths.samples()
    own = pictured(samples, inputs.name, inputs.observations[0] if inputs.observations else None)
    folder = own or samples.get(STAND_IN)
    job = MergeJob(inputs.ref, inputs.mov, inputs.known, config)
    if folder is None or not has_pictures(folder):
        return SideRuns(SideRun(SIGHTING, job, failed="No sample with a picture is installed."))
    task = SightingTask(folder, folder, own is not None)
    return SideRuns(SideRun(SIGHTING, replace(job, steps=task), ends=SightingLook))


def has_pictures(folder: Path) -> bool:
    """Whether pictures lie beside the maps of a sample."""
    return (folder / ENCOUNTER_TABLE).is_file()


def pictured(samples: Mapping[str, Path], name: str, seen: Observation | None) -> Path | None:
    """The folder of the sample of this name, where pictures show what was observed; None without them.

    seen : as it is known now: robots that were moved by hand stand in no picture
    """
    folder = samples.get(name)
    if folder is None or seen is None or not has_pictures(folder):
        return None
    at = read_encounters(folder / ENCOUNTER_TABLE)[0]  # in which robot 1 has turned to the other one
    here = [*at.observer.xy.tolist(), at.observed_x, at.observed_y]
    now = [*seen.observer.xy.tolist(), seen.observed_x, seen.observed_y]
    return folder if np.allclose(here, now, rtol=0, atol=SAME_PLACE) else None


def look(folder: Path, maps: Path, own: bool = True) -> SightingLook:
    """Find the robot in the first encounter of a folder; raises InputFileError."""
    at = read_encounters(folder / ENCOUNTER_TABLE)[0]
    picture, scan = read_picture(folder / at.image), read_scan(folder / at.scan)
    camera, body, model = read_camera(folder / CAMERA_FILE), Footprint(), shipped_model()
    walls = MapWalls(read_map(maps / FIRST_MAP_FILE), at.observer)
    found = SvmDetector(model).detect(picture, camera)
    angle = radians(camera.degrees_wide())
    counting = Camera.counting_pixels(camera.width, camera.height, angle, camera.mounting)

    def read(by: Camera) -> CameraReading:
        return CameraReading(by, LaserView.of(scan, by, walls), sight(found, scan, by, body, walls))

    calibrated = read(camera)
    box = calibrated.one
    things = tuple(clusters_of(scan))
    return SightingLook(
        name=folder.name,
        own=own,
        photo=picture_to_jpeg(picture, QUALITY),
        observer=at.observer,
        scan=scan,
        body=body,
        shape=model.shape,
        calibrated=calibrated,
        counted=read(counting),
        laser_alone=sight(found, scan, camera, body),
        things=things,
        robot_sized=tuple(thing for thing in things if not shape_fault(thing, scan, body)),
        window=None if box is None else hog_picture(picture, box.detection, model.shape),
    )


class LookThread:
    """Looks at pictures in a process that merges, for a part of the page that shows them."""

    def __init__(
        self,
        runner: Runner,
        drawing: RLock,
        show: Callable[[SightingLook], None],
        failed: Callable[[str], None],
    ) -> None:
        """show, failed : called with what was seen, or why nothing could be; whoever calls is drawing"""
        self._show, self._failed = show, failed
        self._thread = JobThread(self, TappedRunner(runner, iter), drawing)

    def ask(self, task: SightingTask, inputs: MergeInputs, config: Any) -> None:
        """Look at this next."""
        if inputs.ref is not None and inputs.mov is not None:
            self._thread.request(MergeJob(inputs.ref, inputs.mov, (), config, steps=task))

    def stop(self) -> None:
        """Nobody wants to know any more."""
        self._thread.stop()

    def close(self) -> None:
        self._thread.close()

    def begun(self, job: MergeJob) -> None:
        """There is nothing to show yet."""

    def show(self, job: MergeJob, run: RunState) -> None:
        """It is shown once it is over."""

    def ending(self, job: MergeJob, run: RunState) -> None:
        """There is nothing more to work out."""

    def waits(self, job: MergeJob, before: int) -> None:
        """Merges of other tabs go first."""

    def ended(self, job: MergeJob, run: RunState) -> None:
        seen = run.get(SightingLook)
        if seen is not None:
            self._show(seen)

    def stopped(self, job: MergeJob, run: RunState) -> None:
        """It is not shown."""

    def failed(self, job: MergeJob, run: RunState, error: Exception) -> None:
        self._failed(str(error))
