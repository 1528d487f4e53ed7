"""Sensors in files of other programs: names of their frames, and settings of their kinds as side/spec.json has them."""

from typing import Literal

from pydantic import Field

from symolo.dataset.documents.run_document import SensorSection, SpecSection


def sensor_frame(name: str) -> str:
    """Return the name of the frame of a sensor of `robot.sensors`; names of other frames have no slash."""
    return f"sensors/{name}"


def optical_frame(name: str) -> str:
    """Return the name of the frame of a further camera with the axes of an image."""
    return f"{sensor_frame(name)}/optical_frame"


class AccelerometerSection(SpecSection):
    """Noise of an accelerometer; 0 where it is not known, as of a sensor of a log."""

    noise_density_m_s2_rtHz: float = 0.0
    random_walk_m_s3_rtHz: float = 0.0


class GyroscopeSection(SpecSection):
    """Noise of a gyroscope; 0 where it is not known, as of a sensor of a log."""

    noise_density_rad_s_rtHz: float = 0.0
    random_walk_rad_s2_rtHz: float = 0.0


class ImuSection(SensorSection):
    """An inertial measurement unit."""

    accelerometer: AccelerometerSection = AccelerometerSection()
    gyroscope: GyroscopeSection = GyroscopeSection()


class LidarSection(SensorSection):
    """A lidar that turns, or that has all rays at once."""

    sweep_s: float
    """Time from the first ray of a scan to the first ray of the next turn; 0 if all rays are measured at once."""
    rays: int = Field(gt=0)
    first_ray_deg: float
    """Direction of the first ray to the left of the x axis of the sensor."""
    ray_step_deg: float
    """Angle from a ray to the next one, counter-clockwise; below 0 for a head that turns clockwise."""
    min_range_m: float
    max_range_m: float


class UltrasonicSection(SensorSection):
    """An ultrasonic range sensor."""

    field_of_view_deg: float
    min_range_m: float
    max_range_m: float


class Vl53l0xSection(SensorSection):
    """A further ToF sensor of the type VL53L0X."""

    mode: str
    """Ranging profile of the data sheet, such as `long_range`."""
    field_of_view_deg: float

    @property
    def reach_m(self) -> float:
        """Range of the mode in the data sheet (DS11555, table of ranging profiles)."""
        return 2.0 if self.mode == "long_range" else 1.2


class WheelEncoderSection(SensorSection):
    """A further encoder of a wheel."""

    wheel: Literal["right", "left"]
    counts_per_revolution: int = Field(gt=0)
