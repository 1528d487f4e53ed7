"""Sensors of the robot as elements of SDF 1.9, fixed to the base.

Line arrays, bumpers and encoders of wheels have no counterpart in SDF.
"""

from dataclasses import dataclass
from math import ceil, radians, sqrt
from xml.etree import ElementTree as ET

from pipeline.models.robot import CAMERA, CAMERA_OPTICAL, Lens, RobotParts
from pipeline.models.sdf_elements import add_pose, child
from sensors.inertial.imu import ImuSettings
from sensors.ranging.lidar import LidarSettings
from sensors.ranging.tof import NOISE_AT_NEAR_MM
from sensors.ranging.ultrasonic import UltrasonicSettings
from sensors.ranging.vl53l0x import MODES, Vl53l0xSettings
from symolo.dataset.documents.sensor_sections import Vl53l0xSection, optical_frame, sensor_frame

_NEAR_M, _FAR_M = 0.01, 100
OWN_BODY, _ALL_BUT_OWN_BODY = 2, 2**32 - 1 - 2
"""Visibility flags: the camera sees as much of its own robot as in the images."""


def add_sensors(base: ET.Element, parts: RobotParts) -> None:
    """Add the camera and range sensors of data.csv, and the sensors of `robot.sensors` that SDF can describe."""
    _camera(base, parts, CAMERA, CAMERA_OPTICAL, parts.lens)
    tof = parts.config.tof
    beam = _Beam(tof.field_of_view_deg, tof.rays, tof.min_range_m, tof.max_range_m, tof.quantisation_m)
    for frame in parts.frames:
        if frame.name.startswith("tof_"):
            _range_sensor(base, parts, frame.name, tof.period_s, beam, 1e-3 * NOISE_AT_NEAR_MM * tof.noise_scale)
    for name, settings in parts.config.sensors:
        frame = sensor_frame(name)
        match settings:
            case ImuSettings():
                _imu(base, parts, frame, settings)
            case LidarSettings():
                _lidar(base, parts, frame, settings)
            case Vl53l0xSettings():
                reach_m = Vl53l0xSection.model_validate(settings).reach_m
                beam = _Beam(settings.field_of_view_deg, settings.rays, _NEAR_M, reach_m, settings.quantisation_m)
                noise_m = 1e-3 * NOISE_AT_NEAR_MM * settings.noise_scale * MODES[settings.mode].noise
                _range_sensor(base, parts, frame, settings.period_s, beam, noise_m)
            case UltrasonicSettings():
                limits_m = settings.min_range_m, settings.max_range_m
                beam = _Beam(settings.field_of_view_deg, settings.rays, *limits_m, settings.quantisation_m)
                _range_sensor(base, parts, frame, settings.period_s, beam, settings.noise_m)
    for name, lens in parts.further_lenses.items():
        _camera(base, parts, sensor_frame(name), optical_frame(name), lens)


def _sensor(base: ET.Element, parts: RobotParts, frame: str, kind: str, rate_hz: float) -> ET.Element:
    """Add a sensor in one of the robot's frames, whose name without `_link` is that of the sensor and of its topic."""
    name = frame.removesuffix("_link")
    sensor = child(base, "sensor", name=name, type=kind)
    add_pose(sensor, parts.frame(frame).placement)
    child(sensor, "update_rate", rate_hz)
    child(sensor, "topic", name)
    return sensor


