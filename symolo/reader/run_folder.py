"""A folder of a run: rows, side tables, camera, images and annotations, each read when it is needed."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import ValidationError

from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.annotations import DOCUMENT, ENCODINGS, RECORD_KINDS, AnnotationDocument, annotation_file
from symolo.dataset.codes import TofStatus
from symolo.dataset.documents.camera_model import INTRINSICS, read_camera_document
from symolo.dataset.documents.metadata import side_tables
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.layout import ANNOTATIONS, DATA, IMAGES, SIDE, SPEC, frame_name
from symolo.dataset.pixels import decoded
from symolo.dataset.tables.camera_rows import main_camera_rows
from symolo.dataset.tables.rows import RANGES, Rows, read_rows
from symolo.dataset.tables.side_reading import first_fault, read_side
from symolo.dataset.tables.side_tables import CAMERA, TOF, SideTable
from symolo.reader.calibrated_camera import CalibratedCamera
from symolo.reader.tables import frame, rows_frame

_IMAGE_KINDS = ENCODINGS.keys() - set(RECORD_KINDS)

Pixels = NDArray[np.uint8]


@dataclass(frozen=True)
class Image:
    """One image of a run, with the pose of robot and camera; its file is opened by `pixels`."""

    run: "RunFolder"
    number: int
    """Number in the column `img` of data.csv, from 1."""
    index: int
    """Place among the run's images, from 0."""
    row: int
    """Row of data.csv at which it was taken, from 0; the last one before, if it was taken between two."""

    @property
    def t_s(self) -> float:
        """Time since the start of the run: the middle of the exposure."""
        return float(self.run.image_table.t_ms[self.index]) / 1000

    @property
    def pose(self) -> Array:
        """(3,), x [m], y [m], theta [rad] of the robot in W."""
        return self.run.image_table.pose[self.index]

    @property
    def X_WC(self) -> Array:
        """(4, 4), pose of the camera in W; C is the optical frame, x right, y down, z forward."""
        return self.run.X_WC[self.index]

    @property
    def path(self) -> Path:
        return self.run.image_path(self.number)

    def pixels(self) -> Pixels:
        """Return the pixels (H, W, 3), uint8, red, green, blue.

        Raises:
            InputError: The file is missing or no image.
        """
        pixels = self._decoded(self.path)
        if pixels.ndim != 3 or pixels.dtype != np.uint8:
            raise InputError("is no colour image with 8 bits", where=str(self.path), cure="make the run again")
        return pixels

    def annotation(self, kind: str) -> np.ndarray:
        """Return an annotation as stored, (H, W) or (H, W, 3), red, green, blue; docs/annotations.md decodes it.

        Args:
            kind: depth, instance, semantic, normals, flow or free_floor.

        Raises:
            InputError: The run has no such annotation, this image lacks it, or the file is no image.
        """
        known = self.run.annotation_kinds
        if kind not in known:
            cure = how_to_add(f"`{kind}`") if kind in _IMAGE_KINDS else ""
            raise _lacking(f"annotation {kind}", known, kind, str(self.run.folder), cure)
        path = self.run.annotation_path(kind, self.number)
        if kind == "flow" and not path.exists() and self.number == self.run.numbers[-1]:
            raise InputError(f"image {self.number} is the last, which has no flow", where=str(self.run.folder))
        return self._decoded(path)

    @property
    def annotation_files(self) -> dict[str, Path]:
        """Files of the annotations by kind; the last image of a run has no flow."""
        paths = {kind: self.run.annotation_path(kind, self.number) for kind in self.run.annotation_kinds}
        return {kind: path for kind, path in paths.items() if path.is_file()}

    def mask(self, name: str) -> NDArray[np.bool_]:
        """Return where a category (`line`, `wall`...) or an instance (as the arena calls it) is seen, (H, W).

        Raises:
            InputError: There is neither of this name, or the run has no such annotations.
        """
        document = self.run.annotations
        categories = {one.name: one.id for one in document.categories}
        instances = {one.name: one.id for one in document.instances}
        if name in categories and "semantic" in self.run.annotation_kinds:
            return self.annotation("semantic") == categories[name]
        if name in categories:
            sky_ids = [0] if categories[name] == 0 else []  # the sky, where no surface is met
            ids = [one.id for one in document.instances if one.category_id == categories[name]]
            return np.isin(self.annotation("instance"), np.array(sky_ids + ids, dtype=np.uint16))
        if name in instances:
            return self.annotation("instance") == instances[name]
        raise _lacking(f"mask {name}", tuple(dict.fromkeys((*categories, *instances))), name, str(self.run.folder))

    def _decoded(self, path: Path) -> np.ndarray:
        """Return the pixels of a file with the size of the run's images, in the file's own type, red first."""
        try:
            size = self.run.camera.width_px, self.run.camera.height_px
        except InputError:  # such as of a dataset without side tables
            size = None
        try:
            pixels = decoded(path, size)
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        if pixels is None:
            what = "is no image" + (f" of {size[0]} x {size[1]} px" if size else "") if path.exists() else "is missing"
            cure = "check or repair the whole release with `symolo verify` or `symolo repair`"
            raise InputError(what, where=str(path), cure=cure)
        return pixels if pixels.ndim == 2 else np.ascontiguousarray(pixels[..., ::-1])


