"""Photographs that a user names, read for the fit of a look."""

import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from diagnosis.photographs.line_place import MIN_SHARE, MIN_WIDTH_PX, BgrImage, find_lines
from diagnosis.photographs.measures import PhotographMeasures
from symolo.core.errors import FaultList, InputError, one_line
from symolo.core.progress import plural
from symolo.dataset.pixels import decoded_bytes

MIN_PHOTOGRAPHS, MAX_PHOTOGRAPHS = 3, 30
MIN_SIDE_PX = 64
NO_LINE = (
    f"no line was recognised: a band of even width, at least {MIN_WIDTH_PX:.0f} px wide, with floor on both sides, "
    f"over at least {100 * MIN_SHARE:.0f} % of the height or width of the image"
)
LARGEST_WIDTH_PX = 640
"""Width to which larger photographs are reduced, if no width is chosen."""


@dataclass(frozen=True)
class LookPhotographs:
    """Photographs with their measures."""

    folder: str
    """Folder of all photographs; their names are relative to it."""
    measured: tuple[PhotographMeasures, ...]
    notes: tuple[str, ...]
    """Changes and omissions, in one sentence each."""


def read_photographs(files: Sequence[tuple[Path, bytes]], width_px: int | None) -> LookPhotographs:
    """Decode and measure photographs.

    Args:
        files: Path and content of each file.
        width_px: Width to which all are reduced; None for that of the photographs, up to `LARGEST_WIDTH_PX`.

    Raises:
        InputError: A file is no image, photographs have different sizes, or too few of them show a line.
    """
    if not MIN_PHOTOGRAPHS <= len(files) <= MAX_PHOTOGRAPHS:
        allowed = f"{MIN_PHOTOGRAPHS} to {MAX_PHOTOGRAPHS}"
        cure = "photograph more places" if len(files) < MIN_PHOTOGRAPHS else "choose some of them, of different places"
        raise InputError("PHOTO...", got=plural(len(files), "file"), allowed=allowed, cure=cure)
    images, notes = _images(files, width_px)
    places = find_lines(images)
    paths = [path for path, _ in files]
    if len({path.is_absolute() for path in paths}) > 1:
        paths = [path.absolute() for path in paths]
    folder = os.path.commonpath([path.parent for path in paths])
    measured = []
    for path, place in zip(paths, places, strict=True):
        measures = (
            None if place is None else PhotographMeasures.from_place(one_line(os.path.relpath(path, folder)), place)
        )
        if measures is None:
            problem = NO_LINE if place is None else "it shows too little floor beside the line"
            notes.append(f"{one_line(str(path))}: not used, because {problem}")
        else:
            measured.append(measures)
    if len(measured) < MIN_PHOTOGRAPHS:
        raise InputError(
            f"a line with floor on both sides is visible in {plural(len(measured), 'photograph')} of {len(files)}",
            where="PHOTO...",
            allowed=f"at least {MIN_PHOTOGRAPHS}",
            cure="photograph the line so that it crosses the image, is between "
            f"{MIN_WIDTH_PX:.0f} pixels and 45 % of the image wide, and differs clearly from the floor",
        )
    return LookPhotographs(one_line(folder or "."), tuple(measured), tuple(notes))


def _images(files: Sequence[tuple[Path, bytes]], width_px: int | None) -> tuple[list[BgrImage], list[str]]:
    """Return the images in one size, and what was changed."""
    faults, images = FaultList(), dict[Path, BgrImage]()
    seen: dict[str, Path] = {}
    for path, data in files:
        with faults.noted():
            same = seen.setdefault(hashlib.sha256(data).hexdigest(), path)
            if same is not path:
                raise InputError(f"is the same image as {same}", where=str(path), cure="name each photograph once")
            images[path] = _image(path, data)
    faults.check()
    height, width = next(iter(images.values())).shape[:2]
    for path, image in images.items():
        with faults.noted():
            if image.shape[:2] != (height, width):
                got, allowed = f"{image.shape[1]} x {image.shape[0]} px", f"{width} x {height} px, as the first one"
                cure = "use photographs of one camera"
                raise InputError("size", where=str(path), got=got, allowed=allowed, cure=cure)
    faults.check()
    if width_px is not None and width_px > width:
        raise InputError("--width-px", got=width_px, allowed=f"up to {width}, the width of the photographs")
    to_px = width_px or min(width, LARGEST_WIDTH_PX)
    if to_px == width:
        return list(images.values()), []
    size = to_px, round(height * to_px / width)
    reduced = [np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8) for image in images.values()]
    return reduced, [f"photographs of {width} x {height} px are reduced to {size[0]} x {size[1]} px"]


def _image(path: Path, data: bytes) -> BgrImage:
    image = decoded_bytes(data, in_colour=True)
    if image is None:
        cure = "save it again as PNG or JPEG, with at most 64 million pixels"
        raise InputError("is no complete image, or too large", where=str(path), cure=cure)
    if min(image.shape[:2]) < MIN_SIDE_PX:
        got = f"{image.shape[1]} x {image.shape[0]} px"
        raise InputError("size", where=str(path), got=got, allowed=f"at least {MIN_SIDE_PX} px on each side")
    return image.astype(np.uint8, copy=False)
