"""Rendering of a scene, or of a part of its image, into a file, and reading it back."""

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from blender_scenes.render.surroundings import require_room
from symolo.core.files.exr import read_exr

_EXR_EXTRA_BYTES = 2**17
"""Upper limit for header and line table of a file."""


@dataclass(frozen=True)
class Part:
    """A rectangle of an image."""

    left_px: int
    top_px: int
    width_px: int
    height_px: int


def show_part(render: bpy.types.RenderSettings, part: Part, size: tuple[int, int]) -> None:
    """Limit a rendering to a part of an image of that width and height."""
    width, height = size
    render.use_border = render.use_crop_to_border = True
    bottom_px = height - part.top_px - part.height_px
    # A quarter beyond the border of a pixel, however Blender rounds the fractions.
    render.border_min_x, render.border_max_x = (
        (px + 0.25) / width for px in (part.left_px, part.left_px + part.width_px)
    )
    render.border_min_y, render.border_max_y = ((px + 0.25) / height for px in (bottom_px, bottom_px + part.height_px))


def rendered(scene: bpy.types.Scene, pixel_bytes: int) -> dict[str, np.ndarray]:
    """Render a scene and return the channels (H, W) by name; `pixel_bytes` is the size of a pixel in the file.

    Raises:
        OSError: The disk is full.
        ValueError: Blender left no complete image.
        RuntimeError: Blender reports an error.
    """
    scratch = Path(scene.render.filepath)
    scratch.unlink(missing_ok=True)
    try:
        bpy.ops.render.render(write_still=True, scene=scene.name)
        return read_exr(scratch.read_bytes() if scratch.exists() else b"")
    except (RuntimeError, ValueError):
        # Blender does not report why it wrote half an image; a full disk is detected here.
        scratch.unlink(missing_ok=True)
        width, height = scene.render.resolution_x, scene.render.resolution_y
        require_room(scratch.parent, width * height * pixel_bytes + _EXR_EXTRA_BYTES)
        raise
