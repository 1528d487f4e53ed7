"""Copies of a surface's material for the scenes of hybrid rendering."""

from collections.abc import Mapping

import bpy

COVER, SURFACE_DATA = "cover", "surface_data"
"""Additional passes: share of a pixel that is floor; height of the relief, number of the material, and roughness."""
WHITE = (1.0, 1.0, 1.0, 1.0)
MIDDLE_GREY = 0.5
"""Reflectance of the floor in the light image, in place of its real one."""


def in_grey(material: bpy.types.Material) -> bpy.types.Material:
    """Return the material of the floor in one grey, with its gloss and relief, for camera rays.

    Other rays meet the real material, so that mirrors and glass show its texture.
    """
    copy = material.copy()
    tree, shader = copy.node_tree, _principled(copy)
    grey = tree.nodes.new(shader.bl_idname)
    for source, target in zip(shader.inputs, grey.inputs, strict=True):
        _feed(tree, source, target)
    base = grey.inputs["Base Color"]
    for link in list(base.links):
        tree.links.remove(link)
    base.default_value = (MIDDLE_GREY, MIDDLE_GREY, MIDDLE_GREY, 1.0)
    _show_to_the_camera(tree, grey.outputs[0])
    _mark_as_floor(tree)
    return copy


def shining(material: bpy.types.Material, number: int) -> bpy.types.Material:
    """Return a material that emits its base colour; `SURFACE_DATA` has its relief, `number` and roughness."""
    copy = material.copy()
    tree, shader = copy.node_tree, _principled(copy)
    shine, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputAOV")
    _feed(tree, shader.inputs["Base Color"], shine.inputs["Color"])
    tree.links.new(shine.outputs[0], _output(tree).inputs["Surface"])
    values = tree.nodes.new("ShaderNodeCombineXYZ")
    values.inputs["Y"].default_value = number
    _feed(tree, shader.inputs["Roughness"], values.inputs["Z"])
    if shader.inputs["Normal"].is_linked:
        # The height itself, because Cycles would evaluate the texture three times for a normal.
        _feed(tree, shader.inputs["Normal"].links[0].from_node.inputs["Height"], values.inputs["X"])
    output.aov_name = SURFACE_DATA
    tree.links.new(values.outputs[0], output.inputs["Color"])
    return copy


def turned(material: bpy.types.Material) -> bpy.types.Material:
    """Return a material that is white and matt for the camera, with the normal that its object's colour encodes."""
    copy = material.copy()
    tree = copy.node_tree
    # This option softens shadows where the normal leans away from the geometry, as it does here on purpose.
    copy.cycles.use_bump_map_correction = False
    white = tree.nodes.new("ShaderNodeBsdfDiffuse")
    white.inputs["Color"].default_value = WHITE
    normal = tree.nodes.new("ShaderNodeVectorMath")
    normal.operation = "MULTIPLY_ADD"
    normal.inputs[1].default_value, normal.inputs[2].default_value = (2.0, 2.0, 2.0), (-1.0, -1.0, -1.0)
    tree.links.new(tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"], normal.inputs[0])
    tree.links.new(normal.outputs[0], white.inputs["Normal"])
    _show_to_the_camera(tree, white.outputs[0])
    return copy


def as_color(normal: tuple[float, float, float]) -> tuple[float, float, float, float]:
    """Return a unit vector as a colour, which has no negative components in Blender."""
    x, y, z = (0.5 * (component + 1) for component in normal)
    return x, y, z, 1.0


def plain(name: str, shader: str, inputs: Mapping[str, object], *, is_floor: bool = False) -> bpy.types.Material:
    """Return a material of a single shader without texture or relief; `is_floor` marks it as floor."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(shader)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    if is_floor:
        _mark_as_floor(tree)
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def _principled(material: bpy.types.Material) -> bpy.types.Node:
    (node,) = (node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled")
    return node


def _output(tree: bpy.types.NodeTree) -> bpy.types.Node:
    (node,) = (node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    return node


def _feed(tree: bpy.types.NodeTree, source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
    """Give a socket the link or the value of another one."""
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    elif hasattr(source, "default_value"):
        target.default_value = source.default_value


def _mark_as_floor(tree: bpy.types.NodeTree) -> None:
    output = tree.nodes.new("ShaderNodeOutputAOV")
    output.aov_name = COVER
    output.inputs["Color"].default_value = WHITE


def _show_to_the_camera(tree: bpy.types.NodeTree, shader: bpy.types.NodeSocket) -> None:
    surface = _output(tree).inputs["Surface"]
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(surface.links[0].from_socket, mix.inputs[1])
    tree.links.new(shader, mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)
