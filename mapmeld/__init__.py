"""Merge two robots' grid maps: the names for programs of your own.

``read_case``, or ``read_map`` and ``read_known``, give what ``merge`` takes; ``merge`` gives a
MergeResult, and ``run`` the same step by step. Metres and radians throughout, counter-clockwise; row 0 of a
grid is the bottom. What a user can mend is raised as a MapMergeError.

    import mapmeld

    case = mapmeld.read_case("sample_maps/office_r2_r1")
    result = mapmeld.merge(case.ref, case.mov, case.observations)
    if result.verdict.accepted:
        mapmeld.write_map("merged.yaml", result.fusion.merged)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # type checkers and editors see the names here; at run time each is loaded when it is used
    from algorithms.common.errors import InputFileError as InputFileError
    from algorithms.common.errors import MapMergeError as MapMergeError
    from algorithms.common.errors import NoAnswerError as NoAnswerError
    from algorithms.common.errors import OutputError as OutputError
    from algorithms.common.errors import SettingError as SettingError
    from algorithms.common.errors import TooLargeError as TooLargeError
    from algorithms.common.pose import Pose2 as Pose2
    from algorithms.detection.footprint import Footprint as Footprint
    from algorithms.detection.map_walls import MapWalls as MapWalls
    from algorithms.detection.model_file import read_model as read_model
    from algorithms.detection.model_file import shipped_model as shipped_model
    from algorithms.detection.robot_sighting import SightedRobots as SightedRobots
    from algorithms.detection.robot_sighting import observation_of as observation_of
    from algorithms.detection.robot_sighting import sight as sight
    from algorithms.detection.svm_detector import SvmDetector as SvmDetector
    from algorithms.detection.tag_detector import TagDetector as TagDetector
    from algorithms.files.camera_file import read_camera as read_camera
    from algorithms.files.camera_picture import read_picture as read_picture
    from algorithms.files.case_folder import Case as Case
    from algorithms.files.case_folder import read_case as read_case
    from algorithms.files.fleet_file import read_fleet as read_fleet
    from algorithms.files.map_file import read_map as read_map
    from algorithms.files.map_file import write_map as write_map
    from algorithms.files.observation_file import read_known as read_known
    from algorithms.files.observation_file import read_observations as read_observations
    from algorithms.files.observation_file import write_observations as write_observations
    from algorithms.files.scan_file import read_scan as read_scan
    from algorithms.fleets.fleet_merge import FleetResult as FleetResult
    from algorithms.fleets.fleet_merge import merge_fleet as merge_fleet
    from algorithms.fleets.fleet_merge import run_fleet as run_fleet
    from algorithms.maps.grid_map import GridMap as GridMap
    from algorithms.maps.map_fusion import Fusion as Fusion
    from algorithms.methods.merge_result import MergeResult as MergeResult
    from algorithms.methods.registry import METHODS as METHODS
    from algorithms.methods.registry import Method as Method
    from algorithms.methods.registry import merge as merge
    from algorithms.methods.registry import run as run
    from algorithms.methods.steps import Step as Step
    from algorithms.observations.fleet import Fleet as Fleet
    from algorithms.observations.fleet import FleetPrior as FleetPrior
    from algorithms.observations.fleet import FleetSighting as FleetSighting
    from algorithms.observations.observation import Observation as Observation
    from algorithms.observations.priors import InitialPose as InitialPose
    from algorithms.observations.priors import NearPlace as NearPlace
    from algorithms.observations.priors import TurnPrior as TurnPrior
    from algorithms.sensors.camera import Camera as Camera
    from algorithms.sensors.laser_scan import LaserScan as LaserScan
    from algorithms.verdict.decision import Outcome as Outcome
    from algorithms.verdict.decision import Verdict as Verdict

    __version__: str

_MODULES = {
    "algorithms.common.errors": (
        "InputFileError",
        "MapMergeError",
        "NoAnswerError",
        "OutputError",
        "SettingError",
        "TooLargeError",
    ),
    "algorithms.common.pose": ("Pose2",),
    "algorithms.files.case_folder": ("Case", "read_case"),
    "algorithms.files.fleet_file": ("read_fleet",),
    "algorithms.files.observation_file": ("read_known", "read_observations", "write_observations"),
    "algorithms.files.map_file": ("read_map", "write_map"),
    "algorithms.fleets.fleet_merge": ("FleetResult", "merge_fleet", "run_fleet"),
    "algorithms.maps.grid_map": ("GridMap",),
    "algorithms.maps.map_fusion": ("Fusion",),
    "algorithms.methods.registry": ("METHODS", "Method", "merge", "run"),
    "algorithms.methods.merge_result": ("MergeResult",),
    "algorithms.methods.steps": ("Step",),
    "algorithms.observations.fleet": ("Fleet", "FleetPrior", "FleetSighting"),
    "algorithms.observations.observation": ("Observation",),
    "algorithms.observations.priors": ("InitialPose", "NearPlace", "TurnPrior"),
    "algorithms.detection.footprint": ("Footprint",),
    "algorithms.detection.map_walls": ("MapWalls",),
    "algorithms.detection.model_file": ("read_model", "shipped_model"),
    "algorithms.detection.robot_sighting": ("SightedRobots", "observation_of", "sight"),
    "algorithms.detection.svm_detector": ("SvmDetector",),
    "algorithms.detection.tag_detector": ("TagDetector",),
    "algorithms.files.camera_file": ("read_camera",),
    "algorithms.files.camera_picture": ("read_picture",),
    "algorithms.files.scan_file": ("read_scan",),
    "algorithms.sensors.camera": ("Camera",),
    "algorithms.sensors.laser_scan": ("LaserScan",),
    "algorithms.verdict.decision": ("Outcome", "Verdict"),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}
__all__ = ["__version__", *_MODULE_OF]

# ``mapmeld --help`` passes here on its way to mapmeld/__main__.py, and whoever only reads maps needs no
# compiled kernels: so a name is loaded when it is first used. Hidden from type checkers, which would take
# any misspelt name for one of these.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """A name of ``__all__``, on its first use.

        raises : AttributeError for any other; ImportError where another package has taken a place of ours
        """
        if name == "__version__":
            value = _version()
        elif name in _MODULE_OF:
            from importlib import import_module

            from mapmeld.own_packages import intruder

            if complaint := intruder("algorithms"):
                raise ImportError(complaint)
            value = getattr(import_module(_MODULE_OF[name]), name)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def _version() -> str:
    """Version of mapmeld; "unknown" where it runs from a folder that was never installed."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("mapmeld")
    except PackageNotFoundError:
        return "unknown"
