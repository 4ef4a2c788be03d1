"""What robot 1's camera and laser saw, and where both robots stood: loads it, and says what is missing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.files.camera_file import CAMERA_FILE
from algorithms.files.camera_picture import MOST_BYTES
from algorithms.files.encounter_table import ENCOUNTER_TABLE, EncounterRow
from algorithms.files.map_file import read_bytes
from algorithms.maps.grid_map import GridMap
from app.model.files.map_slots import short_name
from app.model.merge_inputs import MergeInputs, Upload
from app.model.observation_draft import ObservationDraft
from app.model.sighting.look_settings import LookSettings
from app.model.sighting.sensor_files import SensorFiles
from app.page.sighting.sighting_look import LookOrder
from app.page.tab import Tab
from app.system import data_paths as paths

TYPED = "as typed"
OF_OBSERVATION = "as in the observation"


@dataclass(frozen=True, eq=False)
class LoadedSensors:
    """What was loaded and typed, for a tab that is reloaded.

    grids         : of the maps that it belongs to
    folder        : of the sample whose files these are
    place, source : where the robots stood, and who says so
    """

    grids: tuple[GridMap, ...]
    files: SensorFiles
    folder: Path | None
    place: ObservationDraft
    source: str
    settings: LookSettings


class SensorsController:
    """Of one tab.

    samples : the folders of the samples, by their names
    changed : is called where what is to be looked at has changed
    """

    def __init__(self, tab: Tab, samples: Callable[[], Mapping[str, Path]] = paths.samples) -> None:
        self._state, self._panel, self._notices = tab.state, tab.panels.sensors, tab.notices
        self._locks, self._samples = tab.state.locks, samples
        self.changed: Callable[[], None] = lambda: None
        self.files = SensorFiles()
        self.place = ObservationDraft()  # where the robots stood
        self._source = ""  # who says so
        self._folder: Path | None = None  # of the sample whose files these are
        self._pair = MergeInputs()
        self._panel.connect(
            partial(tab.events.then, self.take), self._take_sample, self._take_row, self.forget
        )
        tab.state.subscribe("setup", self._setup_changed)
        self._setup_changed()

    # --- what is asked of it ----------------------------------------------------------------------

    def order(self) -> LookOrder | None:
        """What is to be looked at as all of it stands; None while something is missing or does not fit."""
        files, settings = self.files, self._panel.settings
        if files.picture is None or files.missing(settings) or files.fault():
            return None
        own = settings.finder == "own" and files.model is not None
        grid, observer = self._state.inputs.ref, self.place.observer
        with_map = settings.use_map and grid is not None and observer is not None
        return LookOrder(
            files.picture.file,
            files.camera.holds if files.camera else None,
            files.scan.holds if files.scan else None,
            files.model.holds if own and files.model else None,
            settings,
            grid if with_map else None,
            observer if with_map else None,
        )

    @property
    def unplaced(self) -> str:
        """Which robot's place is not known yet, as a sentence; "" where both are."""
        missing = [
            f"robot {number} stood in map {number}"
            for number, known in ((1, self.place.observer), (2, self.place.observed))
            if known is None
        ]
        said = f"Give where {' and where '.join(missing)}: under “Where the robots stood”."
        return self._state.inputs.names.told(said) if missing else ""

    def typed(self, name: str, value: float) -> None:
        """A number of a robot's place was typed; metres, radians."""
        with self._locks.action:
            known = replace(
                self.place,
                observer=self.place.observer or (Pose2() if name.endswith("1") else None),
                observed=self.place.observed or ((0.0, 0.0) if name.endswith("2") else None),
            )
            self._stand(known.typed(name, value), TYPED)
            self._tell()

    def settings_changed(self) -> None:
        with self._locks.action:
            self._panel.show_settings()
            self._tell()

    @property
    def loaded(self) -> LoadedSensors:
        grids, settings = self._pair.grids, self._panel.settings
        return LoadedSensors(grids, self.files, self._folder, self.place, self._source, settings)

    def resume(self, loaded: LoadedSensors) -> bool:
        """Take up what was loaded before the reload; False where other maps are there now."""
        if loaded.grids != self._pair.grids:
            return False
        self.files, self._folder = loaded.files, loaded.folder
        self._panel.take_settings(loaded.settings)
        self._stand(loaded.place, loaded.source)
        self._tell()
        return True

    # --- files ------------------------------------------------------------------------------------

    def take(self, upload: Upload) -> None:
        """A file has come: it is what it holds."""
        with self._locks.action:
            try:
                files, kind = self.files.with_file(upload)
            except MapMergeError as error:
                self._notices.report(error)
                self._tell(str(error))
                return
            self.files = files
            if kind in ("encounters", "picture") and files.encounters is not None:
                self._follow_row()
            self._tell()

    def _take_sample(self) -> None:
        folder = self._sample_folder()
        if folder is None:
            return
        with self._locks.action:
            try:
                files = _read_all(SensorFiles(), folder, (ENCOUNTER_TABLE, CAMERA_FILE))
                files = _of_row(files, folder, 0)
            except MapMergeError as error:
                self._notices.report(error)
                return
            self.files, self._folder = files, folder
            self._follow_row()
            self._tell()

    def _take_row(self, row: int) -> None:
        """Another encounter: its image and scan where they lie in the sample's folder, and its places."""
        with self._locks.action:
            encounters = self.files.encounters
            if encounters is None or not 0 <= row < len(encounters.holds):
                return
            try:
                files = self.files if self._folder is None else _of_row(self.files, self._folder, row)
            except MapMergeError as error:
                self._notices.report(error)
                return
            self.files = replace(files, row=row)
            self._follow_row()
            self._tell()

    def forget(self) -> None:
        """Nothing is loaded any more."""
        with self._locks.action:
            self.files, self._folder, self._source = SensorFiles(), None, ""
            self._follow_observation()
            self._tell()

    def _sample_folder(self) -> Path | None:
        """The folder of the sample on the page, where it holds what is asked for here."""
        folder = self._samples().get(self._state.files.sample)
        if folder is None or not all((folder / name).is_file() for name in (ENCOUNTER_TABLE, CAMERA_FILE)):
            return None
        return folder

    # --- where the robots stood -------------------------------------------------------------------

    def _stand(self, at: ObservationDraft, source: str) -> None:
        self.place, self._source = at, source
        self._panel.show_places(at, source, self._state.inputs.names)

    def _follow_row(self) -> None:
        """As the table has it; where no line of it is of this moment, not as a line of another one."""
        row, encounters = self.files.encounter, self.files.encounters
        if row is not None and encounters is not None:
            self._stand(_stood(row), f"as in {encounters.name}")
        elif self._source != TYPED:
            self._source = ""
            self._follow_observation()

    def _follow_observation(self) -> None:
        """As the observation has it, unless a table or a person says otherwise."""
        if self._source not in ("", OF_OBSERVATION):
            return
        seen = self._state.inputs.observations
        of = ObservationDraft.of(seen[0]) if seen else ObservationDraft()
        at = ObservationDraft(of.observer, observed=of.observed, heading=of.heading)
        if at != self.place or not self._source:
            self._stand(at, OF_OBSERVATION if seen else "")

    def _setup_changed(self) -> None:
        """Other maps have nothing to do with what was seen on those before."""
        old, self._pair = self._pair, self._state.inputs
        if old.grids != self._pair.grids:
            self._source = ""
            if self._folder is not None:
                self.files, self._folder = SensorFiles(), None
        elif old is self._pair:
            return  # a setting
        self._follow_observation()
        self._tell()

    # --- what is shown ----------------------------------------------------------------------------

    def _tell(self, trouble: str = "") -> None:
        """Show what is there and what is missing; ``trouble``: what was wrong with the last file."""
        files, settings, panel, inputs = self.files, self._panel.settings, self._panel, self._state.inputs
        panel.visible(len(inputs.grids) == 2)
        panel.name(inputs.names)
        rows = len(files.encounters.holds) if files.encounters else 0
        panel.offer(self._sample_folder() is not None, rows, files.row)
        bad = trouble or files.fault()
        said = bad or (inputs.names.told(files.missing(settings)) if files.any else "")
        panel.show_files(files.told(settings), said, bool(bad), files.any, files.camera is not None)
        self.changed()


def _stood(row: EncounterRow) -> ObservationDraft:
    return ObservationDraft(
        row.observer, observed=(row.observed_x, row.observed_y), heading=row.observed_heading
    )


def _read_all(files: SensorFiles, folder: Path, names: tuple[str, ...]) -> SensorFiles:
    """The same with files of a folder; raises InputFileError."""
    for name in names:
        content = read_bytes(folder / name, "a file of the sample", MOST_BYTES)
        files, _ = files.with_file(Upload(short_name(name), content))
    return files


def _of_row(files: SensorFiles, folder: Path, row: int) -> SensorFiles:
    """The same with the image and the scan of this line of the encounters; raises InputFileError."""
    assert files.encounters is not None
    line = files.encounters.holds[row]
    names = tuple(name for name in (line.image, line.scan) if name)
    return replace(_read_all(files, folder, names), row=row)
