"""QTR-8A row of reflectance sensors: eight channels, each of which measures the floor over a blurred spot."""

from math import cos, sin

import numpy as np

from configs.schema.robot import LineSensor, RobotConfig
from sensors.base import Sampling, Sensor, World
from symolo.arena.geometry import Arena, Line
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import LINE


class LineSensorModel(Sensor):
    """Normalised reflectance of each channel: 1 white, 0 black, L0 at the robot's right end."""

    name = "line"
    Settings = LineSensor
    series = (LINE,)

    def __init__(self, config: LineSensor, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        self.sampling = Sampling.from_seconds(config.period_s, config.delay_s, physics_hz)
        self._config = config
        self._arena = arena
        self._rng = rng
        y_m = channel_weights(config.channels) * config.pitch_m
        self._channels_R = np.stack([np.full_like(y_m, config.x_m), y_m, np.ones_like(y_m)], axis=1)
        # A uniform disc of diameter D has a standard deviation of D / 4 along each axis.
        self._spot_sd_m = 0.25 * (config.spot_diameter_at_floor_m + config.spot_growth * config.height_m)
        self._gain = 1.0 + config.gain_sd * rng.standard_normal(config.channels)
        self._offset = config.offset_sd * rng.standard_normal(config.channels)
        self._last = np.ones(config.channels)

    @classmethod
    def on_robot(cls, robot: RobotConfig, arena: Arena, physics_hz: int, rng: np.random.Generator) -> "LineSensorModel":
        return cls(robot.line_sensor, arena, physics_hz, rng)

    def sample(self, world: World) -> Array:
        """Return the readings (8,) after gain, offset, noise and the ADC."""
        x, y, yaw = world.pose()
        c, s = cos(yaw), sin(yaw)
        points = self._channels_R @ np.array([[c, s], [-s, c], [x, y]])
        ink = tape_share(self._arena.line, points, self._spot_sd_m)
        reflectance = self._arena.floor_reflectance + ink * (
            self._arena.line.reflectance - self._arena.floor_reflectance
        )
        noise = self._config.noise_sd * self._rng.standard_normal(len(points))
        full_scale = 2**self._config.adc_bits - 1
        reading = np.minimum(np.maximum(self._gain * reflectance + self._offset + noise, 0.0), 1.0)
        reading = np.rint(reading * full_scale) / full_scale
        lost = self._rng.random(len(points)) < self._config.dropout_probability
        self._last = np.where(lost, self._last, reading)
        return self._last


def channel_weights(channels: int) -> Array:
    """Return the positions (channels,) in units of the pitch, from right to left: -3.5 to 3.5 for eight channels."""
    return np.arange(channels) - 0.5 * (channels - 1)


def tape_share(line: Line, points: Array, spot_sd_m: float) -> Array:
    """Return the share (N,) of a Gaussian spot that falls on the tape, for spots centred on the floor points (N, 2).

    It is exact on straight pieces. On an arc, the edge is assumed to be straight within the spot, which gives a
    relative error of spot / radius (about 1 % at 25 cm). Pieces that touch end to end add up to a continuous tape.
    """
    from scipy.special import ndtr  # noqa: PLC0415 - the settings of this sensor are read without scipy

    if spot_sd_m <= 0:
        return line.covers(points).astype(float)
    share = np.zeros(len(points))
    half = 0.5 * line.width_m
    xs, ys = points.T.tolist()
    x, y = min(xs), min(ys)
    # No point is farther than this from (x, y), the corner of the rectangle around all points. Beyond eight standard
    # deviations the share of the spot is 0 in double precision. Pieces farther away than the sum are skipped, which
    # saves most of the time.
    reach = max(xs) - x + max(ys) - y + half + 8.0 * spot_sd_m
    for piece in line.pieces:
        if piece.at_min_away_m(x, y) > reach:
            continue
        s, offset = piece.local(points)
        across = ndtr((offset + half) / spot_sd_m) - ndtr((offset - half) / spot_sd_m)
        along = ndtr(s / spot_sd_m) - ndtr((s - piece.length_m) / spot_sd_m)
        share += across * along
    return np.minimum(share, 1.0)
