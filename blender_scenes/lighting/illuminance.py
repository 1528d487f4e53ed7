"""The light of lamps and windows at a place, without path tracing."""

from collections.abc import Sequence

import numpy as np

from blender_scenes.scene.description import LightPanel, Point3
from sensors.camera.colour import RGB
from symolo.core.arrays import triple


def on_the_floor(panels: Sequence[LightPanel], at: Point3) -> RGB:
    """Return the direct illuminance of a level surface [klx]; each panel counts as a small, far Lambertian source."""
    total = np.zeros(3)
    for panel in panels:
        ray = np.subtract(panel.center, at)
        distance = float(np.linalg.norm(ray))
        leaving = -float(ray @ np.cross(panel.right, panel.up)) / distance
        arriving = float(ray[2]) / distance
        area = panel.width_m * panel.height_m
        total += np.multiply(panel.radiance, area * max(leaving, 0.0) * max(arriving, 0.0) / distance**2)
    return triple(total)
