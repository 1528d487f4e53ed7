"""Recordings for the viewer of Rerun (https://rerun.io), one for each run: arena, robot, images and readings."""

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
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.exporters.rerun.rrd_file import Arrays, Chunk, Component, rrd
from symolo.exporters.shared.stereo import OWN_CAMERA, cameras_with_images
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import RunFolder
from symolo.reader.scans import scan_points

_RIGHT_FORWARD_UP, _RIGHT_DOWN_FORWARD = (3, 5, 1), (3, 2, 5)
"""Directions of x, y and z in Rerun's numbers, for the frame W of its default view and for the camera's frame C."""
_CAMERA, _FURTHER_CAMERAS = "/world/camera", "/world/cameras"
_RANGES = ("d_f", "d_l", "d_r")
_RANGE_KINDS = ("vl53l0x", "ultrasonic")
_IMAGE_PLANE_M = 0.15
"""Distance from the camera to its image in the viewer."""


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    arrow = optional_module("pyarrow")
    release = sha256_of(data.root / MANIFEST)[:16]
    for run in data.runs:
        yield ExportedFile(f"{run.name}.rrd", partial(_recording, arrow, run, f"{release}/{run.name}"))


def _recording(arrow: ModuleType, run: Run, recording: str) -> bytes:
    maker = _Arrays(arrow)
    arena = Arena.from_config(run.spec.arena)
    axes = Component("xyz", "ViewCoordinates", maker.one(maker.directions(_RIGHT_FORWARD_UP)))
    chunks = [Chunk("/world", "ViewCoordinates", (axes,)), *_line(maker, arena)]
    for box in arena.boxes:
        chunks += _box(maker, box, run)
    chunks += [*_robot(maker, run), *_cameras(maker, run), *_plots(maker, run), *_sensors(maker, run)]
    return rrd(arrow, recording, chunks)


def _line(maker: "_Arrays", arena: Arena) -> Iterator[Chunk]:
    """Yield the closed outline of each piece of the tape."""
    outlines = [np.concatenate((left, right[::-1], left[:1])) for left, right in arena.line.edges()]
    if outlines:
        yield maker.strips("/world/line", outlines)


def _box(maker: "_Arrays", box: Box, run: Run) -> Iterator[Chunk]:
    """Yield a wall or an obstacle; an obstacle that moves has a pose at each row."""
    path = f"/world/{box.kind}s/{box.name}"
    half_size = 0.5 * np.array([box.size])
    yield Chunk(path, "Boxes3D", (Component("half_sizes", "HalfSize3D", maker.one(maker.fixed(half_size))),))
    if box.motion is None:
        t_s, poses = None, box.poses_at(np.zeros(1))
    else:
        t_s, table = run.t_s, run.side("obstacles")
        poses = np.column_stack([table[f"{box.name}_{field}"] for field in ("x", "y", "theta")])
    positions = np.column_stack((poses[:, :2], np.full(len(poses), box.center[2])))
    yield maker.transform(path, positions, rotations_about_z(poses[:, 2]), t_s)


def _robot(maker: "_Arrays", run: Run) -> Iterator[Chunk]:
    """Yield the robot's pose at each row, its chassis as a box, and its path."""
    pose, chassis = run.table.pose, run.spec.robot.chassis
    positions = np.column_stack((pose[:, :2], np.zeros(len(pose))))
    yield maker.transform("/world/robot", positions, rotations_about_z(pose[:, 2]), run.t_s)
    height_m = 2 * chassis.base_height_m
    half_size = 0.5 * np.array([[chassis.length_m, chassis.width_m, height_m]])
    middle = np.array([[0.0, 0.0, 0.5 * height_m]])
    shape = (
        Component("half_sizes", "HalfSize3D", maker.one(maker.fixed(half_size))),
        Component("centers", "PoseTranslation3D", maker.one(maker.fixed(middle))),
    )
    yield Chunk("/world/robot/chassis", "Boxes3D", shape)
    yield maker.strips("/world/way", [pose[:, :2]])


def _cameras(maker: "_Arrays", run: Run) -> Iterator[Chunk]:
    for name, camera in cameras_with_images(run).items():
        yield from _camera(maker, _CAMERA if name == OWN_CAMERA else f"{_FURTHER_CAMERAS}/{name}", camera)


def _camera(maker: "_Arrays", path: str, camera: RunFolder) -> Iterator[Chunk]:
    """Yield the camera's pose, its lens without the distortion, and the unchanged image files.

    Rerun has no fisheye lens, so such images stand beside the scene.
    """
    images, model = camera.images, camera.camera
    t_s = np.array([image.t_s for image in images])
    yield maker.transform(path, camera.X_WC[:, :3, 3], camera.X_WC[:, :3, :3], t_s)
    arrow, K = maker.arrow, model.K
    lens = (
        Component("image_from_camera", "PinholeProjection", maker.one(maker.fixed(K.T.reshape(1, 9)))),
        Component("resolution", "Resolution", maker.one(maker.fixed(np.array([[model.width_px, model.height_px]])))),
        Component("camera_xyz", "ViewCoordinates", maker.one(maker.directions(_RIGHT_DOWN_FORWARD))),
        Component(
            "image_plane_distance", "ImagePlaneDistance", maker.one(arrow.array([_IMAGE_PLANE_M], arrow.float32()))
        ),
    )
    if model.camera_model == "pinhole":
        yield Chunk(f"{path}/image", "Pinhole", lens)
    jpeg = [read_file(image.path, FileKind.IMAGE) for image in images]
    encoded = (
        Component("blob", "Blob", maker.each(maker.blobs(jpeg))),
        Component("media_type", "MediaType", maker.each(arrow.array(["image/jpeg"] * len(jpeg)))),
    )
    yield Chunk(f"{path}/image", "EncodedImage", encoded, t_s)


