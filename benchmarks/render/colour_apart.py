"""A trial: few samples of the light, many of the surfaces' colour, which cost a fifth to under a half.

A second Blender scene shows the same meshes in surfaces that shine in their own colour: no light, no bounce, no relief.
The picture's diffuse light is divided by the colour that its own few samples met, multiplied by that of the many, and
the whole is denoised once, guided by the colour and the normals of the second scene, which have next to no noise.
Of the floor, which most of a picture shows, the colour may come from a map instead (`floor_map`): then it is black in
the second scene, which tells how much of a pixel it covers, and of one colour in the first.
Each frame stands for itself. Nothing that moves but camera and robot is shown, as in the benchmark's views.
"""

from pathlib import Path
from typing import Any

import bpy
import numpy as np
from colour_exchange import Image, exchanged
from floor_map import FloorMap, lies_on_the_floor
from oidn import denoise

from blender_scenes.bpy_side.placing import place
from blender_scenes.description import FrameView
from blender_scenes.job import RenderJob
from blender_scenes.typical import typical_color
from configs.assets.exr import read_exr

_MET, _COLOUR, _FLOOR = "met", "colour", "floor"
_PASSES = ("diffuse_color", "diffuse_direct", "diffuse_indirect")


class ColourApart:
    """Renders views of the scene that stands in Blender, configured by `engine.configure`."""

    def __init__(
        self, job: RenderJob, folder: Path, light_samples: int, colour_samples: int, floor_texel_m: float | None
    ) -> None:
        self._light = bpy.context.scene
        size = job.camera.width_px, job.camera.height_px
        self._samples = {self._light.name: light_samples, _COLOUR: colour_samples}
        layer, render = self._light.view_layers[0], self._light.render
        render.resolution_x, render.resolution_y = size
        render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        self._light.cycles.use_denoising = False
        on_map = (
            {s.name: typical_color(s) for s in job.scene.surfaces if _is_flat(job, s.name)} if floor_texel_m else {}
        )
        materials = list(bpy.data.materials)
        shining = {material.name: _shining(material, on_map.get(material.name)) for material in materials}
        black = _covering() if on_map else None
        self._colour = self._light.copy()
        self._colour.name = _COLOUR
        self._colour.world, self._colour.cycles.max_bounces = None, 0
        self._colour.render.filepath = str(folder / "colour.exr")
        self._light.render.filepath = str(folder / "light.exr")
        for name in _PASSES:
            setattr(layer, f"use_pass_{name}", True)
        aov = layer.aovs.add()
        aov.name, aov.type = _MET, "COLOR"
        self._colour.view_layers[0].use_pass_normal = True
        self._floor: FloorMap | None = None
        if floor_texel_m is not None:
            above = self._colour.copy()
            above.name = "above"
            above.render.filepath = str(folder / "above.exr")
            _dress(above, {name: shining[name] for name in on_map})
            cover = self._colour.view_layers[0].aovs.add()
            cover.name, cover.type = _FLOOR, "COLOR"
            shining |= dict.fromkeys(on_map, black)
            self._floor = FloorMap(
                above, lambda scene, seed: self._channels(scene, seed)["Combined"], job, floor_texel_m
            )
        _dress(self._colour, shining)

    def light(self, view: FrameView, *, warm_up: bool = False) -> Image:
        """(H, W, 3) linear light of a view."""
        place(view)
        lit = self._traced(self._light, view.number, warm_up=warm_up)
        # Other random numbers than those of the light, which a picture's own colour has.
        plain = self._traced(self._colour, view.number + 2**20, warm_up=warm_up)
        diffuse = lit["DiffCol"] * (lit["DiffDir"] + lit["DiffInd"])
        colour = plain["Combined"]
        if self._floor is not None:
            colour = colour + plain[_FLOOR] * self._floor.colour(view)
        return denoise(exchanged(lit["Combined"], diffuse, lit[_MET], colour), colour, plain["Normal"])

    def _traced(self, scene: bpy.types.Scene, seed: int, *, warm_up: bool) -> dict[str, Image]:
        scene.cycles.samples = 1 if warm_up else self._samples[scene.name]
        return self._channels(scene, seed)

    def _channels(self, scene: bpy.types.Scene, seed: int) -> dict[str, Image]:
        scene.cycles.seed = seed
        bpy.ops.render.render(write_still=True, scene=scene.name)
        found: dict[str, dict[str, Any]] = {}
        for name, values in read_exr(Path(scene.render.filepath).read_bytes()).items():
            *_, of, component = name.split(".")
            found.setdefault(of, {})[component] = values
        return {of: _stacked(parts) for of, parts in found.items() if len(parts) > 1}


