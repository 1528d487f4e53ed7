"""Set-up of the experiments with the line sensor: a straight tape along x on a bare floor, and a sensor above it."""

from dataclasses import dataclass

import numpy as np

from configs.schema.robot import LineSensor
from diagnosis.validation.still_world import StillWorld
from sensors.line.line_sensor import LineSensorModel
from symolo.arena.geometry import Arena, Line, Straight
from symolo.core.arrays import Array
from symolo.core.random_streams import stream

PHYSICS_HZ = 1000
"""Rate of the simulation, which decides when a sensor samples but not what it reads."""
FAR_M = 1.0
"""Distance from the tape at which every channel sees only the bare floor."""


@dataclass(frozen=True)
class Tape:
    """A tape on a floor, with the defaults of an arena."""

    width_m: float = 0.015
    reflectance: float = 0.05
    floor_reflectance: float = 0.85

    def arena(self) -> Arena:
        line = Line((Straight((-1.0, 0.0), (1.0, 0.0)),), self.width_m, self.reflectance)
        return Arena("bench", 2.0, self.floor_reflectance, line, ())


def sensor(config: LineSensor, tape: Tape, seed: int, *key: str | int) -> LineSensorModel:
    """Return a sensor whose gains and offsets are drawn from the random stream of this key."""
    return LineSensorModel(config, tape.arena(), PHYSICS_HZ, stream(seed, "line_bench", *key))


def readings(model: LineSensorModel, y_m: Array) -> Array:
    """Return readings (N, 8) with the middle of the robot at distances (N,) to the left of the middle of the tape."""
    return np.array([model.sample(StillWorld(y_m=y)) for y in y_m.tolist()])


def spot_diameter_m(config: LineSensor, height_m: float) -> float:
    """Return the diameter of the evenly lit spot of a channel; its standard deviation is a quarter of that."""
    return config.spot_diameter_at_floor_m + config.spot_growth * height_m


def without_faults(config: LineSensor, **changes: float) -> LineSensor:
    """Return the sensor with equal channels, no noise, no failed reading and the finest converter, then `changes`."""
    quiet = {"gain_sd": 0.0, "offset_sd": 0.0, "noise_sd": 0.0, "dropout_probability": 0.0, "adc_bits": 16}
    return config.model_copy(update=quiet | changes)
