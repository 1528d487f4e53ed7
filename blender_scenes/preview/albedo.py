"""What share of the light a surface returns at each of its points: the one place that knows how detailed that is."""

import numpy as np

from blender_scenes.preview.triangles import Array
from blender_scenes.shading import Surface
from blender_scenes.typical import typical_color


def albedo(surface: Surface, uv_m: Array) -> Array:
    """Reflectance (N, 3) at surface coordinates (N, 2) [m]: the surface's typical colour everywhere."""
    return np.broadcast_to(np.array(typical_color(surface)), (len(uv_m), 3))
