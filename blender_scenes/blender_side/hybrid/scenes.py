"""The Blender scenes of hybrid rendering.

They share the objects of the main scene, so that `place` moves them in all scenes. Blender keeps Cycles' data of the
last rendered scene only and builds them again for another one. All renderings of a view therefore use one scene, in
which objects that shall be invisible are moved far away; the maps, which are rendered rarely, have a scene each.
"""

import re
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from blender_scenes.blender_side.build import ROBOT, moving_name
from blender_scenes.blender_side.hybrid.joints import MaterialJoints
from blender_scenes.blender_side.hybrid.materials import (
    COVER,
    SURFACE_DATA,
    WHITE,
    as_color,
    in_grey,
    plain,
    shining,
    turned,
)
from blender_scenes.blender_side.placing import place
from blender_scenes.blender_side.rendering import Part, rendered, show_part
from blender_scenes.hybrid.floor.tiled_map import Tile
from blender_scenes.scene.description import Scene
from blender_scenes.scene.typical import typical_color
from sensors.camera.views import FrameView
from symolo.core.arrays import FloatImage

Passes = dict[str, FloatImage]
"""Passes by name: (H, W, 3), or (H, W, 1) for a single channel, float32, with the first row at the top."""

_ABOVE_M = 0.5
_EXR_PIXEL_BYTES = 112
"""At most seven passes of four channels, four bytes each."""
GRID_TURN_RAD = 0.35
"""Angle of the reflectance map's texels in W. Texels are sampled in their middle: an edge parallel to them would be
off by up to half a texel along its whole length, while for others the errors alternate."""
_MIN_FILTER_PX = 0.01
"""Minimum width of Cycles' pixel filter, which samples the middle of a pixel."""
_MIN_REFLECTANCE = 0.05
_LINE = re.compile(r"(tape|paint)_\d+")
"""Names of the pieces of the line in `line_mesh`."""
_FLOOR_PASSES = ("diffuse_color", "diffuse_direct", "diffuse_indirect")
_LIGHT_PASSES = (*_FLOOR_PASSES, "emit", "environment")
_SURFACE_PASSES = ("diffuse_color", "normal", "z", "emit", "environment")
_AWAY_M = 1000.0
"""Distance beyond which the camera sees nothing; a floor that is moved down by it is invisible."""
MaterialChange = Callable[[bpy.types.Material], bpy.types.Material]
"""Function that returns the material in the place of another one."""


def lies_on_the_floor(name: str) -> bool:
    """Return whether a mesh, by its name, belongs to the floor, which for a camera is flat and at z = 0."""
    return name == "floor" or _LINE.fullmatch(name) is not None


