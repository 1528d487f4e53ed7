"""The stand: the simulator's own sensor before targets, far from any floor, moved as the paper's manipulator did.

The sensor sits at the origin of R, 1 m above the floor, which its cone meets at 4.5 m only. All three sensors of the
robot are put in that one place, so that one sample gives three readings.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from configs.effects.robot_effects import RobotEffects
from configs.schema.arena import ArenaConfig, LineConfig, SurfaceName, WallConfig
from configs.schema.robot import RobotConfig, TofMount, TofMounts, TofSensor
from diagnosis.validation.still_world import StillWorld
from physics.arena.rays import RayScene
from sensors.tof import TofArray
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.random_streams import stream
from symolo.dataset.codes import TofStatus

HEIGHT_M = 1.0
TARGET_HEIGHT_M = 2.0
TARGET_HALF_WIDTH_M = 2.0
MIN_VALID = 3
"""Fewest valid readings of a scene that give a mean and a deviation."""
PHYSICS_HZ = 1000
"""Rate of the simulation; it has no effect, because the stand takes the samples itself."""


def target(distance_m: float, surface: SurfaceName = "white_board") -> Arena:
    """Return one plane board across the x axis at a distance from the origin."""
    return arena_of(board("target", distance_m, TARGET_HALF_WIDTH_M, surface=surface))


def board(
    name: str, x_m: float, left_m: float, thickness_m: float = 0.02, surface: SurfaceName = "white_board"
) -> WallConfig:
    """Return a board that faces the sensor, from far on its right to `left_m`."""
    start, end = (x_m, -TARGET_HALF_WIDTH_M), (x_m, left_m)
    return WallConfig(
        name=name, start=start, end=end, height_m=TARGET_HEIGHT_M, thickness_m=thickness_m, surface=surface
    )


def arena_of(*boards: WallConfig) -> Arena:
    """Return an arena with these boards and nothing else."""
    return Arena.from_config(ArenaConfig(name="bench", line=LineConfig(), walls=boards))


@dataclass(frozen=True)
class SensorOnStand:
    """The range sensor of one robot with its effects, on the stand."""

    tof: TofSensor
    effects: RobotEffects
    seed: int

    @classmethod
    def of_robot(cls, robot: RobotConfig, seed: int) -> "SensorOnStand":
        return cls(robot.tof, robot.effects, seed)

    def sensor(self, arena: Arena, *path: str | float, pitch_up_deg: float = 0.0) -> TofArray:
        """Return the sensor as configured, on the random stream of this path; `arena` has the surfaces."""
        mount = TofMount(x_m=0.0, y_m=0.0, z_m=HEIGHT_M, yaw_deg=0.0, pitch_up_deg=pitch_up_deg)
        tof = self.tof.model_copy(update={"mounts": TofMounts(front=mount, left=mount, right=mount)})
        return TofArray(tof, arena, PHYSICS_HZ, stream(self.seed, "bench", "tof", *map(str, path)), self.effects)

    def without_noise(self) -> "SensorOnStand":
        """Return the same with neither noise, rounding nor lost updates, for the shape of a curve."""
        still = {"noise_scale": 0.0, "quantisation_m": 0.0, "dropout_probability": 0.0}
        return SensorOnStand(self.tof.model_copy(update=still), self.effects, self.seed)

    def readings_mm(self, sensor: TofArray, world: StillWorld, count: int) -> Array:
        """Return the valid ones of at least `count` readings of a scene [mm].

        Raises:
            InputError: Hardly any is valid.
        """
        valid = valid_mm(self.samples(sensor, world, count))
        if len(valid) < MIN_VALID:
            what = f"{len(valid)} of {count} readings of a board by the robot's range sensor are valid"
            raise InputError(what, where="robot.tof", allowed=f"at least {MIN_VALID}", cure="take more readings")
        return valid

    def samples(self, sensor: TofArray, world: StillWorld, count: int) -> Array:
        """Return range [m] and `TofStatus` of at least `count` readings of a scene, (N, 2)."""
        # The three sensors are alike unless an effect acts on one of them.
        at_once = 1 if any("sensor" in effect.options() for effect in self.effects) else 3
        return np.concatenate([sensor.sample(world)[:at_once] for _ in range(-(-count // at_once))])


def valid_mm(samples: Array) -> Array:
    """Return the ranges [mm] of those samples (N, 2) that have a target and repeat no earlier one."""
    return 1e3 * samples[samples[:, 1] == TofStatus.VALID, 0]


def seen_mm(sensor: TofArray, world: StillWorld, distance_mm: float) -> float:
    """Return one reading [mm] of a sensor that must see a target at this distance.

    Raises:
        InputError: It sees none.
    """
    range_mm = reading_mm(sensor, world)
    if np.isnan(range_mm):
        raise InputError(f"the robot's range sensor sees no board at {distance_mm:.0f} mm", where="robot.tof")
    return range_mm


def reading_mm(sensor: TofArray, world: StillWorld) -> float:
    """Return one reading [mm], NaN without a target."""
    range_m, status = sensor.sample(world)[0]
    return 1e3 * float(range_m) if status == TofStatus.VALID else float("nan")


def closed_form(arena: Arena) -> RayScene:
    """Return the rays of the simulation."""
    return RayScene(arena)


def grid(first: float, last: float, step: float) -> NDArray[np.float64]:
    """Return evenly spaced values from first to last, both included."""
    return first + step * np.arange(round((last - first) / step) + 1)
