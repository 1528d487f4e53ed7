"""A file for each image in the format of BlenderProc, and one file with all tables.

Keys and types are those of its `write_hdf5` with colours, depth, normals, optical flow and a segmentation by
`category_id`, `instance` and `name` (https://dlr-rm.github.io/BlenderProc, release 2.8).
"""

import json
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from symolo.core.extras import optional_module
from symolo.dataset.annotations import DEPTH_UNIT_M, FLOW_PER_PX, FLOW_ZERO, NORMAL_SCALE, NORMAL_ZERO
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.exporters.shared.record import record_of
from symolo.exporters.shared.splits import images_of_splits
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image, RunFolder
from symolo.reader.tables import UNITS

FAR_M = 1e10
"""Depth [m] in Blender where there is no surface."""
_CAMERA = "camera"
_SPLIT = "split"
"""Attribute of the file of an image, and of the tables of a run, if the dataset is divided."""
_PACKED = {"compression": "gzip", "track_times": False}
"""Arguments for compressed data; without times, the same content gives the same bytes."""
Entries = dict[str, np.ndarray | bytes]


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    h5py = optional_module("h5py")
    split_by_image = {
        (image.run.name, image.number): split for split, images in images_of_splits(data) for image in images if split
    }
    yield ExportedFile("tables.hdf5", lambda: _tables(h5py, data))
    split_by_run = data.splits.split_by_run if data.splits else {}
    for run in data.runs:
        for camera in (run, *run.cameras.values()):
            first_bytes = cache(lambda camera=camera: len(_frame(h5py, camera.images[0], None)))
            for image in camera.images:
                split = split_by_image.get((run.name, image.number)) if camera is run else split_by_run.get(run.name)
                yield ExportedFile(
                    f"{camera.name}/{image.index}.hdf5",
                    lambda image=image, split=split: _frame(h5py, image, split),
                    first_bytes,
                )


def _whole(h5py: ModuleType, fill: Callable[[Any], None]) -> bytes:
    """Return the bytes of a file that `fill` fills, made in memory."""
    with h5py.File.in_memory() as file:
        fill(file)
        file.flush()
        return file.id.get_file_image()


def _tables(h5py: ModuleType, data: Dataset) -> bytes:
    """Return a file with a group for each run, in it a group for each table, and in that each column with its unit."""
    split_by_run = data.splits.split_by_run if data.splits else {}

    def fill(file: Any) -> None:  # noqa: ANN401 - of the library
        for run in data.runs:
            names = sorted(run.side_names, key=lambda name: name == _CAMERA)
            tables = {"rows": run.rows} | {name: run.side(name) for name in names}
            tables |= {f"cameras/{name}": camera.side(_CAMERA) for name, camera in run.cameras.items()}
            for name, table in tables.items():
                for column in table:
                    dataset = file.create_dataset(
                        f"{run.name}/{name}/{column}", data=table[column].to_numpy(), **_PACKED
                    )
                    dataset.attrs["unit"] = table.attrs[UNITS][column]
            if run.name in split_by_run:
                file[run.name].attrs[_SPLIT] = split_by_run[run.name]

    return _whole(h5py, fill)


def _frame(h5py: ModuleType, image: Image, split: str | None) -> bytes:
    entries: Entries = {"colors": image.pixels(), "camera_pose": _pose(image), "row": record_of(image)}
    for kind in image.annotation_files:
        entries |= _DECODED[kind](image.annotation(kind), image.run)

    def fill(file: Any) -> None:  # noqa: ANN401 - of the library
        for name, value in entries.items():
            if isinstance(value, bytes):
                file.create_dataset(name, data=np.bytes_(value), track_times=False)
            else:
                file.create_dataset(name, data=value, **_PACKED)
        if split:
            file.attrs[_SPLIT] = split

    return _whole(h5py, fill)


def _pose(image: Image) -> bytes:
    """Return the pose of the camera in OpenCV's convention, as BlenderProc writes it with `save_world2cam`."""
    X_CW = np.linalg.inv(image.X_WC)
    K = image.run.camera.K
    pose = {"cam_K": K.ravel(), "cam_R_w2c": X_CW[:3, :3].ravel(), "cam_t_w2c": X_CW[:3, 3]}
    without_negative_zeros = {name: (values + 0.0).tolist() for name, values in pose.items()}
    return json.dumps(without_negative_zeros, allow_nan=False).encode()


def _depth(stored: np.ndarray, _run: RunFolder) -> Entries:
    metres = np.where(stored > 0, stored * DEPTH_UNIT_M, FAR_M)
    return {"depth": metres.astype(np.float32)}


def _normals(stored: np.ndarray, _run: RunFolder) -> Entries:
    """Return normals in 0..1, in Blender's axes of a camera: x right, y up, z back; 0.5 where there is no surface."""
    normal_C = (stored.astype(np.float64) - NORMAL_ZERO) / NORMAL_SCALE
    has_surface = np.any(stored > 0, axis=-1, keepdims=True)
    return {"normals": np.where(has_surface, 0.5 + 0.5 * normal_C * (1, -1, -1), 0.5).astype(np.float32)}


def _flow(stored: np.ndarray, _run: RunFolder) -> Entries:
    valid = stored[..., 2] > 0
    change_px = (stored[..., :2].astype(np.float64) - FLOW_ZERO) / FLOW_PER_PX
    flow_px = np.where(valid[..., None], change_px, 0).astype(np.float32)
    return {"forward_flow": flow_px, "forward_flow_valid": valid.astype(np.uint8)}


def _instances(stored: np.ndarray, run: RunFolder) -> Entries:
    seen = set(np.unique(stored).tolist())
    known = [{"idx": one.id, "name": one.name, "category_id": one.category_id} for one in run.annotations.instances]
    sky = {"idx": 0, "name": "sky", "category_id": 0}
    attributes = [one for one in (sky, *known) if one["idx"] in seen]
    return {"instance_segmaps": stored, "instance_attribute_maps": json.dumps(attributes, allow_nan=False).encode()}


def _categories(stored: np.ndarray, _run: RunFolder) -> Entries:
    return {"category_id_segmaps": stored}


def _free_floor(stored: np.ndarray, _run: RunFolder) -> Entries:
    return {"free_floor_segmaps": (stored > 0).astype(np.uint8)}


_DECODED: Mapping[str, Callable[[np.ndarray, RunFolder], Entries]] = {
    "depth": _depth,
    "instance": _instances,
    "semantic": _categories,
    "normals": _normals,
    "flow": _flow,
    "free_floor": _free_floor,
}

EXPORTER = Exporter("hdf5", "a file for each image as BlenderProc writes them, and one with all tables", _files)
