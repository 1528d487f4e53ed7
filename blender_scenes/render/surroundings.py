"""What of the machine the Blender process meets: libraries it needs, variables that change its pixels, a full disk."""

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

SYSTEM_PACKAGES = "libgl1 libsm6 libx11-6 libxext6 libxfixes3 libxi6 libxkbcommon0 libxrender1"
"""Debian packages of the shared libraries that bpy loads: what its `DT_NEEDED` entries name, followed through."""

_SETTINGS = ("OCIO", "BLENDER_", "CYCLES_", "OIDN_", "OPENIMAGEIO_", "EMBREE_")
"""Beginnings of the variables from which Blender and its libraries take colour transforms, start-up files, devices."""


def without_blender_settings(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment less all that would make one scenario look different on two machines."""
    return {name: value for name, value in environment.items() if not name.startswith(_SETTINGS)}


def require_room(folder: Path, size: int) -> None:
    """Find out whether a file of so many bytes fits, for Blender tells no cause when it writes half a picture.

    Raises:
        OSError: It does not; the number says why.
    """
    with tempfile.TemporaryFile(dir=folder, buffering=0) as probe:
        left = size
        while left > 0:
            left -= probe.write(b"\1" * min(left, 2**20))
        os.fsync(probe.fileno())
