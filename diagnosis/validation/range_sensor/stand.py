"""The stand: the simulator's own sensor before targets, far from any floor, moved as the paper's manipulator did.

The sensor sits at the origin of R, 1 m above the floor, which its cone meets at 4.5 m only. All three sensors of the
robot are put in that one place, so that one sample gives three readings.
"""

from dataclasses import dataclass
from math import radians
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from configs.effects.robot_effects import RobotEffects
from configs.schema.arena import ArenaConfig, LineConfig, SurfaceName, WallConfig
from configs.schema.robot import RobotConfig, TofMount, TofMounts, TofSensor
from physics.arena.rays import RayScene
from sensors.base import Hits
from sensors.tof import TofArray
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.random_streams import stream
from symolo.dataset.codes import TofStatus

HEIGHT_M = 1.0
TARGET_HEIGHT_M = 2.0
TARGET_HALF_WIDTH_M = 2.0
FEWEST_VALID = 3
"""Readings of a scene, below which they have hardly a mean and no deviation."""
PHYSICS_HZ = 1000
"""Of no effect: the stand asks for samples itself."""


class Caster(Protocol):
    """What rays are cast against: an arena in closed form, the same in PyBullet, or a body of another shape."""

    def cast(self, origins: Array, ends: Array) -> Hits: ...


@dataclass(frozen=True)
class Stand:
    """A world that stands still, for a sensor to look at."""

    caster: Caster
    x_m: float = 0.0
    y_m: float = 0.0
    yaw_deg: float = 0.0

    @property
    def time_s(self) -> float:
        return 0.0

    def pose(self) -> tuple[float, float, float]:
        return self.x_m, self.y_m, radians(self.yaw_deg)

    def encoder_counts(self) -> tuple[int, int]:
        return 0, 0

    def cast(self, origins: Array, ends: Array) -> Hits:
        return self.caster.cast(origins, ends)


def target(distance_m: float, surface: SurfaceName = "white_board") -> Arena:
    """One plane board across the x axis at a distance from the origin."""
    return bench_arena(board("target", distance_m, TARGET_HALF_WIDTH_M, surface=surface))


def board(
    name: str, x_m: float, left_m: float, thickness_m: float = 0.02, surface: SurfaceName = "white_board"
) -> WallConfig:
    """A board that faces the sensor, from far on its right to `left_m`."""
    start, end = (x_m, -TARGET_HALF_WIDTH_M), (x_m, left_m)
    return WallConfig(
        name=name, start=start, end=end, height_m=TARGET_HEIGHT_M, thickness_m=thickness_m, surface=surface
    )


def bench_arena(*boards: WallConfig) -> Arena:
    return Arena.from_config(ArenaConfig(name="bench", line=LineConfig(), walls=boards))


@dataclass(frozen=True)
class Bench:
    """The sensor of one robot with its effects, on the stand."""

    tof: TofSensor
    effects: RobotEffects
    seed: int

    @classmethod
    def of(cls, robot: RobotConfig, seed: int) -> "Bench":
        return cls(robot.tof, robot.effects, seed)

    def sensor(self, arena: Arena, *path: str | float, pitch_up_deg: float = 0.0) -> TofArray:
        """As shipped, on the random stream of this path; `arena` says which surfaces there are."""
        mount = TofMount(x_m=0.0, y_m=0.0, z_m=HEIGHT_M, yaw_deg=0.0, pitch_up_deg=pitch_up_deg)
        tof = self.tof.model_copy(update={"mounts": TofMounts(front=mount, left=mount, right=mount)})
        return TofArray(tof, arena, PHYSICS_HZ, stream(self.seed, "bench", "tof", *map(str, path)), self.effects)

    def without_noise(self) -> "Bench":
        """The same with neither noise, rounding nor lost updates, for the shape of a curve."""
        still = {"noise_scale": 0.0, "quantisation_m": 0.0, "dropout_probability": 0.0}
        return Bench(self.tof.model_copy(update=still), self.effects, self.seed)

    def readings_mm(self, sensor: TofArray, stand: Stand, count: int) -> Array:
        """The valid ones of at least so many readings of a scene [mm].

        Raises:
            InputError: Hardly any is valid.
        """
        found = valid_mm(self.samples(sensor, stand, count))
        if len(found) < FEWEST_VALID:
            what = f"of {count} readings of a board the robot's range sensor gives {len(found)}"
            raise InputError(what, where="robot.tof", allowed=f"at least {FEWEST_VALID}", cure="take more readings")
        return found

    def samples(self, sensor: TofArray, stand: Stand, count: int) -> Array:
        """Range [m] and `TofStatus` of at least so many readings of a scene, (N, 2)."""
        # The three sensors are alike unless an effect acts on one of them.
        at_once = 1 if any("sensor" in effect.options() for effect in self.effects) else 3
        return np.concatenate([sensor.sample(stand)[:at_once] for _ in range(-(-count // at_once))])


def valid_mm(samples: Array) -> Array:
    """Of samples (N, 2), the ranges [mm] with a target that are no repetition."""
    return 1e3 * samples[samples[:, 1] == TofStatus.VALID, 0]


def seen_mm(sensor: TofArray, stand: Stand, distance_mm: float) -> float:
    """As `reading_mm`, of a robot that must see something there.

    Raises:
        InputError: It does not.
    """
    found = reading_mm(sensor, stand)
    if np.isnan(found):
        raise InputError(f"the robot's range sensor sees no board at {distance_mm:.0f} mm", where="robot.tof")
    return found


def reading_mm(sensor: TofArray, stand: Stand) -> float:
    """One reading [mm], NaN without a target."""
    range_m, status = sensor.sample(stand)[0]
    return 1e3 * float(range_m) if status == TofStatus.VALID else float("nan")


def closed_form(arena: Arena) -> RayScene:
    """The rays of the simulation."""
    return RayScene(arena)


def grid(first: float, last: float, step: float) -> NDArray[np.float64]:
    """From first to last, both included."""
    return first + step * np.arange(round((last - first) / step) + 1)
