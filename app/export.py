"""What the button "Download merged map" sends."""

from __future__ import annotations

import io
import zipfile

from algorithms.mapio import map_to_bytes
from algorithms.steps import MergeResult
from app.report import transform_yaml

STEM = "merged"


def archive(result: MergeResult) -> bytes:
    """A zip with the merged map and its transform, as ``mapmeld merge`` leaves them in a folder."""
    files = map_to_bytes(result.fusion.merged, STEM)
    files["transform.yaml"] = transform_yaml(result)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in files.items():
            target.writestr(name, content)
    return packed.getvalue()
