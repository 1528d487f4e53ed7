"""side/intrinsics.json and side/camera.csv: all data that relate pixels to the world."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from symolo.core.files.file_hashes import canonical_json
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.geometry.pinhole import Intrinsics, Shutter, intrinsics, matrix_K, pose_X_RC
from symolo.core.geometry.poses import pose_X_WR
from symolo.dataset.documents.run_document import ImagingDocument
from symolo.dataset.layout import SIDE
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.side_reading import read_record
from symolo.dataset.tables.side_tables import CAMERA

INTRINSICS = "intrinsics.json"
X_CB = ((0.0, -1.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
"""Pose in the optical frame C of the camera's body frame B, x forward, y left, z up (REP 103)."""
_DECIMALS = 9

Row3 = tuple[float, float, float]
Row4 = tuple[float, float, float, float]


class CameraDocument(BaseModel):
    """The content of intrinsics.json."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    camera_model: Literal["pinhole", "fisheye"] = "pinhole"
    distortion_model: Literal["plumb_bob", "equidistant"] = "plumb_bob"
    """ROS' name for D in OpenCV's order; if all values are 0, it is a pinhole camera or an equidistant lens."""
    width_px: int
    height_px: int
    K: tuple[Row3, Row3, Row3]
    """Camera matrix [px]; pixel (0, 0) is the middle of the first pixel."""
    D: tuple[float, ...] = Field(min_length=4, max_length=5, description="k1, k2, p1, p2, k3; fisheye: k1, k2, k3, k4")
    field_of_view_deg: float | None = Field(default=None, exclude_if=lambda angle: angle is None)
    """Angle within which a fisheye lens brings light to the sensor."""
    exposure_s: float
    iso: float | None = Field(default=None, exclude_if=lambda speed: speed is None)
    """ISO speed of a manual exposure; None for an automatic one."""
    f_number: float | None = Field(default=None, exclude_if=lambda number: number is None)
    """F-number of a manual exposure; None for an automatic one."""
    read_out_s: float
    """Time from the exposure of the first row to that of the row after the last; 0 for a global shutter."""
    X_RC: tuple[Row4, Row4, Row4, Row4]
    X_CB: tuple[Row4, Row4, Row4, Row4]

    @property
    def intrinsics(self) -> Intrinsics:
        """Intrinsics for the functions of `symolo.core.geometry.pinhole`."""
        (fx, _, cx), (_, fy, cy), _ = self.K
        size = self.width_px, self.height_px
        if self.field_of_view_deg is None:
            k1, k2, p1, p2, k3 = self.D
            return Intrinsics(*size, fx, fy, cx, cy, (k1, k2, p1, p2, k3))
        k1, k2, k3, k4 = self.D
        return Intrinsics(
            *size, fx, fy, cx, cy, fisheye=Fisheye(float(np.radians(0.5 * self.field_of_view_deg)), (k1, k2, k3, k4))
        )

    @classmethod
    def from_imaging(cls, imaging: object) -> "CameraDocument":
        """Return the model of a camera; `imaging` has the sections of an `ImagingDocument`."""
        spec = ImagingDocument.model_validate(imaging)
        camera = intrinsics(spec.robot.camera, spec.render.width_px, spec.render.height_px)
        lens: dict[str, Any] = {"D": camera.distortion}
        if camera.fisheye is not None:
            angle_deg = round(2 * float(np.degrees(camera.fisheye.half_field_rad)), _DECIMALS)
            lens = {"camera_model": "fisheye", "distortion_model": "equidistant", "D": camera.fisheye.k}
            lens |= {"field_of_view_deg": angle_deg}
        numbers = {
            **lens,
            "K": _rounded(matrix_K(camera)),
            "X_RC": _rounded(pose_X_RC(spec.robot.camera, spec.robot.chassis.base_height_m)),
            "X_CB": X_CB,
            "exposure_s": spec.look.camera.exposure_time_s,
            "read_out_s": spec.robot.camera.read_out_s,
        }
        if (manual := spec.look.camera.manual_exposure) is not None:
            numbers |= {"iso": manual.iso, "f_number": manual.f_number}
        return cls.model_validate({"width_px": camera.width_px, "height_px": camera.height_px, **numbers})

    def to_json(self) -> bytes:
        return canonical_json(json.loads(self.model_dump_json()))


def read_camera_document(path: Path) -> CameraDocument:
    """Return the document that `to_json` wrote.

    Raises:
        OSError: There is no such file.
        ValueError: It is damaged; the text is one line.
    """
    return read_record(path, CameraDocument)


def camera_files(imaging: object, rows: Rows) -> Iterator[tuple[str, bytes]]:
    """Yield the files that describe the camera of some images, by their path in the folder of the images.

    Args:
        imaging: Any object with the sections of an `ImagingDocument`.
        rows: The rows of data.csv, with the poses of the robot.
    """
    yield f"{SIDE}/{CAMERA.file}", CAMERA.to_csv(camera_table(imaging, rows))
    yield f"{SIDE}/{INTRINSICS}", CameraDocument.from_imaging(imaging).to_json()


def camera_table(imaging: object, rows: Rows) -> np.ndarray:
    """Return the columns of side/camera.csv, (images, 16); `imaging` as for `camera_files`."""
    spec = ImagingDocument.model_validate(imaging)
    X_RC = pose_X_RC(spec.robot.camera, spec.robot.chassis.base_height_m)
    shutter = Shutter(spec.look.camera.exposure_time_s, spec.robot.camera.read_out_s)
    opens_ms = 1000 * shutter.row_opens_s(0, spec.render.height_px)
    table = []
    for i in np.flatnonzero(rows.image):
        X_WC = pose_X_WR(*rows.pose[i]) @ X_RC
        exposed = rows.t_ms[i] + opens_ms, 1000 * shutter.exposure_s
        table.append([rows.image[i], rows.t_ms[i], *X_WC[:3, :3].ravel(), *X_WC[:3, 3], *exposed])
    return np.array(table, dtype=np.float64)


def _rounded(matrix: np.ndarray) -> list[list[float]]:
    return [[round(value, _DECIMALS) + 0.0 for value in row] for row in matrix.tolist()]
