"""What the controllers of a tab work with, all of them."""

from __future__ import annotations

from dataclasses import dataclass

from app.page.modes import ModeSwitch
from app.page.notices import Notices
from app.page.page_display import PageDisplay
from app.page.page_state import PageState
from app.page.panel_set import Panels
from app.page.undo.undo_history import UndoHistory
from app.web.browser_events import BrowserEvents


@dataclass(frozen=True, eq=False)
class Tab:
    """What is on it, what draws it, its widgets, its modes, what was done on it, its notice, its browser."""

    state: PageState
    display: PageDisplay
    panels: Panels
    modes: ModeSwitch
    history: UndoHistory
    notices: Notices
    events: BrowserEvents
