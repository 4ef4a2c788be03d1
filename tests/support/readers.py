"""Every reader of files that strangers send, and files to begin with: what test_fuzz.py and fuzz.py feed.

A reader takes any bytes at all, and answers or raises a MapMergeError; nothing else.
"""

from __future__ import annotations

import math
import re
import resource
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from bag_readers import BAG_READERS
from imagefiles import bmp, exif, interlaced_png, segment
from mapfiles import encoded
from PIL import Image
from repository import ROOT

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.files.camera_file import camera_from_bytes, camera_to_bytes
from algorithms.files.camera_picture import picture_from_bytes
from algorithms.files.encounter_table import EncounterRow, encounters_from_bytes, encounters_to_bytes
from algorithms.files.fleet_file import FLEET_FILE, read_fleet
from algorithms.files.map_file import grey_image, map_from_bytes, parse_meta
from algorithms.files.observation_file import (
    MOST_OBSERVATIONS,
    known_from_bytes,
    known_to_bytes,
    observations_from_bytes,
    read_known,
)
from algorithms.files.scan_file import scan_from_bytes, scan_to_bytes
from algorithms.files.truth_file import read_truth
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import Fleet
from algorithms.observations.pair_problem import Known
from algorithms.sensors.camera import Camera
from algorithms.sensors.laser_scan import LaserScan
from app.model.fleet_state import FleetState
from app.model.merge_inputs import Files, MergeInputs, OtherFile, Upload
from app.model.settings import with_value
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_texts import read_step
from app.page.lesson.museum.exhibit_texts import read_exhibit
from app.page.lesson.placeholders import NUMBERS
from app.page.page_state import PageState
from app.page.project.project_file import project_from_bytes, project_to_bytes
from app.page.project.project_reader import saved_tab
from app.page.project.project_writer import project_of
from app.page.undo.undo_history import SavedTab, UndoStep
from app.report.export_frame import ExportFrame

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
    b"anchor: b\nrobots:\n  a: {map: m.yaml}\n  b: {map: m.yaml}\n"
    b"known:\n  - {of: b, in: a, initial: {pose: [1, 2, 0.5]}}\n"
    b"sightings:\n  - observer: {robot: a, pose: [1, 2, 3]}\n    observed: {robot: b, pose: [4, 5]}\n"
    b"    measurement: {range: 1, bearing: 0.5}\n"
)
TRUTH = (
    b"T_ref_mov: {x: 1.0, y: -2, theta: 0.5}\n"
    b"tolerance: {distance: 0.5, angle: 0.05}\nexpected: merge\noverlap: 0.4\n"
)
CAMERA = (
    b"image_width: 640\nimage_height: 480\ncamera_name: c\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
    b"  data: [515., 0., 318.4, 0., 515.4, 243.8, 0., 0., 1.]\ndistortion_model: plumb_bob\n"
    b"distortion_coefficients: {rows: 1, cols: 5, data: [0.03, -0.08, 0.001, -0.0007, 0.]}\n"
)
CAMERA_INFO = (
    b"header:\n  frame_id: camera\nheight: 480\nwidth: 640\ndistortion_model: rational_polynomial\n"
    b"d: [0.1, 0.2, 0, 0, 0.1, 0.3, 0.1, 0]\nk:\n- 515\n- 0\n- 318\n- 0\n- 515\n- 243\n- 0\n- 0\n- 1\n"
    b"roi: {width: 0}\nmounting: {x: 0.1, y: 0, yaw: -1.5}\n---\n"
)
SCAN = (
    b"header:\n  frame_id: base_scan\nangle_min: -1.5\nangle_max: 1.5\nangle_increment: 0.2\n"
    b"range_min: 0.12\nrange_max: 3.5\nranges:\n"
    + b"- 1.25\n- .inf\n- 0.0\n- .nan\n" * 4
    + b"intensities: []\n---\n"
)
SCAN_IN_LINE = (
    b"angle_min: 1.5\nangle_increment: -0.2\nranges: [1.25, inf, 0.0, nan, 2, 2.5, 3,\n  3.5, 0.5]\n"
    b"mounting: {x: 0.1, y: 0, yaw: -1.5}\n"
)
ENCOUNTERS = (
    b"image,scan,observer_x,observer_y,observer_yaw,observed_x,observed_y,observed_yaw\n"
    b"a.jpg,a.yaml,1,-2.5,0.3,4,5,-1\nb.jpg,b.yaml,1,2,3,4,5,\n"
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


def _pictures() -> list[bytes]:
    colours = Image.fromarray((np.indices((33, 40)).sum(0)[..., None] * (1, 2, 3)).astype(np.uint8))
    jpeg = encoded(colours, "JPEG", quality=50)
    pictures = [encoded(colours, kind) for kind in ("PNG", "BMP", "WEBP", "PPM")]
    pictures += [jpeg, jpeg[:2] + segment(0xE1, exif(6)) + jpeg[2:], encoded(colours, "PNG", exif=exif(5))]
    pictures += [encoded(colours.convert("CMYK"), "JPEG"), encoded(colours, "JPEG", progressive=True)]
    pictures += [encoded(colours.convert("RGBA"), "WEBP", lossless=True), encoded(colours.quantize(9), "PNG")]
    pictures += [encoded(colours.convert("I;16"), "PNG"), b"P5\n32 32\n4095\n" + bytes(2048)]
    pictures += [encoded(colours, "GIF"), encoded(colours, "PNG", save_all=True, append_images=[colours])]
    return pictures


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


def _camera_twice(data: bytes) -> Camera:
    """What a camera's file says, which is the same once it has been written again."""
    camera = camera_from_bytes("c.yaml", data)
    assert camera_from_bytes("again", camera_to_bytes(camera)) == camera
    return camera


def _scan_twice(data: bytes) -> LaserScan:
    scan = scan_from_bytes("s.yaml", data)
    again = scan_from_bytes("again", scan_to_bytes(scan))
    assert np.array_equal(again.ranges, scan.ranges, equal_nan=True)
    assert replace(again, ranges=scan.ranges).__dict__ == scan.__dict__
    return scan


def _encounters_twice(data: bytes) -> tuple[EncounterRow, ...]:
    encounters = encounters_from_bytes("e.csv", data)
    assert encounters_from_bytes("again", encounters_to_bytes(encounters)) == encounters
    return encounters


def _tab() -> SavedTab:
    """A tab with a pair, a fleet, and something of everything else."""
    room = GridMap(np.zeros((3, 4), np.int8), 0.05)
    pair = MergeInputs.pair(room, room).knowing(known_from_bytes("o.yaml", SEEN + NEAR))
    files = Files("office", {"yaml1": Upload("m.yaml", META)}, (OtherFile("a", "waits"),))
    page = replace(PageState().snapshot(), inputs=pair, files=files, hand=Pose2(1, 2, 3), seed=4)
    page = replace(page, config=with_value(page.config, ("augment", "spread"), 4.5), taken="by hand")
    answer = Hypothesis(Pose2(1, 2, 3), np.eye(3), 0.5, 1.0)
    found = PairFinding(PairOrder("a", "b", ()), np.zeros(2), (answer,), "fits")
    fleet = FleetState(Fleet({"a": room, "b": room}), "two", again=True).with_finding(found)
    fleets = replace(page, inputs=MergeInputs(), fleet=fleet, export=ExportFrame(Pose2(1, 2, 3)))
    return SavedTab((UndoStep("load", page), UndoStep("a fleet", fleets)), 1)


TAB = _tab()
PROJECT = project_of(TAB)


def _document_twice(data: bytes) -> SavedTab:
    """What a project's document says whose files are there, and which is the same written again."""
    contents = {digest: make() for digest, make in PROJECT.contents.items()}
    saved = saved_tab("p.mapmeld", data, contents.get)
    written = project_of(saved)
    files = {digest: make() for digest, make in written.contents.items()}
    again = saved_tab("again", written.document, files.get)
    assert project_of(again).document == written.document
    return saved


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
    "project": (lambda data: project_from_bytes("p.mapmeld", data), [project_to_bytes(TAB)]),
    "a project's document": (_document_twice, [PROJECT.document]),
    "truth": (_from_disk(read_truth), [TRUTH, b"expected: refuse\n"]),
    "camera": (_camera_twice, [CAMERA, CAMERA_INFO, b"width: 64\nheight: 48\nfield_of_view: 1.2\n"]),
    "scan": (_scan_twice, [SCAN, SCAN.replace(b"ranges:\n", b"ranges:\n  # m\n"), SCAN_IN_LINE]),
    "encounters": (
        _encounters_twice,
        [ENCOUNTERS, ENCOUNTERS.replace(b",", b";"), b"\xef\xbb\xbf" + ENCOUNTERS],
    ),
    **BAG_READERS,
    "picture": (lambda data: picture_from_bytes("p.jpg", data), _pictures()),
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
