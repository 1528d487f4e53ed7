"""Instances of each image with masks, boxes and key points in COCO's format (https://cocodataset.org/#format-data)."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from symolo.core.errors import InputError
from symolo.dataset.annotations import AnnotationEntry, KeyPointSighting, pixel_box
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_labelled, copied_file, run_of
from symolo.exporters.shared.splits import ImagesOfSplits, by_run, further_cameras_of_splits, images_of_splits
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image, RunFolder

_CORNERS = tuple(f"corner_{number}" for number in range(8))
"""Names of a box's corners: 0-3 at the foot, 4-7 above them, counter-clockwise, as in our key points."""
_EDGES = ((1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8))
"""Edges of a box between its corners; COCO counts the points of a skeleton from 1."""
_WITH_CORNERS = ("wall", "obstacle")
"""Categories whose instances have corners."""
_NOT_LABELLED, _HIDDEN, _VISIBLE = 0, 1, 2
"""COCO's flag v of a key point; a key point outside of the image is not labelled."""


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    check_labelled(data, "coco", "instance", "masks")
    cameras: list[tuple[str, Sequence[RunFolder], ImagesOfSplits]] = [("", data.runs, images_of_splits(data))]
    further = further_cameras_of_splits(data, "instance")
    cameras += [(f"{camera.folder}/", camera.runs, camera.splits) for camera in further]
    # Ids are unique over all files, so that users may join the files of splits or cameras.
    max_id = max((one.id for _, runs, _ in cameras for run in runs for one in run.annotations.instances), default=1)
    images_before = 0
    for folder, runs, splits in cameras:
        yield from _files_of(folder, data, runs, splits, _Ids(images_before, max_id))
        images_before += sum(len(images) for _, images in splits)


@dataclass(frozen=True)
class _Ids:
    """Ids of the images and annotations in one file."""

    images_before: int
    """Number of images in the files before."""
    max_instance_id: int
    """Largest id of an instance in any file."""

    def image(self, index: int) -> int:
        """Return the id of the image at an index of the file."""
        return self.images_before + index + 1

    def annotation(self, index: int, instance_id: int) -> int:
        """Return the id of the annotation of an instance in this image."""
        return (self.images_before + index) * self.max_instance_id + instance_id


def _files_of(
    folder: str, data: Dataset, runs: Sequence[RunFolder], splits: ImagesOfSplits, ids: _Ids
) -> Iterator[ExportedFile]:
    """Yield the annotations of one camera in a folder, and its images."""
    known = runs[0].annotations.categories
    for run in runs[1:]:
        if run.annotations.categories != known:
            what, cure = "has different categories than the first run", "export them separately with --runs"
            raise InputError(what, where=str(run.folder), cure=cure)
    for split, images in splits:
        name = "_".join(("instances", *([split] if split else [])))
        yield ExportedFile(
            f"annotations/{folder}{name}.json",
            lambda images=images, ids=ids: _document(data, runs, images, ids),
            lambda images=images: _estimated_bytes(runs, len(images)),
        )
        ids = replace(ids, images_before=ids.images_before + len(images))
    for run in runs:
        for image in run.images:
            yield copied_file(f"images/{_file_name(image)}", image.path)


def _file_name(image: Image) -> str:
    """Return the path of an image within images/."""
    return f"{image.run.name}/{image.path.name}"


def _estimated_bytes(runs: Sequence[RunFolder], count: int) -> int:
    """Return the estimated size of the JSON of `count` images, as if all had the labels of the first of each run."""
    labels = [(run, json.dumps([*_Labels(run).annotations(run.images[0])])) for run in runs if run.numbers]
    all_bytes = sum(len(run.numbers) * len(first_labels) for run, first_labels in labels)
    return all_bytes * count // sum(len(run.numbers) for run in runs)


def _document(data: Dataset, runs: Sequence[RunFolder], chosen: Sequence[Image], ids: _Ids) -> bytes:
    """Return the JSON file of some images of runs or of a camera of runs, in the order of the runs."""
    images, annotations = [], []
    for run, run_images in by_run(chosen):
        labels = _Labels(run)
        for image in run_images:
            index = len(images)
            images.append(_image(image, ids.image(index)))
            for instance_id, annotation in labels.annotations(image):
                numbers = {"id": ids.annotation(index, instance_id), "image_id": ids.image(index)}
                annotations.append(numbers | annotation)
    metadata = data.metadata
    description = metadata.description or metadata.name if metadata else data.root.name
    content = {
        # COCO also has a year and a day, but a release has no date.
        "info": {"description": description, "version": "1"},
        "licenses": [{"id": 1, "name": metadata.licence if metadata else "", "url": ""}],
        "images": images,
        "annotations": annotations,
        "categories": _categories(runs),
    }
    return (json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False) + "\n").encode()


