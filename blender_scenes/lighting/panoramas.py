"""Mean colours of panoramas: measured once for the shipped ones, and when the look is read for the user's files."""

from blender_scenes.scene.description import Sky
from configs.schema.appearance.asset import Asset
from configs.schema.appearance.lighting import PanoramaName
from sensors.camera.colour import RGB

CEILING = 10.0
"""Components above this belong to a sun or a lamp in the panorama, not to the sky."""

MEAN_COLOR: dict[str, RGB] = {
    "city": (1.1422, 1.2265, 1.3952),
    "courtyard": (0.8434, 0.8878, 1.0983),
    "forest": (1.0518, 1.1792, 1.3717),
    "interior": (0.8373, 0.7887, 0.7859),
    "night": (0.2135, 0.1820, 0.1614),
    "studio": (0.1188, 0.1288, 0.1343),
    "sunrise": (0.3824, 0.4797, 0.5808),
    "sunset": (0.7437, 0.7732, 1.0392),
}
"""Mean linear colour above the horizon by solid angle of each `PanoramaName`, components cut off at `CEILING`."""


def mean_color(panorama: PanoramaName | Asset) -> RGB:
    """Return the mean linear colour above the horizon, without sun and lamps."""
    return panorama.mean_rgb if isinstance(panorama, Asset) else MEAN_COLOR[panorama]


def mean_of_sky(sky: Sky) -> RGB:
    """Return the mean linear colour of a scene's sky above the horizon."""
    return sky.mean if sky.mean is not None else MEAN_COLOR[sky.panorama]
