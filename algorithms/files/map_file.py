"""Map files of ROS map_server and Nav2: a YAML file and its image, to and from a GridMap.

What Nav2's map_io loads, this loads to the same cells, and what this writes, Nav2 loads to the same
cells. An image has its top row first and a GridMap its bottom row: the flip lives here alone.
"""

from __future__ import annotations

import io
import os
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath, PureWindowsPath
from typing import BinaryIO

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, OutputError, SettingError, unreadable
from algorithms.common.pose import Pose2
from algorithms.common.source_file import SourceFile
from algorithms.files import yaml_fields as fields
from algorithms.files.atomic_write import write_files
from algorithms.files.bags.bag_path import bag_path
from algorithms.files.foreign_files import check_foreign_folder
from algorithms.files.images.grey_levels import corrected, count_greys, remarks
from algorithms.files.images.image_decoder import read_pixels
from algorithms.files.images.thresholds import MODES, GreyArray, Shading, cells_of, greys_of
from algorithms.maps.grid_map import COARSEST, FINEST, CellArray, GridMap

YAML_SUFFIXES = (".yaml", ".yml")
AT_ZERO = Pose2()
USUAL = Shading()
READABLE_SUFFIXES = (".pgm", ".ppm", ".pbm", ".pnm", ".png", ".bmp")
# lossy, or grey without one meaning: refused, but as images
REFUSED_SUFFIXES = (".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".webp")
IMAGE_SUFFIXES = READABLE_SUFFIXES + REFUSED_SUFFIXES


@dataclass(frozen=True)
class MapMeta:
    """What a map's YAML file says.

    image      : file name of the image, relative to the YAML file's folder, or absolute
    resolution : metres per pixel
    origin     : T_map_grid, pose of the image's lower-left corner in the map's frame
    shading    : how grey becomes occupancy
    remarks    : what a person should know of the file, each a clause
    file       : the YAML file itself; None where there is none
    """

    image: str
    resolution: float
    origin: Pose2
    shading: Shading
    remarks: tuple[str, ...] = ()
    file: SourceFile | None = field(default=None, compare=False)


@dataclass(frozen=True, eq=False)
class GreyImage:
    """A decoded image: grey and, where it has one, alpha; (H, W) uint8, row 0 at the top."""

    grey: GreyArray
    alpha: GreyArray | None

    def read(self, shading: Shading) -> tuple[CellArray, tuple[str, ...]]:
        """(H, W) int8 cells, row 0 at the bottom, under a shading or the one that is unmistakably meant; and
        what is odd about that, each a clause with the cure.
        """
        counts = count_greys(self.grey, self.alpha)
        shading, meant = corrected(shading, counts)
        cells = cells_of(self.grey, self.alpha, shading)
        odd = remarks(shading, counts, cells)
        return cells, (meant, *odd) if meant else odd


def read_map(path: Path | str, unknown_grey: int | None = None) -> GridMap:
    """Read a map from disk. What is odd about its greys is told in ``GridMap.remarks``.

    path         : its YAML file; or its image, where a YAML file of the same stem lies beside it; or a
                   recording, ``BAG[#/topic][@TIME]``
    unknown_grey : 0 … 255, a grey that stands for unknown, whatever its thresholds say
    raises       : InputFileError, TooLargeError
    """
    recording = bag_path(path)
    if recording is not None:
        from algorithms.files.bags.map_messages import read_bag_map  # few read one, and its library is large

        return read_bag_map(recording)
    path = Path(path)
    if path.suffix.lower() in IMAGE_SUFFIXES:
        yaml_path = _yaml_beside(path)
        return _read_image(path, _meta_of(yaml_path, unknown_grey), yaml_path.stem)
    meta = _meta_of(path, unknown_grey)
    image_path, remark = _image_of(path, meta.image)
    if remark:
        meta = replace(meta, remarks=(*meta.remarks, remark))
    return _read_image(image_path, meta, path.stem)


def _image_of(path: Path, image: str) -> tuple[Path, str]:
    """Where a map's image is, and what is to be said of that.

    Files are moved, and keep the path of another machine: then the image of that name beside the YAML file is
    taken.
    """
    named = path.parent / image
    if image.startswith("~"):
        with suppress(RuntimeError):  # there is no home
            named = path.parent / Path(image).expanduser()
    if named.is_file():
        return named, ""
    name = PureWindowsPath(image).name  # which takes slashes of both kinds
    beside = path.parent / name
    missing = f"its image {image} is {'a folder' if named.is_dir() else 'not there'}"
    if not name or beside == named:
        raise InputFileError(path, missing, "put it there, or correct the key image")
    if not beside.is_file():
        found = f"{missing}, and no {name} is beside the YAML file"
        raise InputFileError(path, found, "put it there, or correct the key image")
    return beside, f"{missing}; {name} beside the YAML file was taken"


def _meta_of(path: Path, unknown_grey: int | None) -> MapMeta:
    meta = parse_meta(str(path), read_bytes(path, "a map"))
    return replace(meta, shading=replace(meta.shading, unknown_grey=unknown_grey))


def read_image(path: Path, resolution: float, origin: Pose2 = AT_ZERO, shading: Shading = USUAL) -> GridMap:
    """Read a plain image as a map; what a YAML file would say is given by the caller.

    resolution : metres per pixel
    origin     : pose of the lower-left corner of the image in the map's frame
    raises     : InputFileError, TooLargeError; SettingError where the resolution is none
    """
    path = Path(path)
    return _read_image(path, MapMeta(path.name, resolution, origin, shading), path.stem)


def map_from_bytes(yaml_name: str, yaml_bytes: bytes, image_name: str, image: bytes | BinaryIO) -> GridMap:
    """A map from two uploads. The image is the one given: the key ``image`` never touches the disk.

    image  : its content, or that as an open file, which is read part by part
    raises : InputFileError, TooLargeError
    """
    meta = parse_meta(yaml_name, yaml_bytes)
    return _to_map(image_name, _opened(image), meta, PurePath(yaml_name).stem)


def grey_image(name: str, data: bytes | BinaryIO) -> GreyImage:
    """An upload decoded once, to try several shadings on it; ``data`` as of ``map_from_bytes``.

    raises : InputFileError, TooLargeError
    """
    return GreyImage(*read_pixels(name, _opened(data)))


def write_map(yaml_path: Path | str, grid: GridMap) -> None:
    """Write a map: the YAML file, and a PGM of the same stem beside it, both whole or not at all.

    yaml_path : ends in .yaml or .yml; folders that are not there are made
    raises    : OutputError
    """
    yaml_path = Path(yaml_path)
    if yaml_path.suffix.lower() not in YAML_SUFFIXES:
        raise OutputError(yaml_path, "is no name of a YAML file", "let it end in .yaml")
    image, text = map_to_bytes(grid, yaml_path.stem).values()
    # The image first: a YAML file that is there names an image that is there.
    write_files({yaml_path.with_suffix(".pgm"): image, yaml_path: text})


def map_to_bytes(grid: GridMap, stem: str) -> dict[str, bytes]:
    """The files of a map by name: the image ``stem.pgm``, then ``stem.yaml``.

    Equal maps give equal bytes. Every cell value −1 … 100, the resolution and the origin read back
    as they are.
    """
    pixels, shading = greys_of(grid.cells)
    image = f"P5\n{grid.width} {grid.height}\n255\n".encode() + pixels
    name = f"{stem}.pgm"
    return {name: image, f"{stem}.yaml": meta_to_bytes(MapMeta(name, grid.resolution, grid.origin, shading))}


def meta_to_bytes(meta: MapMeta) -> bytes:
    """The content of a map's YAML file; ``parse_meta`` reads it back as it is."""
    number = fields.number_text
    o, shading = meta.origin, meta.shading
    return (
        f"image: {fields.quoted(meta.image)}\n"
        f"mode: {shading.mode}\n"
        f"resolution: {number(meta.resolution)}\n"
        f"origin: [{number(o.x)}, {number(o.y)}, {number(o.theta)}]\n"
        f"negate: {int(shading.negate)}\n"
        f"occupied_thresh: {number(shading.occupied_thresh)}\n"
        f"free_thresh: {number(shading.free_thresh)}\n"
    ).encode()


def parse_meta(source: str, data: bytes) -> MapMeta:
    """What a map's YAML file says; keys of others' are passed over, as Nav2 does.

    source : name of the file as the user knows it
    raises : InputFileError
    """
    f = fields.parse(source, data, "a map's YAML file", first_only=True)
    image = f.text("image", "give the file name of the image")
    resolution = f.number("resolution", "give metres per pixel, e.g. 0.05")
    if not FINEST <= resolution <= COARSEST:
        span = f"metres per pixel, {FINEST:g} to {COARSEST:g}" if resolution > 0 else "a positive number"
        raise f.error("resolution", f"is {resolution:g} m", f"give {span}, e.g. 0.05")
    x, y, yaw = f.pose("origin", (3,), "give [x, y, yaw] of the lower-left pixel; m, m, rad")
    negate = f.flag("negate", "give 0, or 1 where white is occupied")
    occupied = f.number("occupied_thresh", "give a number in [0, 1], e.g. 0.65")
    free = f.number("free_thresh", "give a number in [0, 1], e.g. 0.196")
    mode = "trinary"
    if "mode" in f.values:
        mode = f.text("mode", f"give one of {', '.join(MODES)}, or leave it out").lower()
    try:
        shading = Shading(negate, occupied, free, mode)
    except SettingError as error:
        found, remedy = str(error).split("; ", 1)
        raise InputFileError(source, found, remedy) from error
    more = ("its YAML file holds several documents; the first was taken",) if f.further else ()
    return MapMeta(image, resolution, Pose2(x, y, yaw), shading, more, SourceFile.of(source, data))


def read_bytes(
    path: Path, what: str, most: int = fields.MAX_YAML_BYTES, kind: str = "YAML file", instead: str = ""
) -> bytes:
    """The content of a small text file; of one that is too long a byte more than it may have.

    what    : what the file is about, for the remedy: "a map"
    most    : bytes that it may have
    kind    : of file, for the remedy
    instead : as of ``check_foreign``
    raises  : InputFileError where it is not there, or not readable
    """
    if path.is_dir():
        check_foreign_folder(path, instead)
    try:
        with path.open("rb") as stream:
            return stream.read(most + 1)  # one more, so that the parser can tell
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise unreadable(path, error, f"give the {kind} of {what}") from error


def _yaml_beside(image_path: Path) -> Path:
    for suffix in YAML_SUFFIXES:
        yaml_path = image_path.with_suffix(suffix)
        if yaml_path.is_file():
            return yaml_path
    with _open(image_path):  # without it no YAML file would help
        pass
    found = f"there is no {image_path.stem}.yaml beside it"
    raise InputFileError(image_path, found, "give the map's YAML file, or the resolution of the image")


def _open(image_path: Path) -> BinaryIO:
    try:
        return image_path.open("rb")
    except (OSError, ValueError) as error:
        raise unreadable(image_path, error, "check the path") from error


def _read_image(path: Path, meta: MapMeta, name: str) -> GridMap:
    with _open(path) as stream:
        return replace(_to_map(str(path), stream, meta, name), made=os.fstat(stream.fileno()).st_mtime)


def _to_map(source: str, stream: BinaryIO, meta: MapMeta, name: str) -> GridMap:
    cells, odd = GreyImage(*read_pixels(source, stream)).read(meta.shading)
    remarks = (*meta.remarks, *odd)
    files = tuple(filter(None, (meta.file, SourceFile.of(source, stream))))
    return GridMap(cells, meta.resolution, meta.origin, show_hidden(name) or "map", remarks, files)


def _opened(data: bytes | BinaryIO) -> BinaryIO:
    return io.BytesIO(data) if isinstance(data, bytes) else data
