"""Fisheye lenses: the model of Kannala and Brandt as OpenCV's module `fisheye` writes it, and its inverse.

A ray at the angle t from the axis meets the sensor at the distance f d(t) from the axis, with

    d(t) = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)

With all k at 0 the lens is equidistant. Directions are unit vectors here and not slopes x / z and y / z, because a ray
may come from beside the camera or from behind it.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from symolo.core.arrays import Array

_NEWTON_STEPS = 12
_AXIS = 1e-12
"""Sine or radius below which a ray is on the axis."""


class FisheyeSettings(Protocol):
    """A fisheye lens, as the configuration of a robot has it."""

    field_of_view_deg: float
    k1: float
    k2: float
    k3: float
    k4: float


@dataclass(frozen=True)
class Fisheye:
    """A lens that shows what lies within an angle from its axis, and is dark beyond it."""

    half_field_rad: float
    k: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @classmethod
    def from_settings(cls, settings: FisheyeSettings) -> "Fisheye":
        half_field_rad = float(np.radians(0.5 * settings.field_of_view_deg))
        return cls(half_field_rad, (settings.k1, settings.k2, settings.k3, settings.k4))

    @property
    def is_equidistant(self) -> bool:
        return not any(self.k)

    def radius(self, angle: Array) -> Array:
        """Return the distance from the axis, in units of the focal length, of rays at angles [rad], of any shape."""
        a2 = angle * angle
        k1, k2, k3, k4 = self.k
        return angle * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))))

    def slope(self, angle: Array) -> Array:
        """Return the derivative of `radius`."""
        a2 = angle * angle
        k1, k2, k3, k4 = self.k
        return 1.0 + a2 * (3.0 * k1 + a2 * (5.0 * k2 + a2 * (7.0 * k3 + a2 * 9.0 * k4)))

    def angle(self, radius: Array) -> Array:
        """Return the angles [rad] of rays at distances from the axis; NaN beyond the field of view."""
        if self.is_equidistant:
            angle = np.asarray(radius, dtype=np.float64)
        else:
            angle = np.minimum(radius, self.half_field_rad)
            for _ in range(_NEWTON_STEPS):
                angle = np.clip(
                    angle - (self.radius(angle) - radius) / self.slope(angle), 0.0, 1.5 * self.half_field_rad
                )
        return np.where(angle <= self.half_field_rad + 1e-9, angle, np.nan)

    def on_sensor(self, p_C: Array) -> Array:
        """Return the points (N, 2) on the sensor, in units of the focal length, of points (N, 3) in C.

        Points beyond the field of view have NaN.
        """
        across = np.hypot(p_C[:, 0], p_C[:, 1])
        angle = np.arctan2(across, p_C[:, 2])
        angle = np.where(angle <= self.half_field_rad + 1e-9, angle, np.nan)
        return p_C[:, :2] * (self.radius(angle) / np.maximum(across, _AXIS))[:, None]

    def directions(self, on_sensor: Array) -> Array:
        """Return the unit vectors (N, 3) in C of rays that meet the sensor in points (N, 2); NaN beyond the field."""
        radius = np.hypot(on_sensor[:, 0], on_sensor[:, 1])
        angle = self.angle(radius)
        across = on_sensor * (np.sin(angle) / np.maximum(radius, _AXIS))[:, None]
        return np.column_stack([across, np.cos(angle)])

    def problem(self) -> str:
        """Return why the lens is impossible; empty where it is possible."""
        angles = np.linspace(0.0, self.half_field_rad, 257)
        if np.any(self.slope(angles) <= 0.0):
            return "the lens folds the image back on itself within its field of view"
        return ""
