"""Boxes of walls and obstacles in the format of Ultralytics YOLO (https://docs.ultralytics.com/datasets/detect/).

Each image has a text file with a line for each visible wall or obstacle: class, x and y of the middle, width and height
of its box, as shares of the width and height of the image.
"""

from collections.abc import Iterator, Mapping

import yaml

from symolo.core.errors import InputError
from symolo.dataset.annotations import Category, PixelBox
from symolo.dataset.documents.splits_record import SplitName
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_images, copied_file
from symolo.exporters.splits import ImagesOfSplits, by_run, further_cameras_of_splits, images_of_splits
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image, RunFolder, how_to_add

CLASSES: tuple[Category, ...] = ("wall", "obstacle")
"""Categories with boxes, in the order of the numbers of their classes."""
_FOLDERS: Mapping[SplitName | None, str] = {None: "train", "train": "train", "validation": "val", "test": "test"}
"""Name of the folder of a split; images of a dataset that is not divided are for training."""
_NO_VALIDATION = "# There is no validation split: val names the images of {}. `symolo export --splits` makes one.\n"


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    check_images(data)
    for run in data.runs:
        if not run.has_annotations or "boxes_2d" not in run.annotations.kinds:
            what = f"run {run.name} has no annotations of the kind `boxes_2d`, which give the boxes"
            raise InputError(what, where=str(data.root), cure=how_to_add("`boxes_2d`"))
    yield from _files_of("", images_of_splits(data))
    for camera in further_cameras_of_splits(data, "boxes_2d"):
        yield from _files_of(f"{camera.folder}/", camera.splits)


def _files_of(folder: str, splits: ImagesOfSplits) -> Iterator[ExportedFile]:
    """Yield the files of one camera."""
    yield ExportedFile(f"{folder}data.yaml", lambda: _description([_FOLDERS[split] for split, _ in splits]))
    for split, images in splits:
        for run, of_run in by_run(images):
            labels = _Labels(run)
            for image in of_run:
                name = f"{_FOLDERS[split]}/{_file_name(image)}"
                yield copied_file(f"{folder}images/{name}{image.path.suffix}", image.path)
                yield ExportedFile(f"{folder}labels/{name}.txt", lambda labels=labels, image=image: labels.text(image))


def _file_name(image: Image) -> str:
    """Return the name of the files of an image, without folders, because readers replace the last folder `images`."""
    return f"{image.run.name.replace('/', '-')}-{image.number:06d}"


def _description(folders: list[str]) -> bytes:
    """Return data.yaml; without `path`, a reader takes the folder of the file itself.

    Readers need the keys `train` and `val`, so a dataset without one of them names another split there.
    """
    train = "train" if "train" in folders else folders[0]
    val = next((name for name in ("val", "test") if name in folders), train)
    content = {"train": f"images/{train}", "val": f"images/{val}"}
    if "test" in folders:
        content["test"] = "images/test"
    names = {"names": dict(enumerate(CLASSES))}
    note = "" if val == "val" else _NO_VALIDATION.format(val)
    return (note + yaml.safe_dump(content | names, sort_keys=False)).encode()


class _Labels:
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


EXPORTER = Exporter(
    "yolo",
    "boxes of walls and obstacles for Ultralytics YOLO; needs the annotation kind `boxes_2d`",
    _files,
)
