"""QTR-8A row of reflectance sensors: eight channels, each of which measures the floor over a blurred spot."""

from dataclasses import dataclass
from math import cos, sin
from typing import Protocol

import numpy as np

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import LineSensor, RobotConfig
from physics.robot.model import applied
from sensors.base import Sampling, Sensor, World
from symolo.arena.geometry import Arena, Line
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import LINE

NO_EFFECTS = RobotEffects()


@dataclass(frozen=True)
class LineOptics:
    """Places and spots of the channels; numbers of many robots may be stacked and are then broadcast."""

    place_m: Array
    """(8,), places of the channels to the left of the robot's middle."""
    spot_sd_m: float
    level: float
    """Light relative to that at the specified height."""

    @classmethod
    def from_config(cls, config: LineSensor, effects: RobotEffects) -> "LineOptics":
        place_m = applied(effects.functions(Slot.LINE_PLACE), channel_weights(config.channels) * config.pitch_m)
        return cls.at_places(place_m, config.spot_diameter_at_floor_m, config.spot_growth * config.height_m, effects)

    @classmethod
    def at_places(
        cls, place_m: Array, at_floor_m: float, growth_m: float, effects: RobotEffects = NO_EFFECTS
    ) -> "LineOptics":
        """Return the optics of channels whose spots have a diameter at the floor and grow up to their height."""
        ratio = applied(effects.functions(Slot.LINE_HEIGHT), 1.0)
        # A uniform disc of diameter D has a standard deviation of D / 4 along each axis.
        return cls(place_m, 0.25 * (at_floor_m + growth_m * ratio), ratio**-2.0)

    def light(self, ink: Array, arena: Arena) -> Array:
        """Return the reflectance that is read for shares of the spots on the tape, in any shape."""
        return self.level * (arena.floor_reflectance + ink * (arena.line.reflectance - arena.floor_reflectance))


class ChannelErrors(Protocol):
    """Errors of reflectance sensors, as the configuration of a robot has them."""

    gain_sd: float
    offset_sd: float
    noise_sd: float
    adc_bits: int
    dropout_probability: float


class ReflectanceChannels:
    """Any number N of reflectance sensors at any places."""

    def __init__(  # noqa: PLR0917 - what the readings depend on
        self,
        places_R: Array,
        optics: LineOptics,
        errors: ChannelErrors,
        arena: Arena,
        rng: np.random.Generator,
        effects: RobotEffects,
    ) -> None:
        """Build the sensors.

        Args:
            places_R: (N, 2) [m], places ahead of the axle and to the left.
            optics: Size and light of a spot.
            errors: Sizes of the errors.
            arena: The arena in which the robot drives.
            rng: Random stream of these sensors.
            effects: Effects on the readings.
        """
        count = len(places_R)
        self._optics, self._errors, self._arena, self._rng, self._effects = optics, errors, arena, rng, effects
        self._channels_R = np.column_stack([places_R, np.ones(count)])
        self._gain = 1.0 + errors.gain_sd * rng.standard_normal(count)
        self._offset = errors.offset_sd * rng.standard_normal(count)
        self._last = np.ones(count)

    def read(self, world: World) -> Array:
        """Return the readings (N,) after gain, offset, noise and the ADC."""
        x, y, yaw = world.pose()
        c, s = cos(yaw), sin(yaw)
        points = self._channels_R @ np.array([[c, s], [-s, c], [x, y]])
        ink = tape_share(self._arena.line, points, self._optics.spot_sd_m)
        reflectance = self._optics.light(ink, self._arena)
        noise = self._errors.noise_sd * self._rng.standard_normal(len(points))
        full_scale = 2**self._errors.adc_bits - 1
        read = applied(self._effects.functions(Slot.LINE_READING), self._gain * reflectance + self._offset)
        reading = np.minimum(np.maximum(read + noise, 0.0), 1.0)
        reading = applied(self._effects.functions(Slot.LINE_LIMIT), reading)
        reading = np.rint(reading * full_scale) / full_scale
        lost = self._rng.random(len(points)) < self._errors.dropout_probability
        self._last = np.where(lost, self._last, reading)
        return self._last


class LineSensorModel(Sensor):
    """Normalised reflectance of each channel: 1 white, 0 black, L0 at the robot's right end."""

    name = "line"
    Settings = LineSensor
    series = (LINE,)

    def __init__(
        self,
        config: LineSensor,
        arena: Arena,
        physics_hz: int,
        rng: np.random.Generator,
        effects: RobotEffects = NO_EFFECTS,
    ) -> None:
        self.sampling = Sampling.from_seconds(config.period_s, config.delay_s, physics_hz)
        optics = LineOptics.from_config(config, effects)
        places_R = np.column_stack([np.full_like(optics.place_m, config.x_m), optics.place_m])
        self._channels = ReflectanceChannels(places_R, optics, config, arena, rng, effects)

    @classmethod
    def on_robot(cls, robot: RobotConfig, arena: Arena, physics_hz: int, rng: np.random.Generator) -> "LineSensorModel":
        return cls(robot.line_sensor, arena, physics_hz, rng, robot.effects)

    def sample(self, world: World) -> Array:
        """Return the readings (8,) after gain, offset, noise and the ADC."""
        return self._channels.read(world)


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
