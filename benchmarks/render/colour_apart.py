"""A trial: few samples of the light, many of the surfaces' colour, which cost a fifth to under a half.

A second Blender scene shows the same meshes in surfaces that shine in their own colour: no light, no bounce, no relief.
The picture's diffuse light is divided by the colour that its own few samples met, multiplied by that of the many, and
the whole is denoised once, guided by the colour and the normals of the second scene, which have next to no noise.
Each frame stands for itself. Nothing that moves but camera and robot is shown, as in the benchmark's views.
"""

from pathlib import Path
from typing import Any

import bpy
import numpy as np
from colour_exchange import Image, exchanged
from oidn import denoise

from blender_scenes.bpy_side.placing import place
from blender_scenes.description import FrameView
from configs.assets.exr import read_exr

_MET, _COLOUR = "met", "colour"
_PASSES = ("diffuse_color", "diffuse_direct", "diffuse_indirect")


class ColourApart:
    """Renders views of the scene that stands in Blender, configured by `engine.configure`."""

    def __init__(self, size: tuple[int, int], folder: Path, light_samples: int, colour_samples: int) -> None:
        self._light = bpy.context.scene
        self._samples = {self._light.name: light_samples, _COLOUR: colour_samples}
        layer, render = self._light.view_layers[0], self._light.render
        render.resolution_x, render.resolution_y = size
        render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        self._light.cycles.use_denoising = False
        shining = {material.name: _shining(material) for material in list(bpy.data.materials)}
        self._colour = self._light.copy()
        self._colour.name = _COLOUR
        self._colour.world, self._colour.cycles.max_bounces = None, 0
        for scene in (self._light, self._colour):
            scene.render.filepath = str(folder / f"{scene.name}.exr")
        for name in _PASSES:
            setattr(layer, f"use_pass_{name}", True)
        aov = layer.aovs.add()
        aov.name, aov.type = _MET, "COLOR"
        self._colour.view_layers[0].use_pass_normal = True
        _dress(self._colour, shining)

    def light(self, view: FrameView, *, warm_up: bool = False) -> Image:
        """(H, W, 3) linear light of a view."""
        place(view)
        lit = self._traced(self._light, view.number, warm_up=warm_up)
        # Other random numbers than those of the light, which a picture's own colour has.
        plain = self._traced(self._colour, view.number + 2**20, warm_up=warm_up)
        diffuse = lit["DiffCol"] * (lit["DiffDir"] + lit["DiffInd"])
        colour = plain["Combined"]
        return denoise(exchanged(lit["Combined"], diffuse, lit[_MET], colour), colour, plain["Normal"])

    def _traced(self, scene: bpy.types.Scene, seed: int, *, warm_up: bool) -> dict[str, Image]:
        scene.cycles.seed, scene.cycles.samples = seed, 1 if warm_up else self._samples[scene.name]
        bpy.ops.render.render(write_still=True, scene=scene.name)
        found: dict[str, dict[str, Any]] = {}
        for name, values in read_exr(Path(scene.render.filepath).read_bytes()).items():
            *_, of, component = name.split(".")
            found.setdefault(of, {})[component] = values
        return {of: _stacked(parts) for of, parts in found.items() if len(parts) > 1}


def _stacked(parts: dict[str, Any]) -> Image:
    return np.stack([parts[c] for c in ("RGB" if "R" in parts else "XYZ")], axis=-1).astype(np.float32)


def _shining(material: bpy.types.Material) -> bpy.types.Material:
    """A copy that shines in its diffuse colour; the material itself is made to tell the colour that is met."""
    copy = material.copy()
    for one in (material, copy):
        tree = one.node_tree
        (surface,) = (node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        scaled = tree.nodes.new("ShaderNodeVectorMath")
        scaled.operation = "SCALE"
        metal, clear = (surface.inputs[name].default_value for name in ("Metallic", "Transmission Weight"))
        scaled.inputs["Scale"].default_value = (1 - metal) * (1 - clear)
        base = surface.inputs["Base Color"]
        if base.is_linked:
            tree.links.new(base.links[0].from_socket, scaled.inputs[0])
        else:
            scaled.inputs[0].default_value = base.default_value[:3]
        if one is material:
            told = tree.nodes.new("ShaderNodeOutputAOV")
            told.aov_name = _MET
            tree.links.new(scaled.outputs[0], told.inputs["Color"])
        else:
            (out,) = (node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
            shine = tree.nodes.new("ShaderNodeEmission")
            tree.links.new(scaled.outputs[0], shine.inputs["Color"])
            tree.links.new(shine.outputs[0], out.inputs["Surface"])
    return copy


def _dress(scene: bpy.types.Scene, shining: dict[str, bpy.types.Material]) -> None:
    """Puts copies of what the camera sees in place of the scene's objects, in their shining surfaces."""
    for thing in list(scene.collection.objects):
        if thing == scene.camera:
            continue
        scene.collection.objects.unlink(thing)
        if thing.type != "MESH" or not thing.visible_camera:
            continue
        dressed = thing.copy()
        for slot in dressed.material_slots:
            own = shining[slot.material.name]
            slot.link, slot.material = "OBJECT", own
        scene.collection.objects.link(dressed)
