"""Every reader of files that strangers send, and files to begin with: what test_fuzz.py and fuzz.py feed.

A reader takes any bytes at all, and answers or raises a MapMergeError; nothing else.
"""

from __future__ import annotations

import math
import re
import resource
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from imagefiles import bmp, interlaced_png
from mapfiles import encoded
from PIL import Image
from repository import ROOT

from algorithms.common.errors import MapMergeError
from algorithms.files.fleet_file import FLEET_FILE, read_fleet
from algorithms.files.map_file import grey_image, map_from_bytes, parse_meta
from algorithms.files.observation_file import (
    MOST_OBSERVATIONS,
    known_from_bytes,
    known_to_bytes,
    observations_from_bytes,
    read_known,
)
from algorithms.files.truth_file import read_truth
from algorithms.observations.fleet import Fleet
from algorithms.observations.pair_problem import Known
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_texts import read_exhibit, read_step
from app.page.lesson.placeholders import NUMBERS

MOST_MEMORY = 2_000  # MB that a process may take to read any file of at most 1 MB
MOST_SECONDS = 1.0  # of processor time
SLOWER = 3  # times that a machine which runs the tests may be slower than ours

META = (
    b"image: m.pgm\nresolution: 0.05\norigin: [-1.5, 2.0, 0.1]\n"
    b"negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
)
SEEN = (
    b"observer: {pose: [31.248, 2.711, 2.96434]}\nobserved: {pose: [24.8295, 34.5772, -0.62006]}\n"
    b"measurement: {range: 2.97, bearing: 0.406, sigma_range: 0.05, sigma_bearing: 0.035}\n"
)
INITIAL = b"initial: {pose: [1.5, -2, 0.5], sigma: [2.0, 2.0, 0.17]}\n"
TURN = b"turn: {yaw: -1.2, sigma: 0.1}\n"
NEAR = b"near: {map1: [3, 4.5], map2: [0.5, -1], radius: 2}\n"
KNOWN = b"- " + INITIAL + b"  " + TURN + b"- " + NEAR
FLEET = (
    b"anchor: b\nrobots:\n  a: {map: m.yaml}\n  b: {map: m.yaml, known: {pose: [1, 2, 0.5]}}\n"
    b"sightings:\n  - observer: {robot: a, pose: [1, 2, 3]}\n    observed: {robot: b, pose: [4, 5]}\n"
    b"    measurement: {range: 1, bearing: 0.5}\n"
)
TRUTH = (
    b"T_ref_mov: {x: 1.0, y: -2, theta: 0.5}\n"
    b"tolerance: {distance: 0.5, angle: 0.05}\nexpected: merge\noverlap: 0.4\n"
)
STATUS = Path("/proc/self/status")
STATIC = ROOT / "static"


def _images() -> list[bytes]:
    grey = Image.fromarray((np.indices((7, 9)).sum(0) * 16).astype(np.uint8))
    palette = grey.convert("P")
    images = [encoded(grey.convert(mode), "PNG") for mode in ("1", "L", "LA", "RGB", "RGBA")]
    images += [encoded(palette, "PNG", transparency=3), encoded(grey, "PNG", optimize=True)]
    images += [encoded(grey.convert(mode), "BMP") for mode in ("1", "L", "RGB")]
    images += [encoded(grey.convert(mode), "PPM") for mode in ("1", "L", "RGB")]
    images += [b"P2\n2 2\n255\n0 205 254 # x\n9\n", b"P1\n2 2\n0 1#\n#\n1 0\n", b"P3\n1 1\n9\n1 2 3\n"]
    images += [interlaced_png(np.asarray(grey.convert(mode))) for mode in ("L", "RGBA")]
    images += [bmp(3, 2, b"\3\0\0\0\1\377\2\0\0\1", 8, 1), bmp(3, 2, b"\3\x1f\0\0\3\xf1\0\1", 4, 2)]
    images += [encoded(grey.convert("CMYK"), kind) for kind in ("TIFF", "JPEG")]
    images += [encoded(grey, "JPEG"), encoded(grey, "GIF")]
    images += [encoded(Image.new("I;16", (3, 2)), "PNG")]
    return images


def _from_disk(read: Callable[[Path], object]) -> Callable[[bytes], object]:
    def reader(data: bytes) -> object:
        with TemporaryDirectory() as folder:
            path = Path(folder, "file")
            path.write_bytes(data)
            return read(path)

    return reader


def _known_twice(path: Path) -> tuple[Known, ...]:
    """What a file says is known, which is the same once it has been written again."""
    known = read_known(path)
    if len(known) <= MOST_OBSERVATIONS:
        assert known_from_bytes("again", known_to_bytes(known)) == known
    return known


def _fleet(data: bytes) -> Fleet:
    """What a fleet's file says whose robots' maps lie beside it."""
    with TemporaryDirectory() as folder:
        Path(folder, "m.yaml").write_bytes(META)
        Path(folder, "m.pgm").write_bytes(b"P5\n2 2\n255\n\0\376\315\376")
        path = Path(folder, FLEET_FILE)
        path.write_bytes(data)
        return read_fleet(path)


