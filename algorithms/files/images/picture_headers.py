"""What stands before the pixels of a picture, read here: Pillow would unpack whatever a camera has put there,
or a stranger, and would make room for a WebP before anybody knows how large it is.
"""

from __future__ import annotations

import struct

JPEG = b"\xff\xd8\xff"
EXIF = b"Exif\0\0"
APP1, START_OF_SCAN = 0xE1, 0xDA
# What pixels and their colours cannot do without: size, tables, JFIF, and Adobe's segment.
KEPT = frozenset({*range(0xC0, 0xD0), 0xDB, 0xDD, 0xE0, 0xEE} - {0xC8})
ALONE = frozenset({0x00, 0x01, *range(0xD0, 0xD9)})  # markers that nothing belongs to, and no marker
KEPT_CHUNKS = frozenset({b"IHDR", b"PLTE", b"tRNS", b"IDAT", b"IEND", b"eXIf"} | {b"acTL", b"fcTL", b"fdAT"})
ORIENTATION, SHORT = 0x0112, 3  # a tag of EXIF, and the type of its value
ENTRY = 12  # bytes of a tag


def bare_jpeg(data: bytes) -> tuple[bytes, bytes]:
    """A JPEG without what its pixels can do without, and its EXIF; empty where it has none.

    What follows the beginning of the first scan stays as it is; where there is none, nothing is left of it.
    """
    kept, exif, at = [data[:2]], b"", data.find(b"\xff", 2)
    while 0 <= at <= len(data) - 4:
        marker = data[at + 1]
        if marker == START_OF_SCAN:
            return b"".join([*kept, data[at:]]), exif
        if marker == 0xFF or marker in ALONE:
            at = data.find(b"\xff", at + (1 if marker == 0xFF else 2))
            continue
        (length,) = struct.unpack_from(">H", data, at + 2)
        segment = data[at : at + 2 + max(length, 2)]
        if marker == APP1 and segment[4:10] == EXIF and not exif:
            exif = segment[4:]
        if marker in KEPT:
            kept.append(segment)
        at = data.find(b"\xff", at + len(segment))
    return b"", exif


def scans_of(jpeg: bytes) -> int:
    """How many times a bare JPEG goes over its pixels; some more where its tables look like it."""
    return jpeg.count(bytes([0xFF, START_OF_SCAN]))


def bare_png(data: bytes) -> bytes:
    """A PNG without what its pixels, its frames and the way it lies can do without."""
    kept, at = [data[:8]], 8
    while at + 8 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        if data[at + 4 : at + 8] in KEPT_CHUNKS:
            kept.append(data[at : at + length + 12])
        at += length + 12
    return b"".join(kept)


def is_webp(head: bytes) -> bool:
    return head.startswith(b"RIFF") and head[8:12] == b"WEBP"


def webp_size(head: bytes) -> tuple[int, int] | None:
    """Width and height in pixels, from the first 30 bytes of a WebP; None where they do not tell."""
    kind = head[12:16]
    if len(head) < 30:
        return None
    if kind == b"VP8X":
        width, height = (int.from_bytes(head[at : at + 3], "little") for at in (24, 27))
        return width + 1, height + 1
    if kind == b"VP8L" and head[20] == 0x2F:
        bits = int.from_bytes(head[21:25], "little")
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if kind == b"VP8 " and head[23:26] == b"\x9d\x01\x2a":
        width, height = struct.unpack_from("<HH", head, 26)
        return width & 0x3FFF, height & 0x3FFF
    return None


def orientation(exif: bytes) -> int:
    """How a picture lies, 1 … 8 as EXIF counts it; 1, upright, where it does not tell."""
    tiff = exif.removeprefix(EXIF)
    order = {b"II*\0": "<", b"MM\0*": ">"}.get(tiff[:4])
    if order is None or len(tiff) < 8:
        return 1
    (at,) = struct.unpack_from(f"{order}I", tiff, 4)
    if at + 2 > len(tiff):
        return 1
    (count,) = struct.unpack_from(f"{order}H", tiff, at)
    for entry in range(at + 2, min(at + 2 + count * ENTRY, len(tiff) - ENTRY + 1), ENTRY):
        tag, kind, _, value = struct.unpack_from(f"{order}HHIH", tiff, entry)
        if (tag, kind) == (ORIENTATION, SHORT):
            return int(value) if 1 <= value <= 8 else 1
    return 1
