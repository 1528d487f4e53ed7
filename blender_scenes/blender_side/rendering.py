"""A scene rendered into its file, and the file read back whole."""

from pathlib import Path

import bpy
import numpy as np

from blender_scenes.render.surroundings import require_room
from symolo.core.exr import read_exr

_EXR_EXTRA_BYTES = 2**17
"""More than header, table of lines and their heads take."""


def rendered(scene: bpy.types.Scene, pixel_bytes: int) -> dict[str, np.ndarray]:
    """Channel name -> (H, W) of what Blender writes of a scene, `pixel_bytes` for each pixel.

    Raises:
        OSError: The disk is full.
        ValueError: Blender left no whole picture.
        RuntimeError: Blender reports an error.
    """
    scratch = Path(scene.render.filepath)
    scratch.unlink(missing_ok=True)
    try:
        bpy.ops.render.render(write_still=True, scene=scene.name)
        return read_exr(scratch.read_bytes() if scratch.exists() else b"")
    except (RuntimeError, ValueError):
        # Blender does not say why it wrote half a picture; a full disk is told here.
        scratch.unlink(missing_ok=True)
        width, height = scene.render.resolution_x, scene.render.resolution_y
        require_room(scratch.parent, width * height * pixel_bytes + _EXR_EXTRA_BYTES)
        raise
