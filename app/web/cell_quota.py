"""How much all tabs of a server may hold: one who loads too much is told so, and the others go on."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock

from algorithms.common.errors import TooLargeError

# Of the maps on all pages together. A page and its worker take about 27 bytes for a cell of its maps after
# the first merge, and 43 with two results to go back to (measured with a pair of 4000 x 4000): 5 to 9 GB.
MOST_CELLS = 200_000_000


class CellQuota:
    """Cells that are spoken for, by who holds them."""

    def __init__(self, most: int = MOST_CELLS, make_room: Callable[[], None] = lambda: None) -> None:
        """make_room : is called before anyone is refused; lets go of what nobody looks at"""
        self._most, self._make_room = most, make_room
        self._held: dict[object, int] = {}
        self._lock = Lock()

    def claim(self, who: object, cells: int) -> None:
        """Have so many cells in place of those before; raises TooLargeError, which changes nothing."""
        with self._lock:
            others = sum(self._held.values()) - self._held.get(who, 0)
            if cells > self._most:
                raise TooLargeError(
                    f"these maps have {cells / 1e6:.0f} million cells, and a page holds "
                    f"{self._most / 1e6:.0f} million at most; make them coarser"
                )
            if others + cells > self._most:
                raise TooLargeError(
                    f"these maps have {cells / 1e6:.0f} million cells, and the other tabs of this server "
                    f"hold {others / 1e6:.0f} of the {self._most / 1e6:.0f} million that there may be; "
                    "close one of them, or make the maps coarser"
                )
            if others + cells > self._most / 2:
                self._make_room()
            self._held[who] = cells

    def release(self, who: object) -> None:
        with self._lock:
            self._held.pop(who, None)
