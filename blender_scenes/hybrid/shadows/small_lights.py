"""Lights whose shadows have narrow borders: the sun, and lamps that are small beside their height above the floor.

A point of a light is homogeneous: (x, y, z, 1) for a place, (x, y, z, 0) for a direction.
"""

import numpy as np

from blender_scenes.hybrid.floor.relief import lean_from
from blender_scenes.scene.description import LightPanel, Sun
from symolo.core.arrays import Array, FloatImage

_GOLDEN_RAD = np.pi * (3.0 - 5.0**0.5)
_MIN_RISE = 1e-3
"""Smallest z of a direction to the light of the sun, below which its shadows do not end."""
_MIN_TIMES_HEIGHT = 1.5
"""Height of a lamp, as a multiple of that of a body, from which on its light comes from above all of the body."""


class SunDisc:
    """The sun, a disc at no finite distance."""

    def __init__(self, sun: Sun) -> None:
        self.name = "sun"
        self._towards, self._diameter_rad = np.array(sun.towards), sun.angular_diameter_rad
        self._irradiance = float(np.mean(sun.irradiance))

    def points(self, count: int) -> Array:
        """Return points (K, 4) in W with equal parts of the light, about as many as `count`."""
        directions = disc_directions(self._towards, self._diameter_rad, count)
        return np.column_stack([directions, np.zeros(len(directions))])

    def corners(self) -> Array:
        """Return the corners (4, 4) in W of a square around all of its light."""
        right, up = _across(self._towards)
        reach = np.tan(0.5 * self._diameter_rad)
        # A lower side of the square that would be below the horizon lies on it.
        down = min(reach, (self._towards[2] - _MIN_RISE) / up[2]) if up[2] > 0 else reach
        sides = [self._towards + x * right + y * up for x in (-reach, reach) for y in (-down, reach)]
        return np.column_stack([sides, np.zeros(len(sides))])

    def border_m(self, height_m: float) -> float:
        """Return the width of the border of a shadow that is thrown from a height."""
        # A point of the sun is seen up to d h / sin(elevation)^2 from the place of its middle.
        return height_m * self._diameter_rad / float(self._towards[2]) ** 2

    def is_above(self, height_m: float) -> bool:  # noqa: ARG002 - a lamp's height matters
        """Return whether its light comes from above everything that is no higher."""
        return True

    def light_at(self, points: FloatImage) -> FloatImage:
        """Return the mean light (H, W) of a matt white floor at points (H, W, 2) if nothing hides the light."""
        return np.full(points.shape[:2], self._irradiance * self._towards[2] / np.pi, np.float32)

    def lean_at(self, points: FloatImage) -> FloatImage:  # noqa: ARG002 - as above
        """Return the lean of its light, as `relief.lean` has it, at points (H, W, 2) of the floor."""
        return lean_from(self._towards)


class SmallLamp:
    """A lamp that is a small rectangle."""

    def __init__(self, panel: LightPanel) -> None:
        self.name = panel.name
        self._panel, self._height_m = panel, panel.center[2]
        self._size_m = max(panel.width_m, panel.height_m)

    def points(self, count: int) -> Array:
        """Return points (K, 4) in W with equal parts of the light, at least as many as `count`."""
        panel, along = self._panel, int(np.ceil(np.sqrt(count)))
        shares = (np.arange(along) + 0.5) / along - 0.5
        right, up = np.meshgrid(shares * panel.width_m, shares * panel.height_m)
        places = panel.center + right.reshape(-1, 1) * np.array(panel.right) + up.reshape(-1, 1) * np.array(panel.up)
        return np.column_stack([places, np.ones(len(places))])

    def corners(self) -> Array:
        """Return the corners (4, 4) in W of a rectangle around all of its light."""
        panel = self._panel
        right, up = (0.5 * panel.width_m * np.array(panel.right), 0.5 * panel.height_m * np.array(panel.up))
        sides = [panel.center + x * right + y * up for x in (-1, 1) for y in (-1, 1)]
        return np.column_stack([sides, np.ones(len(sides))])

    def border_m(self, height_m: float) -> float:
        """Return the width of the border of a shadow that is thrown from a height, straight below the lamp."""
        return self._size_m * height_m / (self._height_m - height_m)

    def is_above(self, height_m: float) -> bool:
        """Return whether its light comes from above everything that is no higher."""
        return self._height_m > _MIN_TIMES_HEIGHT * height_m

    def light_at(self, points: FloatImage) -> FloatImage:
        """Return the mean light (H, W) of a matt white floor at points (H, W, 2) if nothing hides the light."""
        panel = self._panel
        across_m = points - np.array(panel.center[:2])
        away = np.concatenate([across_m, np.full_like(points[..., :1], -self._height_m)], axis=-1)
        square_m2 = (away**2).sum(axis=-1)
        forward_m = np.maximum(away @ np.cross(panel.right, panel.up), 0)
        power = float(np.mean(panel.radiance)) * panel.width_m * panel.height_m
        return (power * forward_m * self._height_m / (np.pi * square_m2**2)).astype(np.float32)

    def lean_at(self, points: FloatImage) -> FloatImage:
        """Return the lean (H, W, 6) of its light, as `relief.lean` has it, at points (H, W, 2) of the floor."""
        away = np.array(self._panel.center[:2], np.float32) - points
        return lean_from(np.concatenate([away, np.full_like(away[..., :1], self._height_m)], axis=-1))


SmallLight = SunDisc | SmallLamp
"""Both have the same methods."""


def on_floor(points: Array, light: Array) -> Array:
    """Return where a point (4,) of a light throws the shadows (N, 2) of points (N, 3) below it."""
    z = points[:, 2:]
    return (light[2] * points[:, :2] - z * light[:2]) / (light[2] - light[3] * z)


def disc_directions(towards: Array, diameter_rad: float, count: int) -> list[Array]:
    """Return directions (3,) to points with equal parts of a disc, on a spiral (Vogel, Math. Biosciences 44, 1979)."""
    towards = np.asarray(towards, float)
    right, up = _across(towards)
    reach = np.tan(0.5 * diameter_rad) * np.sqrt((np.arange(count) + 0.5) / count)
    angle = _GOLDEN_RAD * np.arange(count)
    away = reach[:, None] * (np.cos(angle)[:, None] * right + np.sin(angle)[:, None] * up)
    return [direction for direction in towards + away if direction[2] > _MIN_RISE]


def _across(towards: Array) -> tuple[Array, Array]:
    """Return two directions (3,) at right angles to a third one and to each other."""
    right = np.cross(towards, (0.0, 0.0, 1.0) if abs(towards[2]) < 0.9 else (1.0, 0.0, 0.0))
    right /= np.linalg.norm(right)
    return right, np.cross(right, towards)
