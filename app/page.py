"""One tab of the page: its inputs, its panels and pictures, and its session."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import viser

from algorithms.casefiles import Case, Truth
from algorithms.errors import MapMergeError
from algorithms.gridmap import GridMap
from algorithms.observation import Observation, encounter
from algorithms.methods import METHODS
from app import words
from app.layout import lay_out
from app.palette import LIGHT, Palette, css
from app.session import Job, Session
from app.stage import Stage
from app.story import Story
from app.views.maps import MapView

log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Inputs:
    ref: GridMap | None = None
    mov: GridMap | None = None
    observation: Observation | None = None
    name: str = ""
    truth: Truth | None = None


class Page:
    def __init__(self, client: viser.ClientHandle, initial: Case | None) -> None:
        self.client = client
        self.palette: Palette = LIGHT
        self.stage = Stage(client)
        self.maps = MapView(client, self.stage)
        self.session = Session(self)
        self.inputs = Inputs()
        self.stage.theme(self.palette)
        gui = client.gui
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium")
        gui.main_panel.dock_right()
        gui.add_button("Merge", color="green").on_click(lambda _: self.merge())
        gui.add_button("Stop").on_click(lambda _: self.session.stop())
        self.config = METHODS["spectra-swarm"].defaults
        if initial:
            self.load(Inputs(initial.ref, initial.mov, initial.observation, initial.name, initial.truth))

    def load(self, inputs: Inputs) -> None:
        self.inputs = inputs
        at = encounter(inputs.observation) if inputs.observation else None
        layout = lay_out(inputs.ref, inputs.mov, at)
        self.maps.load(inputs.ref, inputs.mov, inputs.observation, at, layout, self.palette)
        self.stage.hud(case=inputs.name, state=words.READY, mood="idle", anchor=layout.anchor_ref.tolist(),
          legend=[{"s":"square","c":css(self.palette.ref),"t":"map 1"},{"s":"square","c":css(self.palette.mov),"t":"map 2"}])
        self.stage.flush()

    def merge(self) -> None:
        i = self.inputs
        self.session.request(Job(i.ref, i.mov, i.observation, self.config, pace=1.0, again=True))

    def begun(self, job: Job) -> None:
        self.stage.hud(state="Starting.", mood="running", progress=0.0)
        self.stage.flush()

    def show(self, job: Job, story: Story) -> None:
        self.maps.show(story, True, job.pace > 0)
        self.stage.hud(state=words.sentence(story), progress=words.progress(story))
        self.stage.flush()

    def ended(self, job: Job, story: Story) -> None:
        self.show(job, story)
        self.stage.hud(mood="accepted", progress=None)
        self.stage.flush()

    def stopped(self, job: Job, story: Story) -> None:
        self.stage.hud(mood="stopped", state="Stopped.", progress=None)
        self.stage.flush()

    def failed(self, job: Job, error: Exception) -> None:
        self.stage.hud(mood="failed", state=str(error), progress=None)
        self.stage.flush()

    def close(self) -> None:
        self.session.close()
