"""Recordings for the viewer of Rerun (https://rerun.io), one for each run: arena, robot, what it saw and read."""

from collections.abc import Iterator
from functools import partial
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from symolo.arena.geometry import Arena, Box
from symolo.core.arrays import Array
from symolo.core.extras import optional_module
from symolo.core.files.file_hashes import sha256_of
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.geometry.poses import rotations_about_z
from symolo.dataset.manifest import MANIFEST
from symolo.dataset.tables.rows import COLUMNS
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, MadeFile
from symolo.exporters.rrd_file import Arrays, Chunk, Component, rrd
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run

_RIGHT_FORWARD_UP, _RIGHT_DOWN_FORWARD = (3, 5, 1), (3, 2, 5)
"""Directions of x, y and z as Rerun numbers them: W of its default view, and the camera's optical frame C."""
_CAMERA = "/world/camera"
_RANGES = ("d_f", "d_l", "d_r")
_IMAGE_PLANE_M = 0.15
"""How far before the camera the viewer shows its image."""


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    arrow = optional_module("pyarrow")
    release = sha256_of(data.root / MANIFEST)[:16]
    for run in data.runs:
        yield MadeFile(f"{run.name}.rrd", partial(_recording, arrow, run, f"{release}/{run.name}"))


def _recording(arrow: ModuleType, run: Run, recording: str) -> bytes:
    maker = _Maker(arrow)
    arena = Arena.from_config(run.spec.arena)
    chunks = [maker.view("/world", _RIGHT_FORWARD_UP), *_line(maker, arena)]
    for box in arena.boxes:
        chunks += _box(maker, box, run)
    chunks += [*_robot(maker, run), *_camera(maker, run), *_plots(maker, run)]
    return rrd(arrow, recording, chunks)


def _line(maker: "_Maker", arena: Arena) -> Iterator[Chunk]:
    """The outline of each piece of the tape, closed."""
    outlines = [np.concatenate((left, right[::-1], left[:1])) for left, right in arena.line.edges()]
    if outlines:
        yield maker.strips("/world/line", outlines)


def _box(maker: "_Maker", box: Box, run: Run) -> Iterator[Chunk]:
    """A wall or an obstacle; one that moves has a pose at each row."""
    path = f"/world/{box.kind}s/{box.name}"
    half = 0.5 * np.array([box.size])
    yield Chunk(path, "Boxes3D", (Component("half_sizes", "HalfSize3D", maker.one(maker.vectors(half))),))
    t_s = run.t_s if box.motion is not None else np.zeros(1)
    if box.motion is None:
        poses = box.poses_at(t_s)
    else:
        table = run.side("obstacles")
        poses = np.column_stack([table[f"{box.name}_{field}"] for field in ("x", "y", "theta")])
    places = np.column_stack((poses[:, :2], np.full(len(poses), box.center[2])))
    yield maker.transform(path, places, rotations_about_z(poses[:, 2]), t_s if box.motion is not None else None)


def _robot(maker: "_Maker", run: Run) -> Iterator[Chunk]:
    """Its pose at each row, its chassis as a box, and its way."""
    pose, chassis = run.table.pose, run.spec.robot.chassis
    floor = np.column_stack((pose[:, :2], np.zeros(len(pose))))
    yield maker.transform("/world/robot", floor, rotations_about_z(pose[:, 2]), run.t_s)
    height_m = 2 * chassis.base_height_m
    half = 0.5 * np.array([[chassis.length_m, chassis.width_m, height_m]])
    middle = np.array([[0.0, 0.0, 0.5 * height_m]])
    shape = (
        Component("half_sizes", "HalfSize3D", maker.one(maker.vectors(half))),
        Component("centers", "PoseTranslation3D", maker.one(maker.vectors(middle))),
    )
    yield Chunk("/world/robot/chassis", "Boxes3D", shape)
    yield maker.strips("/world/way", [pose[:, :2]])


def _camera(maker: "_Maker", run: Run) -> Iterator[Chunk]:
    """Its pose, its lens without the distortion, and the files of its images as they are."""
    images = run.images
    if not images:
        return
    t_s = np.array([image.t_s for image in images])
    yield maker.transform(_CAMERA, run.X_WC[:, :3, 3], run.X_WC[:, :3, :3], t_s)
    K, width_px, height_px = np.array(run.camera.K), run.camera.width_px, run.camera.height_px
    lens = (
        Component("image_from_camera", "PinholeProjection", maker.one(maker.matrices(K[None]))),
        Component("resolution", "Resolution", maker.one(maker.fixed(np.array([[width_px, height_px]])))),
        Component("camera_xyz", "ViewCoordinates", maker.one(maker.directions(_RIGHT_DOWN_FORWARD))),
        Component("image_plane_distance", "ImagePlaneDistance", maker.one(maker.floats([_IMAGE_PLANE_M]))),
    )
    yield Chunk(f"{_CAMERA}/image", "Pinhole", lens)
    jpeg = [read_file(image.path, FileKind.IMAGE) for image in images]
    encoded = (
        Component("blob", "Blob", maker.each(maker.blobs(jpeg))),
        Component("media_type", "MediaType", maker.each(maker.texts(["image/jpeg"] * len(jpeg)))),
    )
    yield Chunk(f"{_CAMERA}/image", "EncodedImage", encoded, t_s)


