"""Packages that not every installation has: which extra of symolo brings each, and how to install it."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from symolo.core.errors import EnvironmentLacking

EXTRA_OF = {
    "bpy": "generate",
    "pybullet": "generate",
    "pybullet_data": "generate",
    "scipy": "generate",
    "serial": "generate",
    "svgelements": "generate",
    "trimesh": "generate",
    "h5py": "export",
    "pyarrow": "export",
    "rosbags": "export",
    "av": "video",
    "obstore": "cloud",
    "cryptography": "sign",
    "ray": "cluster",
    "gymnasium": "gym",
    "torch": "learn",
}
"""Extra of symolo by the name under which a package is imported."""


def how_to_install(extra: str) -> str:
    """Return what to type for an extra, whether or not an index of packages has symolo."""
    commands = (
        f"`pip install '.[{extra}]'` in the folder of its sources, or `pip install 'symolo[{extra}]'` from an index"
    )
    return f"install symolo with the extra `{extra}`: {commands}"


def extra_is_missing(package: str) -> EnvironmentLacking:
    """Return the error for a package of an extra that is not installed."""
    return EnvironmentLacking(f"the package {package} is missing; {how_to_install(EXTRA_OF[package])}")


def check_installed(package: str) -> None:
    """Check that a package of an extra is installed, without loading it.

    Raises:
        EnvironmentLacking: It is not.
    """
    if find_spec(package) is None:
        raise extra_is_missing(package)


def extra_lacking(error: BaseException) -> str:
    """Return which extra to install where an import failed for the lack of it; empty for every other error."""
    package = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return str(extra_is_missing(package)) if package in EXTRA_OF else ""


def optional_module(module: str) -> ModuleType:
    """Return a module of an extra.

    Raises:
        EnvironmentLacking: The extra is not installed.
    """
    package = module.partition(".")[0]
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        raise extra_is_missing(package) from None
