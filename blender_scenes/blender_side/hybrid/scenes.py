"""Blender scenes beside the main one, which show parts of its picture.

They share the main scene's things, so that what `place` puts in place is so in all of them. Blender keeps Cycles' data
of one scene alone, the last rendered, and for another they are made anew. So all parts of a picture are seen in one
scene, in which what is not to be seen is put far away; maps, which are made now and then, are seen in one each.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from blender_scenes.blender_side.build import ROBOT, moving_name
from blender_scenes.blender_side.hybrid.materials import COVER, TOLD, as_color, covering, in_grey, shining, turned
from blender_scenes.blender_side.placing import place
from blender_scenes.blender_side.rendering import rendered
from blender_scenes.hybrid.tiled_map import Image, Tile
from blender_scenes.scene.description import Scene
from blender_scenes.scene.typical import typical_color
from sensors.camera.views import FrameView

Passes = dict[str, Image]
"""Name of a pass -> (H, W, 3), or (H, W, 1) of a single channel, float32, the first row at the top."""

_ABOVE_M = 0.5
_EXR_PIXEL_BYTES = 112
"""At most seven passes of four channels, four bytes each."""
GRID_TURN_RAD = 0.35
"""Of the reflectance's texels, which are seen in their middle, against W. An edge along them would be off by up to half
a texel all of its way; across them it is off to either side in turns."""
_IN_THE_MIDDLE = 0.01
"""Of a pixel: the least width that Cycles has for a filter."""
_MIN_REFLECTANCE = 0.05
_LINE = re.compile(r"(tape|paint)_\d+")
"""Pieces of the line, as `line_mesh` calls them."""
_FLOOR_PASSES = ("diffuse_color", "diffuse_direct", "diffuse_indirect")
_LIGHT_PASSES = (*_FLOOR_PASSES, "emit", "environment")
_SURFACE_PASSES = ("diffuse_color", "normal", "z", "emit", "environment")
_AWAY_M = 1000.0
"""As far as the camera sees. A floor is put as much below its place, which hides it from what is above."""
Dresser = Callable[[bpy.types.Material], bpy.types.Material]


def lies_on_the_floor(name: str) -> bool:
    """Whether a mesh belongs to the floor, flat and on z = 0 for all that a camera can tell; by its name."""
    return name == "floor" or _LINE.fullmatch(name) is not None


class HybridScenes:
    """Made from the scene that stands in Blender, configured by `engine.configure`."""

    def __init__(self, scene: Scene, scratch: Path) -> None:
        self._main, self._scratch = bpy.context.scene, scratch
        moving = [bpy.data.objects[moving_name(number)] for number in range(len(scene.moving))]
        self._moves = {thing for thing in bpy.data.objects if thing.parent and thing.parent.name == ROBOT} | {*moving}
        self._floor = [bpy.data.objects[mesh.name] for mesh in scene.meshes if lies_on_the_floor(mesh.name)]
        self._dressed: dict[tuple[Dresser, str], bpy.types.Material] = {}
        self._view = self._scene("view", _LIGHT_PASSES)
        black = covering()
        self._grey_floor = self._dress_floor(self._view, in_grey)
        self._black_floor = self._add_floor(self._view, lambda _: black)
        _add_pass(self._view, COVER)
        self._reflectance = self._scene("reflectance", ())
        self._keep_floor(self._reflectance)
        numbers = {thing.data.materials[0].name: number for number, thing in enumerate(self._floor)}
        self._dress_floor(self._reflectance, lambda material: shining(material, numbers[material.name]))
        self._reflectance.cycles.filter_width = _IN_THE_MIDDLE
        _add_pass(self._reflectance, TOLD)
        self._irradiance = self._scene("irradiance", _FLOOR_PASSES)
        self._hide_all_but_floor(self._irradiance)
        self._lit_floor = self._dress_floor(self._irradiance, turned)
        # The main scene's light is cut off after the floor has taken its share, the white floor's would be before.
        self._irradiance.cycles.sample_clamp_indirect /= _reflectance_of_the_floor(scene)
        for baking in (self._reflectance, self._irradiance):
            _look_down(baking)

    def light(self, size: tuple[int, int], samples: int, seed: int, view: FrameView) -> tuple[Passes, Passes]:
        """Light on a grey floor and on all else in a view: as it is, and without what moves, by the same numbers.

        `size` is width and height [px]; each pixel is the mean of its square. The first tells the floor's cover too.
        """
        self._show_light()
        place(_without_what_moves(view))
        without = self._traced(self._view, size, samples, seed, view=view)
        place(view)
        return self._traced(self._view, size, samples, seed, view=view), without

    def upper_light(self, size: tuple[int, int], rows: int, samples: int, seed: int, view: FrameView) -> Passes:
        """Light as it is in the uppermost rows of a picture of a size; call after `light` of the same view."""
        self._show_light()
        return self._traced(self._view, size, samples, seed, view=view, rows=rows)

    def surfaces(self, size: tuple[int, int], rows: int, samples: int, seed: int, view: FrameView) -> Passes:
        """What the surfaces in the uppermost rows reflect, the floor black and told by its cover.

        Call after `light` of the same view.
        """
        self._show_surfaces()
        return self._traced(self._view, size, samples, seed, view=view, rows=rows)

    def reflectance(self, tile: Tile) -> tuple[Image, Image]:
        """(N, N, 3) reflectance of the floor in the middle of texels; (N, N, 3) what `part_materials.TOLD` has there.

        Rows along y, columns along x of a grid that is turned by `GRID_TURN_RAD` against W.
        """
        passes = self._from_above(self._reflectance, tile, 1, 0, GRID_TURN_RAD)
        return passes["Combined"][::-1], passes[TOLD][::-1]

    def irradiance(self, tile: Tile, samples: int, seed: int, facing: tuple[float, float, float]) -> Image:
        """(N, N, 3) light on the floor without what moves, were it turned to the unit vector `facing`."""
        for thing in self._lit_floor:
            thing.color = as_color(facing)
        passes = self._from_above(self._irradiance, tile, samples, seed)
        return (passes["DiffDir"] + passes["DiffInd"])[::-1]

    def _scene(self, name: str, passes: tuple[str, ...]) -> bpy.types.Scene:
        made = self._main.copy()
        made.name, made.render.filepath = name, str(self._scratch / f"{name}.exr")
        made.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        cycles = made.cycles
        cycles.use_denoising = False
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
        _ask_for(made, passes)
        return made

    def _show_light(self) -> None:
        cycles = self._view.cycles
        _swap(self._grey_floor, self._black_floor)
        _ask_for(self._view, _LIGHT_PASSES)
        cycles.max_bounces = self._main.cycles.max_bounces
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0

    def _show_surfaces(self) -> None:
        cycles = self._view.cycles
        _swap(self._black_floor, self._grey_floor)
        _ask_for(self._view, _SURFACE_PASSES)
        cycles.max_bounces = 0
        cycles.pixel_filter_type = self._main.cycles.pixel_filter_type
        cycles.filter_width = self._main.cycles.filter_width

    def _dress_floor(self, scene: bpy.types.Scene, dresser: Dresser) -> list[bpy.types.Object]:
        """Copies of the floor's things in other materials take their place in a scene."""
        for thing in self._floor:
            scene.collection.objects.unlink(thing)
        return self._add_floor(scene, dresser)

    def _add_floor(self, scene: bpy.types.Scene, dresser: Dresser) -> list[bpy.types.Object]:
        made = []
        for thing in self._floor:
            copy = thing.copy()
            for slot in copy.material_slots:
                own = slot.material
                slot.link = "OBJECT"
                slot.material = self._once(dresser, own)
            scene.collection.objects.link(copy)
            made.append(copy)
        return made

    def _once(self, dresser: Dresser, material: bpy.types.Material) -> bpy.types.Material:
        if (dresser, material.name) not in self._dressed:
            self._dressed[dresser, material.name] = dresser(material)
        return self._dressed[dresser, material.name]

    def _keep_floor(self, scene: bpy.types.Scene) -> None:
        scene.world, scene.cycles.max_bounces = None, 0
        for thing in list(scene.collection.objects):
            if thing not in self._floor:
                scene.collection.objects.unlink(thing)

    def _hide_all_but_floor(self, scene: bpy.types.Scene) -> None:
        for thing in list(scene.collection.objects):
            if thing in self._floor or thing.type not in {"MESH", "LIGHT"}:
                continue
            scene.collection.objects.unlink(thing)
            if thing in self._moves:
                continue
            hidden = thing.copy()
            hidden.visible_camera = False
            scene.collection.objects.link(hidden)

    def _from_above(self, scene: bpy.types.Scene, tile: Tile, samples: int, seed: int, turn_rad: float = 0.0) -> Passes:
        side = tile.texel_m * tile.texels
        scene.camera.data.ortho_scale = side
        middle = tile.low[0] + 0.5 * side, tile.low[1] + 0.5 * side, _ABOVE_M
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
        rows: int | None = None,
    ) -> Passes:
        """Of a view or of what never moves; of the uppermost rows or of all."""
        render = scene.render
        render.resolution_x, render.resolution_y = size
        render.use_motion_blur = view is not None and bool(view.exposure)
        scene.cycles.samples, scene.cycles.seed = samples, seed
        render.use_border = render.use_crop_to_border = rows is not None
        if rows is not None:
            render.border_min_x, render.border_max_x = 0.0, 1.0
            # Amid the last row, whatever its fraction is rounded to.
            render.border_min_y, render.border_max_y = 1.0 - (rows - 0.25) / size[1], 1.0
        return _by_pass(rendered(scene, _EXR_PIXEL_BYTES))


