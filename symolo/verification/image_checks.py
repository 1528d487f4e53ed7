"""Checks of the images of a camera: their number, and that each is whole and has its size."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from symolo.core.files.image_headers import image_size
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import plural
from symolo.dataset.documents.metadata import RunRecord
from symolo.dataset.layout import frame_name
from symolo.dataset.pixels import MAX_PIXELS, decoded_contents
from symolo.dataset.tables.rows import Rows
from symolo.verification.findings import Finding, limited

_JPEG_START, _JPEG_END = b"\xff\xd8\xff", b"\xff\xd9"


def check_images(folder: Path, name: str, rows: Rows, record: RunRecord, source: str = "data.csv") -> Iterator[Finding]:
    """Yield every fault of a folder of images.

    Args:
        folder: Folder of the images.
        name: Its path in the dataset.
        rows: Rows with the numbers of the images.
        record: The run as metadata.json describes it.
        source: File that the numbers come from, for messages.
    """
    numbers = [int(number) for number in rows.image if number > 0]
    if len(numbers) != record.images:
        yield Finding(name, f"{source} names {plural(len(numbers), 'image')}, metadata.json says {record.images}")
    expected = {frame_name(number) for number in numbers}
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    yield from limited(name, [f"{file} is missing" for file in sorted(expected - there)])
    yield from limited(name, [f"{file} is not named in {source}" for file in sorted(there - expected)])
    size, faults, present = (record.image_width_px, record.image_height_px), [], sorted(expected & there)

    def whole_ones() -> Iterator[bytes | None]:
        for file in present:
            data = read_file(folder / file, FileKind.IMAGE)
            faults.append(_header_fault(data, *size))
            yield None if faults[-1] else data

    for number, pixels in enumerate(decoded_contents(whole_ones(), in_colour=True)):
        if fault := faults[number] or _size_fault(pixels, *size):
            yield Finding(f"{name}/{present[number]}", fault)


def _header_fault(data: bytes, width_px: int, height_px: int) -> str:
    if not data.startswith(_JPEG_START) or not data.endswith(_JPEG_END):
        return "is not a whole JPEG file"
    try:
        size = image_size(data, MAX_PIXELS)
    except ValueError:
        return "cannot be decoded"
    # A header that announces a large image costs a second of decoding; EXIF may exchange width and height.
    if size not in {(width_px, height_px), (height_px, width_px)}:
        return f"is {size[0]} x {size[1]} px, metadata.json says {width_px} x {height_px}"
    return ""


def _size_fault(pixels: np.ndarray | None, width_px: int, height_px: int) -> str:
    if pixels is None:
        return "cannot be decoded"
    if pixels.shape[:2] != (height_px, width_px):
        return f"is {pixels.shape[1]} x {pixels.shape[0]} px, metadata.json says {width_px} x {height_px}"
    return ""