class HybridScenes:
    """The scenes, made from the main scene in Blender after `engine.configure`."""

    def __init__(self, scene: Scene, scratch: Path) -> None:
        self._main, self._scratch = bpy.context.scene, scratch
        moving = [bpy.data.objects[moving_name(number)] for number in range(len(scene.moving))]
        self._moves = {item for item in bpy.data.objects if item.parent and item.parent.name == ROBOT} | {*moving}
        self._floor = [bpy.data.objects[mesh.name] for mesh in scene.meshes if lies_on_the_floor(mesh.name)]
        self._changed: dict[tuple[MaterialChange, str], bpy.types.Material] = {}
        self._view = self._scene("view", _LIGHT_PASSES)
        black = plain("covering", "ShaderNodeEmission", {"Strength": 0.0}, is_floor=True)
        self._grey_floor = self._replace_floor(self._view, in_grey)
        self._black_floor = self._add_floor(self._view, lambda _: black)
        white = plain("matt white", "ShaderNodeBsdfDiffuse", {"Color": WHITE})
        self._white_floor = self._add_floor(self._view, lambda _: white)
        self._lamps = [item.data for item in bpy.data.objects if item.type == "LIGHT"]
        _add_pass(self._view, COVER)
        self._reflectance = self._scene("reflectance", ())
        self._keep_floor(self._reflectance)
        names = dict.fromkeys(material.name for item in self._floor for material in item.data.materials)
        numbers = {name: number for number, name in enumerate(names)}
        replaced = self._replace_floor(self._reflectance, lambda material: shining(material, numbers[material.name]))
        shown = {slot.material.name: slot.material for item in replaced for slot in item.material_slots}
        self._joints = MaterialJoints(shown.values())
        self._reflectance.cycles.filter_width = _MIN_FILTER_PX
        _add_pass(self._reflectance, SURFACE_DATA)
        self._irradiance = self._scene("irradiance", _FLOOR_PASSES)
        self._hide_all_but_floor(self._irradiance)
        self._lit_floor = self._replace_floor(self._irradiance, turned)
        # Clamping applies to the light that the floor reflects: on the white floor it must set in at a higher value.
        self._irradiance.cycles.sample_clamp_indirect /= _reflectance_of_the_floor(scene)
        for baking in (self._reflectance, self._irradiance):
            _look_down(baking)

    def light(self, size: tuple[int, int], samples: int, seed: int, view: FrameView) -> tuple[Passes, Passes]:
        """Return the light of a view with a grey floor, with and without what moves, from the same random numbers.

        `size` is width and height [px]; each pixel is the mean of its square. The first result has the pass `COVER`.
        """
        self._show_light()
        return self._with_and_without_what_moves(size, samples, seed, view)

    def direct_light(self, size: tuple[int, int], samples: int, seed: int, view: FrameView, lamp: str) -> FloatImage:
        """Return the light that a matt floor has straight from one lamp, without what moves, as in `light`.

        The lamp is alone, so that its light has no noise but in the narrow borders of shadows.
        """
        with self._straight_light({light.name for light in self._lamps} - {lamp}):
            place(_without_what_moves(view))
            still = self._traced(self._view, size, samples, seed, view=view)
            place(view)
        return still["DiffDir"]

    def lamplight(
        self, size: tuple[int, int], samples: int, seed: int, view: FrameView, off: Collection[str]
    ) -> tuple[FloatImage, FloatImage]:
        """Return the light that a matt floor has straight from all but some lamps, with and without what moves."""
        with self._straight_light(off):
            moved, still = self._with_and_without_what_moves(size, samples, seed, view)
        return moved["DiffDir"], still["DiffDir"]

    def upper_light(self, size: tuple[int, int], rows: int, samples: int, seed: int, view: FrameView) -> Passes:
        """Return the light in the uppermost rows of an image of a size; call it after `light` of the same view."""
        self._show_light()
        return self._traced(self._view, size, samples, seed, view=view, part=Part(0, 0, size[0], rows))

    def surfaces(self, size: tuple[int, int], rows: int, samples: int, seed: int, view: FrameView) -> Passes:
        """Return the surfaces in the uppermost rows, with a black floor that is marked by `COVER`.

        Call it after `light` of the same view.
        """
        self._show_surfaces()
        return self._traced(self._view, size, samples, seed, view=view, part=Part(0, 0, size[0], rows))

    def reflectance(self, tile: Tile) -> tuple[FloatImage, FloatImage]:
        """Return the floor's reflectance (N, N, 3) in the middle of texels, and `SURFACE_DATA` (N, N, 3) there.

        Rows are along y, columns along x of a grid that is turned by `GRID_TURN_RAD` against W.
        """
        self._joints.fit(tile.texel_m)
        passes = self._from_above(self._reflectance, tile, 1, 0, GRID_TURN_RAD)
        return passes["Combined"][::-1], passes[SURFACE_DATA][::-1]

    def irradiance(self, tile: Tile, samples: int, seed: int, facing: tuple[float, float, float]) -> FloatImage:
        """Return the light (N, N, 3) on a floor with the unit normal `facing`, without what moves."""
        for item in self._lit_floor:
            item.color = as_color(facing)
        passes = self._from_above(self._irradiance, tile, samples, seed)
        return (passes["DiffDir"] + passes["DiffInd"])[::-1]

    def _scene(self, name: str, passes: tuple[str, ...]) -> bpy.types.Scene:
        made = self._main.copy()
        made.name, made.render.filepath = name, str(self._scratch / f"{name}.exr")
        made.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        cycles = made.cycles
        cycles.use_denoising = False
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
        _set_passes(made, passes)
        return made

    def _show_light(self) -> None:
        self._show(self._grey_floor, _LIGHT_PASSES, filtered=False)
        self._view.cycles.max_bounces = self._main.cycles.max_bounces

    def _show_surfaces(self) -> None:
        self._show(self._black_floor, _SURFACE_PASSES, filtered=True)
        self._view.cycles.max_bounces = 0

    def _show(self, floor: list[bpy.types.Object], passes: tuple[str, ...], *, filtered: bool) -> None:
        """Show one of the floors, and filter its pixels as those of the final image or by squares."""
        for objects in (self._grey_floor, self._black_floor, self._white_floor):
            for item in objects:
                item.matrix_world = Matrix.Translation((0.0, 0.0, 0.0 if objects is floor else -_AWAY_M))
        _set_passes(self._view, passes)
        cycles, final = self._view.cycles, self._main.cycles
        cycles.pixel_filter_type = final.pixel_filter_type if filtered else "BOX"
        cycles.filter_width = final.filter_width if filtered else 1.0

    @contextmanager
    def _straight_light(self, off: Collection[str]) -> Iterator[None]:
        """Show the matt floor with light straight from all lamps, the sun among them, but those that are `off`."""
        self._show(self._white_floor, ("diffuse_direct",), filtered=False)
        self._view.cycles.max_bounces = 0
        energies = {lamp: lamp.energy for lamp in self._lamps if lamp.name in off}
        try:
            for lamp in energies:
                lamp.energy = 0.0
            yield
        finally:
            for lamp, energy in energies.items():
                lamp.energy = energy

    def _with_and_without_what_moves(
        self, size: tuple[int, int], samples: int, seed: int, view: FrameView
    ) -> tuple[Passes, Passes]:
        # Robot and obstacles are moved far away instead of hidden, so that Cycles keeps its data of the scene.
        place(_without_what_moves(view))
        without = self._traced(self._view, size, samples, seed, view=view)
        place(view)
        return self._traced(self._view, size, samples, seed, view=view), without

    def _replace_floor(self, scene: bpy.types.Scene, change: MaterialChange) -> list[bpy.types.Object]:
        """Replace the floor's objects of a scene by copies with other materials, and return the copies."""
        for item in self._floor:
            scene.collection.objects.unlink(item)
        return self._add_floor(scene, change)

    def _add_floor(self, scene: bpy.types.Scene, change: MaterialChange) -> list[bpy.types.Object]:
        made = []
        for item in self._floor:
            copy = item.copy()
            for slot in copy.material_slots:
                material = slot.material
                slot.link = "OBJECT"
                slot.material = self._once(change, material)
            scene.collection.objects.link(copy)
            made.append(copy)
        return made

    def _once(self, change: MaterialChange, material: bpy.types.Material) -> bpy.types.Material:
        if (change, material.name) not in self._changed:
            self._changed[change, material.name] = change(material)
        return self._changed[change, material.name]

    def _keep_floor(self, scene: bpy.types.Scene) -> None:
        scene.world, scene.cycles.max_bounces = None, 0
        for item in list(scene.collection.objects):
            if item not in self._floor:
                scene.collection.objects.unlink(item)

    def _hide_all_but_floor(self, scene: bpy.types.Scene) -> None:
        for item in list(scene.collection.objects):
            if item in self._floor or item.type not in {"MESH", "LIGHT"}:
                continue
            scene.collection.objects.unlink(item)
            if item in self._moves:
                continue
            hidden = item.copy()
            hidden.visible_camera = False
            scene.collection.objects.link(hidden)

    def _from_above(self, scene: bpy.types.Scene, tile: Tile, samples: int, seed: int, turn_rad: float = 0.0) -> Passes:
        side_m = tile.texel_m * tile.texels
        scene.camera.data.ortho_scale = side_m
        middle = tile.low[0] + 0.5 * side_m, tile.low[1] + 0.5 * side_m, _ABOVE_M
        scene.camera.matrix_world = Matrix.Rotation(turn_rad, 4, "Z") @ Matrix.Translation(middle)
        return self._traced(scene, (tile.texels, tile.texels), samples, seed)

    def _traced(
        self,
        scene: bpy.types.Scene,
        size: tuple[int, int],
        samples: int,
        seed: int,
        *,
        view: FrameView | None = None,
        part: Part | None = None,
    ) -> Passes:
        """Render a part, or all, of a view or of what never moves."""
        render = scene.render
        render.resolution_x, render.resolution_y = size
        render.use_motion_blur = view is not None and bool(view.exposure)
        scene.cycles.samples, scene.cycles.seed = samples, seed
        render.use_border = False
        if part is not None:
            show_part(render, part, size)
        return _by_pass(rendered(scene, _EXR_PIXEL_BYTES))