def _plots(maker: "_Maker", run: Run) -> Iterator[Chunk]:
    """Every other column of data.csv but the number of the image, ranges with gaps where no target was seen."""
    table, none = run.table.table(), run.spec.robot.tof.no_target_m
    for column, values in zip(COLUMNS, table.T, strict=True):
        if column.name in {"t", "x", "y", "theta", "img"}:
            continue
        seen = values != round(none, column.decimals) if column.name in _RANGES else np.ones(len(values), np.bool_)
        yield Chunk(_plot(column.name), "Scalars", (Component("scalars", "Scalar", maker.some(values, seen)),), run.t_s)


def _plot(column: str) -> str:
    """Its path; the viewer shows what begins alike in one plot."""
    if column == "state":  # its numbers are larger than any speed
        return "/state"
    return f"/{'range' if column in _RANGES else 'line' if column.startswith('L') else 'motion'}/{column}"


class _Maker:
    """Arrays of Arrow in the types of Rerun's components."""

    def __init__(self, arrow: ModuleType) -> None:
        self._arrow = arrow

    def view(self, path: str, directions: tuple[int, int, int]) -> Chunk:
        return Chunk(
            path, "ViewCoordinates", (Component("xyz", "ViewCoordinates", self.one(self.directions(directions))),)
        )

    def transform(self, path: str, places: Array, rotations: Array, t_s: Array | None) -> Chunk:
        """The pose of an entity in that which it stands below; (N, 3) and (N, 3, 3)."""
        translation = Component("translation", "Translation3D", self.each(self.vectors(places)))
        return Chunk(
            path,
            "Transform3D",
            (translation, Component("mat3x3", "TransformMat3x3", self.each(self.matrices(rotations)))),
            t_s,
        )

    def strips(self, path: str, floor: list[Array]) -> Chunk:
        """Lines on the floor, (N, 2) each."""
        points = [np.column_stack((line, np.zeros(len(line)))) for line in floor]
        ends = np.cumsum([0, *map(len, points)])
        inner = self._arrow.list_(self._arrow.field("item", self._vector(3), nullable=False))
        found = self._arrow.ListArray.from_arrays(self._offsets(ends), self.vectors(np.concatenate(points)), type=inner)
        return Chunk(path, "LineStrips3D", (Component("strips", "LineStrip3D", self.one(found)),))

    def vectors(self, values: Array) -> Arrays:
        """(N, 3)."""
        return self.fixed(values)

    def matrices(self, values: Array) -> Arrays:
        """(N, 3, 3), by columns."""
        return self.fixed(values.transpose(0, 2, 1).reshape(-1, 9))

    def fixed(self, values: NDArray[np.generic]) -> Arrays:
        """(N, k), as 32 bits."""
        flat = self._arrow.array(values.astype(np.float32).ravel())
        return self._arrow.FixedSizeListArray.from_arrays(flat, type=self._vector(values.shape[1]))

    def directions(self, of_axes: tuple[int, int, int]) -> Arrays:
        kind = self._arrow.list_(self._arrow.field("item", self._arrow.uint8(), nullable=False), 3)
        return self._arrow.array([of_axes], kind)

    def floats(self, values: list[float]) -> Arrays:
        return self._arrow.array(values, self._arrow.float32())

    def texts(self, values: list[str]) -> Arrays:
        return self._arrow.array(values)

    def blobs(self, values: list[bytes]) -> Arrays:
        kind = self._arrow.list_(self._arrow.field("item", self._arrow.uint8(), nullable=False))
        flat = self._arrow.array(np.frombuffer(b"".join(values), np.uint8))
        return self._arrow.ListArray.from_arrays(self._offsets(np.cumsum([0, *map(len, values)])), flat, type=kind)

    def one(self, values: Arrays) -> Arrays:
        """All values in one row."""
        return self._arrow.ListArray.from_arrays(self._offsets(np.array([0, len(values)])), values)

    def each(self, values: Arrays) -> Arrays:
        """Each value in a row of its own."""
        return self._arrow.ListArray.from_arrays(self._offsets(np.arange(len(values) + 1)), values)

    def some(self, values: Array, seen: NDArray[np.bool_]) -> Arrays:
        """Numbers of 64 bits, each in a row of its own; a row that is not `seen` has none."""
        return self._arrow.ListArray.from_arrays(
            self._offsets(np.concatenate(([0], np.cumsum(seen)))), self._arrow.array(values[seen])
        )

    def _vector(self, length: int) -> Arrays:
        return self._arrow.list_(self._arrow.field("item", self._arrow.float32(), nullable=False), length)

    def _offsets(self, ends: NDArray[np.generic]) -> Arrays:
        return self._arrow.array(ends.astype(np.int32))


EXPORTER = Exporter("rerun", "a recording of each run for Rerun's viewer: arena, robot, images, readings", _files)
