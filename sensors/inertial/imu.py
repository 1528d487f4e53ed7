"""An inertial measurement unit: accelerometer and gyroscope of three axes each, and a thermometer.

Both give means over the time since the sample before, as devices that integrate internally do: the change of the
velocity and of the orientation, divided by this time. The accelerometer reads the specific force, which at rest is
9.81 m/s^2 upwards.
"""

from collections.abc import Iterator

import numpy as np
from pydantic import Field

from configs.robot_sensors import MountedSettings, SensorSettings
from configs.schema.base import Section
from configs.validation.faults import ConfigFault
from physics.robot.body_inertia import GRAVITY_M_S2
from physics.robot.body_motion import BodyMotion, velocity_of_turn
from sensors.base import Reading, Sensor, World, quantise
from sensors.inertial.inertial_errors import ErrorSizes, FixedErrors, RandomErrors
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.tables.column import Column


class Accelerometer(Section):
    """Errors of the accelerometer; the defaults are those of an MPU-6050 that was calibrated once."""

    noise_density_m_s2_rtHz: float = Field(default=3.9e-3, ge=0, le=10)
    """White noise: standard deviation of a sample times the root of the period [m/s^2/sqrt(Hz)]; also called velocity
    random walk."""
    bias_instability_m_s2: float = Field(default=5e-4, ge=0, le=10)
    """Bias instability B; the lowest Allan deviation is about 0.664 B."""
    random_walk_m_s3_rtHz: float = Field(default=1e-5, ge=0, le=10)
    """Random walk of the bias [m/s^2/sqrt(s)]."""
    bias_sd_m_s2: float = Field(default=0.05, ge=0, le=10)
    """Standard deviation of the bias of an axis when the robot is switched on, drawn once per run."""
    bias_per_K_sd_m_s2: float = Field(default=0.005, ge=0, le=1)
    """Standard deviation of the growth of this bias per kelvin, drawn once per run."""
    scale_sd: float = Field(default=0.005, ge=0, le=0.5)
    """Standard deviation of the relative error of the scale of an axis, drawn once per run."""
    misalignment_sd_rad: float = Field(default=0.005, ge=0, le=0.5)
    """Standard deviation of the tilts between the axes, drawn once per run."""
    range_m_s2: float = Field(default=19.6133, gt=0, le=10_000)
    """Largest reading, 2 g by default; larger accelerations read as this."""

    def sizes(self) -> ErrorSizes:
        return ErrorSizes(
            self.noise_density_m_s2_rtHz,
            self.bias_instability_m_s2,
            self.random_walk_m_s3_rtHz,
            self.bias_sd_m_s2,
            self.bias_per_K_sd_m_s2,
            self.scale_sd,
            self.misalignment_sd_rad,
            self.range_m_s2,
        )


class Gyroscope(Section):
    """Errors of the gyroscope; the defaults are those of an MPU-6050 whose bias was measured at rest once."""

    noise_density_rad_s_rtHz: float = Field(default=8.7e-5, ge=0, le=10)
    """White noise: standard deviation of a sample times the root of the period [rad/s/sqrt(Hz)]; also called angle
    random walk."""
    bias_instability_rad_s: float = Field(default=4e-5, ge=0, le=10)
    """Bias instability B; the lowest Allan deviation is about 0.664 B."""
    random_walk_rad_s2_rtHz: float = Field(default=1e-6, ge=0, le=10)
    """Random walk of the bias [rad/s/sqrt(s)]."""
    bias_sd_rad_s: float = Field(default=0.005, ge=0, le=10)
    """Standard deviation of the bias of an axis when the robot is switched on, drawn once per run."""
    bias_per_K_sd_rad_s: float = Field(default=3e-4, ge=0, le=1)
    """Standard deviation of the growth of this bias per kelvin, drawn once per run."""
    scale_sd: float = Field(default=0.005, ge=0, le=0.5)
    """Standard deviation of the relative error of the scale of an axis, drawn once per run."""
    misalignment_sd_rad: float = Field(default=0.005, ge=0, le=0.5)
    """Standard deviation of the tilts between the axes, drawn once per run."""
    range_rad_s: float = Field(default=4.36332, gt=0, le=1000)
    """Largest reading, 250 deg/s by default; faster turns read as this."""

    def sizes(self) -> ErrorSizes:
        return ErrorSizes(
            self.noise_density_rad_s_rtHz,
            self.bias_instability_rad_s,
            self.random_walk_rad_s2_rtHz,
            self.bias_sd_rad_s,
            self.bias_per_K_sd_rad_s,
            self.scale_sd,
            self.misalignment_sd_rad,
            self.range_rad_s,
        )


