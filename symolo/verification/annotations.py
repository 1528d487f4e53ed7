"""Checks of the annotations of a released run: files, their form, and ids that no table has."""

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.geometry.pinhole import intrinsics
from symolo.dataset.annotations import (
    CATEGORIES,
    DOCUMENT,
    RECORD_KINDS,
    AnnotationDocument,
    annotation_file,
    encodings,
)
from symolo.dataset.documents.camera_model import camera_table
from symolo.dataset.documents.metadata import RunRecord
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.layout import frame_name
from symolo.dataset.pixels import decoded_files
from symolo.dataset.tables.rows import Rows

_FORMS = {
    "depth": (np.uint16, 1),
    "instance": (np.uint16, 1),
    "semantic": (np.uint8, 1),
    "normals": (np.uint16, 3),
    "flow": (np.uint16, 3),
    "free_floor": (np.uint8, 1),
}
"""Type and number of channels of the image of each kind."""

_POSE_TOLERANCE = 1e-6
"""Largest difference of times [ms], positions [m] and components of unit vectors."""

_LAST_ID = 2**16 - 1
"""Largest id of an instance, since the image of instances has 16 bits."""

Fault = tuple[str, str]
"""File within the folder, empty for the folder itself, and its fault."""


def annotation_faults(folder: Path, rows: Rows, record: RunRecord, spec: RunDocument | None) -> Iterator[Fault]:
    """Yield every fault of the annotations of a run; without its specification, cameras and poses are not checked."""
    numbers = rows.image[rows.image > 0].tolist()
    there = set(_files_below(folder))
    expected = set(_expected(numbers, record))
    for name in sorted(expected - there):
        yield name, "is missing"
    for name in sorted(there - expected):
        yield name, "is none of the annotations that metadata.json names"
    known, category_of = None, None
    if DOCUMENT in expected & there:
        try:
            document = AnnotationDocument.from_json(read_file(folder / DOCUMENT, FileKind.ANNOTATIONS))
        except ValueError as error:
            yield DOCUMENT, f"cannot be read: {str(error).splitlines()[0]}"
        else:
            known = {0, *(one.id for one in document.instances)}
            yield from _head_faults(document, record)
            if spec is not None:
                yield from _camera_faults(document, rows, spec)
            yield from _document_faults(document, numbers, known)
            strange = list(_instance_faults(document))
            yield from strange
            if not strange:
                category_of = {one.id: one.category_id for one in document.instances}
    yield from _image_faults(folder, (expected & there) - {DOCUMENT}, record, known, category_of)


def _files_below(folder: Path) -> Iterator[str]:
    """Yield the path within a folder of everything that is a file or a link to one."""
    for place, _, names in os.walk(folder):
        within = "" if place == str(folder) else f"{Path(place).relative_to(folder).as_posix()}/"
        yield from (f"{within}{name}" for name in names if os.path.isfile(f"{place}/{name}"))  # noqa: PTH113


def _expected(numbers: Sequence[int], record: RunRecord) -> Iterator[str]:
    for kind in record.annotations:
        if kind not in RECORD_KINDS:
            # The flow leads to the next image, which the last image does not have.
            yield from (annotation_file(kind, number) for number in (numbers[:-1] if kind == "flow" else numbers))
    if record.annotations:
        yield DOCUMENT


def _head_faults(document: AnnotationDocument, record: RunRecord) -> Iterator[Fault]:
    """Check what all images have in common against the run."""
    if sorted(document.kinds) != sorted(record.annotations):
        yield DOCUMENT, f"is of {', '.join(document.kinds)}, metadata.json names {', '.join(record.annotations)}"
    if document.encodings != encodings(document.kinds, document.camera):
        yield DOCUMENT, "encodings are not those of its annotations"
    if [(one.id, one.name) for one in document.categories] != list(enumerate(CATEGORIES)):
        yield DOCUMENT, f"categories are not {', '.join(CATEGORIES)}, numbered from 0"
    size = record.image_width_px, record.image_height_px
    if any((image.width, image.height) != size for image in document.images):
        yield DOCUMENT, f"images are of another size than {size[0]} x {size[1]} px"


def _instance_faults(document: AnnotationDocument) -> Iterator[Fault]:
    ids = [one.id for one in document.instances]
    if len(set(ids)) < len(ids) or not all(0 < one <= _LAST_ID for one in ids):
        yield DOCUMENT, f"ids of instances are not different numbers from 1 to {_LAST_ID}"
    strange = [one.name for one in document.instances if not 0 < one.category_id < len(CATEGORIES)]
    if strange:
        yield DOCUMENT, f"instance {strange[0]} is of a category that is not there"


