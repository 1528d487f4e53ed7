"""Conversion of surfaces to Blender materials: each texture expression becomes a node, which equal ones share."""

from collections.abc import Callable, Iterator, Sequence

import bpy
import numpy as np

from blender_scenes.blender_side.user_images import UserImages
from blender_scenes.scene.shading import (
    Arithmetic,
    Cells,
    Color,
    Constant,
    Expression,
    ImageTexture,
    Mix,
    NoiseTexture,
    Step,
    Surface,
    SurfaceCoordinate,
    Tiles,
)
from blender_scenes.scene.structure import structure_of
from blender_scenes.scene.typical import matt_color, typical_color

_OPERATIONS = {"add": "ADD", "subtract": "SUBTRACT", "multiply": "MULTIPLY", "maximum": "MAXIMUM", "sine": "SINE"}
_CELLS = {"distance": ("F1", "Distance"), "edge": ("DISTANCE_TO_EDGE", "Distance"), "random": ("F1", "Color")}

SURFACE = "surface"
"""Property of a material with the name of its surface, which may exceed the 63 bytes of a name in Blender."""
MATT = "matt"
"""Name of the node that replaces the surface for light that it reflects to a matt surface."""


class ShaderGraph:
    """Compiles the expressions of one material."""

    def __init__(
        self, tree: bpy.types.NodeTree, user_images: UserImages | None = None, *, is_copy: bool = False
    ) -> None:
        """Begin a graph.

        Args:
            tree: Its nodes. They are removed, or written again if the tree is a copy.
            user_images: The user's images; None for none.
            is_copy: Whether the tree is a copy of a graph of the same structure. Its nodes and links are then those
                that would be made here, in the same order, and only their values are written.
        """
        self._copied: Iterator[bpy.types.Node] | None = iter(tree.nodes.values()) if is_copy else None
        if not is_copy:
            tree.nodes.clear()
        self._tree = tree
        self._user_images = user_images or UserImages(None)
        self._sockets: dict[Expression, bpy.types.NodeSocket] = {}
        self._uv: bpy.types.NodeSocket | None = None
        self._compilers: dict[type, Callable] = {
            Constant: self._number,
            Color: self._color,
            SurfaceCoordinate: self._coordinate,
            NoiseTexture: self._noise,
            Cells: self._cells,
            Tiles: self._tiles,
            ImageTexture: self._image_texture,
            Arithmetic: self._arithmetic,
            Step: self._step,
            Mix: self._mix,
        }

    def node(self, kind: str, **inputs: object) -> bpy.types.Node:
        """Return a new node with values or sockets for its inputs, by Blender's names with underscores for spaces."""
        node = self._tree.nodes.new(kind) if self._copied is None else next(self._copied)
        for name, value in inputs.items():
            self.feed(node.inputs[name.replace("_", " ")], value)
        return node

    def feed(self, socket: bpy.types.NodeSocket, value: object) -> None:
        if isinstance(value, Expression):
            value = self.socket(value)
        if isinstance(value, bpy.types.NodeSocket):
            if self._copied is None:
                self._tree.links.new(value, socket)
        # Blender checks all of the graph after each change, so what it has already is not written again.
        elif not np.array_equal(np.float32(socket.default_value), np.float32(value)):
            socket.default_value = value

    def socket(self, expression: Expression) -> bpy.types.NodeSocket:
        if expression not in self._sockets:
            self._sockets[expression] = self._compilers[type(expression)](expression)
        return self._sockets[expression]

    def _surface_coordinates(self) -> bpy.types.NodeSocket:
        if self._uv is None:
            node = self.node("ShaderNodeUVMap")
            _set(node, uv_map="uv_m")
            self._uv = node.outputs[0]
        return self._uv

    def _number(self, e: Constant) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeValue")
        self.feed(node.outputs[0], e.value)
        return node.outputs[0]

    def _color(self, e: Color) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeRGB")
        self.feed(node.outputs[0], (*e.rgb, 1.0))
        return node.outputs[0]

    def _coordinate(self, e: SurfaceCoordinate) -> bpy.types.NodeSocket:
        return self.node("ShaderNodeSeparateXYZ", Vector=self._surface_coordinates()).outputs["uv".index(e.axis)]

    def _placed(
        self, per_m: tuple[float, float], offset: tuple[float, float], turn_rad: float = 0.0
    ) -> bpy.types.NodeSocket:
        """Return the surface coordinates turned, scaled to features and shifted."""
        at = self._surface_coordinates()
        if turn_rad:
            at = self.node("ShaderNodeMapping", Vector=at, Rotation=(0.0, 0.0, -turn_rad)).outputs[0]
        # Faster than a mapping node, which computes a rotation for every sample.
        moved = self.node("ShaderNodeVectorMath")
        _set(moved, operation="MULTIPLY_ADD")
        for socket, value in zip(moved.inputs, (at, (*per_m, 1.0), (*offset, 0.0)), strict=False):
            self.feed(socket, value)
        return moved.outputs[0]

    def _noise(self, e: NoiseTexture) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeTexNoise")
        _set(node, noise_dimensions="2D", noise_type="FBM", normalize=True)
        at = self._placed(e.per_m, e.offset, e.turn_rad)
        if e.shift is not None:
            apart = self.node("ShaderNodeCombineXYZ", X=e.shift, Y=e.shift)
            moved = self.node("ShaderNodeVectorMath")
            self.feed(moved.inputs[0], at)
            self.feed(moved.inputs[1], apart.outputs[0])
            at = moved.outputs[0]
        values = {"Vector": at, "Scale": 1.0, "Detail": e.octaves - 1, "Roughness": e.gain}
        for name, value in {**values, "Lacunarity": 2.0, "Distortion": e.warp}.items():
            self.feed(node.inputs[name], value)
        return node.outputs["Fac"]

    def _cells(self, e: Cells) -> bpy.types.NodeSocket:
        feature, output = _CELLS[e.value]
        node = self.node("ShaderNodeTexVoronoi")
        _set(node, voronoi_dimensions="2D", feature=feature)
        for name, value in {"Vector": self._placed(e.per_m, e.offset), "Scale": 1.0, "Randomness": 1.0}.items():
            self.feed(node.inputs[name], value)
        if output == "Distance":
            return node.outputs["Distance"]
        return self.node("ShaderNodeSeparateColor", Color=node.outputs["Color"]).outputs[0]

    def _tiles(self, e: Tiles) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeTexBrick")
        _set(node, offset=e.stagger, offset_frequency=2, squash=1.0)
        values = {
            "Vector": self._placed((1.0, 1.0), e.offset_m),
            "Color1": (0, 0, 0, 1),
            "Color2": (1, 1, 1, 1),
            "Mortar": (0.5, 0.5, 0.5, 1),
            "Scale": 1.0,
            "Mortar Size": 0.5 * e.joint_m,  # Blender measures it from the tile's edge, half the joint
            "Mortar Smooth": e.softness,
            "Bias": 0.0,
            "Brick Width": e.size_m[0],
            "Row Height": e.size_m[1],
        }
        for name, value in values.items():
            self.feed(node.inputs[name], value)
        if e.value == "joint":
            return node.outputs["Fac"]
        return self.node("ShaderNodeSeparateColor", Color=node.outputs["Color"]).outputs[0]

    def _image_texture(self, e: ImageTexture) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeTexImage")
        _set(node, image=self._user_images.image(e.sha256), interpolation="Linear", extension="REPEAT")
        (width, height), (u, v) = e.size_m, e.at_m
        self.feed(node.inputs["Vector"], self._placed((1 / width, 1 / height), (-u / width, -v / height)))
        return node.outputs["Color"]

    def _arithmetic(self, e: Arithmetic) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeMath")
        _set(node, operation=_OPERATIONS[e.operation])
        for socket, operand in zip(node.inputs, (e.a, e.b), strict=False):
            self.feed(socket, operand.value if isinstance(operand, Constant) else operand)
        return node.outputs[0]

    def _step(self, e: Step) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeMapRange")
        _set(node, interpolation_type="SMOOTHSTEP", clamp=True)
        for name, value in {"Value": e.of, "From Min": e.low, "From Max": e.high, "To Min": 0.0, "To Max": 1.0}.items():
            self.feed(node.inputs[name], value)
        return node.outputs["Result"]

    def _mix(self, e: Mix) -> bpy.types.NodeSocket:
        node = self.node("ShaderNodeMix")
        _set(node, data_type="RGBA", blend_type="MIX", clamp_factor=True)
        # The node has one input per data type under the same names; the colours are numbers 6 and 7.
        self.feed(node.inputs[0], e.by)
        self.feed(node.inputs[6], e.a)
        self.feed(node.inputs[7], e.b)
        return node.outputs[2]