# name -> what reads it, and files that it is meant for
READERS: dict[str, tuple[Callable[[bytes], object], list[bytes]]] = {
    "meta": (lambda data: parse_meta("m.yaml", data), [META, META.replace(b"[", b"\n- ")]),
    "image": (lambda data: grey_image("m.png", data), _images()),
    "map": (
        lambda data: map_from_bytes("m.yaml", META, "m.pgm", data),
        [image for image in _images() if image[:1] == b"P"],
    ),
    "observations": (
        lambda data: observations_from_bytes("o.yaml", data),
        [SEEN, b"- " + SEEN.replace(b"\n", b"\n  ", 2)],
    ),
    "known": (_from_disk(_known_twice), [KNOWN, INITIAL, SEEN + NEAR, b"- " + TURN + b"- " + NEAR]),
    "fleet": (_fleet, [FLEET, FLEET.replace(b"anchor: b\n", b"")]),
    "truth": (_from_disk(read_truth), [TRUTH, b"expected: refuse\n"]),
    "step": (
        _from_disk(lambda path: read_step(path, PICTURES, NUMBERS)),
        [path.read_bytes() for path in sorted((STATIC / "lesson" / "en").glob("*.md"))[:4]],
    ),
    "exhibit": (
        _from_disk(read_exhibit),
        [path.read_bytes() for path in sorted((STATIC / "museum" / "en").glob("*.md"))[:3]],
    ),
}

# What takes a parser's time or memory by its shape; N bytes or less of each
N = 32 * 1024
SHAPES: dict[str, bytes] = {
    "lists in lists": b"[" * N,
    "mappings in mappings": b"{" * N,
    "mappings in mappings with keys": b"{a: " * (N // 4),
    "lists in lists by indentation": b"- " * (N // 2),
    "questions": b"? " * (N // 2),
    "keys": b"".join(b"k%d: 1\n" % k for k in range(N // 9)),
    "a long list": b"[" + b"1," * (N // 2 - 2) + b"]",
    "anchors": b"".join(b"- &a%d x\n" % k for k in range(N // 12)),
    "aliases": b"- &a x\n" + b"- *a\n" * (N // 6),
    "laughs": b"a0: &a0 [x,x,x,x,x,x,x,x,x]\n"
    + b"".join(b"a%d: &a%d [%s]\n" % (k, k, b",".join([b"*a%d" % (k - 1)] * 9)) for k in range(1, 300)),
    "itself": b"a: &a [*a]",
    "comments": b"#\n" * (N // 2),
    "blanks": b" " * N,
    "lines": b"\n" * N,
    "a text without an end": b'"' + b"\\x41" * (N // 4 - 1),
    "folded lines": b"a: >\n" + b" x\n" * (N // 3 - 2),
    "indents": b"".join(b" " * k + b"a:\n" for k in range(240)),
    "directives": b"%a\n" * (N // 3),
    "wide characters": b"\xff\xfe" + b"a\0" * (N // 2 - 1),
    "pixels after many comments": b"P2\n200 200\n255\n" + b"#\n" * (N // 2),
    "bits after many comments": b"P1\n10000 10000\n" + b"#\n" * (N // 2),
    "bits and comments in turn": b"P1\n100 100\n" + b"1#\n" * (N // 3),
    "a header of comments": b"P1" + b"#\n" * N,
    "pixels after a header of comments": b"P2" + b"#\n" * N + b"200 200\n9\n" + b"#\n" * N,
    "an image one pixel wide": encoded(Image.new("1", (1, 15_000_000)), "PNG"),
    "a pixel of many digits": b"P2\n200 200\n255\n" + b"1" * N,
}


class TooSlowError(AssertionError):
    """A reading took more processor time than it may."""


def reads(
    reader: Callable[[bytes], object], data: bytes, seconds: float = MOST_SECONDS, peak: float = math.inf
) -> bool:
    """Whether it was read, and not refused; an error where that was not in words, in time and in memory.

    seconds : of this thread's processor time. No reader waits or has a second thread, and for how long this
              one stands aside for others is not counted.
    peak    : MB that the process may have held by then, from its start
    """
    began = time.thread_time()
    read = True
    try:
        reader(data)
    except MapMergeError as error:
        read = False
        if isinstance(error.__cause__, MemoryError):
            raise AssertionError("took more memory than there is") from error
    took, held = time.thread_time() - began, peak_memory()
    if took > seconds:
        raise TooSlowError(f"took {took:.1f} s of processor time; {seconds:g} s are the most")
    if held > peak:
        raise AssertionError(f"made the process {held:,.0f} MB large; {peak:,.0f} MB are the most")
    return read


def peak_memory() -> float:
    """The most memory that this process has held; MB."""
    if STATUS.exists():  # Linux; its getrusage begins with the peak of the process that started this one
        return int(re.search(r"VmHWM:\s*(\d+) kB", STATUS.read_text())[1]) / 1000
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6  # bytes, on macOS
