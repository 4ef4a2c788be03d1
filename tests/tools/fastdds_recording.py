"""Record tests/app/live/recorded_by_fastdds with Fast DDS, not with ours.

    PYTHONPATH=tests/support python3 tests/tools/fastdds_recording.py FOLDER

where Debian's libfastrtps-dev, fastddsgen and g++ are: a map and a transform, as the bytes that it sends.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from fastdds_peer import build


def main(folder: str) -> None:
    Path(folder).mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as made:
        subprocess.run([build(Path(made)), "record", folder], check=True)


if __name__ == "__main__":
    main(sys.argv[1])
