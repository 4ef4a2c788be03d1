"""The web server: one page per tab, nothing shared between them."""

from __future__ import annotations

import errno
import logging
import socket
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import radians
from pathlib import Path

import viser

from algorithms.common.errors import MapMergeError
from algorithms.files.case_folder import Case
from algorithms.methods.steps import Step
from app.jobs import worker_pool as workers
from app.jobs.forked_start import FORKS, start_parent
from app.jobs.runner import RunCallbacks
from app.jobs.warm_up import small_merge
from app.jobs.warm_up import warm_up as warm_up_there
from app.live.watch.robot_network import RobotNetwork
from app.model.merge_inputs import MergeInputs
from app.page.page import Page
from app.page.project.kept_work import KeptWork
from app.page.undo.undo_history import SavedTab
from app.system.logging_setup import facts
from app.system.memory import MemoryCleanup
from app.web.cell_quota import CellQuota
from app.web.security.access_control import Access
from app.web.session_store import SessionStore
from app.web.viser_server import guarded_server

log = logging.getLogger(__name__)


MOST_TABS = 64  # about 8 MB each, and what its maps and results take
WARM = 1 if FORKS else 2  # processes for merges from the start: a second tab need not wait long for its own
SPARE = 8  # connections more, so that a tab too many gets an answer


class PortError(MapMergeError):
    """The address cannot be listened at."""


def make_server(
    host: str = "127.0.0.1",
    port: int = 8080,
    initial: Case | SavedTab | None = None,
    lesson: Path | None = None,
    access: Access | None = None,
    research: bool = False,
    kept: KeptWork | None = None,
    network: RobotNetwork | None = None,
) -> viser.ViserServer:
    """Start to serve; every tab opens with ``initial``, a pair or a project.

    port   : 0 for any free one (``server.get_port()`` tells which)
    lesson : folder of the lesson's texts; None for those that come along
    research : tabs open in the mode of researchers, unless their browser remembers another
    access : who may talk to it; None: this machine alone
    kept   : keeps the work of tabs beyond the server's end; None: it ends with it
    network : in which robots that run are looked for; None: none is opened
    raises : PortError where the port is taken or the address is not this machine's
    """
    _probe(host, port)
    server = guarded_server(host, port, access or Access(), MOST_TABS + SPARE)
    if port and server.get_port() != port:  # taken between the probe and now: viser went one further
        server.stop()
        raise PortError(_taken(port))
    server.scene.set_up_direction("+y")
    server.scene.configure_environment_map(hdri=None)  # nothing shiny here, and no second of fading in
    camera = server.initial_camera
    camera.position, camera.look_at, camera.up = (0.0, 0.0, 600.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    camera.fov, camera.near, camera.far = radians(4), 10.0, 5000.0
    pages: dict[int, Page] = {}
    first = MergeInputs.of(initial) if isinstance(initial, Case) else initial or MergeInputs()
    keep: SessionStore[SavedTab] = SessionStore(shelf=kept)
    quota = CellQuota(make_room=keep.forget_all)
    housekeeping = MemoryCleanup()
    visited = False

    @server.on_client_connect
    def _(client: viser.ClientHandle) -> None:
        if len(pages) >= MOST_TABS:
            client.gui.add_markdown(f"{MOST_TABS} tabs are open already. Close one, then reload this page.")
            return
        log.info("a tab came", extra=facts(tab=client.client_id, tabs=len(pages) + 1))
        nonlocal visited
        if not visited:
            visited = True
            _aside(warm_up_here)
        pages[client.client_id] = Page(client, first, keep, server.uploads, quota, lesson, research, network)

    @server.on_client_disconnect
    def _(client: viser.ClientHandle) -> None:
        page = pages.pop(client.client_id, None)
        if page is not None:
            dropped = dict(server.gate.dropped)
            log.info("a tab went", extra=facts(tab=client.client_id, tabs=len(pages), dropped=dropped))
            page.close()
            housekeeping.soon()

    start_parent()  # before a browser is started: it would inherit the environment that this sets meanwhile
    _aside(warm_up)
    return server


def _aside(what: Callable[[], None]) -> None:
    threading.Thread(target=what, name="mapmeld-warm-up", daemon=True).start()


def warm_up() -> None:
    """Have what merges ready for it, its kernels compiled: the first Merge need not wait."""
    runners = [workers.COMMON.runner() for _ in range(WARM)]
    job = replace(small_merge(), steps=warm_up_there)
    try:
        for runner in runners:  # each has a process of its own, as long as the others are there
            _run_through(runner.steps(job, RunCallbacks()))
    finally:
        for runner in runners:
            runner.close()


def warm_up_here() -> None:
    """The same in this process, for what a hand moves, and the lesson."""
    _run_through(small_merge().run({}))


def _run_through(steps: Iterator[Step]) -> None:
    try:
        for _ in steps:
            pass
    except MapMergeError:
        log.debug("warming up ended early", exc_info=True)
    except Exception:  # nobody asked for it: who merges then sees it
        log.warning("warming up failed", exc_info=True)


def _taken(port: int) -> str:
    return f"port {port} is taken by another program; give another one with --port, or 0 for any"


def _probe(host: str, port: int) -> None:
    """Raise PortError where the port cannot be had: viser would silently take the next one."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise PortError(_taken(port)) from error
            raise PortError(f"cannot listen at {host}, port {port}: {error.strerror or error}") from error