def _set_passes(scene: bpy.types.Scene, passes: tuple[str, ...]) -> None:
    layer = scene.view_layers[0]
    for name in {*_LIGHT_PASSES, *_SURFACE_PASSES}:
        setattr(layer, f"use_pass_{name}", name in passes)


def _without_what_moves(view: FrameView) -> FrameView:
    """Return the view with robot and moving obstacles far away."""
    away = (_AWAY_M, _AWAY_M, 0.0)
    exposure = tuple(replace(m, robot_pose=away, moving=(away,) * len(m.moving)) for m in view.exposure)
    return replace(view, robot_pose=away, moving=(away,) * len(view.moving), exposure=exposure)


def _reflectance_of_the_floor(scene: Scene) -> float:
    (floor,) = (mesh for mesh in scene.meshes if mesh.name == "floor")
    surface = next(surface for surface in scene.surfaces if surface.name == floor.face_surface[0])
    mean = sum(typical_color(surface)) / 3
    return min(max(mean, _MIN_REFLECTANCE), 1.0)


def _look_down(scene: bpy.types.Scene) -> None:
    data = bpy.data.cameras.new(f"{scene.name} above")
    data.type, data.clip_start = "ORTHO", 0.5 * _ABOVE_M
    camera = bpy.data.objects.new(data.name, data)
    scene.collection.objects.link(camera)
    scene.camera = camera


def _add_pass(scene: bpy.types.Scene, name: str) -> None:
    made = scene.view_layers[0].aovs.add()
    made.name, made.type = name, "COLOR"


def _by_pass(channels: dict[str, np.ndarray]) -> Passes:
    by_pass: dict[str, dict[str, np.ndarray]] = {}
    for name, values in channels.items():
        *_, pass_name, component = name.split(".")
        by_pass.setdefault(pass_name, {})[component] = values
    stacked = {}
    for pass_name, components in by_pass.items():
        order = next((o for o in ("RGB", "XYZ") if o[0] in components), "".join(components))
        stacked[pass_name] = np.stack([components[c] for c in order], axis=-1).astype(np.float32)
    return stacked