def _camera(base: ET.Element, parts: RobotParts, frame: str, optical: str, lens: Lens) -> None:
    """Add a camera. Pixel coordinates are those of pixel centres in side/intrinsics.json, and of pixel edges here."""
    intrinsics = lens.intrinsics
    sensor = _sensor(base, parts, frame, "camera" if intrinsics.fisheye is None else "wideanglecamera", lens.rate_hz)
    camera = child(sensor, "camera")
    child(camera, "horizontal_fov", lens.horizontal_field_of_view_rad)
    child(camera, "image", {"width": intrinsics.width_px, "height": intrinsics.height_px, "format": "R8G8B8"})
    child(camera, "clip", {"near": _NEAR_M, "far": _FAR_M})
    if any(intrinsics.distortion):
        child(camera, "distortion", dict(zip(("k1", "k2", "p1", "p2", "k3"), intrinsics.distortion, strict=True)))
    if intrinsics.fisheye is None:
        center = {"cx": intrinsics.cx_px + 0.5, "cy": intrinsics.cy_px + 0.5}
        child(camera, "lens", {"intrinsics": {"fx": intrinsics.fx_px, "fy": intrinsics.fy_px, **center, "s": 0}})
    else:
        cutoff_rad = intrinsics.fisheye.half_field_rad
        child(camera, "lens", {"type": "equidistant", "scale_to_hfov": "true", "cutoff_angle": cutoff_rad})
    child(camera, "optical_frame_id", optical)
    if not lens.sees_robot or frame == CAMERA:
        child(camera, "visibility_mask", _ALL_BUT_OWN_BODY)


@dataclass(frozen=True)
class _Beam:
    field_of_view_deg: float
    rays: int
    min_range_m: float
    max_range_m: float
    step_m: float


def _range_sensor(  # noqa: PLR0917 - all of them describe the sensor
    base: ET.Element, parts: RobotParts, frame: str, period_s: float, beam: _Beam, noise_m: float
) -> None:
    """Add a square bundle of at least as many rays around the cone. Each ray has a reading, where the device has
    one.
    """
    half_rad = 0.5 * radians(beam.field_of_view_deg)
    rays = {"samples": ceil(sqrt(beam.rays)), "resolution": 1, "min_angle": -half_rad, "max_angle": half_rad}
    distances = {"min": beam.min_range_m, "max": beam.max_range_m, "resolution": beam.step_m}
    scan = {"horizontal": rays, "vertical": rays}
    sensor = _sensor(base, parts, frame, "gpu_lidar", 1 / period_s)
    child(sensor, "lidar", {"scan": scan, "range": distances, "noise": _noise(noise_m)})


def _lidar(base: ET.Element, parts: RobotParts, frame: str, settings: LidarSettings) -> None:
    """Add a lidar whose rays are in the order of their angles, also if the head turns clockwise."""
    ends_deg = settings.first_ray_deg, settings.first_ray_deg + settings.ray_step_deg * (settings.rays - 1)
    first_rad, last_rad = sorted(map(radians, ends_deg))
    rays = {"samples": settings.rays, "resolution": 1, "min_angle": first_rad, "max_angle": last_rad}
    distances = {"min": settings.min_range_m, "max": settings.max_range_m, "resolution": settings.quantisation_m}
    sensor = _sensor(base, parts, frame, "gpu_lidar", 1 / settings.period_s)
    child(sensor, "lidar", {"scan": {"horizontal": rays}, "range": distances, "noise": _noise(settings.noise_m)})


def _imu(base: ET.Element, parts: RobotParts, frame: str, settings: ImuSettings) -> None:
    """Add an IMU with the white noise of a sample; its biases are drawn for each run."""
    root_s = sqrt(settings.period_s)
    deviations = {
        "angular_velocity": settings.gyroscope.noise_density_rad_s_rtHz / root_s,
        "linear_acceleration": settings.accelerometer.noise_density_m_s2_rtHz / root_s,
    }
    imu = child(_sensor(base, parts, frame, "imu", 1 / settings.period_s), "imu")
    for name, sd in deviations.items():
        axes = child(imu, name)
        for axis in "xyz":
            child(child(axes, axis), "noise", {"mean": 0, "stddev": round(sd, 9)}, type="gaussian")


def _noise(sd: float) -> dict[str, object]:
    return {"type": "gaussian", "mean": 0, "stddev": round(sd, 9)}
