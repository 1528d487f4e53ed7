"""The colours of the objects of a run, as its images show them from a distance."""

from collections import Counter

from blender_scenes.scene.description import Scene
from blender_scenes.scene.run_scene import describe
from blender_scenes.scene.typical import typical_color
from configs.schema.scenario import RunSpec
from pipeline.models.geometry import srgb
from pipeline.stages.render import picture_seed
from sensors.camera.colour import RGB
from symolo.arena.geometry import Arena


def scene_of(spec: RunSpec) -> Scene:
    """Return the scene of a run, with its robot."""
    seed = picture_seed(spec.seed, spec.route, spec.run)
    return describe(Arena.from_config(spec.arena), spec.robot, spec.look, seed)


def colours(scene: Scene) -> dict[str, RGB]:
    """Return the sRGB colour of each mesh by name: that of the surface of most of its faces."""
    typical = {surface.name: srgb(typical_color(surface)) for surface in scene.surfaces}
    meshes = (*scene.meshes, *scene.moving, *scene.robot_parts)
    return {mesh.name: typical[Counter(mesh.face_surface).most_common(1)[0][0]] for mesh in meshes}