@dataclass(frozen=True)
class RunFolder:
    """A folder with the rows, images and annotations of a run; files are opened when they are needed."""

    folder: Path
    name: str
    """Name of the run, for example `CW/test_1`."""
    sensor_tables: tuple[SideTable, ...] = field(default=(), repr=False)
    """Tables of the sensors of `robot.sensors`, as metadata.json describes them."""
    image_folder: Path | None = field(default=None, repr=False)
    """Folder of the images of a run that is not released; by default that within `folder`."""

    @cached_property
    def table(self) -> Rows:
        """data.csv as arrays, read only.

        Raises:
            InputError: The first fault of the file, with its line and column.
        """
        return read_rows(self.folder / DATA)

    @property
    def rows(self) -> pd.DataFrame:
        """data.csv, one row per control period, columns and units as in the file; `attrs["units"]` names them."""
        return rows_frame(self.table)

    @property
    def image_rows(self) -> pd.DataFrame:
        """Rows of `image_table`, by the number of the image. Row i belongs to the i-th image and the i-th X_WC."""
        return rows_frame(self.image_table).set_index("img", drop=False)

    @cached_property
    def image_table(self) -> Rows:
        """A row for each image: that of data.csv at which it was taken.

        An image between two rows has pose and speeds at its time, and everything else of the last row before it.

        Raises:
            InputError: data.csv or spec.json is damaged.
        """
        has_spec = (self.folder / SIDE / SPEC).is_file()
        rows = main_camera_rows(self.table, self.spec.rates if has_spec else None)
        if self.image_folder is None:
            return rows
        return rows.where(np.array([self.image_path(number).is_file() for number in rows.image.tolist()], dtype=bool))

    @property
    def t_s(self) -> Array:
        """(N,), time of each row [s]."""
        return self.table.t_ms / 1000

    @cached_property
    def spec(self) -> RunDocument:
        """The fields of side/spec.json that the library needs; `specification` has them all.

        Raises:
            InputError: The file is missing or damaged.
        """
        path, content = self.folder / SIDE / SPEC, self.specification
        try:
            return RunDocument.model_validate_json(json.dumps(content))
        except ValidationError as error:
            raise InputError(f"is damaged: {first_fault(error)}", where=str(path)) from None

    @cached_property
    def specification(self) -> dict[str, Any]:
        """Every number that the run was made from, as plain data: the content of side/spec.json.

        Raises:
            InputError: The file is missing or damaged.
        """
        path = self.folder / SIDE / SPEC
        try:
            return json.loads(read_file(path, FileKind.DOCUMENT))
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        except (ValueError, RecursionError) as error:
            raise InputError(f"is damaged: {error}", where=str(path)) from None

    @property
    def side_names(self) -> tuple[str, ...]:
        """What `side` takes."""
        return tuple(table.name for table in self._side_tables)

    @property
    def _side_tables(self) -> tuple[SideTable, ...]:
        return (*side_tables(self.spec, has_images=bool(self.numbers)), *self.sensor_tables)

    def side(self, name: str) -> pd.DataFrame:
        """Return a table below `side/`, such as `wheels`.

        Its rows are those of `rows`, those of `image_rows` for `camera`, or the samples of a sensor.

        Raises:
            InputError: There is none of this name, or it is damaged or of other times than data.csv.
        """
        table = next((table for table in self._side_tables if table.name == name), None)
        if table is None:
            allowed, hint = ", ".join(self.side_names), nearest(name, self.side_names)
            raise InputError(f"has no side table {name}", where=str(self.folder), allowed=allowed, nearest=hint)
        return frame(table.cells, self._side(table))

    @cached_property
    def no_target(self) -> NDArray[np.bool_]:
        """(N, 3), whether the front, left and right range sensor saw no target, by side/tof.csv if there is one.

        Raises:
            InputError: A file is missing or damaged.
        """
        if TOF.name in self.side_names:
            return self._side(TOF)[:, 1:] == TofStatus.NO_TARGET
        decimals = next(column.decimals for column in RANGES.columns)
        return self.table.tof_m == round(self.spec.robot.tof.no_target_m, decimals)

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of the images, in their order."""
        return tuple(self.image_table.image.tolist())

    def index_of(self, number: int) -> int:
        """Return the index of the image with this number.

        Raises:
            InputError: No image has this number.
        """
        if number not in self.numbers:
            allowed = f"{self.numbers[0]} to {self.numbers[-1]}" if self.numbers else "none"
            raise InputError("image", where=str(self.folder), got=number, allowed=allowed)
        return self.numbers.index(number)

    @property
    def images(self) -> tuple[Image, ...]:
        """All images in their order; no file is opened."""
        rows = np.searchsorted(self.table.t_ms, self.image_table.t_ms, side="right") - 1
        taken = zip(self.numbers, rows.tolist(), strict=True)
        return tuple(Image(self, number, index, row) for index, (number, row) in enumerate(taken))

    def image(self, number: int) -> Image:
        """Return the image with this number, as in the column `img`.

        Raises:
            InputError: No image has this number.
        """
        return self.images[self.index_of(number)]

    def image_path(self, number: int) -> Path:
        return (self.image_folder or self.folder / IMAGES) / frame_name(number)

    @cached_property
    def X_WC(self) -> Array:
        """(images, 4, 4), pose of the camera in W at each shutter, of side/camera.csv.

        Raises:
            InputError: It is damaged or of other images than data.csv.
        """
        table = self._side(CAMERA) if self.numbers else np.zeros((0, len(CAMERA.header)))
        first = CAMERA.header.index("r11")
        poses = np.tile(np.eye(4), (len(table), 1, 1))
        poses[:, :3, :3] = table[:, first : first + 9].reshape(-1, 3, 3)
        poses[:, :3, 3] = table[:, first + 9 : first + 12]
        poses.flags.writeable = False
        return poses

    @cached_property
    def camera(self) -> CalibratedCamera:
        """Intrinsics, distortion, exposure and the camera's pose on the robot, of side/intrinsics.json.

        Raises:
            InputError: The run has no images, or the file is missing or damaged.
        """
        if not self.numbers:
            cure = "render its trajectory with `symolo rerender`"
            raise InputError(f"run {self.name} has no images, and so no camera", where=str(self.folder), cure=cure)
        path = self.folder / SIDE / INTRINSICS
        try:
            return CalibratedCamera.from_document(read_camera_document(path))
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        except ValueError as error:
            raise InputError(f"is damaged: {error}", where=str(path)) from None

    @cached_property
    def annotations(self) -> AnnotationDocument:
        """annotations.json: categories, instances, boxes, key points.

        Raises:
            InputError: The run has none, or it is damaged.
        """
        path = self._annotation_folder / DOCUMENT
        try:
            return AnnotationDocument.from_json(read_file(path, FileKind.ANNOTATIONS))
        except FileNotFoundError:
            cure = how_to_add("the kinds that you need")
            raise InputError("has no annotations", where=str(self.folder), cure=cure) from None
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        except ValueError as error:
            raise InputError(f"is damaged: {str(error).splitlines()[0]}", where=str(path)) from None

    @property
    def has_annotations(self) -> bool:
        """Whether the run has annotations of any kind."""
        return self._annotation_folder.is_dir()

    @property
    def annotation_kinds(self) -> tuple[str, ...]:
        """Kinds of annotations that have a file for each image."""
        if not self.has_annotations:
            return ()
        return tuple(kind for kind in self.annotations.kinds if kind not in RECORD_KINDS)

    def annotation_path(self, kind: str, number: int) -> Path:
        """Return where the annotation of an image lies, if there is one."""
        return self._annotation_folder / annotation_file(kind, number)

    @property
    def _annotation_folder(self) -> Path:
        return self.folder / ANNOTATIONS

    def _side(self, table: SideTable) -> Array:
        rows = self.image_table if table.rows_of == "images" else self.table
        return read_side(self.folder / SIDE / table.file, table, rows)

    def __iter__(self) -> Iterator[Image]:
        return iter(self.images)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.table.t_ms)


def _lacking(what: str, known: tuple[str, ...], name: str, where: str, cure: str = "") -> InputError:
    allowed = ", ".join(known) or "none"
    return InputError(f"has no {what}", where=where, allowed=allowed, nearest=nearest(name, known), cure=cure)


def how_to_add(kinds: str) -> str:
    """Return a sentence that says how to add kinds of annotations to a release."""
    return (
        f"add {kinds} to render.annotations and repeat `symolo release` with the same --out"
        " (if its .stages is still there, no image is rendered again)"
    )