class ImuSettings(MountedSettings):
    """Place, rate and errors of an accelerometer and a gyroscope in one device."""

    period_s: float = Field(default=0.005, gt=0, le=1)
    """Time between two samples."""
    accelerometer: Accelerometer = Accelerometer()
    gyroscope: Gyroscope = Gyroscope()
    bits: int = Field(default=16, ge=4, le=32)
    """Resolution of the readings: the whole range, from the negative to the positive end, has 2^bits steps."""
    temperature_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature when the robot is switched on."""
    warm_up_K: float = Field(default=5.0, ge=0, le=100)
    """Rise of the temperature in the long run."""
    warm_up_s: float = Field(default=300.0, gt=0, le=36_000)
    """Time after which 63 % of the rise have passed."""
    calibrated_at_C: float = Field(default=25.0, ge=-40, le=125)
    """Temperature at which the growth of the biases with the temperature is zero."""

    def faults(self) -> Iterator[ConfigFault]:
        if self.accelerometer.range_m_s2 <= GRAVITY_M_S2:
            yield ConfigFault(
                ("accelerometer", "range_m_s2"),
                got=self.accelerometer.range_m_s2,
                allowed=f"more than {GRAVITY_M_S2}, which it reads at rest",
            )


class Imu(Sensor):
    """Specific force and angular rate in the axes of the sensor, means over the time since the row before."""

    Settings = ImuSettings
    columns = (
        *(Column(f"acc_{axis}", "m/s^2", 6, f"specific force along {axis}, 9.81 upwards at rest") for axis in "xyz"),
        *(Column(f"gyro_{axis}", "rad/s", 7, f"angular rate about {axis}") for axis in "xyz"),
        Column("temperature", "degC", 3, "temperature of the device"),
    )
    settings: ImuSettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        X_RS = self.settings.X_RS()
        self._R_RS, self._p_RS = X_RS[:3, :3], X_RS[:3, 3]
        self._period_s = self.sampling.period_steps / physics_hz
        self._before: BodyMotion | None = None
        self._axes = tuple(
            _Axes(sizes, self.settings.bits, self._period_s, sensor_rng)
            for sizes, sensor_rng in zip(
                (self.settings.accelerometer.sizes(), self.settings.gyroscope.sizes()), rng.spawn(2), strict=True
            )
        )

    def sample(self, world: World) -> Reading:
        """Return specific force [m/s^2], angular rate [rad/s] and temperature [deg C], (7,)."""
        settings, now = self.settings, world.motion()
        force, rate = self._felt(self._before or now, now)
        self._before = now
        rise_K = settings.warm_up_K * -np.expm1(-world.time_s / settings.warm_up_s)
        temperature_C = settings.temperature_C + rise_K
        over_K = temperature_C - settings.calibrated_at_C
        accelerometer, gyroscope = self._axes
        return np.concatenate([accelerometer.read(force, over_K), gyroscope.read(rate, over_K), [temperature_C]])

    def _felt(self, before: BodyMotion, now: BodyMotion) -> tuple[Array, Array]:
        """Return the true specific force [m/s^2] and angular rate [rad/s], (3,) each, in the axes of the sensor."""
        turn_rad = _rotation_vector(before.R_WR.T @ now.R_WR)
        change_m_s = self._velocity(now) - self._velocity(before)
        force_W = change_m_s / self._period_s + (0.0, 0.0, GRAVITY_M_S2)
        # The mean orientation: half of the turn after the sample before.
        R_WS = 0.5 * (before.R_WR + now.R_WR) @ self._R_RS
        return force_W @ R_WS, turn_rad / self._period_s @ self._R_RS

    def _velocity(self, motion: BodyMotion) -> Array:
        """Return the velocity (3,) [m/s] of the sensor in W."""
        return motion.v_WR + velocity_of_turn(motion.w_WR, motion.R_WR @ self._p_RS)


class _Axes:
    """The three axes of an accelerometer or gyroscope."""

    def __init__(self, sizes: ErrorSizes, bits: int, period_s: float, rng: np.random.Generator) -> None:
        self._range = sizes.range
        self._step = 2.0 * sizes.range / 2**bits
        self._fixed = FixedErrors.drawn(sizes, rng)
        self._random = RandomErrors(sizes, period_s, rng)

    def read(self, true: Array, over_K: float) -> Array:
        """Return the readings (3,) at true values (3,) and a temperature over that of the calibration."""
        fixed = self._fixed
        reading = fixed.sensitivity @ true + fixed.bias + fixed.bias_per_K * over_K + self._random.next()
        return np.clip(quantise(reading, self._step), -self._range, self._range)


def _rotation_vector(R: Array) -> Array:
    """Return axis times angle (3,) [rad] of a rotation (3, 3) by less than half a turn."""
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = float(np.linalg.norm(axis))
    return axis if sine < 1e-9 else axis * (np.arctan2(sine, 0.5 * (np.trace(R) - 1.0)) / sine)
