"""Runs in the layout of the EuRoC MAV datasets: cameras, IMUs and the true state, with their calibration.

The body B is the frame of imu0, as in those datasets, or R if the robot has no IMU. Stamps are in ns
(Burri et al., The EuRoC micro aerial vehicle datasets, IJRR 2016).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import starmap

import cv2
import numpy as np

from symolo.core.arrays import Array
from symolo.core.geometry.poses import pose_X_WR, quaternions
from symolo.dataset.documents.camera_model import CameraDocument
from symolo.dataset.documents.sensor_sections import ImuSection
from symolo.dataset.rates import period_beside_rows_s
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.exporters.shared.stereo import pair_first
from symolo.reader.camera_run import CameraRun
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image, RunFolder
from symolo.reader.sensor import RunSensor

START_NS = 10**18
"""Stamp of the first row. All stamps have 19 digits, as those of EuRoC, so names of images sort by time."""
_PLACE = tuple(f"p_RS_R_{axis} [m]" for axis in "xyz")
_ROTATION = tuple(f"q_RS_{axis} []" for axis in "wxyz")
_VELOCITY = tuple(f"v_RS_R_{axis} [m s^-1]" for axis in "xyz")
_BIASES = (*(f"b_w_RS_S_{axis} [rad s^-1]" for axis in "xyz"), *(f"b_a_RS_S_{axis} [m s^-2]" for axis in "xyz"))
_IMU = (*(f"w_RS_S_{axis} [rad s^-1]" for axis in "xyz"), *(f"a_RS_S_{axis} [m s^-2]" for axis in "xyz"))
_STAMP = "#timestamp [ns]"


@dataclass(frozen=True)
class _Body:
    """A run, its sensors in the order of their folders, and the body B."""

    run: Run

    @cached_property
    def imus(self) -> tuple[RunSensor, ...]:
        """The IMUs by name."""
        return tuple(sensor for _, sensor in sorted(self.run.sensors.items()) if sensor.kind == "imu")

    @cached_property
    def cameras(self) -> dict[str, RunFolder]:
        """The cameras by name, those of a rectified pair first."""
        return pair_first(self.run)

    @cached_property
    def X_RB(self) -> Array:
        """(4, 4), pose in R of the body."""
        return self.imus[0].X_RS if self.imus else np.eye(4)

    def pose(self, X_RS: Array) -> Array:
        """Return the pose (4, 4) in B of a sensor."""
        return np.linalg.inv(self.X_RB) @ X_RS


def _files(data: Dataset, _settings: ExportSettings) -> Iterator[ExportedFile]:
    for run in data.runs:
        body, folder = _Body(run), f"{run.name}/mav0"
        yield ExportedFile(f"{folder}/body.yaml", lambda body=body: _body_file(body))
        for number, (name, camera) in enumerate(body.cameras.items()):
            yield from _camera_files(f"{folder}/cam{number}", name, camera, body)
        for number, imu in enumerate(body.imus):
            yield ExportedFile(f"{folder}/imu{number}/data.csv", lambda imu=imu: _imu_table(imu))
            description = _imu_file(imu, body.pose(imu.X_RS))
            yield ExportedFile(f"{folder}/imu{number}/sensor.yaml", lambda text=description: text)
        yield from _pose_files(folder, body)


def _body_file(body: _Body) -> bytes:
    what = f"B is the frame of {body.imus[0].name}" if body.imus else "B is the frame of the robot"
    robot = body.run.spec.robot.name
    return _text([f'comment: "{body.run.name} of the robot {robot}; {what}; R in names of columns is the world"'])


def _camera_files(folder: str, name: str, camera: RunFolder, body: _Body) -> Iterator[ExportedFile]:
    stamps = {image.number: _stamp(float(camera.image_table.t_ms[image.index])) for image in camera.images}
    lines = [f"{stamp},{stamp}.png" for stamp in stamps.values()]
    yield ExportedFile(f"{folder}/data.csv", lambda: _text([f"{_STAMP},filename", *lines]))
    yield ExportedFile(f"{folder}/sensor.yaml", lambda: _camera_file(name, camera, body))
    pixels = camera.camera.width_px * camera.camera.height_px
    for image in camera.images:
        place = f"{folder}/data/{stamps[image.number]}.png"
        yield ExportedFile(place, lambda image=image: _grey(image), lambda: pixels)


def _grey(image: Image) -> bytes:
    """Return a PNG file of the image in grey by the weights of Rec. 601."""
    _encoded, data = cv2.imencode(".png", cv2.cvtColor(image.pixels(), cv2.COLOR_RGB2GRAY))
    return data.tobytes()


def _camera_file(name: str, camera: RunFolder, body: _Body) -> bytes:
    model = camera.camera.document
    (fx, _, cx), (_, fy, cy), _ = model.K
    period_s = camera.settings.period_s if isinstance(camera, CameraRun) else _period_s(camera)
    coefficients, kind = _distortion(model)
    return _text(
        [
            *_head("camera", name, body.pose(np.array(model.X_RC))),
            f"rate_hz: {_number(1 / period_s)}",
            f"resolution: [{model.width_px}, {model.height_px}]",
            "camera_model: pinhole",
            f"intrinsics: {_list((fx, fy, cx, cy))} # fu, fv, cu, cv",
            f"distortion_model: {kind}",
            f"distortion_coefficients: {_list(coefficients)}",
            f"# exposure: {model.exposure_s:.9g} s; rolling shutter: {model.read_out_s:.9g} s from top to bottom",
        ]
    )


def _period_s(camera: RunFolder) -> float:
    """Return the time between two images of the camera of data.csv: of those at rows the mean, 1 s for one image."""
    if (period_s := period_beside_rows_s(camera.spec.rates)) is not None:
        return period_s
    t_s = [image.t_s for image in camera.images]
    return (t_s[-1] - t_s[0]) / (len(t_s) - 1) if len(t_s) > 1 else 1.0


def _distortion(model: CameraDocument) -> tuple[Sequence[float], str]:
    """Return coefficients and name of the lens; EuRoC has no k3, so it is the fifth coefficient only if it is not 0."""
    if model.camera_model == "fisheye":
        return model.D, "equidistant"
    return model.D if model.D[4] else model.D[:4], "radial-tangential"


def _imu_file(imu: RunSensor, X_BS: Array) -> bytes:
    settings = ImuSection.model_validate(imu.settings)
    gyroscope, accelerometer = settings.gyroscope, settings.accelerometer
    return _text(
        [
            *_head("imu", imu.name, X_BS),
            f"rate_hz: {_number(1 / settings.period_s)}",
            f"gyroscope_noise_density: {_number(gyroscope.noise_density_rad_s_rtHz)} # rad/s/sqrt(Hz)",
            f"gyroscope_random_walk: {_number(gyroscope.random_walk_rad_s2_rtHz)} # rad/s^2/sqrt(Hz)",
            f"accelerometer_noise_density: {_number(accelerometer.noise_density_m_s2_rtHz)} # m/s^2/sqrt(Hz)",
            f"accelerometer_random_walk: {_number(accelerometer.random_walk_m_s3_rtHz)} # m/s^3/sqrt(Hz)",
        ]
    )


def _imu_table(imu: RunSensor) -> bytes:
    columns = [imu.values(f"{kind}_{axis}") for kind in ("gyro", "acc") for axis in "xyz"]
    return _table(_IMU, imu.numbers[:, 0], np.column_stack(columns))


def _pose_files(folder: str, body: _Body) -> Iterator[ExportedFile]:
    """Yield the true state of B, and the poses of R in the form of a motion capture system."""
    state, marker = f"{folder}/state_groundtruth_estimate0", f"{folder}/mocap0"
    yield ExportedFile(f"{state}/data.csv", lambda: _state_table(body))
    truth = _head("visual-inertial", "true states of the simulation; the biases in data.csv are not known", np.eye(4))
    yield ExportedFile(f"{state}/sensor.yaml", lambda: _text(truth))
    yield ExportedFile(f"{marker}/data.csv", lambda: _robot_table(body))
    robot = _head("pose", "true poses of R: middle of the axle on the floor, x forward, y left", body.pose(np.eye(4)))
    yield ExportedFile(f"{marker}/sensor.yaml", lambda: _text(robot))


def _state_table(body: _Body) -> bytes:
    """Return pose and velocity of B; EuRoC's columns of biases are 0. Unknown speeds are 0, too."""
    t_ms, pose, twist = _motion(body)
    X_WR = np.array(list(starmap(pose_X_WR, pose.tolist())))
    v_m_s, w_rad_s = np.nan_to_num(twist).T
    arm_W = X_WR[:, :3, :3] @ body.X_RB[:3, 3]
    ahead_W, turned_W = X_WR[:, :3, 0], np.stack([-arm_W[:, 1], arm_W[:, 0], np.zeros(len(arm_W))], axis=1)
    velocity_W = v_m_s[:, None] * ahead_W + w_rad_s[:, None] * turned_W
    cells = np.column_stack((_pose_cells(X_WR @ body.X_RB), velocity_W, np.zeros((len(t_ms), len(_BIASES)))))
    return _table((*_PLACE, *_ROTATION, *_VELOCITY, *_BIASES), t_ms, cells)


