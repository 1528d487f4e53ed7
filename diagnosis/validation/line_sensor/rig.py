"""The rig of the line bench: a straight tape along x on a bare floor, and a sensor that is moved across it."""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import LineSensor
from sensors.base import Hits
from sensors.line_sensor import LineSensorModel
from symolo.arena.geometry import Arena, Line, Straight
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

PHYSICS_HZ = 1000
"""Matters to when a sensor samples, not to what it reads."""
FAR_M = 1.0
"""From the tape: bare floor for every channel."""


@dataclass(frozen=True)
class Tape:
    """Defaults as in an arena's file."""

    width_m: float = 0.015
    reflectance: float = 0.05
    floor_reflectance: float = 0.85

    def arena(self) -> Arena:
        line = Line((Straight((-1.0, 0.0), (1.0, 0.0)),), self.width_m, self.reflectance)
        return Arena("bench", 2.0, self.floor_reflectance, line, ())


@dataclass(frozen=True)
class Standing:
    """A world in which the robot stands square to the tape, its middle `y_m` to the left of the tape's."""

    y_m: float
    time_s: float = 0.0

    def pose(self) -> tuple[float, float, float]:
        return 0.0, self.y_m, 0.0

    def cast(self, origins: Array, ends: Array) -> Hits:
        """Not asked for by a line sensor."""
        raise NotImplementedError

    def encoder_counts(self) -> tuple[int, int]:
        return 0, 0


def sensor(config: LineSensor, tape: Tape, seed: int, *key: str | int) -> LineSensorModel:
    """A sensor with gains and offsets of its own, drawn from the stream of this key."""
    return LineSensorModel(config, tape.arena(), PHYSICS_HZ, stream(seed, "line_bench", *key))


def readings(model: LineSensorModel, y_m: Array) -> Array:
    """(N, 8) for the robot at each of the offsets (N,)."""
    return np.array([model.sample(Standing(y)) for y in y_m.tolist()])


def spot_diameter_m(config: LineSensor, height_m: float) -> float:
    """Of one channel's spot on the floor, an evenly lit disc; its standard deviation across is a quarter of it."""
    return config.spot_diameter_at_floor_m + config.spot_growth * height_m


def without_faults(config: LineSensor, **changes: float) -> LineSensor:
    """The same sensor with equal channels, no noise, no failed reading and the finest converter."""
    quiet = {"gain_sd": 0.0, "offset_sd": 0.0, "noise_sd": 0.0, "dropout_probability": 0.0, "adc_bits": 16}
    return config.model_copy(update=quiet | changes)
