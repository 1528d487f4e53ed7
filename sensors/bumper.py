"""A bumper: a bar before the body, with switches that close where something pushes it in."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import Field

from configs.robot_sensors import MountedSettings, SensorSettings
from configs.schema.base import Fixed
from configs.validation.faults import ConfigFault
from sensors.base import Reading, Sensor, World
from symolo.arena.geometry import Arena
from symolo.dataset.tables.column import Column

SPACING_M = 0.002
"""Largest distance between two rays; a narrower thing may pass between them."""
INTO_BODY_M = 0.01
"""Distance behind the surface of the body at which the rays start, because a body that touches it overlaps with it, and
a ray does not meet a body in which it starts."""


class BumperSettings(MountedSettings):
    """Place and size of a bumper. Its x axis points out of the body, and its origin is on the body behind the bar."""

    period_s: float = Field(default=0.01, gt=0, le=1)
    """Time between two readings of the switches."""
    x_m: float = Field(default=0.09, ge=-1, le=1)
    """Place of the body's surface behind the bar, ahead of the axle [m]."""
    z_m: float = Field(default=0.04, ge=0, le=2)
    """Height of the bar above the floor [m]."""
    width_m: float = Field(default=0.15, gt=0, le=2)
    """Length of the bar across the x axis [m]."""
    reach_m: float = Field(default=0.015, gt=0, le=0.5)
    """Distance from the body to the outer face of the bar at rest [m]."""
    travel_m: float = Field(default=0.003, ge=0, le=0.5)
    """Distance by which the bar must be pushed in before a switch closes [m]."""
    zones: Annotated[int, Fixed("it decides the columns of the table")] = Field(default=1, ge=1, le=32)
    """Number of switches, each for an equal part of the bar."""

    def faults(self) -> Iterator[ConfigFault]:
        if self.travel_m >= self.reach_m:
            allowed = f"less than reach_m, which is {self.reach_m}"
            yield ConfigFault(("travel_m",), got=self.travel_m, allowed=allowed, against=("reach_m",))


class Bumper(Sensor):
    """State of each switch of a bumper, 1 while something presses its zone of the bar, from right to left."""

    Settings = BumperSettings
    settings: BumperSettings

    def __init__(self, settings: SensorSettings, arena: Arena, physics_hz: int, rng: np.random.Generator) -> None:
        super().__init__(settings, arena, physics_hz, rng)
        config = self.settings
        per_zone = max(2, round(config.width_m / config.zones / SPACING_M) + 1)
        edges = np.linspace(-0.5 * config.width_m, 0.5 * config.width_m, config.zones + 1)
        across = np.concatenate([np.linspace(low, high, per_zone) for low, high in pairwise(edges)])
        starts = np.stack([np.zeros_like(across), across, np.zeros_like(across)], axis=1)
        X_RS = config.X_RS()
        ends = starts + np.array([config.reach_m - config.travel_m, 0.0, 0.0])
        points_S = np.concatenate([starts - np.array([INTO_BODY_M, 0.0, 0.0]), ends])
        self._points_R = points_S @ X_RS[:3, :3].T + X_RS[:3, 3]

    @classmethod
    def columns_of(cls, settings: SensorSettings) -> tuple[Column, ...]:
        zones = settings.zones if isinstance(settings, BumperSettings) else 1
        return (Column("pressed", "-", 0, "1 while something presses this zone of the bar", zones),)

    def sample(self, world: World) -> Reading:
        """Return whether each zone is pushed in, (zones,)."""
        x, y, yaw = world.pose()
        c, s = np.cos(yaw), np.sin(yaw)
        points = self._points_R @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + (x, y, 0.0)
        starts, ends = np.split(points, 2)
        hits = world.cast(starts, ends)
        return (hits.surface.reshape(self.settings.zones, -1) >= 0).any(axis=1).astype(np.float64)