def _set(node: bpy.types.Node, **properties: object) -> None:
    """Set properties that differ, because Blender checks all of the graph after each change."""
    for name, value in properties.items():
        if getattr(node, name) != value:
            setattr(node, name, value)


def make_materials(
    surfaces: Sequence[Surface], user_images: UserImages | None = None, *, caustics: bool = False
) -> dict[str, bpy.types.Material]:
    """Return the Blender materials of surfaces by their names; without `caustics` they are simpler for light between
    other surfaces.

    A scene has a hundred surfaces, but few structures of them, and a copy takes less time than new nodes and links.
    """
    made: dict[str, bpy.types.Material] = {}
    first: dict[object, bpy.types.Material] = {}
    for surface in surfaces:
        structure = structure_of(surface)
        original = first.get(structure)
        material = bpy.data.materials.new(surface.name) if original is None else original.copy()
        material.name, material[SURFACE] = surface.name, surface.name
        material.use_nodes = True
        graph = ShaderGraph(material.node_tree, user_images, is_copy=original is not None)
        _compile(surface, graph, caustics=caustics)
        first.setdefault(structure, material)
        made[surface.name] = material
    return made


def _compile(surface: Surface, graph: ShaderGraph, *, caustics: bool) -> None:
    values = {
        "Base Color": surface.base_color,
        "Roughness": surface.roughness,
        "Metallic": surface.metallic,
        "IOR": surface.refractive_index,
        "Transmission Weight": surface.transmission,
    }
    shader = graph.node("ShaderNodeBsdfPrincipled")
    for name, value in values.items():
        graph.feed(shader.inputs[name], value)
    if surface.height_m is not None:
        bump = graph.node("ShaderNodeBump", Strength=1.0, Distance=1.0, Height=surface.height_m)
        graph.feed(shader.inputs["Normal"], bump.outputs[0])
    keeps_gloss = caustics or surface.encloses_lamp
    lit = shader.outputs[0] if keeps_gloss else _without_caustics(graph, shader.outputs[0], surface)
    _set(graph.node("ShaderNodeOutputMaterial", Surface=lit), is_active_output=True)


