"""Mean colours of textured surfaces, measured on a map of each, for the light that they reflect to other surfaces.

A mean that is computed from the formula of a texture is off by some per cent where a pattern has thresholds, and on the
floor that error is one of all light.
"""

import itertools
from pathlib import Path

import bpy
import numpy as np

from blender_scenes.blender_side.hybrid.materials import shining
from blender_scenes.blender_side.rendering import rendered
from blender_scenes.blender_side.shaders import MATT, SURFACE
from blender_scenes.scene.description import Point2, Scene
from blender_scenes.scene.shading import Color, Constant, Surface
from blender_scenes.scene.typical import matt_color
from symolo.core.arrays import triple

_SIDE_PX = 32
"""Side of the map of a surface; its pixels are samples of the texture, a few centimetres apart on a floor."""
_COLUMNS = 8
_EXR_PIXEL_BYTES = 12
_ABOVE_M = 1.0


def measure_matt_colors(scene: Scene, scratch: Path) -> None:
    """Give the matt part of each textured material its mean colour; call it after `engine.configure`.

    Raises:
        OSError: The disk is full.
    """
    textured = [surface for surface in scene.surfaces if _has_matt_part(surface)]
    if not textured:
        return
    materials = {material[SURFACE]: material for material in bpy.data.materials if SURFACE in material}
    squares = [(materials[surface.name], _bounds(scene, surface.name)) for surface in textured]
    maps = _scene_of_maps(bpy.context.scene, squares)
    maps.render.filepath = str(scratch / "matt_colors.exr")
    channels = rendered(maps, _EXR_PIXEL_BYTES)
    image = np.stack([channels[name] for name in "RGB"], axis=-1)
    # The scene stays, because Blender crashes some time after a scene was removed whose data Cycles had kept.
    for number, surface in enumerate(textured):
        row, column = divmod(number, _COLUMNS)
        tile = image[row * _SIDE_PX :, column * _SIDE_PX :][:_SIDE_PX, :_SIDE_PX]
        color = matt_color(surface, triple(tile.mean(axis=(0, 1), dtype=np.float64)))
        materials[surface.name].node_tree.nodes[MATT].inputs["Color"].default_value = (*color, 1.0)


def _has_matt_part(surface: Surface) -> bool:
    has_one = surface.transmission == 0 and not surface.encloses_lamp
    return has_one and not isinstance(surface.base_color, Color | Constant)


def _bounds(scene: Scene, surface: str) -> tuple[Point2, Point2]:
    """Return the corners of the rectangle around the surface coordinates of all faces of a surface."""
    meshes = (*scene.meshes, *scene.robot_parts, *scene.moving)
    faces = (zip(mesh.face_surface, mesh.uv_m, strict=True) for mesh in meshes if surface in mesh.face_surface)
    points = np.array(
        [point for name, uv in itertools.chain(*faces) if name == surface for point in uv] or [(0.0, 0.0)]
    )
    (u0, v0), (u1, v1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return (u0, v0), (u1, v1)


def _scene_of_maps(
    main: bpy.types.Scene, surfaces: list[tuple[bpy.types.Material, tuple[Point2, Point2]]]
) -> bpy.types.Scene:
    """Return a scene in which a square of each material shines with its colour, in rows from the top left."""
    made = main.copy()
    made.name, made.world = "matt colors", None
    for item in list(made.collection.objects):
        made.collection.objects.unlink(item)
    for number, (material, bounds) in enumerate(surfaces):
        row, column = divmod(number, _COLUMNS)
        made.collection.objects.link(_square(shining(material, 0), bounds, (float(column), -float(row + 1))))
    rows = -(-len(surfaces) // _COLUMNS)
    data = bpy.data.cameras.new(made.name)
    data.type, data.ortho_scale = "ORTHO", float(max(_COLUMNS, rows))
    made.camera = bpy.data.objects.new(made.name, data)
    made.camera.location = (0.5 * _COLUMNS, -0.5 * rows, _ABOVE_M)
    made.collection.objects.link(made.camera)
    made.render.resolution_x, made.render.resolution_y = _COLUMNS * _SIDE_PX, rows * _SIDE_PX
    made.render.use_persistent_data = False
    cycles = made.cycles
    cycles.device, cycles.samples, cycles.seed, cycles.use_denoising, cycles.max_bounces = "CPU", 1, 0, False, 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    return made


def _square(material: bpy.types.Material, bounds: tuple[Point2, Point2], corner: Point2) -> bpy.types.Object:
    (x, y), ((u0, v0), (u1, v1)) = corner, bounds
    data = bpy.data.meshes.new(material.name)
    data.from_pydata([(x, y, 0.0), (x + 1, y, 0.0), (x + 1, y + 1, 0.0), (x, y + 1, 0.0)], [], [(0, 1, 2, 3)])
    data.uv_layers.new(name="uv_m").data.foreach_set("uv", [u0, v0, u1, v0, u1, v1, u0, v1])
    data.materials.append(material)
    return bpy.data.objects.new(material.name, data)