def _ask_for(scene: bpy.types.Scene, passes: tuple[str, ...]) -> None:
    layer = scene.view_layers[0]
    for name in {*_LIGHT_PASSES, *_SURFACE_PASSES}:
        setattr(layer, f"use_pass_{name}", name in passes)


def _swap(here: list[bpy.types.Object], away: list[bpy.types.Object]) -> None:
    for things, height_m in ((here, 0.0), (away, -_AWAY_M)):
        for thing in things:
            thing.matrix_world = Matrix.Translation((0.0, 0.0, height_m))


def _without_what_moves(view: FrameView) -> FrameView:
    """The camera as it is, robot and moving obstacles far away."""
    away = (_AWAY_M, _AWAY_M, 0.0)
    exposure = tuple(replace(m, robot_pose=away, moving=(away,) * len(m.moving)) for m in view.exposure)
    return replace(view, robot_pose=away, moving=(away,) * len(view.moving), exposure=exposure)


def _reflectance_of_the_floor(scene: Scene) -> float:
    (floor,) = (mesh for mesh in scene.meshes if mesh.name == "floor")
    of = {surface.name: surface for surface in scene.surfaces}
    mean = sum(typical_color(of[floor.face_surface[0]])) / 3
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
    found: dict[str, dict[str, np.ndarray]] = {}
    for name, values in channels.items():
        *_, of, component = name.split(".")
        found.setdefault(of, {})[component] = values
    stacked = {}
    for of, parts in found.items():
        order = next((o for o in ("RGB", "XYZ") if o[0] in parts), "".join(parts))
        stacked[of] = np.stack([parts[c] for c in order], axis=-1).astype(np.float32)
    return stacked
