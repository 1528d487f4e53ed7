"""The generated pages and their files."""

from collections.abc import Callable
from pathlib import Path

from commands import commands
from configuration import configuration
from effects import effects
from formats import formats
from json_results import json_results
from materials import materials

DOCS = Path(__file__).parents[1]
PAGES: dict[str, Callable[[], str]] = {
    "reference/commands.md": commands,
    "reference/configuration.md": configuration,
    "reference/effects.md": effects,
    "reference/materials.md": materials,
    "reference/formats.md": formats,
    "reference/json.md": json_results,
}


def write() -> None:
    for name, page in PAGES.items():
        path = DOCS / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(page())


def drifted() -> tuple[str, ...]:
    """Return the names of the pages that are missing or differ from the code."""
    paths = {name: DOCS / name for name in PAGES}
    return tuple(
        name for name, path in paths.items() if not path.exists() or path.read_text(encoding="utf-8") != PAGES[name]()
    )
