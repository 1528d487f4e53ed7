"""Names the installed packages that symolo with some extras does not run on: `unneeded.py cloud,export`."""

# ruff: noqa: INP001

import sys
from importlib.metadata import PackageNotFoundError, distribution, distributions

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

KEPT = {"pip"}


def needed(extras: set[str]) -> set[str]:
    """Names of all that symolo asks for, and of what that asks for in turn."""
    requirements = {("symolo", extra) for extra in {"", *extras}}
    waiting = list(requirements)
    while waiting:
        name, extra = waiting.pop()
        try:
            lines = distribution(name).requires or []
        except PackageNotFoundError:  # an option that is not installed
            continue
        direct = [one for one in map(Requirement, lines) if not one.marker or one.marker.evaluate({"extra": extra})]
        for one in direct:
            new = {(canonicalize_name(one.name), chosen) for chosen in {"", *one.extras}} - requirements
            requirements |= new
            waiting += new
    return {name for name, _ in requirements} | KEPT


if __name__ == "__main__":
    installed = {canonicalize_name(one.name) for one in distributions()}
    unneeded = installed - needed({extra for extra in sys.argv[1].split(",") if extra})
    sys.stdout.writelines(f"{name}\n" for name in sorted(unneeded))
