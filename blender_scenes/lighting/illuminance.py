"""How much light of what colour the lamps and windows bring to a place, without tracing it."""

from collections.abc import Sequence

import numpy as np

from blender_scenes.scene.description import Panel, Point3
from sensors.camera.colour import RGB


def on_the_floor(panels: Sequence[Panel], at: Point3) -> RGB:
    """Direct illuminance of a level surface [klx], each panel taken as one small Lambertian source far away."""
    total = np.zeros(3)
    for panel in panels:
        ray = np.subtract(panel.center, at)
        distance = float(np.linalg.norm(ray))
        leaving = -float(ray @ np.cross(panel.right, panel.up)) / distance
        arriving = float(ray[2]) / distance
        area = panel.width_m * panel.height_m
        total += np.multiply(panel.radiance, area * max(leaving, 0.0) * max(arriving, 0.0) / distance**2)
    return float(total[0]), float(total[1]), float(total[2])
