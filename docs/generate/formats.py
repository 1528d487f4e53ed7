"""The formats of `symolo export`."""

from pathlib import Path

from markdown_text import page, table, text

from symolo.exporters import FORMATS
from symolo.exporters.export import exporters_of

ABOUT = """`symolo export DIR --format NAMES --out OUT` converts a release to these formats. The page
[exports](../exports.md) has examples."""
SECTIONS = Path(__file__).parents[1] / "exports"
"""Folder of the pages with a section for each format."""


def formats() -> str:
    pages = sorted(SECTIONS.glob("*.md"))
    page_of = {name: page.name for name in FORMATS for page in pages if f"\n## {name}\n" in page.read_text()}
    rows = [
        (f"[{each.name}](../exports/{page_of[each.name]}#{each.name})", text(each.what))
        for each in exporters_of(FORMATS, "")
        if each.name in page_of  # a test names the formats without a section
    ]
    return page("Formats", ABOUT, [table(("format", "content"), rows)])