def _sensors(maker: "_Arrays", run: Run) -> Iterator[Chunk]:
    """Yield the points of each lidar in W, and the readings of all other sensors with gaps where nothing was seen."""
    for name, sensor in run.sensors.items():
        if sensor.kind == "lidar":
            yield maker.points(f"/world/lidars/{name}", scan_points(run, sensor), sensor.t_s)
            continue
        seen = ~np.isnan(sensor.numbers)
        if sensor.kind in _RANGE_KINDS:
            seen &= ~sensor.no_target[:, None]
        for i, cell in enumerate(sensor.side_table.cells[1:], start=1):
            scalars = Component("scalars", "Scalar", maker.some(sensor.numbers[:, i], seen[:, i]))
            yield Chunk(f"/sensors/{name}/{cell.name}", "Scalars", (scalars,), sensor.t_s)


def _plots(maker: "_Arrays", run: Run) -> Iterator[Chunk]:
    """Yield the readings of data.csv; there are gaps where nothing was measured or no target was seen."""
    for column, values in zip(run.table.definitions, run.table.table().T, strict=True):
        if column.name in {"t", "x", "y", "theta", "img"}:
            continue
        seen = ~np.isnan(values)
        if column.name in _RANGES:
            no_target_m = run.spec.robot.tof.no_target_m
            seen &= values != round(no_target_m, column.decimals)  # as data.csv holds it
        scalars = Component("scalars", "Scalar", maker.some(values, seen))
        yield Chunk(_plot(column.name), "Scalars", (scalars,), run.t_s)


def _plot(column: str) -> str:
    """Return the path of a column; the viewer shows the columns of one folder in one plot."""
    if column == "state":  # its numbers are larger than any speed
        return "/state"
    return f"/{'range' if column in _RANGES else 'line' if column.startswith('L') else 'motion'}/{column}"


class _Arrays:
    """Makes arrays of pyarrow in the types of Rerun's components."""

    def __init__(self, arrow: ModuleType) -> None:
        self.arrow = arrow

    def transform(self, path: str, positions: Array, rotations: Array, t_s: Array | None) -> Chunk:
        """Return the poses of an entity in the frame of its parent: positions (N, 3) [m], rotations (N, 3, 3)."""
        columns = rotations.transpose(0, 2, 1).reshape(-1, 9)  # Rerun stores matrices by columns
        pose = (
            Component("translation", "Translation3D", self.each(self.fixed(positions))),
            Component("mat3x3", "TransformMat3x3", self.each(self.fixed(columns))),
        )
        return Chunk(path, "Transform3D", pose, t_s)

    def strips(self, path: str, lines: list[Array]) -> Chunk:
        """Return lines on the floor, (N, 2) each."""
        points = self.fixed(np.concatenate([np.column_stack((line, np.zeros(len(line)))) for line in lines]))
        strips = self._lists(np.cumsum([0, *map(len, lines)]), points, self._required(points.type))
        return Chunk(path, "LineStrips3D", (Component("strips", "LineStrip3D", self.one(strips)),))

    def points(self, path: str, points: Array, t_s: Array) -> Chunk:
        """Return points (N, M, 3) [m], N at a time; points that are NaN are left out."""
        seen = np.isfinite(points).all(axis=2)
        ends = np.concatenate(([0], np.cumsum(seen.sum(axis=1))))
        positions = self._lists(ends, self.fixed(points[seen]))
        return Chunk(path, "Points3D", (Component("positions", "Position3D", positions),), t_s)

    def fixed(self, values: NDArray[np.generic]) -> Arrays:
        """Return vectors (N, k) of 32 bit numbers."""
        flat = self.arrow.array(values.astype(np.float32).ravel())
        return self.arrow.FixedSizeListArray.from_arrays(flat, type=self._required(flat.type, values.shape[1]))

    def directions(self, axes: tuple[int, int, int]) -> Arrays:
        """Return three directions in Rerun's numbers."""
        return self.arrow.array([axes], self._required(self.arrow.uint8(), 3))

    def blobs(self, values: list[bytes]) -> Arrays:
        flat = self.arrow.array(np.frombuffer(b"".join(values), np.uint8))
        return self._lists(np.cumsum([0, *map(len, values)]), flat, self._required(flat.type))

    def one(self, values: Arrays) -> Arrays:
        """Return one row with all values."""
        return self._lists(np.array([0, len(values)]), values)

    def each(self, values: Arrays) -> Arrays:
        """Return a row for each value."""
        return self._lists(np.arange(len(values) + 1), values)

    def some(self, values: Array, seen: NDArray[np.bool_]) -> Arrays:
        """Return a row for each number of 64 bits; rows that are not `seen` are empty."""
        return self._lists(np.concatenate(([0], np.cumsum(seen))), self.arrow.array(values[seen]))

    def _lists(self, ends: NDArray[np.generic], values: Arrays, kind: Arrays | None = None) -> Arrays:
        """Return values in lists that end at these indices; the first index is 0."""
        return self.arrow.ListArray.from_arrays(self.arrow.array(ends.astype(np.int32)), values, type=kind)

    def _required(self, kind: Arrays, length: int = -1) -> Arrays:
        """Return the type of lists without nulls; if a length is given, all lists have it."""
        return self.arrow.list_(self.arrow.field("item", kind, nullable=False), length)


EXPORTER = Exporter("rerun", "a recording of each run for Rerun's viewer: arena, robot, images, readings", _files)
