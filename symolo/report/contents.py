"""What is in the release, at a glance and as a table, and how it is read."""

from collections.abc import Iterator

from symolo.core.progress import seconds
from symolo.pages.markup import Html, table, tag
from symolo.report.statistics.facts import ReleaseFacts

READING = """import symolo

data = symolo.load("DIR")
for run in data:
    print(run.name, len(run.rows), "rows,", len(run.images), "images")
    x_y_theta = run.table.pose"""


def glance(facts: ReleaseFacts) -> list[str | Html]:
    """A sentence on the whole, the licence, and where something is to be heeded, a link to it."""
    records = [one.record for one in facts.runs]
    driven_s = sum(record.duration_s for record in records)
    told = (
        f"{_count(len(records), 'run')} on {_count(len({one.route for one in facts.runs}), 'route')}, "
        f"{seconds(driven_s)} and {sum(record.distance_m for record in records):.1f} m of driving: "
        f"{_grouped(sum(record.rows for record in records))} rows, "
        f"{_grouped(sum(record.images for record in records))} images. "
    )
    if len(records) < len(facts.metadata.runs):
        told += f"Of {len(facts.metadata.runs)} runs in the release these were asked for. "
    heeded = sum(len(record.warnings) for record in facts.metadata.runs)
    parts: list[str | Html] = [told, f"Licence: {facts.metadata.licence}. "]
    if heeded or facts.metadata.failed_runs:
        said = f"{_count(heeded, 'warning')}, {_count(len(facts.metadata.failed_runs), 'run')} set aside"
        parts.append(tag("a", said, href="#warnings", class_="warn"))
    return parts


def contents(facts: ReleaseFacts) -> Iterator[Html]:
    records = [one.record for one in facts.runs]
    first = records[0]
    sizes = sorted({f"{record.image_width_px} x {record.image_height_px} px" for record in records})
    rows = [
        ["Licence", facts.metadata.licence],
        ["Runs", f"{len(records)}: {_names([record.run for record in records])}"],
        ["Driving", f"{seconds(sum(r.duration_s for r in records))}, {sum(r.distance_m for r in records):.2f} m"],
        ["Rows", f"{_grouped(sum(r.rows for r in records))}, {first.rates.control_hz} in a second"],
        [
            "Images",
            f"{_grouped(sum(r.images for r in records))}, {first.rates.camera_hz} in a second, {', '.join(sizes)}",
        ],
        ["Annotations", ", ".join(first.annotations) or "none"],
        ["Size", f"{facts.size_bytes / 1e6:.1f} MB in {_grouped(facts.files)} files, the whole release"],
    ]
    yield table(["", ""], rows)
    columns = [[c.name, c.unit, c.meaning] for c in facts.metadata.columns.get("data.csv", [])]
    yield tag("details", tag("summary", "Columns of data.csv"), table(["column", "unit", "meaning"], columns))
    yield tag("p", "In Python, with the folder of the release for DIR:")
    yield tag("pre", READING)


def _names(names: list[str]) -> str:
    return ", ".join(names) if len(names) <= 12 else f"{names[0]} to {names[-1]}"


def _count(number: int, what: str) -> str:
    return f"{_grouped(number)} {what}" if number == 1 else f"{_grouped(number)} {what}s"


def _grouped(number: int) -> str:
    """12 345: spaces that do not break."""
    return f"{number:,}".replace(",", "\N{NO-BREAK SPACE}")
