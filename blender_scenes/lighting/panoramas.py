"""What the panoramas shipped with bpy hold, measured once, so that their light is known without reading them."""

from blender_scenes.shading import RGB
from configs.schema.lighting import PanoramaName

CEILING = 10.0
"""Components above this belong to a sun or a lamp in the picture, not to the sky."""

MEAN_COLOR: dict[PanoramaName, RGB] = {
    "city": (1.1422, 1.2265, 1.3952),
    "courtyard": (0.8434, 0.8878, 1.0983),
    "forest": (1.0518, 1.1792, 1.3717),
    "interior": (0.8373, 0.7887, 0.7859),
    "night": (0.2135, 0.1820, 0.1614),
    "studio": (0.1188, 0.1288, 0.1343),
    "sunrise": (0.3824, 0.4797, 0.5808),
    "sunset": (0.7437, 0.7732, 1.0392),
}
"""Mean linear colour above the horizon by solid angle, each component cut off at `CEILING`."""
