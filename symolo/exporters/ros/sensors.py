"""The sensors of `robot.sensors` as messages of their kind, at the times of their samples.

The stamp of a message is the time of the sample, and its time in the bag is later by the delay of the sensor. Kinds
without a message of their own in ROS, such as bumpers, are arrays.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from symolo.core.arrays import Array
from symolo.dataset.documents.sensor_sections import (
    ImuSection,
    LidarSection,
    UltrasonicSection,
    Vl53l0xSection,
    WheelEncoderSection,
    sensor_frame,
)
from symolo.exporters.ros.topic import Log, Stamped, Topic
from symolo.exporters.ros.vocabulary import BASE, INFRARED, START_NS, ULTRASOUND, Vocabulary
from symolo.reader.run import Run
from symolo.reader.sensor import RunSensor

_PLACE = frozenset({"x_m", "y_m", "z_m"})
Messages = Callable[[RunSensor, Log, Vocabulary], Iterator[Stamped]]


def sensor_topics(run: Run) -> Iterator[Topic]:
    """Yield the topics of each sensor: `/sensors/<name>`, and those that continue this name."""
    for name, sensor in run.sensors.items():
        for end, kind, messages in _TOPICS.get(sensor.kind, _ARRAY):
            if end and not sensor.has(end.strip("/")):  # such as the temperature of an IMU of a log
                continue
            yield Topic(f"/sensors/{name}{end}", kind, partial(messages, sensor))


def sensor_poses(run: Run) -> Iterator[tuple[str, str, Array]]:
    """Yield parent, child and pose (4, 4) of the frame of each sensor that has a place on the robot."""
    for name, sensor in run.sensors.items():
        if sensor.settings.model_fields_set & _PLACE:
            yield BASE, sensor_frame(name), sensor.X_RS


def _stamps(sensor: RunSensor) -> Iterator[tuple[int, int, int]]:
    """Yield the number of each sample, its time [ns] and its time in the bag [ns]."""
    delay_ns = round(1e9 * sensor.settings.delay_s)
    for number, t_ms in enumerate(sensor.numbers[:, 0].tolist()):
        at_ns = START_NS + round(t_ms * 1e6)
        yield number, at_ns, at_ns + delay_ns


def _imu(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield the readings with the variances of their white noise; -1 stands for no orientation, as in the message."""
    settings = ImuSection.model_validate(sensor.settings)
    densities = settings.gyroscope.noise_density_rad_s_rtHz, settings.accelerometer.noise_density_m_s2_rtHz
    rate_covariance, force_covariance = (
        np.eye(3).ravel() * density**2 / settings.period_s for density in densities
    )  # 0: unknown
    none = np.array([-1.0, *np.zeros(8)])
    unknown = ros.quaternion(0, 0, 0, 1)
    axes = [np.column_stack([sensor.values(f"{one}_{axis}") for axis in "xyz"]).tolist() for one in ("gyro", "acc")]
    for (number, at_ns, bag_ns), rate, force in zip(_stamps(sensor), *axes, strict=True):
        header = ros.header(at_ns, sensor_frame(sensor.name), number)
        measured = ros.vector(*rate), rate_covariance, ros.vector(*force), force_covariance
        yield bag_ns, ros("sensor_msgs/Imu", header, unknown, none, *measured)


