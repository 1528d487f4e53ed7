"""The colours of the objects of a run, as its images show them from a distance."""

from collections import Counter

from blender_scenes.scene.run_scene import describe
from blender_scenes.scene.typical import typical_color
from configs.schema.scenario import RunSpec
from pipeline.models.geometry import srgb
from pipeline.stages.render import image_seed
from sensors.camera.colour import RGB
from symolo.arena.geometry import Arena


def colours(spec: RunSpec) -> dict[str, RGB]:
    """Return the sRGB colour of each mesh of a run's scene by name: that of the surface of most of its faces."""
    seed = image_seed(spec.seed, spec.route, spec.run)
    scene = describe(Arena.from_config(spec.arena), spec.robot, spec.look, seed)
    typical = {surface.name: srgb(typical_color(surface)) for surface in scene.surfaces}
    meshes = (*scene.meshes, *scene.moving, *scene.robot_parts)
    return {mesh.name: typical[Counter(mesh.face_surface).most_common(1)[0][0]] for mesh in meshes}