def _camera_faults(document: AnnotationDocument, rows: Rows, spec: RunDocument) -> Iterator[Fault]:
    if document.camera != intrinsics(spec.robot.camera, spec.render.width_px, spec.render.height_px):
        yield DOCUMENT, "camera is not that of spec.json"
    poses = {int(row[0]): row[1:14] for row in camera_table(spec, rows)}
    for image in document.images:
        X_WC = np.array(image.X_WC)
        pose = np.concatenate([[1000 * image.t_s], X_WC[:3, :3].ravel(), X_WC[:3, 3]])
        if image.id in poses and not np.allclose(pose, poses[image.id], rtol=0, atol=_POSE_TOLERANCE):
            yield DOCUMENT, f"t_s or X_WC of image {image.id} is not that of data.csv"


def _document_faults(document: AnnotationDocument, numbers: Sequence[int], known: set[int]) -> Iterator[Fault]:
    if [image.id for image in document.images] != list(numbers):
        yield DOCUMENT, "images are not those of data.csv"
    for image in document.images:
        if image.file_name.rpartition("/")[2] != frame_name(image.id):
            yield DOCUMENT, f"file of image {image.id} is not that of data.csv"
    images, category_of = set(numbers), {one.id: one.category_id for one in document.instances}
    for one in document.annotations:
        if one.image_id not in images or one.instance_id not in known:
            yield DOCUMENT, f"annotation {one.id} is of an image or an instance that is not there"
        elif one.category_id != category_of.get(one.instance_id):
            yield DOCUMENT, f"annotation {one.id} is not of its instance's category"
    points = {point.id for point in document.key_points}
    strays = [one for one in document.sightings if one.image_id not in images or one.key_point_id not in points]
    if strays:
        yield DOCUMENT, f"{len(strays)} sightings are of an image or a key point that is not there"


def _image_faults(
    folder: Path, names: Iterable[str], record: RunRecord, known: set[int] | None, category_of: dict[int, int] | None
) -> Iterator[Fault]:
    """Yield the faults of the images.

    Args:
        folder: The annotations.
        names: Images in it.
        record: The run.
        known: Ids of instances, and 0; None where the document does not have them.
        category_of: Category of each instance; None where the document does not say it.
    """
    size = record.image_width_px, record.image_height_px
    instances: tuple[str, np.ndarray | None] = "", None
    # The kinds of an image follow one another, so that those that belong together are decoded once.
    ordered = sorted((Path(name).name, name) for name in names)
    for (file, name), pixels in zip(ordered, decoded_files([folder / name for _, name in ordered], size), strict=True):
        kind = name.partition("/")[0]
        if kind == "instance":
            instances = file, pixels
        if pixels is None:
            yield name, f"is no image of {size[0]} x {size[1]} px"
        elif fault := _form_fault(kind, pixels, size) or (_id_fault(pixels, known) if kind == "instance" else ""):
            yield name, fault
        elif kind == "semantic" and category_of is not None:
            fault = _category_fault(pixels, instances[1] if instances[0] == file else None, category_of)
            if fault:
                yield name, fault


def _form_fault(kind: str, pixels: np.ndarray, size: tuple[int, int]) -> str:
    dtype, channels = _FORMS[kind]
    form = size[::-1]
    if pixels.dtype != dtype or pixels.shape != (form if channels == 1 else (*form, channels)):
        return f"is {pixels.dtype} {pixels.shape}, expected {np.dtype(dtype)} of {form} and {channels} channels"
    return ""


def _id_fault(pixels: np.ndarray, known: set[int] | None) -> str:
    strange = set(np.unique(pixels).tolist()) - known if known is not None else ()
    return f"has the id {min(strange)}, which {DOCUMENT} does not name" if strange else ""


def _category_fault(semantic: np.ndarray, instance: np.ndarray | None, category_of: dict[int, int]) -> str:
    """Check that each pixel has the category of its instance or, without an image of instances, a known category."""
    if instance is not None and instance.shape == semantic.shape and set(np.unique(instance)) <= {0, *category_of}:
        table = np.zeros(_LAST_ID + 1, np.int64)
        table[list(category_of)] = list(category_of.values())
        differ = np.count_nonzero(table[instance] != semantic)
        return f"differs in {differ} pixels from the categories of the instances there" if differ else ""
    return f"has the id {semantic.max()}, which {DOCUMENT} does not name" if semantic.max() >= len(CATEGORIES) else ""
