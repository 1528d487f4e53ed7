"""The stand: the sensor of the simulator in front of boards, moved as the manipulator of the paper moved it.

The sensor sits at the origin of R, 1 m above the floor, which its cone meets only at 4.5 m. All three sensors of the
robot are at that one place, so that one sample gives three readings.
"""

from dataclasses import dataclass

import numpy as np

from configs.effects.robot_effects import RobotEffects
from configs.schema.arena import ArenaConfig, LineConfig, SurfaceName, WallConfig
from configs.schema.robot import RobotConfig, TofMount, TofMounts, TofSensor
from diagnosis.validation.still_world import RayCaster, StillWorld
from physics.arena.rays import RayScene
from sensors.ranging.tof import TofArray
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
    def from_robot(cls, robot: RobotConfig, seed: int) -> "SensorOnStand":
        return cls(robot.tof, robot.effects, seed)

    def facing(self, arena: Arena, *path: str | float, pitch_up_deg: float = 0.0) -> "StandScene":
        """Return the sensor as configured in front of the boards of an arena, on the random stream of this path."""
        mount = TofMount(x_m=0.0, y_m=0.0, z_m=HEIGHT_M, yaw_deg=0.0, pitch_up_deg=pitch_up_deg)
        tof = self.tof.model_copy(update={"mounts": TofMounts(front=mount, left=mount, right=mount)})
        rng = stream(self.seed, "bench", "tof", *map(str, path))
        # The three sensors are alike unless an effect acts on one of them.
        alike = 1 if any("sensor" in effect.options() for effect in self.effects) else 3
        return StandScene(TofArray(tof, arena, PHYSICS_HZ, rng, self.effects), RayScene(arena), alike)

    def without_noise(self) -> "SensorOnStand":
        """Return the same with neither noise, rounding nor lost updates, for the shape of a curve."""
        still = {"noise_scale": 0.0, "quantisation_m": 0.0, "dropout_probability": 0.0}
        return SensorOnStand(self.tof.model_copy(update=still), self.effects, self.seed)


@dataclass(frozen=True)
class StandScene:
    """The sensor in front of boards."""

    sensor: TofArray
    caster: RayCaster
    """Bodies that the rays of the sensor hit; other bodies than the boards for a second opinion."""
    alike: int
    """Number of sensors, 1 or 3, whose readings are used."""

    def samples(self, count: int, yaw_deg: float = 0.0) -> Array:
        """Return range [m] and `TofStatus` of at least `count` readings, (N, 2)."""
        world = StillWorld(self.caster, yaw_deg=yaw_deg)
        return np.concatenate([self.sensor.sample(world)[: self.alike] for _ in range(-(-count // self.alike))])

    def readings_mm(self, count: int, yaw_deg: float = 0.0) -> Array:
        """Return the valid ones of at least `count` readings [mm].

        Raises:
            InputError: Hardly any reading is valid.
        """
        valid = valid_mm(self.samples(count, yaw_deg))
        if len(valid) < MIN_VALID:
            what = f"{len(valid)} of {count} readings of a board by the robot's range sensor are valid"
            raise InputError(what, where="robot.tof", allowed=f"at least {MIN_VALID}", cure="take more readings")
        return valid

    def reading_mm(self, y_m: float = 0.0, yaw_deg: float = 0.0) -> float:
        """Return one reading [mm], NaN without a target."""
        range_m, status = self.sensor.sample(StillWorld(self.caster, y_m=y_m, yaw_deg=yaw_deg))[0]
        return 1e3 * float(range_m) if status == TofStatus.VALID else float("nan")

    def seen_mm(self, distance_mm: float, y_m: float = 0.0, yaw_deg: float = 0.0) -> float:
        """Return one reading [mm] of a target at this distance, which the sensor must see.

        Raises:
            InputError: The sensor sees no target.
        """
        range_mm = self.reading_mm(y_m, yaw_deg)
        if np.isnan(range_mm):
            raise InputError(f"the robot's range sensor sees no board at {distance_mm:.0f} mm", where="robot.tof")
        return range_mm


def valid_mm(samples: Array) -> Array:
    """Return the ranges [mm] of those samples (N, 2) that have a target and do not repeat an earlier one."""
    return 1e3 * samples[samples[:, 1] == TofStatus.VALID, 0]


def grid(first: float, last: float, step: float) -> Array:
    """Return evenly spaced values from first to last, both included."""
    return first + step * np.arange(round((last - first) / step) + 1)
