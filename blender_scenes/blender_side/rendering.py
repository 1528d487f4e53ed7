"""Rendering of a scene into a file, and reading it back."""

from pathlib import Path

import bpy
import numpy as np

from blender_scenes.render.surroundings import require_room
from symolo.core.exr import read_exr

_EXR_EXTRA_BYTES = 2**17
"""Upper limit for header and line table of a file."""


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
