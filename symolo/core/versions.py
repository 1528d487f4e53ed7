"""Versions of this program and its engines, read without importing them."""

from functools import cache
from importlib.metadata import PackageNotFoundError, version


def versions(*packages: str) -> dict[str, str]:
    """Installed version by package name; raises no error for one that is missing, `doctor` does."""
    return {package: installed_version(package) or "missing" for package in packages}


@cache
def installed_version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
