"""Cameras of a log as further cameras of an imported run: settings, images, times, poses and lens."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from configs.robot_sensors import IS_LOGGED
from configs.schema.scenario import SceneSpec
from logs.trajectories.base import LoggedCamera
from symolo.core.geometry.fisheye import Fisheye
from symolo.core.progress import plural
from symolo.dataset.documents.camera_model import INTRINSICS, CameraDocument, camera_files
from symolo.dataset.documents.camera_specification import KIND, specification_of
from symolo.dataset.documents.run_document import RunDocument
from symolo.dataset.layout import IMAGES, POSITIONS, SIDE, camera_folder, frame_name
from symolo.dataset.tables.camera_rows import rows_at
from symolo.dataset.tables.rows import Rows
from symolo.dataset.tables.side_tables import image_positions

_MM_PER_PX = 1e-3
"""Size of a pixel in the settings. No message states it, and only its ratio to the focal length matters."""
_HALF_TURN = np.linspace(0.0, np.pi, 20_001)


def camera_settings(camera: LoggedCamera) -> dict[str, Any]:
    """Return the settings of a camera as `robot.sensors` has them; pixels are square there, in intrinsics.json not."""
    (width_px, height_px), K = camera.size, camera.K
    settings: dict[str, Any] = {
        "kind": KIND,
        IS_LOGGED: True,
        **camera.settings,
        "width_px": width_px,
        "height_px": height_px,
        "focal_length_mm": round(0.5 * _MM_PER_PX * float(K[0, 0] + K[1, 1]), 9),
        "sensor_width_mm": round(_MM_PER_PX * width_px, 9),
        "principal_point_right_mm": round(_MM_PER_PX * float(K[0, 2] - 0.5 * (width_px - 1)), 9),
        "principal_point_down_mm": round(_MM_PER_PX * float(K[1, 2] - 0.5 * (height_px - 1)), 9),
        "distortion": dict.fromkeys(("k1", "k2", "p1", "p2", "k3"), 0.0),
        "read_out_s": 0.0,
        "exposure_time_s": 0.0,
    }
    if camera.distortion_model == "plumb_bob":
        return settings | {"distortion": dict(zip(("k1", "k2", "p1", "p2", "k3"), camera.D, strict=True))}
    k1, k2, k3, k4 = camera.D
    angle_deg = _field_of_view_deg(Fisheye(np.pi, (k1, k2, k3, k4)), 0.5 * width_px / float(K[0, 0]))
    return settings | {"fisheye": {"field_of_view_deg": angle_deg, "k1": k1, "k2": k2, "k3": k3, "k4": k4}}


def _field_of_view_deg(lens: Fisheye, radius: float) -> float:
    """Return the angle that a lens shows within this distance from the axis, in units of the focal length."""
    grown = np.maximum.accumulate(lens.radius(_HALF_TURN))
    return round(float(np.degrees(2.0 * np.interp(radius, grown, _HALF_TURN))), 6)


def camera_content(
    spec: SceneSpec, rows: Rows, cameras: Mapping[str, LoggedCamera], start_s: float
) -> Iterator[tuple[str, bytes]]:
    """Yield the files of the cameras of a run by their path in its folder.

    Args:
        spec: Specification of the run, with the settings of the cameras.
        rows: Content of data.csv.
        cameras: The cameras by name.
        start_s: Time of the first row in the clock of the log.
    """
    content = spec.model_dump(mode="json")
    for name, camera in cameras.items():
        chosen, t_ms = image_times(camera, rows, start_s)
        at_images, folder = rows_at(rows, t_ms), camera_folder(name)
        for number, index in enumerate(chosen, 1):
            yield f"{folder}/{IMAGES}/{frame_name(number)}", camera.files[index]
        yield f"{folder}/{POSITIONS}", image_positions(at_images)
        document = RunDocument.model_validate(specification_of(content, name))
        for path, data in camera_files(document, at_images):
            yield f"{folder}/{path}", data if path != f"{SIDE}/{INTRINSICS}" else _intrinsics(document, camera)


def image_times(camera: LoggedCamera, rows: Rows, start_s: float) -> tuple[list[int], np.ndarray]:
    """Return the images between the first and the last row, each with a time of its own, and their times (N,) [ms]."""
    t_ms = np.rint(1000.0 * (camera.t_s - start_s)).astype(np.int64)
    is_new = np.concatenate(([True], np.diff(t_ms) > 0))
    chosen = np.flatnonzero(is_new & (t_ms >= 0) & (t_ms <= rows.t_ms[-1]))
    return chosen.tolist(), t_ms[chosen]


def left_out_images(cameras: Sequence[LoggedCamera], rows: Rows, start_s: float) -> Iterator[str]:
    """Yield how many images of each camera are not in the dataset, and why."""
    for camera in cameras:
        if left_out := len(camera.files) - len(image_times(camera, rows, start_s)[0]):
            text = f"{camera.name}: left out: {plural(left_out, 'image')} before the first or after the last row"
            yield f"{text}, or within a millisecond of another one"


def _intrinsics(document: RunDocument, camera: LoggedCamera) -> bytes:
    """Return intrinsics.json with the camera matrix and the distortion of the log."""
    K = tuple(tuple(row) for row in camera.K.tolist())
    return CameraDocument.from_imaging(document).model_copy(update={"K": K, "D": camera.D}).to_json()
