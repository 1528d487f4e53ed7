"""The formats of `symolo export`."""

from markdown_text import page, table, text

from symolo.exporters import EXPORTERS

ABOUT = """`symolo export DIR --format NAMES --out OUT` converts a release to these formats. The page
[exports](../exports.md) has examples."""


def formats() -> str:
    rows = [(f"[{exporter.name}](../exports.md#{exporter.name})", text(exporter.what)) for exporter in EXPORTERS]
    return page("Formats", ABOUT, [table(("format", "content"), rows)])
