"""VL53L0X time-of-flight sensors: rays over the cone, weighted mean, error, noise (paper sections 5.2 and 6).

One update of the three sensors is one batch of rays. The weight of a ray is the beam profile at its angle times the
cosine of incidence (Lambert). A ray that hits nothing has weight 0. If too little light returns, there is no target.
Effects may change the weights in the mean, but not the amount of light.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import cos, sin
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from configs.effects.base import Slot
from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RangeBeam, RobotConfig, TofMount, TofSensor
from physics.arena.surfaces import SURFACES
from physics.robot.model import applied
from sensors.base import Reading, Sampling, Sensor, World, quantise
from sensors.ranging.logarithmic_error import NEAR_LIMIT_M, log_beyond_near
from sensors.ranging.range_effects import RangeEffects
from sensors.ranging.range_view import OTHER_SENSOR, RANGE_SENSORS, RangeView
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.dataset.codes import TofStatus
from symolo.dataset.tables.rows import RANGES
from symolo.dataset.tables.side_tables import RANGE_STATUS

NO_EFFECTS = RobotEffects()
SUBSAMPLES = 8
"""Number of moments at which the scene is evaluated while light is gathered, besides the end of this time."""

NOISE_AT_NEAR_MM = 1.41
"""Standard deviation of Eq. 23 up to 0.18 m."""
VALID, NO_TARGET, HELD = map(float, TofStatus)
"""Status as a number in a reading; with the members of an enum, numpy is ten times slower."""


@dataclass(frozen=True)
class Light:
    """Light that returns to the N sensors at one moment."""

    signal: Array
    """(N,), light relative to that of a flat wall head-on that fills the cone, at any reflectance and distance."""
    share: Array
    """(N, rays), share of each ray in the mean."""
    range_m: Array
    """(N,), mean over the rays."""
    surface: NDArray[np.int64]
    """(N, rays), index of the surface."""
    normal: Array
    """(N, rays, 3), normal of the surface; 0 without a hit."""


class RangeDevices:
    """Any number N of sensors of one kind; each reading is a range [m] and a `TofStatus`."""

    sensor: ClassVar[int | NDArray[np.int64]] = OTHER_SENSOR
    """Index of each one among `RANGE_SENSORS`."""

    def __init__(  # noqa: PLR0917 - what a sensor is built from, and the places
        self,
        config: RangeBeam,
        mounts: Sequence[TofMount],
        arena: Arena,
        physics_hz: int,
        rng: np.random.Generator,
        effects: RobotEffects = NO_EFFECTS,
        roll_rad: float = 0.0,
    ) -> None:
        delay_s = applied(effects.functions(Slot.RANGE_DELAY), config.delay_s)
        self._gathering_s = applied(effects.functions(Slot.RANGE_GATHERING), 0.0)
        gathering = {round(physics_hz * self._gathering_s * k / SUBSAMPLES) for k in range(SUBSAMPLES + 1)}
        subsamples = tuple(sorted(gathering - {0}, reverse=True))
        self.sampling = replace(
            Sampling.from_seconds(config.period_s, delay_s, physics_hz), subsamples_before=subsamples
        )
        self._subsamples: list[tuple[float, Light]] = []
        self._drift_functions = effects.functions(Slot.RANGE_WANDER)
        # A stream of its own, so that the noise is the same with and without a random drift.
        (self._drift_rng,) = rng.spawn(1)
        self._count = len(mounts)
        self._drift_m, self._drift_time_s = np.zeros(self._count), -np.inf
        self._effects = RangeEffects.from_effects(effects)
        self._config = config
        self._rng = rng
        angle, roll = ray_pattern(config.rays, np.radians(config.field_of_view_deg))
        roll = roll + roll_rad
        self._profile = beam_profile(config, angle)
        self._weighting = effects.functions(Slot.RAY_WEIGHT)
        self._head_on = head_on_factor(self._profile, angle, self._weighting)
        self._full_signal = head_on_factor(self._profile, angle) * self._profile.sum()
        self._rays_R, self._frames_R = self._rays_and_frames(mounts, effects, angle, roll, roll_rad)
        self._read_surfaces(arena)
        self._previous_m: Array | None = None
        self._last = [(config.no_target_m, NO_TARGET)] * self._count

    def _rays_and_frames(
        self, mounts: Sequence[TofMount], effects: RobotEffects, angle: Array, roll: Array, roll_rad: float
    ) -> tuple[Array, Array]:
        """Return origins and directions of all rays (2 N rays, 4), and axis, left and up of each sensor (3, N, 3), in
        R.

        Args:
            mounts: Places of the N sensors.
            effects: Effects of the robot, which may turn a sensor in its mount.
            angle: (rays,), angle of each ray to the axis.
            roll: (rays,), direction of each ray around the axis.
            roll_rad: Roll of the sensors about their axes.
        """
        origins_R = [np.tile([m.x_m, m.y_m, m.z_m, 1.0], (len(angle), 1)) for m in mounts]
        askew = applied(effects.functions(Slot.RANGE_MOUNT), np.zeros(self._count))
        directions_R = [ray_directions(m, angle, roll, extra) for m, extra in zip(mounts, askew, strict=True)]
        # Origins, then directions. Rows that end with 1 are moved and turned with the robot, rows with 0 only turned.
        rays_R = np.concatenate([*origins_R, np.pad(np.concatenate(directions_R), ((0, 0), (0, 1)))])
        # Axis, left and up of each sensor, (3, N, 3): the directions of rays along the axis and at right angles to it.
        frame_angle = 0.5 * np.pi * np.array([0.0, 1.0, 1.0])
        frame_roll = 0.5 * np.pi * np.array([0.0, 0.0, 1.0]) + roll_rad
        frames = [ray_directions(m, frame_angle, frame_roll, extra) for m, extra in zip(mounts, askew, strict=True)]
        return rays_R, np.stack(frames, axis=1)

    def _read_surfaces(self, arena: Arena) -> None:
        """Keep what each surface of the arena does to a reading, the floor first."""
        surfaces = [SURFACES[box.surface] for box in arena.boxes]
        # Index 0 is the floor, which the paper did not measure. It has no offset and the noise of Eq. 23.
        offset_m = np.array([0.0] + [s.offset_m for s in surfaces])
        sd_m = 1e-3 * np.array([NOISE_AT_NEAR_MM] + [s.sd_mm_at_100_mm for s in surfaces])
        self._offset_and_sd_m = np.stack([offset_m, sd_m])
        self._reflectance = np.array([arena.floor_reflectance] + [s.reflectance for s in surfaces])
        self._materials = np.array(["floor"] + [box.surface for box in arena.boxes])

    def sample(self, world: World) -> Array:
        """Return range [m] and `TofStatus` of each sensor, (N, 2)."""
        config = self._config
        light = self._light(world)
        true_range = self._gathered(world.time_s, light) if self._gathering_s > 0.0 else light.range_m
        offset, surface_sd = (light.share * self._offset_and_sd_m.take(light.surface, axis=1)).sum(axis=2)
        # The device averages over its beam, so offset and noise are means over the surfaces, weighted by their light.
        sd = noise_sd_m(surface_sd, true_range) * config.noise_scale
        reading = true_range + offset + config.error_scale * log_error_m(true_range)
        if self._effects.need_view:
            reading, sd = self._effects.seen(reading, sd, self._view(world, true_range, light))
            self._previous_m = true_range
        if self._drift_functions:
            reading = reading + self._drifted(world.time_s)
        noise = sd * self._rng.standard_normal(self._count)
        reading = self._effects.limited(quantise(reading + noise, config.quantisation_m))
        fresh = self._all_judged(light, true_range, reading)
        lost = (self._rng.random(self._count) < config.dropout_probability).tolist()
        self._last = [
            (before[0], HELD) if gone else now for now, before, gone in zip(fresh, self._last, lost, strict=True)
        ]
        return np.array(self._last)

    def subsample(self, world: World) -> None:
        self._subsamples.append((world.time_s, self._light(world)))

    def _light(self, world: World) -> Light:
        """Return the light that returns at this moment."""
        distance, cosine, surface, normal = self._cast(world)
        weight = self._profile * cosine
        returned = weight.sum(axis=1)
        signal = returned / self._full_signal
        if self._weighting:
            weight = applied(self._weighting, weight, distance)
            returned = weight.sum(axis=1)
        share = weight / np.maximum(returned, 1e-12)[:, None]
        return Light(signal, share, (share * distance).sum(axis=1) * self._head_on, surface, normal)

    def _gathered(self, time_s: float, light: Light) -> Array:
        """Return the mean range (N,) over the gathering time; moments without returned light do not count."""
        begin_s = time_s - self._gathering_s - 1e-9
        self._subsamples = [subsample for subsample in self._subsamples if subsample[0] >= begin_s] + [(time_s, light)]
        if len(self._subsamples) == 1:
            return light.range_m
        times = np.array([seen_s for seen_s, _ in self._subsamples])
        gaps = np.diff(times)
        # The trapezoidal rule, with twice its weights.
        length_s = np.append(gaps, 0.0) + np.append(0.0, gaps)
        ranges = np.stack([seen.range_m for _, seen in self._subsamples])
        signals = np.stack([seen.signal for _, seen in self._subsamples])
        weight = length_s[:, None] * (signals > 0.0)
        # Without any light the mean is 0, as the range of a single moment is.
        return (weight * ranges).sum(axis=0) / np.maximum(weight.sum(axis=0), 1e-12)

    def _drifted(self, time_s: float) -> Array:
        """Return the random drift (N,) at a time [m]."""
        deviates = self._drift_rng.standard_normal(self._count)
        self._drift_m = applied(self._drift_functions, self._drift_m, time_s - self._drift_time_s, deviates)
        self._drift_time_s = time_s
        return self._drift_m

    def _all_judged(self, light: Light, true_m: Array, reading_m: Array) -> list[tuple[float, float]]:
        """Return range [m] and status of each sensor."""
        del true_m
        return [self._judged(*pair) for pair in zip(light.signal.tolist(), reading_m.tolist(), strict=True)]

    def _judged(self, signal: float, reading_m: float) -> tuple[float, float]:
        """Return range [m] and status of one sensor, from plain floats; for three sensors numpy is not faster."""
        config = self._config
        if signal >= config.signal_threshold and config.min_range_m <= reading_m <= config.max_range_m:
            return reading_m, VALID
        return config.no_target_m, NO_TARGET

    def _view(self, world: World, distance_m: Array, light: Light) -> RangeView:
        """Return the view for the effects; material, reflectance and normal are means over the returned light."""
        share, surface, normal = light.share, light.surface, light.normal
        _, _, yaw = world.pose()
        c, s = np.cos(yaw), np.sin(yaw)
        frames = self._frames_R @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        mean_normal = np.einsum("ij,ijk->ik", share, normal)
        length = np.maximum(np.linalg.norm(mean_normal, axis=1), 1e-12)
        axial, left, up = np.einsum("aij,ij->ai", frames, mean_normal) / length
        seen = self._materials[surface]
        return RangeView(
            distance_m=distance_m,
            previous_distance_m=distance_m if self._previous_m is None else self._previous_m,
            incidence_rad=np.arccos(np.minimum(-axial, 1.0)),
            tilt_forward_rad=np.arctan2(up, -axial),
            tilt_sideways_rad=np.arctan2(left, -axial),
            # If no light returns there is no reading, and any reflectance will do.
            reflectance=np.where(share.sum(axis=1) > 0.0, (share * self._reflectance[surface]).sum(axis=1), 1.0),
            material_share={name: (share * (seen == name)).sum(axis=1) for name in np.unique(self._materials)},
            temperature_C=self._config.temperature_C,
            reference_temperature_C=self._config.reference_temperature_C,
            ambient_lux=self._config.ambient_lux,
            time_s=world.time_s,
            sensor=self.sensor,
            normal_rad=np.arctan2(mean_normal[:, 1], mean_normal[:, 0]),
        )

    def _cast(self, world: World) -> tuple[Array, Array, NDArray[np.int64], Array]:
        """Return slant distance [m], cosine of incidence and surface index, (N, rays) each, and normal, (N, rays, 3).

        A ray without a hit has a normal of 0 and so a cosine and a weight of 0, whatever its surface index.
        """
        x, y, yaw = world.pose()
        c, s = cos(yaw), sin(yaw)
        rays = self._rays_R @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0], [x, y, 0.0]])
        origins, directions = rays[: len(rays) // 2], rays[len(rays) // 2 :]
        # Rays end a little beyond the largest range that the device reports; a ray without a hit returns no light.
        reach = 1.25 * self._config.max_range_m
        hits = world.cast(origins, origins + reach * directions)
        shape = (self._count, self._config.rays)
        cosine = np.abs(np.einsum("ij,ij->i", directions, hits.normal))
        distance_m = hits.fraction * reach
        return (
            distance_m.reshape(shape),
            cosine.reshape(shape),
            hits.surface.reshape(shape),
            hits.normal.reshape((*shape, 3)),
        )


class TofArray(RangeDevices, Sensor):
    """The front, left and right sensors, in this order everywhere."""

    name = "tof"
    Settings = TofSensor
    series = (RANGES, RANGE_STATUS)
    sensor = np.arange(len(RANGE_SENSORS))

    def __init__(
        self,
        config: TofSensor,
        arena: Arena,
        physics_hz: int,
        rng: np.random.Generator,
        effects: RobotEffects = NO_EFFECTS,
    ) -> None:
        mounts = (config.mounts.front, config.mounts.left, config.mounts.right)
        super().__init__(config, mounts, arena, physics_hz, rng, effects)

    @classmethod
    def on_robot(cls, robot: RobotConfig, arena: Arena, physics_hz: int, rng: np.random.Generator) -> "TofArray":
        return cls(robot.tof, arena, physics_hz, rng, robot.effects)

    def recorded(self, reading: Reading) -> tuple[Reading, ...]:
        return reading[:, 0], reading[:, 1].astype(np.int64)


def ray_pattern(rays: int, field_of_view_rad: float) -> tuple[Array, Array]:
    """Return each ray's angle off the axis and around it [rad], (rays,) each.

    The rays form a sunflower spiral, whose points are evenly distributed over the solid angle of the cone.
    """
    index = np.arange(rays) + 0.5
    golden_angle = np.pi * (3.0 - np.sqrt(5.0))
    return 0.5 * field_of_view_rad * np.sqrt(index / rays), golden_angle * index


def beam_profile(config: RangeBeam, angle: Array) -> Array:
    """Return the intensity of the beam along rays at these angles off its axis [rad]."""
    return np.exp(-0.5 * (angle / np.radians(config.beam_sigma_deg)) ** 2)


def head_on_factor(profile: Array, angle: Array, weighting: tuple[Callable[..., Array], ...] = ()) -> float:
    """Return the distance of a flat wall head-on over the mean over its rays, which travel further at a slant.

    The device is calibrated head-on: a flat wall at d reads d.

    Args:
        profile: (rays,), intensity of the beam.
        angle: (rays,), angles off the axis [rad].
        weighting: Effects on the weights of rays.
    """
    facing, slanted = (applied(weighting, light, 1.0 / np.cos(angle)) for light in (profile * np.cos(angle), profile))
    return float(np.sum(facing) / np.sum(slanted))


def ray_directions(mount: TofMount, angle: Array, roll: Array, extra_yaw_rad: float = 0.0) -> Array:
    """Return the unit directions (rays, 3) in R of a cone whose axis is turned by the mount's yaw and pitch."""
    x, y, z = np.cos(angle), np.sin(angle) * np.cos(roll), np.sin(angle) * np.sin(roll)
    pitch, yaw = np.radians(mount.pitch_up_deg), np.radians(mount.yaw_deg) + extra_yaw_rad
    x, z = x * np.cos(pitch) - z * np.sin(pitch), x * np.sin(pitch) + z * np.cos(pitch)
    return np.stack([x * np.cos(yaw) - y * np.sin(yaw), x * np.sin(yaw) + y * np.cos(yaw), z], axis=1)


