"""Boxes, or polygons, of what images show in the format of Ultralytics YOLO.

Each image has a text file with a line for each visible object. For detection
(https://docs.ultralytics.com/datasets/detect/), it has class, x and y of the middle, width and height of the box of a
wall or obstacle. For segmentation (https://docs.ultralytics.com/datasets/segment/), it has the class and x and y of
each vertex of a polygon around the visible part of a wall, an obstacle or the line. All are shares of the width and
height of the image.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import yaml

from symolo.dataset.annotations import AnnotationName, Category, PixelBox
from symolo.dataset.documents.splits_record import SplitName
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_labelled, copied_file
from symolo.exporters.shared.polygons import polygon_of
from symolo.exporters.shared.splits import ImagesOfSplits, by_run, further_cameras_of_splits, images_of_splits
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image, RunFolder

CLASSES: tuple[Category, ...] = ("wall", "obstacle")
"""Categories with boxes, in the order of the numbers of their classes."""
CLASSES_OF_POLYGONS: tuple[Category, ...] = (*CLASSES, "line")
_FOLDERS: Mapping[SplitName | None, str] = {None: "train", "train": "train", "validation": "val", "test": "test"}
"""Name of the folder of a split; images of a dataset that is not divided are for training."""
_NO_VALIDATION = "# There is no validation split: val names the images of {}. `symolo export --splits` makes one.\n"


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    labelling = _POLYGONS if settings.polygons else _BOXES
    check_labelled(data, "yolo", labelling.kind, labelling.what)
    yield from _files_of("", images_of_splits(data), labelling)
    for camera in further_cameras_of_splits(data, labelling.kind):
        yield from _files_of(f"{camera.folder}/", camera.splits, labelling)


def _files_of(folder: str, splits: ImagesOfSplits, labelling: "_Labelling") -> Iterator[ExportedFile]:
    """Yield the files of one camera."""
    folders = [_FOLDERS[split] for split, _ in splits]
    yield ExportedFile(f"{folder}data.yaml", lambda: _description(folders, labelling.classes))
    for split, images in splits:
        for run, run_images in by_run(images):
            labels = labelling.labels(run)
            for image in run_images:
                name = f"{_FOLDERS[split]}/{_file_name(image)}"
                yield copied_file(f"{folder}images/{name}{image.path.suffix}", image.path)
                yield ExportedFile(f"{folder}labels/{name}.txt", lambda labels=labels, image=image: labels.text(image))


def _file_name(image: Image) -> str:
    """Return the name of the files of an image, without folders, because readers replace the last folder `images`."""
    return f"{image.run.name.replace('/', '-')}-{image.number:06d}"


def _description(folders: list[str], classes: Sequence[Category]) -> bytes:
    """Return data.yaml; without `path`, a reader takes the folder of the file itself.

    Readers need the keys `train` and `val`, so a dataset without one of them names another split there.
    """
    train = "train" if "train" in folders else folders[0]
    val = next((name for name in ("val", "test") if name in folders), train)
    content = {"train": f"images/{train}", "val": f"images/{val}"}
    if "test" in folders:
        content["test"] = "images/test"
    names = {"names": dict(enumerate(classes))}
    note = "" if val == "val" else _NO_VALIDATION.format(val)
    return (note + yaml.safe_dump(content | names, sort_keys=False)).encode()


class _Boxes:
    """Boxes of the images of a run, from its annotations."""

    def __init__(self, run: RunFolder) -> None:
        document = run.annotations
        classes = {one.id: CLASSES.index(one.name) for one in document.categories if one.name in CLASSES}
        self._boxes: dict[int, list[tuple[int, PixelBox]]] = {}
        for one in document.annotations:
            if one.area and one.bbox is not None:  # an area of 0 is a wall or obstacle that is hidden completely
                self._boxes.setdefault(one.image_id, []).append((classes[one.category_id], one.bbox))
        self._size_px = run.camera.width_px, run.camera.height_px

    def text(self, image: Image) -> bytes:
        """Return the label file of an image, empty if it shows no wall or obstacle."""
        width_px, height_px = self._size_px
        lines = []
        for number, (x, y, w, h) in self._boxes.get(image.number, ()):
            middle = f"{(x + w / 2) / width_px:.6f} {(y + h / 2) / height_px:.6f}"
            lines.append(f"{number} {middle} {w / width_px:.6f} {h / height_px:.6f}\n")
        return "".join(lines).encode()


class _Polygons:
    """Polygons of the images of a run, from its masks of instances."""

    def __init__(self, run: RunFolder) -> None:
        document = run.annotations
        names = {one.id: one.name for one in document.categories}
        self._classes = {
            one.id: CLASSES_OF_POLYGONS.index(name)
            for one in document.instances
            if (name := names[one.category_id]) in CLASSES_OF_POLYGONS
        }
        self._size_px = run.camera.width_px, run.camera.height_px

    def text(self, image: Image) -> bytes:
        """Return the label file of an image, empty if it shows no wall, obstacle or line."""
        ids = image.annotation("instance")
        seen = set(np.unique(ids).tolist())
        lines = []
        for instance, number in self._classes.items():
            if instance in seen:
                shares = polygon_of(ids == instance) / self._size_px
                lines.append(" ".join((str(number), *(f"{share:.6f}" for share in shares.ravel().tolist()))) + "\n")
        return "".join(lines).encode()


@dataclass(frozen=True)
class _Labelling:
    """One of the two kinds of labels."""

    kind: AnnotationName
    """Kind of annotations that it needs."""
    what: str
    """Description in one word."""
    classes: Sequence[Category]
    """Categories in the order of the numbers of their classes."""
    labels: Callable[[RunFolder], _Boxes | _Polygons]
    """Function that returns the labels of a run or camera."""


_BOXES = _Labelling("boxes_2d", "boxes", CLASSES, _Boxes)
_POLYGONS = _Labelling("instance", "polygons", CLASSES_OF_POLYGONS, _Polygons)

EXPORTER = Exporter(
    "yolo",
    "boxes of walls and obstacles for Ultralytics YOLO, from the annotation kind `boxes_2d`; with --polygons, polygons "
    "from the kind `instance`",
    _files,
)
