"""Chunks of recordings unpacked up to a size: a few bytes may stand for more than there is memory."""

from __future__ import annotations

from bz2 import BZ2Decompressor
from collections.abc import Callable
from typing import Any

from lz4.frame import LZ4FrameDecompressor
from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag1.reader import decompressors
from rosbags.rosbag2 import storage_mcap

MOST_CHUNK = 256 * 2**20  # bytes; a chunk may hold a single large message, a map of 100 million cells


def _bounded(kind: Callable[[], Any]) -> Callable[..., bytes]:
    """Unpacks with a decompressor of this kind; raises ValueError beyond MOST_CHUNK, or cut off."""

    def unpack(data: bytes, size: int = MOST_CHUNK) -> bytes:
        work = kind()
        out: bytes = work.decompress(data, max_length=min(size, MOST_CHUNK) + 1)
        if len(out) > min(size, MOST_CHUNK) or not work.eof:
            raise ValueError(f"a chunk is cut off, or unpacks to more than {min(size, MOST_CHUNK):,} bytes")
        return out

    return unpack


MCAP: Any = storage_mcap  # has Zstandard by the way that each Python has it
BZ2, LZ4, ZSTD = map(_bounded, (BZ2Decompressor, LZ4FrameDecompressor, MCAP.zstd.ZstdDecompressor))
# by what the library unpacks with, which has no bound
OF_ROS1 = {decompressors["bz2"]: BZ2, decompressors["lz4"]: LZ4}
MCAP.DECOMPRESSORS.update(lz4=LZ4, zstd=ZSTD)


def bound(reader: Reader1) -> None:
    """Have an open recording of ROS 1 unpack so."""
    for at, chunk in reader.chunks.items():
        reader.chunks[at] = chunk._replace(decompressor=OF_ROS1.get(chunk.decompressor, chunk.decompressor))
