"""What is wrong with the annotations of a released run: files, their form, and ids that no table has."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from blender_scenes.annotations.document import DOCUMENT, Document
from blender_scenes.annotations.job import RECORDS, picture_file
from pipeline.dataset.metadata import RunRecord

ANNOTATIONS = "annotations"
"""Their folder within a run's."""

_FORMS = {
    "depth": (np.uint16, 1),
    "instance": (np.uint16, 1),
    "semantic": (np.uint8, 1),
    "normals": (np.uint16, 3),
    "flow": (np.uint16, 3),
    "free_floor": (np.uint8, 1),
}
"""Type and channels of each picture."""

Fault = tuple[str, str]
"""A file within the folder, nothing for the folder itself, and what is wrong with it."""


def annotation_faults(folder: Path, numbers: Sequence[int], record: RunRecord) -> Iterator[Fault]:
    """Every fault of the annotations of a run whose images have these numbers."""
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    expected = set(_expected(numbers, record))
    for name in sorted(expected - there):
        yield name, "is missing"
    for name in sorted(there - expected):
        yield name, "is none of the annotations that metadata.json names"
    known = set(range(2**16))
    if DOCUMENT in expected & there:
        try:
            document = Document.from_json((folder / DOCUMENT).read_bytes())
        except ValueError as error:
            yield DOCUMENT, f"cannot be read: {str(error).splitlines()[0]}"
        else:
            known = {0, *(one.id for one in document.instances)}
            yield from _document_faults(document, numbers, known)
    for name in sorted((expected & there) - {DOCUMENT}):
        fault = _picture_fault(folder / name, record, known)
        if fault:
            yield name, fault


def _expected(numbers: Sequence[int], record: RunRecord) -> Iterator[str]:
    for kind in record.annotations:
        if kind not in RECORDS:
            # Nothing follows the last image.
            yield from (picture_file(kind, number) for number in (numbers[:-1] if kind == "flow" else numbers))
    if record.annotations:
        yield DOCUMENT


def _document_faults(document: Document, numbers: Sequence[int], known: set[int]) -> Iterator[Fault]:
    if [image.id for image in document.images] != list(numbers):
        yield DOCUMENT, "images are not those of data.csv"
    images = set(numbers)
    for one in document.annotations:
        if one.image_id not in images or one.instance_id not in known:
            yield DOCUMENT, f"annotation {one.id} is of an image or an instance that is not there"
    points = {point.id for point in document.key_points}
    strays = [one for one in document.sightings if one.image_id not in images or one.key_point_id not in points]
    if strays:
        yield DOCUMENT, f"{len(strays)} sightings are of an image or a key point that is not there"


def _picture_fault(path: Path, record: RunRecord, known: set[int]) -> str:
    import cv2  # noqa: PLC0415 - half a second that no other command needs

    data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    try:
        pixels = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if len(data) else None
    except cv2.error:  # its head claims more pixels than OpenCV takes
        pixels = None
    if pixels is None:
        return "cannot be decoded"
    dtype, channels = _FORMS[path.parent.name]
    form = record.image_height_px, record.image_width_px
    if pixels.dtype != dtype or pixels.shape != (form if channels == 1 else (*form, channels)):
        return f"is {pixels.dtype} {pixels.shape}, expected {np.dtype(dtype)} of {form} and {channels} channels"
    strange = set(np.unique(pixels).tolist()) - known if path.parent.name == "instance" else set()
    return f"has the id {min(strange)}, which {DOCUMENT} does not name" if strange else ""
