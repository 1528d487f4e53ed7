"""Copies of a surface's material that show one side of it: what it reflects, how it shines, what light falls on it."""

import bpy

COVER, TOLD = "cover", "told"
"""Passes of their own: how much of a pixel is floor; the height of its relief, whose that is, and its roughness."""
MIDDLE_GREY = 0.5
"""What the light's floor reflects, whatever lies there."""


def in_grey(material: bpy.types.Material) -> bpy.types.Material:
    """Seen by the camera, and told, as floor of one colour with its gloss and relief; met by other rays as it is.

    What is seen in mirrors and through glass so keeps its texture.
    """
    copy = material.copy()
    tree, own = copy.node_tree, _principled(copy)
    grey = tree.nodes.new(own.bl_idname)
    for as_in, into in zip(own.inputs, grey.inputs, strict=True):
        _feed(tree, as_in, into)
    base = grey.inputs["Base Color"]
    for link in list(base.links):
        tree.links.remove(link)
    base.default_value = (MIDDLE_GREY, MIDDLE_GREY, MIDDLE_GREY, 1.0)
    _shown_to_the_camera(tree, grey.outputs[0])
    _told_as_floor(tree)
    return copy


def shining(material: bpy.types.Material, number: int) -> bpy.types.Material:
    """Shines in its own colour; told are its relief's height [m], a number of its own, and its roughness."""
    copy = material.copy()
    tree, own = copy.node_tree, _principled(copy)
    shine, told = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputAOV")
    _feed(tree, own.inputs["Base Color"], shine.inputs["Color"])
    tree.links.new(shine.outputs[0], _output(tree).inputs["Surface"])
    values = tree.nodes.new("ShaderNodeCombineXYZ")
    values.inputs["Y"].default_value = number
    _feed(tree, own.inputs["Roughness"], values.inputs["Z"])
    if own.inputs["Normal"].is_linked:
        # The height itself: to have the normal from Cycles would mean to work it out at three places.
        _feed(tree, own.inputs["Normal"].links[0].from_node.inputs["Height"], values.inputs["X"])
    told.aov_name = TOLD
    tree.links.new(values.outputs[0], told.inputs["Color"])
    return copy


def turned(material: bpy.types.Material) -> bpy.types.Material:
    """White and matt to the camera, facing where its object's colour says, as `as_color` has it."""
    copy = material.copy()
    tree = copy.node_tree
    # It softens shadows for normals that lean away from a surface, which this one only seems to have.
    copy.cycles.use_bump_map_correction = False
    white = tree.nodes.new("ShaderNodeBsdfDiffuse")
    white.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    normal = tree.nodes.new("ShaderNodeVectorMath")
    normal.operation = "MULTIPLY_ADD"
    normal.inputs[1].default_value, normal.inputs[2].default_value = (2.0, 2.0, 2.0), (-1.0, -1.0, -1.0)
    tree.links.new(tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"], normal.inputs[0])
    tree.links.new(normal.outputs[0], white.inputs["Normal"])
    _shown_to_the_camera(tree, white.outputs[0])
    return copy


def as_color(normal: tuple[float, float, float]) -> tuple[float, float, float, float]:
    """A unit vector as a colour, of which Blender keeps nothing below 0."""
    x, y, z = (0.5 * (component + 1) for component in normal)
    return x, y, z, 1.0


def covering() -> bpy.types.Material:
    """Black, and told as floor."""
    made = bpy.data.materials.new("covering")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    black = tree.nodes.new("ShaderNodeEmission")
    black.inputs["Strength"].default_value = 0.0
    _told_as_floor(tree)
    tree.links.new(black.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def _principled(material: bpy.types.Material) -> bpy.types.Node:
    (found,) = (node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled")
    return found


def _output(tree: bpy.types.NodeTree) -> bpy.types.Node:
    (found,) = (node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    return found


def _feed(tree: bpy.types.NodeTree, as_in: bpy.types.NodeSocket, into: bpy.types.NodeSocket) -> None:
    if as_in.is_linked:
        tree.links.new(as_in.links[0].from_socket, into)
    elif hasattr(as_in, "default_value"):
        into.default_value = as_in.default_value


def _told_as_floor(tree: bpy.types.NodeTree) -> None:
    told = tree.nodes.new("ShaderNodeOutputAOV")
    told.aov_name = COVER
    told.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)


def _shown_to_the_camera(tree: bpy.types.NodeTree, shader: bpy.types.NodeSocket) -> None:
    surface = _output(tree).inputs["Surface"]
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(surface.links[0].from_socket, mix.inputs[1])
    tree.links.new(shader, mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)
