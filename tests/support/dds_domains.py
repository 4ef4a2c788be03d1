"""Domains of DDS for tests that run at the same time: others for every process, below those whose ports Linux
gives to anybody.
"""

from __future__ import annotations

import os
from itertools import count

HIGHEST = 101
_numbers = count(7 * os.getpid())


def new_domain() -> int:
    return 1 + next(_numbers) % HIGHEST
