"""One released run: rows, side tables, camera, images and annotations, each read when it is asked for."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from pydantic import ValidationError

from configs.schema.scenario import RunSpec
from symolo.core.arrays import Array
from symolo.core.errors import InputError, nearest
from symolo.dataset.layout import DATA, IMAGES, LOOK, SIDE, SPEC
from symolo.dataset.metadata import side_tables
from symolo.dataset.rows import Rows, read_rows
from symolo.dataset.side_reading import read_side
from symolo.dataset.side_tables import CAMERA, SideTable
from symolo.reader.image import Image
from symolo.reader.tables import frame, rows_frame

if TYPE_CHECKING:
    from blender_scenes.render.job import RenderJob
    from symolo.dataset.annotations import AnnotationDocument
    from symolo.dataset.camera_model import CameraModel

# Whatever knows of pictures loads OpenCV, which takes half a second; tables and poses do without.
# ruff: noqa: PLC0415

OF_THE_RUN = "take those of the run that they were made from"


@dataclass(frozen=True)
class Run:
    """A folder that holds a data.csv; what lies beside it is looked for only when it is asked for."""

    folder: Path
    name: str
    """For example `CW/test_1`."""
    sensor_tables: tuple[SideTable, ...] = ()
    """Tables of the sensors of `robot.sensors`, as metadata.json describes them."""

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
        """Those rows at which an image was taken, by its number: the i-th is that of the i-th image and X_WC."""
        rows = self.rows
        return rows[rows["img"] > 0].set_index("img", drop=False)

    @property
    def t_s(self) -> Array:
        """(N,), time of each row [s]."""
        return self.table.t_ms / 1000

    @cached_property
    def spec(self) -> RunSpec:
        """Every number that the run was made from.

        Raises:
            InputError: side/spec.json is missing or damaged.
        """
        if self.is_rerendered:
            what = "holds pictures of `symolo rerender`, which have no specification"
            raise InputError(what, where=str(self.folder), cure=OF_THE_RUN)
        path = self.folder / SIDE / SPEC
        try:
            return RunSpec.model_validate_json(path.read_bytes())
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        except ValidationError as error:
            raise InputError(f"is damaged: {error.errors()[0]['msg']}", where=str(path)) from None

    @property
    def side_names(self) -> tuple[str, ...]:
        """What `side` takes."""
        return tuple(table.name for table in self._side_tables)

    @property
    def _side_tables(self) -> tuple[SideTable, ...]:
        if not self.is_rerendered:
            return (*side_tables(self.spec), *self.sensor_tables)
        return () if self._has_job_alone else (CAMERA,)

    def side(self, name: str) -> pd.DataFrame:
        """A table below `side/`, such as `wheels`: at the rows of `rows`, or of `image_rows` for `camera`.

        Raises:
            InputError: There is none of this name, or it is damaged or of other times than data.csv.
        """
        table = next((table for table in self._side_tables if table.name == name), None)
        if table is None:
            allowed, hint = ", ".join(self.side_names), nearest(name, self.side_names)
            cure = OF_THE_RUN if self.is_rerendered else ""
            what = f"has no side table {name}"
            raise InputError(what, where=str(self.folder), allowed=allowed, nearest=hint, cure=cure)
        return frame(table.columns, self._side(table))

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """Of the images, in their order."""
        return tuple(self.table.image[self.table.image > 0].tolist())

    def index_of(self, number: int) -> int:
        """Which of the images has a number.

        Raises:
            InputError: None has.
        """
        if number not in self.numbers:
            allowed = f"{self.numbers[0]} to {self.numbers[-1]}" if self.numbers else "none"
            raise InputError("image", where=str(self.folder), got=number, allowed=allowed)
        return self.numbers.index(number)

    @property
    def images(self) -> tuple[Image, ...]:
        """All images in their order; no file is opened."""
        at = np.flatnonzero(self.table.image).tolist()
        taken = zip(self.numbers, at, strict=True)
        return tuple(Image(self, number, index, row) for index, (number, row) in enumerate(taken))

    def image(self, number: int) -> Image:
        """That of a number, as in the column `img`.

        Raises:
            InputError: There is none.
        """
        return self.images[self.index_of(number)]

    def image_path(self, number: int) -> Path:
        from symolo.dataset.layout import frame_name

        return self.folder / IMAGES / frame_name(number)

    @cached_property
    def X_WC(self) -> Array:
        """(images, 4, 4), pose of the camera in W at each shutter, of side/camera.csv.

        Of pictures of an earlier `rerender`, which have none, as they were rendered.

        Raises:
            InputError: It is damaged or of other images than data.csv.
        """
        if self._has_job_alone:
            from symolo.reader.rerendered import poses_of

            poses = poses_of(self._job)
            poses.flags.writeable = False
            return poses
        table = self._side(CAMERA)
        first = CAMERA.header.index("r11")
        poses = np.tile(np.eye(4), (len(table), 1, 1))
        poses[:, :3, :3] = table[:, first : first + 9].reshape(-1, 3, 3)
        poses[:, :3, 3] = table[:, first + 9 : first + 12]
        poses.flags.writeable = False
        return poses

    @cached_property
    def camera(self) -> "CameraModel":
        """Intrinsics, distortion, exposure and the camera's pose on the robot, of side/intrinsics.json; or as above.

        Raises:
            InputError: The file is missing or damaged.
        """
        from symolo.dataset.camera_model import INTRINSICS, read_camera_model

        if self._has_job_alone:
            from symolo.reader.rerendered import camera_of

            return camera_of(self._job)
        path = self.folder / SIDE / INTRINSICS
        try:
            return read_camera_model(path)
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        except ValueError as error:
            raise InputError(f"is damaged: {error}", where=str(path)) from None

    @cached_property
    def annotations(self) -> "AnnotationDocument":
        """annotations.json: categories, instances, boxes, key points.

        Raises:
            InputError: The run has none, or it is damaged.
        """
        from symolo.dataset.annotations import DOCUMENT, AnnotationDocument

        path = self._annotation_folder / DOCUMENT
        try:
            return AnnotationDocument.from_json(path.read_bytes())
        except FileNotFoundError:
            cure = "release it with `--set render.annotations=[instance,semantic]`"
            raise InputError("has no annotations", where=str(self.folder), cure=cure) from None
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
        except ValueError as error:
            raise InputError(f"is damaged: {str(error).splitlines()[0]}", where=str(path)) from None

    @property
    def has_annotations(self) -> bool:
        return self._annotation_folder.is_dir()

    @property
    def annotation_pictures(self) -> tuple[str, ...]:
        """Kinds of which each image has a picture."""
        from symolo.dataset.annotations import RECORD_KINDS

        return (
            tuple(kind for kind in self.annotations.kinds if kind not in RECORD_KINDS) if self.has_annotations else ()
        )

    def annotation_picture(self, kind: str, number: int) -> Path:
        """Where the picture of a kind lies, if there is one."""
        from symolo.dataset.annotations import annotation_file

        return self._annotation_folder / annotation_file(kind, number)

    @property
    def _annotation_folder(self) -> Path:
        from symolo.dataset.layout import ANNOTATIONS

        return self.folder / ANNOTATIONS

    @property
    def is_rerendered(self) -> bool:
        """Whether these are pictures of `rerender`, which have no specification, and of the side tables one."""
        return (self.folder / LOOK).is_file() and not (self.folder / SIDE / SPEC).exists()

    @property
    def _has_job_alone(self) -> bool:
        """Whether nothing but the job tells of the camera: before side/ was written, `rerender` left it at that."""
        return self.is_rerendered and not (self.folder / SIDE).exists()

    @cached_property
    def _job(self) -> "RenderJob":
        from symolo.reader.rerendered import read_job

        return read_job(self.folder, self.numbers)

    def _side(self, table: SideTable) -> Array:
        return read_side(self.folder / SIDE / table.file, table, self.table)

    def __iter__(self) -> Iterator[Image]:
        return iter(self.images)

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.table.t_ms)
