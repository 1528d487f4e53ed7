"""What should be heeded, and what made the data."""

import json
from collections.abc import Iterator

from symolo.core.errors import one_line
from symolo.dataset.metadata import Metadata
from symolo.pages.markup import Html, table, tag
from symolo.report.statistics.facts import ReleaseFacts


def warnings(metadata: Metadata) -> Iterator[Html]:
    """Those of the release, of all its runs, and the runs that are not in it."""
    told = [[record.run, one_line(text)] for record in metadata.runs for text in record.warnings]
    if told:
        yield table(["run", "warning"], told)
    boards = [
        [record.run, ", ".join(f"{count} {name}" for name, count in record.board.events.items())]
        for record in metadata.runs
        if record.board is not None and record.board.events
    ]
    if boards:
        yield tag("h3", "On the line to the board")
        yield table(["run", "events"], boards)
    if metadata.failed_runs:
        yield tag("h3", "Set aside, and not in the release")
        yield table(["run", "stage", "problem"], [[f.run, f.stage, one_line(f.problem)] for f in metadata.failed_runs])
    if not told and not boards and not metadata.failed_runs:
        yield tag("p", "None: no run was set aside, and no image is black or burnt in large parts.")


def provenance(facts: ReleaseFacts) -> Iterator[Html]:
    metadata = facts.metadata
    devices = sorted({record.render_device for record in metadata.runs})
    rows = [
        ["Seed", str(metadata.seed)],
        ["Made with", ", ".join(f"{name} {version}" for name, version in sorted(metadata.made_with.items()))],
        ["Rendered on", ", ".join(devices)],
        ["Format", f"{metadata.format} {metadata.format_version}"],
        ["SHA-256 of the manifest", tag("td", facts.manifest_sha256, class_="hash")],
    ]
    yield table(["", ""], rows)
    yield tag(
        "p",
        "Every file had the checksum of the manifest when this page was made; ",
        tag("code", "symolo verify DIR"),
        " looks again.",
    )
    scenario = json.dumps(metadata.scenario, indent=2, ensure_ascii=False, sort_keys=True)
    yield tag("details", tag("summary", "The scenario, with its distributions"), tag("pre", scenario))
