"""What the button "Download merged map" sends."""

from __future__ import annotations

import io
import zipfile

from algorithms.mapio import map_to_bytes
from algorithms.steps import MergeResult

STEM = "merged"


def archive(result: MergeResult) -> bytes:
    """A zip with the merged map and its transform, as ``mapmeld merge`` leaves them in a folder."""
    files = map_to_bytes(result.fusion.merged, STEM)
    try:
        from app.report import transform_yaml
    except ImportError:
        pass
    else:
        text = transform_yaml(result)
        files["transform.yaml"] = text.encode() if isinstance(text, str) else text
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in files.items():
            target.writestr(name, content)
    return packed.getvalue()
