"""On what a measurement was made."""

from __future__ import annotations

import os
import platform
from contextlib import suppress
from pathlib import Path

from app.system.version import versions


def machine() -> dict[str, str]:
    """Processor, cores, system, and the versions of everything that computes."""
    names = []
    with suppress(OSError):  # no such file on macOS and Windows
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": names[0] if names else platform.processor() or platform.machine(),
        "cores": str(os.cpu_count() or 1),
        "system": f"{platform.system()} {platform.machine()}",
        **versions(),
    }
