"""Libraries that single formats are written with, which come with the extra `export` alone."""

from importlib import import_module
from types import ModuleType

from symolo.core.errors import EnvironmentLacking

PYARROW = "pyarrow<26"
"""From 26 on it does not load beside Blender's numpy."""
ROSBAGS = "rosbags<0.12"
H5PY = "h5py>=3.13,<4"


def optional(module: str, requirement: str) -> ModuleType:
    """A module that need not be installed unless its format is asked for.

    Raises:
        EnvironmentLacking: It is not; the text ends with the line that installs it.
    """
    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        what = f"{package}, of the extra `export`, is missing"
        raise EnvironmentLacking(f"{what}; run: pip install '{requirement}'") from None
