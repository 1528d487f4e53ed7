"""Annotations, one file each: functions of a `VisibleScene`; and the table of those that are images."""

from collections.abc import Callable

from blender_scenes.annotations.depth import depth
from blender_scenes.annotations.flow import flow
from blender_scenes.annotations.free_floor import free_floor
from blender_scenes.annotations.instance import instance
from blender_scenes.annotations.normals import normals
from blender_scenes.annotations.png import PngImage
from blender_scenes.annotations.seen import VisibleScene
from blender_scenes.annotations.semantic import semantic
from symolo.dataset.annotations import AnnotationName

IMAGE_ANNOTATIONS: dict[AnnotationName, Callable[[VisibleScene], PngImage | None]] = {
    "depth": depth,
    "instance": instance,
    "semantic": semantic,
    "normals": normals,
    "flow": flow,
    "free_floor": free_floor,
}
"""Annotations with a PNG file for each image."""