def _stacked(parts: dict[str, Any]) -> Image:
    return np.stack([parts[c] for c in ("RGB" if "R" in parts else "XYZ")], axis=-1).astype(np.float32)


def _is_flat(job: RenderJob, surface: str) -> bool:
    """Whether a surface belongs to meshes on the floor."""
    return any(lies_on_the_floor(mesh.name) and surface in mesh.face_surface for mesh in job.scene.meshes)


def _shining(material: bpy.types.Material, plain: tuple[float, float, float] | None) -> bpy.types.Material:
    """A copy that shines in its diffuse colour; the material itself is made to tell the colour that is met.

    That is `plain` where it is given, which the material then has all over.
    """
    copy = material.copy()
    for one, only in ((material, plain), (copy, None)):
        tree = one.node_tree
        (surface,) = (node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        scaled = tree.nodes.new("ShaderNodeVectorMath")
        scaled.operation = "SCALE"
        metal, clear = (surface.inputs[name].default_value for name in ("Metallic", "Transmission Weight"))
        scaled.inputs["Scale"].default_value = (1 - metal) * (1 - clear)
        base = surface.inputs["Base Color"]
        if only is not None:
            for link in list(base.links):
                tree.links.remove(link)
            base.default_value = (*only, 1.0)
        if base.is_linked:
            tree.links.new(base.links[0].from_socket, scaled.inputs[0])
        else:
            scaled.inputs[0].default_value = base.default_value[:3]
        if one is material:
            told = tree.nodes.new("ShaderNodeOutputAOV")
            told.aov_name = _MET
            tree.links.new(scaled.outputs[0], told.inputs["Color"])
        else:
            _shine(tree, scaled.outputs[0])
    return copy


def _shine(tree: bpy.types.NodeTree, colour: bpy.types.NodeSocket) -> None:
    (out,) = (node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    shine = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(colour, shine.inputs["Color"])
    tree.links.new(shine.outputs[0], out.inputs["Surface"])


def _covering() -> bpy.types.Material:
    """Black, and told apart by 1 in a pass of its own."""
    made = bpy.data.materials.new("covering")
    made.use_nodes = True
    tree = made.node_tree
    black = tree.nodes.new("ShaderNodeRGB")
    black.outputs[0].default_value = (0.0, 0.0, 0.0, 1.0)
    _shine(tree, black.outputs[0])
    told = tree.nodes.new("ShaderNodeOutputAOV")
    told.aov_name = _FLOOR
    told.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    return made


def _dress(scene: bpy.types.Scene, shining: dict[str, bpy.types.Material]) -> None:
    """Puts copies of what the camera sees, of those surfaces, in place of the scene's objects."""
    for thing in list(scene.collection.objects):
        if thing == scene.camera:
            continue
        scene.collection.objects.unlink(thing)
        if thing.type != "MESH" or not thing.visible_camera:
            continue
        if not all(slot.material.name in shining for slot in thing.material_slots):
            continue
        dressed = thing.copy()
        for slot in dressed.material_slots:
            own = shining[slot.material.name]
            slot.link, slot.material = "OBJECT", own
        scene.collection.objects.link(dressed)