def _image(image: Image, number: int) -> dict[str, object]:
    """Return the entry of an image; COCO does not have the keys `run`, `camera`, `img`, `t_s` and `X_WC`."""
    camera = image.run.camera
    return {
        "id": number,
        "file_name": _file_name(image),
        "width": camera.width_px,
        "height": camera.height_px,
        "license": 1,
        **run_of(image),
        "img": image.number,
        "t_s": image.t_s,
        "X_WC": image.X_WC.tolist(),
    }


def _categories(runs: Sequence[RunFolder]) -> list[dict[str, object]]:
    """Return all categories except the sky: it has no instances, and for many readers its id 0 means "no category"."""
    with_corners = _WITH_CORNERS if any("key_points" in run.annotations.kinds for run in runs) else ()
    return [
        {"id": one.id, "name": one.name, "supercategory": "scene"}
        | ({"keypoints": _CORNERS, "skeleton": _EDGES} if one.name in with_corners else {})
        for one in runs[0].annotations.categories
        if one.id
    ]


class _Labels:
    """Labels of the images of a run, from its annotations."""

    def __init__(self, run: RunFolder) -> None:
        document = run.annotations
        names = {one.id: one.name for one in document.categories}
        self._instances = document.instances
        self._has_corners = {
            one.id: "key_points" in document.kinds and names[one.category_id] in _WITH_CORNERS
            for one in document.instances
        }
        corners = {
            point.id: (point.instance_id, int(point.name.rpartition("_")[2]))
            for point in document.key_points
            if self._has_corners.get(point.instance_id)
        }
        self._sighted: dict[tuple[int, int], dict[int, KeyPointSighting]] = {}
        for sighting in document.sightings:
            if sighting.key_point_id in corners:
                instance, corner = corners[sighting.key_point_id]
                self._sighted.setdefault((sighting.image_id, instance), {})[corner] = sighting
        self._entries = {(one.image_id, one.instance_id): one for one in document.annotations}

    def annotations(self, image: Image) -> Iterator[tuple[int, dict[str, object]]]:
        """Yield the id and the annotation of each instance that has a visible pixel."""
        ids = image.annotation("instance")
        seen = set(np.unique(ids).tolist())
        for one in self._instances:
            if one.id not in seen:
                continue
            mask = ids == one.id
            annotation: dict[str, object] = {
                "category_id": one.category_id,
                "segmentation": {"size": list(mask.shape), "counts": run_lengths(mask)},
                "area": int(mask.sum()),
                "bbox": pixel_box(mask),
                "iscrowd": 0,
                "instance_id": one.id,
                "name": one.name,
            }
            key = image.number, one.id
            yield one.id, annotation | self._corners(key) | _amodal(self._entries.get(key))

    def _corners(self, key: tuple[int, int]) -> dict[str, object]:
        if not self._has_corners[key[1]]:
            return {}
        sighted = self._sighted.get(key, {})
        points = [_flagged(sighted.get(corner)) for corner in range(len(_CORNERS))]
        return {"keypoints": [number for point in points for number in point], "num_keypoints": len(sighted)}


def _flagged(sighting: KeyPointSighting | None) -> tuple[float, float, int]:
    """Return x, y and the flag v; (0, 0) is the middle of the first pixel, in COCO as in our annotations."""
    if sighting is None:
        return 0, 0, _NOT_LABELLED
    return *sighting.pixel, _VISIBLE if sighting.visible else _HIDDEN


def _amodal(entry: AnnotationEntry | None) -> dict[str, object]:
    """Return the numbers of `boxes_2d` that cannot be computed from the mask; COCO's readers ignore them."""
    names = ("amodal_bbox", "amodal_area", "visible_fraction", "truncated")
    values = asdict(entry) if entry else {}
    return {name: values[name] for name in names if values.get(name) is not None}


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Return COCO's uncompressed RLE of a mask (H, W): lengths of runs along the columns, of 0 and 1 alternately.

    pycocotools (2.0.11) writes only the compressed form, which people cannot read, and a compiled dependency would cost
    more than these lines.
    """
    pixels = mask.ravel(order="F")
    bounds = [0, *(np.flatnonzero(pixels[1:] != pixels[:-1]) + 1).tolist(), pixels.size]
    lengths = [after - before for before, after in pairwise(bounds)]
    return [0, *lengths] if pixels[0] else lengths


EXPORTER = Exporter(
    "coco",
    "masks, boxes and corners of the visible instances; needs the annotation kind `instance`",
    _files,
)
