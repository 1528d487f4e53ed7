"""An ultrasonic range sensor such as the HC-SR04: a wide beam, smooth walls that reflect sound away, the first echo."""

from collections.abc import Iterator
from math import sqrt

import numpy as np
from pydantic import Field

from configs.robot_sensors import MountedSettings, SensorSettings
from configs.validation.faults import ConfigFault
from sensors.base import Reading, Sensor, World, quantise
from sensors.ranging.tof import ray_pattern
from symolo.arena.geometry import Arena
from symolo.dataset.tables.column import Column


class UltrasonicSettings(MountedSettings):
    """Place, beam and errors of an ultrasonic range sensor; the defaults are those of an HC-SR04."""

    period_s: float = Field(default=0.06, gt=0, le=1)
    """Time between two readings; a shorter one would hear late echoes of the pulse before."""
    field_of_view_deg: float = Field(default=30.0, gt=0, le=120)
    """Full angle of the cone in which echoes are heard."""
    beam_sigma_deg: float = Field(default=8.0, gt=0, le=90)
    """Standard deviation of the Gaussian beam of transmitter and receiver together."""
    rays: int = Field(default=120, ge=1, le=1000)
    """Number of rays in the cone."""
    scatter_deg: float = Field(default=8.0, gt=0, le=90)
    """Standard deviation of the angle at which a surface still returns sound: small for smooth walls, which reflect
    sound away like a mirror when they are hit at a slant."""
    echo_threshold: float = Field(default=0.02, ge=0, le=1)
    """Weakest echo that is heard, relative to that of a flat wall head-on at the same distance."""
    pulse_m: float = Field(default=0.03, gt=0, le=1)
    """Length of the pulse in the air, over which the parts of an echo add up."""
    min_range_m: float = Field(default=0.02, ge=0, le=1)
    """Smallest range; nearer echoes come while the transmitter still rings."""
    max_range_m: float = Field(default=4.0, gt=0, le=20)
    """Largest range; later echoes are not waited for."""
    air_temperature_C: float = Field(default=20.0, ge=-40, le=60)
    """Temperature of the air, which decides the speed of sound."""
    assumed_temperature_C: float = Field(default=20.0, ge=-40, le=60)
    """Temperature that the robot assumes when it turns times into ranges."""
    noise_m: float = Field(default=0.002, ge=0, le=1)
    """Standard deviation of a range [m]."""
    quantisation_m: float = Field(default=0.003, ge=0, le=0.1)
    """Step of the ranges [m], about one period of the sound of 40 kHz; 0 for none."""
    dropout_probability: float = Field(default=0.01, ge=0, le=1)
    """Probability that an echo is missed."""

    def faults(self) -> Iterator[ConfigFault]:
        if self.min_range_m >= self.max_range_m:
            allowed = f"less than max_range_m, which is {self.max_range_m}"
            yield ConfigFault(("min_range_m",), got=self.min_range_m, allowed=allowed, against=("max_range_m",))


class Ultrasonic(Sensor):
    """Range to the first echo that is loud enough."""

    Settings = UltrasonicSettings
    columns = (Column("range", "m", 4, "range to the first echo, 0 for none"),)
    settings: UltrasonicSettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        config = self.settings
        angle, roll = ray_pattern(config.rays, np.radians(config.field_of_view_deg))
        X_RS = config.X_RS()
        across = np.sin(angle)
        rays_S = np.stack([np.cos(angle), across * np.cos(roll), across * np.sin(roll)], axis=1)
        self._origin_R, self._rays_R = X_RS[:3, 3], rays_S @ X_RS[:3, :3].T
        self._profile = np.exp(-0.5 * (angle / np.radians(config.beam_sigma_deg)) ** 2)
        self._head_on = float(np.sum(self._profile * self._returned(np.cos(angle))))
        # The robot multiplies the time by the speed of sound that it assumes (Laplace: proportional to sqrt(T)).
        self._stretch = sqrt((273.15 + config.assumed_temperature_C) / (273.15 + config.air_temperature_C))

    def sample(self, world: World) -> Reading:
        """Return the range [m], (1,)."""
        config = self.settings
        range_m = self._first_echo(world)
        reading_m = float(
            quantise(range_m * self._stretch + config.noise_m * self.rng.standard_normal(1), config.quantisation_m)[0]
        )
        missed = self.rng.random() < config.dropout_probability
        heard = range_m > 0.0 and config.min_range_m <= reading_m <= config.max_range_m and not missed
        return np.array([reading_m if heard else 0.0])

    def _first_echo(self, world: World) -> float:
        """Return the distance [m] at which the echoes within a pulse first add up to the threshold; 0 for none."""
        config = self.settings
        x, y, yaw = world.pose()
        c, s = np.cos(yaw), np.sin(yaw)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        origin, directions = self._origin_R @ turn + (x, y, 0.0), self._rays_R @ turn
        reach_m = config.max_range_m + config.pulse_m
        origins = np.broadcast_to(origin, directions.shape)
        hits = world.cast(origins, origins + reach_m * directions)
        cosine = np.abs(np.einsum("ij,ij->i", directions, hits.normal))
        echo = self._profile * self._returned(cosine)
        order = np.argsort(hits.fraction, kind="stable")
        distance_m, total = hits.fraction[order] * reach_m, np.cumsum(echo[order])
        # Sound from the beginning of the pulse is heard together with what returns half a pulse farther away.
        first = np.searchsorted(distance_m, distance_m - 0.5 * config.pulse_m)
        loud = total - np.where(first > 0, total[first - 1], 0.0) >= config.echo_threshold * self._head_on
        heard = np.flatnonzero(loud & (echo[order] > 0.0) & (hits.surface[order] >= 0))
        return float(distance_m[heard[0]]) if len(heard) else 0.0

    def _returned(self, cosine: np.ndarray) -> np.ndarray:
        """Return the share of sound that comes back from surfaces, by the cosine of the incidence."""
        incidence = np.arccos(np.minimum(cosine, 1.0))
        return np.where(cosine > 0.0, np.exp(-0.5 * (incidence / np.radians(self.settings.scatter_deg)) ** 2), 0.0)
