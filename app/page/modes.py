"""What a person can do on the map besides looking at a run: at most one of these modes is on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from algorithms.common.pose import FloatArray
from app.drawing.scene_layout import Rect
from app.page.undo.page_snapshot import PageSnapshot


@dataclass(frozen=True, eq=False)
class Mode:
    """Lesson, map 2 in the hand, robots being placed, another method's result, or a fleet.

    end     : called once it is off; what the page shows then is the caller's business
    leave   : puts back what was on the page before; None: there is nothing to put back
    redraw  : draws the map while it is on; None: the run is drawn as usual
    changed : a setting was changed while it was on
    resume  : goes on as a snapshot says, given whether it was on before; whether there is nothing to run
    reopen  : goes on with other maps; the settings are its own for a while. None: other maps end it
    merge   : what the button Merge does while it is on; None: the method runs
    stop    : leaves what it is at; whether there was anything
    click   : a place of the scene was clicked; None: what the two maps know of it is read out
    extent  : all that it draws; None: both maps
    """

    end: Callable[[], None]
    leave: Callable[[], None] | None = None
    redraw: Callable[[], None] | None = None
    changed: Callable[[], None] = lambda: None
    resume: Callable[[PageSnapshot, bool], bool] = lambda snapshot, was_on: False
    reopen: Callable[[], None] | None = None
    merge: Callable[[], None] | None = None
    stop: Callable[[], bool] = lambda: False
    click: Callable[[FloatArray], None] | None = None
    extent: Callable[[], Rect] | None = None


class ModeSwitch:
    """Of one tab; whoever calls holds the action lock."""

    def __init__(self) -> None:
        self._modes: list[Mode] = []
        self.current: Mode | None = None

    def add(self, mode: Mode) -> Mode:
        self._modes.append(mode)
        return mode

    def enter(self, mode: Mode) -> None:
        """Switch this mode on, after any other was left."""
        if self.current is not mode:
            self.leave()
            self.current = mode

    def close(self) -> Mode | None:
        """End the mode that is on, and put nothing back; which it was."""
        mode, self.current = self.current, None
        if mode is not None:
            mode.end()
        return mode

    def leave(self) -> None:
        """End the mode that is on, and put back what was on the page before."""
        leave = self.current.leave if self.current is not None else None
        (leave or self.close)()

    def resume(self, snapshot: PageSnapshot, before: Mode | None) -> bool:
        """Switch on what a snapshot asks for, if anything; ``before``: the mode that was on until now."""
        return any(mode.resume(snapshot, mode is before) for mode in self._modes)
