"""Joints of floors for the map of the reflectance, whose texels are often wider than a joint."""

from collections.abc import Iterable
from dataclasses import dataclass

import bpy

from blender_scenes.hybrid.floor.joint_profile import JointProfile, widened


@dataclass(frozen=True)
class _Joint:
    node: bpy.types.Node
    share: bpy.types.NodeSocket
    """Factor of the node's value."""
    profile: JointProfile
    max_half_m: float
    """Half of the shorter side of a tile, in whose middle the joint has to end."""


class MaterialJoints:
    """Joints of the floor's materials, whose width can be adapted to the size of a texel."""

    def __init__(self, materials: Iterable[bpy.types.Material]) -> None:
        """Take all joints of some materials, which from now on have the width that `fit` gives them."""
        trees = [material.node_tree for material in materials]
        self._joints = [
            _joint(tree, node)
            for tree in trees
            for node in list(tree.nodes)
            if node.bl_idname == "ShaderNodeTexBrick" and node.outputs["Fac"].is_linked
        ]
        self._texel_m: float | None = None

    def fit(self, texel_m: float) -> None:
        """Make the joints wide enough for texels of this size."""
        if texel_m == self._texel_m:
            return
        self._texel_m = texel_m
        for joint in self._joints:
            wide = widened(joint.profile, texel_m, joint.max_half_m)
            joint.node.inputs["Mortar Size"].default_value = wide.half_m
            joint.node.inputs["Mortar Smooth"].default_value = wide.softness
            joint.share.default_value = wide.share


def _joint(tree: bpy.types.NodeTree, node: bpy.types.Node) -> _Joint:
    value, times = node.outputs["Fac"], tree.nodes.new("ShaderNodeMath")
    times.operation = "MULTIPLY"
    for link in list(value.links):
        tree.links.new(times.outputs[0], link.to_socket)
    tree.links.new(value, times.inputs[0])
    size, smooth, *tile = (
        node.inputs[name].default_value for name in ("Mortar Size", "Mortar Smooth", "Brick Width", "Row Height")
    )
    return _Joint(node, times.inputs[1], JointProfile(size, smooth), 0.5 * min(tile))
