"""Which pages there are, and where they lie."""

from collections.abc import Callable
from pathlib import Path

from commands import commands
from configuration import configuration
from effects import effects
from formats import formats
from materials import materials

DOCS = Path(__file__).parents[1]
PAGES: dict[str, Callable[[], str]] = {
    "reference/commands.md": commands,
    "reference/configuration.md": configuration,
    "reference/effects.md": effects,
    "reference/materials.md": materials,
    "reference/formats.md": formats,
}


def write() -> None:
    for name, page in PAGES.items():
        path = DOCS / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(page())


def drifted() -> tuple[str, ...]:
    """Pages that are missing, or other than the code says."""
    found = {name: DOCS / name for name in PAGES}
    return tuple(
        name for name, path in found.items() if not path.exists() or path.read_text(encoding="utf-8") != PAGES[name]()
    )
