"""The machine around the Blender process: shared libraries, variables that change its pixels, a full disk."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

SYSTEM_PACKAGES = "libgl1 libsm6 libx11-6 libxext6 libxfixes3 libxi6 libxkbcommon0 libxrender1"
"""Debian packages of the shared libraries that bpy loads, from its `DT_NEEDED` entries and theirs."""

_SETTINGS = ("OCIO", "BLENDER_", "CYCLES_", "OIDN_", "OPENIMAGEIO_", "EMBREE_")
"""Prefixes of the variables with colour transforms, start-up files and devices of Blender and its libraries."""


def without_blender_settings(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment without the variables that would change the pixels of a scenario."""
    return {name: value for name, value in environment.items() if not name.startswith(_SETTINGS)}


def require_room(folder: Path, size: int) -> None:
    """Check that a file of that size fits on the disk, because Blender gives no cause when it writes half an image.

    Raises:
        OSError: The file does not fit; `errno` says why.
    """
    with tempfile.TemporaryFile(dir=folder, buffering=0) as probe:
        left = size
        while left > 0:
            left -= probe.write(b"\1" * min(left, 2**20))
        os.fsync(probe.fileno())
