"""Plain surfaces of the room and of the robot, which are seen from far, in mirrors and as shadows."""

from blender_scenes.scene.shading import Color, Surface, paint_color
from configs.schema.appearance.look import Paint
from sensors.camera.colour import RGB


def painted(name: str, paint: Paint, roughness: float) -> Surface:
    return Surface(name, paint_color(paint), roughness=roughness)


def moulded(name: str, rgb: RGB, roughness: float) -> Surface:
    """Return plastic, rubber or lacquer of one colour."""
    return Surface(name, Color(rgb), roughness=roughness)


def bare_metal(name: str, rgb: RGB, roughness: float) -> Surface:
    return Surface(name, Color(rgb), roughness=roughness, metallic=1.0)
