"""Versions of this program and its engines, read without importing them."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version


def versions(*packages: str) -> dict[str, str]:
    """Return the installed version of each package by its name; `missing` for one that is not installed."""
    return {package: installed_version(package) or "missing" for package in packages}


@cache
def installed_version(package: str) -> str | None:
    """Return the installed version of a package; None if it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None