def _temperature(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    for (number, at_ns, bag_ns), value in zip(_stamps(sensor), sensor.values("temperature").tolist(), strict=True):
        header = ros.header(at_ns, sensor_frame(sensor.name), number)
        yield bag_ns, ros("sensor_msgs/Temperature", header, value, 0.0)  # 0: unknown variance


def _scan(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield the scans; a message has the time of its first ray, and a table that of the last."""
    settings = LidarSection.model_validate(sensor.settings)
    count, step_rad = settings.rays, np.radians(settings.ray_step_deg)
    first_rad, ray_s = np.radians(settings.first_ray_deg), settings.sweep_s / count
    sweep_ns = round(1e9 * ray_s * (count - 1))
    angles = first_rad, first_rad + step_rad * (count - 1), step_rad
    fields = *angles, ray_s, settings.period_s, settings.min_range_m, settings.max_range_m
    numbers = tuple(map(float, fields))
    shape = len(sensor.t_s), count
    range_m = np.where(sensor.no_target, np.inf, sensor.values("range").reshape(shape)).astype(np.float32)
    intensity = sensor.values("intensity").reshape(shape) if sensor.has("intensity") else np.zeros((len(range_m), 0))
    for (number, at_ns, bag_ns), scan_m, light in zip(_stamps(sensor), range_m, intensity, strict=True):
        header = ros.header(at_ns - sweep_ns, sensor_frame(sensor.name), number)
        yield bag_ns, ros("sensor_msgs/LaserScan", header, *numbers, scan_m, light.astype(np.float32))


def _vl53l0x(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    settings = Vl53l0xSection.model_validate(sensor.settings)
    limits = np.radians(settings.field_of_view_deg), 0.0, settings.reach_m
    return _ranges(sensor, ros, INFRARED, limits, np.where(sensor.no_target, np.inf, sensor.values("range")))


def _ultrasonic(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    settings = UltrasonicSection.model_validate(sensor.settings)
    limits = np.radians(settings.field_of_view_deg), settings.min_range_m, settings.max_range_m
    return _ranges(sensor, ros, ULTRASOUND, limits, np.where(sensor.no_target, np.inf, sensor.values("range")))


def _ranges(
    sensor: RunSensor, ros: Vocabulary, radiation: int, limits: tuple[float, float, float], range_m: Array
) -> Iterator[Stamped]:
    """Yield ranges (samples,) [m]; `limits` are field of view [rad], smallest and largest range [m]."""
    variance = [0.0] if ros.version > 1 else []  # 0: unknown
    for (number, at_ns, bag_ns), value in zip(_stamps(sensor), range_m.tolist(), strict=True):
        header = ros.header(at_ns, sensor_frame(sensor.name), number)
        yield bag_ns, ros("sensor_msgs/Range", header, radiation, *map(float, limits), value, *variance)


def _encoder(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield the angle of the wheel; an encoder measures neither speed nor torque."""
    settings = WheelEncoderSection.model_validate(sensor.settings)
    angles_rad = 2 * np.pi / settings.counts_per_revolution * sensor.values("counts")
    names, none = [f"{settings.wheel}_wheel_joint"], np.zeros(0)
    for (number, at_ns, bag_ns), angle_rad in zip(_stamps(sensor), angles_rad.tolist(), strict=True):
        header = ros.header(at_ns, "", number)
        yield bag_ns, ros("sensor_msgs/JointState", header, names, np.array([angle_rad]), none, none)


def _array(sensor: RunSensor, _log: Log, ros: Vocabulary) -> Iterator[Stamped]:
    """Yield all columns; the label of the array names them and their units."""
    columns, count = sensor.side_table.columns[1:], len(sensor.side_table.cells) - 1
    label = ", ".join(f"{column.title} [{column.unit}]" for column in columns)
    dimension = ros("std_msgs/MultiArrayDimension", label, count, count)
    layout = ros("std_msgs/MultiArrayLayout", [dimension], 0)
    for (_number, _at_ns, bag_ns), row in zip(_stamps(sensor), sensor.numbers[:, 1:], strict=True):
        yield bag_ns, ros("std_msgs/Float64MultiArray", layout, row.copy())


_ARRAY: tuple[tuple[str, str, Messages], ...] = (("", "std_msgs/msg/Float64MultiArray", _array),)
_TOPICS: Mapping[str, tuple[tuple[str, str, Messages], ...]] = MappingProxyType(
    {
        "imu": (
            ("", "sensor_msgs/msg/Imu", _imu),
            ("/temperature", "sensor_msgs/msg/Temperature", _temperature),
        ),
        "lidar": (("", "sensor_msgs/msg/LaserScan", _scan),),
        "vl53l0x": (("", "sensor_msgs/msg/Range", _vl53l0x),),
        "ultrasonic": (("", "sensor_msgs/msg/Range", _ultrasonic),),
        "wheel_encoder": (("", "sensor_msgs/msg/JointState", _encoder),),
    }
)
"""End of the name, type and messages of each topic of a kind."""