def _without_caustics(graph: ShaderGraph, shader: bpy.types.NodeSocket, surface: Surface) -> bpy.types.NodeSocket:
    """Return the shader with a simpler one for the light that a surface passes on to a matt one."""
    rays = graph.node("ShaderNodeLightPath")
    if surface.transmission > 0:
        # Without caustics a clear body would have the shadow of a black one: light goes straight through instead.
        clear = graph.node("ShaderNodeBsdfTransparent", Color=surface.base_color)
        return _instead(graph, shader, clear, rays.outputs["Is Shadow Ray"])
    # Light that is reflected to another surface needs no texture of this one: that saves a quarter of the time.
    plain = graph.node("ShaderNodeBsdfDiffuse", Color=(*matt_color(surface, typical_color(surface)), 1.0))
    _set(plain, name=MATT)
    return _instead(graph, shader, plain, rays.outputs["Is Diffuse Ray"])


def _instead(
    graph: ShaderGraph, shader: bpy.types.NodeSocket, other: bpy.types.Node, rays: bpy.types.NodeSocket
) -> bpy.types.NodeSocket:
    """Return the shader, replaced by the other one for some rays."""
    mix = graph.node("ShaderNodeMixShader", Fac=rays)
    graph.feed(mix.inputs[1], shader)
    graph.feed(mix.inputs[2], other.outputs[0])
    return mix.outputs[0]