def _robot_table(body: _Body) -> bytes:
    t_ms, pose, _twist = _motion(body)
    return _table((*_PLACE, *_ROTATION), t_ms, _pose_cells(np.array(list(starmap(pose_X_WR, pose.tolist())))))


def _motion(body: _Body) -> tuple[Array, Array, Array]:
    """Return t (N,) [ms], pose (N, 3) and v, w (N, 2) at each row of data.csv and each image."""
    tables = [body.run.table, *(camera.image_table for camera in body.cameras.values())]
    stacked = [np.concatenate([getattr(table, name) for table in tables]) for name in ("t_ms", "pose", "twist")]
    t_ms, first = np.unique(stacked[0], return_index=True)
    return t_ms.astype(np.float64), stacked[1][first], stacked[2][first]


def _pose_cells(X: Array) -> Array:
    """Return places and quaternions (N, 7), w first, of poses (N, 4, 4)."""
    return np.column_stack((X[:, :3, 3], quaternions(X[:, :3, :3])[:, [3, 0, 1, 2]]))


def _head(kind: str, comment: str, X_BS: Array) -> list[str]:
    numbers = _list((np.round(X_BS, 9) + 0.0).ravel().tolist())
    pose = ["T_BS:", "  cols: 4", "  rows: 4", f"  data: {numbers}"]
    return [f"sensor_type: {kind}", f'comment: "{comment}"', *pose]


def _table(names: Sequence[str], t_ms: Array, cells: Array) -> bytes:
    rows = zip(t_ms.tolist(), (np.round(cells, 9) + 0.0).tolist(), strict=True)
    lines = (",".join([str(_stamp(at_ms)), *(f"{cell:.9f}" for cell in row)]) for at_ms, row in rows)
    return _text([",".join((_STAMP, *names)), *lines])


def _stamp(t_ms: float) -> int:
    return START_NS + round(1e6 * t_ms)


def _number(number: float) -> str:
    """Return a number as YAML 1.1 reads it, where an exponent needs a point before it."""
    text = f"{number:.9g}"
    return text.replace("e", ".0e") if "." not in text else text


def _list(numbers: Iterable[float]) -> str:
    return f"[{', '.join(map(_number, numbers))}]"


def _text(lines: Iterable[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode()


EXPORTER = Exporter("euroc", "the layout of the EuRoC MAV datasets: grey images, IMUs, true state, calibration", _files)
