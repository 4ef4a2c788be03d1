"""The file that an input was read from: what it is called, and a hash that tells it from every other."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from io import BytesIO
from pathlib import Path, PurePath
from typing import BinaryIO

from algorithms.common.display_text import show_hidden

PART = 1 << 20  # bytes that are hashed at a time


@dataclass(frozen=True)
class SourceFile:
    """name   : of the file, without its folders
    sha256 : of its bytes, 64 hexadecimal digits
    """

    name: str
    sha256: str

    @staticmethod
    def of(name: str, data: bytes | BinaryIO) -> SourceFile:
        """A file by its content, or by that as an open file, which is read from its start part by part."""
        stream = BytesIO(data) if isinstance(data, bytes) else data
        stream.seek(0)
        digest = sha256()
        while part := stream.read(PART):
            digest.update(part)
        return SourceFile(show_hidden(PurePath(name).name), digest.hexdigest())

    @staticmethod
    def at(path: Path) -> SourceFile:
        """A file on the disk; raises OSError."""
        with path.open("rb") as stream:
            return SourceFile.of(path.name, stream)
