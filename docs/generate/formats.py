"""What `symolo export` can make."""

from markdown import page, table, text

from symolo.exporters import EXPORTERS

ABOUT = "What `symolo export DIR --format NAMES --out OUT` makes of a release; with examples: [exports](../exports.md)."


def formats() -> str:
    rows = [(f"[{exporter.name}](../exports.md#{exporter.name})", text(exporter.what)) for exporter in EXPORTERS]
    return page("Formats", ABOUT, [table(("format", "what"), rows)])
