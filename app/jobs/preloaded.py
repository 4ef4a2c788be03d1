"""Loads what a merge needs into the process that is copied for merges; see ``forked_start``.

Importing it does the work, which is all that can be asked of such a process. It must not leave a thread
behind, for a copy has none of them, and must not take long, for whoever merges waits: kernels that have to
be compiled are left to the copies.
"""

from __future__ import annotations

import gc

import cv2

from algorithms.common import parallel_kernels as kernels
from app.jobs import worker_pool  # noqa: F401  # what the copies run
from app.jobs.warm_up import small_merge
from app.system.memory import give_back


def _load() -> bool:
    """Run a merge; whether that went well."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    kernels.use_threads(1)
    try:
        with kernels.kept_only():
            for _ in small_merge().run({}):
                pass
    except Exception:  # a copy tells what is wrong, to who merges
        return False
    finally:
        kernels.use_threads(kernels.cores())
        cv2.setNumThreads(threads)
    return True


loaded = _load()
give_back()
gc.freeze()  # or the first collection of a copy would write into all that it shares