def noise_sd_m(surface_sd_m: Array, range_m: Array) -> Array:
    """Return the standard deviation of a reading [m].

    At short range it is that of the surface; at longer range, the growth of Eq. 23 is added.

    Tables 3 and 4 list a standard deviation at 100 mm for each surface, which differs from the 1.41 mm of Eq. 23. Both
    are right if variances add: a surface with 1.41 mm follows Eq. 23 exactly, and every other surface approaches it as
    the distance grows. The variable of the polynomial is d = x - 0.18 m, so that it is continuous at 0.18 m.
    """
    d = range_m - NEAR_LIMIT_M
    # For d < 0 the polynomial is below 1.41, so that the maximum is 1.41 there.
    eq_23_mm = np.maximum(((1.15 * d + 2.51) * d + 4.88) * d + 1.40, NOISE_AT_NEAR_MM)
    return np.sqrt(surface_sd_m**2 + 1e-6 * (eq_23_mm**2 - NOISE_AT_NEAR_MM**2))


def log_error_m(range_m: Array) -> Array:
    """Return the error of Eq. 24 [m]: 59.77 mm ln(x / 0.18 m) from 0.18 m on, 0 below.

    The printed formula 59.77 ln(x) - 116.86 is 0 at x = 7.065, which is 0.18 m in inches. With x in metres it would be
    wrong by 219 mm at 0.18 m, so it is not used.
    """
    return 0.05977 * log_beyond_near(range_m)
