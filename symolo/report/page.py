"""The page: what a release holds, what it looks like, what varies in it, and what made it."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from symolo.core.distributions import in_words
from symolo.core.errors import one_line
from symolo.core.progress import seconds
from symolo.dataset.documents.contents import Contents
from symolo.dataset.documents.metadata import Metadata, RunRecord
from symolo.pages.html import grouped, render_page
from symolo.pages.states import named
from symolo.report.media import Media
from symolo.report.plots.draw_strip import Strip, strip
from symolo.report.statistics.draws import DrawnField, drawn_fields
from symolo.report.statistics.facts import ReleaseFacts
from symolo.report.statistics.spread import spread

MAX_OUTLIERS = 12
"""Groups of outliers whose most different image is shown."""
_MAX_LISTED_OUTLIERS = 200
_MAX_TABLE_RUNS = 1000
_MAX_OPTIONS = 8
_MAX_RUN_NAMES = 12
_SECTIONS = {
    "states": "What the camera sees",
    "map": "Where the robot drove",
    "runs": "Runs over time",
    "cameras": "What all cameras see",
    "sensors": "Further sensors",
    "draws": "What varies from run to run",
    "images": "Images in numbers",
    "splits": "Training, validation and test",
    "warnings": "Warnings",
    "contents": "Files, columns and how to read them",
    "provenance": "Provenance",
}
"""Title of each part of the page by the name of its template, in their order."""


def page(facts: ReleaseFacts, media: Media) -> str:
    """Return the whole page, which needs no file beside itself."""
    metadata = facts.metadata
    whole = Contents.from_metadata(metadata)
    records = [run.record for run in facts.runs]
    outliers = [(group.run, group.worst, f"{group.why}; {group.extent}") for group in facts.outliers]
    return render_page(
        "symolo.report",
        title=f"{metadata.name}: release",
        svg="image/svg+xml",
        sections=_sections(facts, media),
        facts=facts,
        balance=facts.balance,
        media=media,
        metadata=metadata,
        lead=metadata.description or f"{whole.kind} in the layout of SyMoLo.",
        records=records,
        routes=len({run.route for run in facts.runs}),
        driven=seconds(sum(record.duration_s for record in records)),
        distance_m=sum(record.distance_m for record in records),
        contents=_contents(facts),
        origins=[(record.run, record.origin.text) for record in records if record.origin],
        columns=[(column.name, column.unit, column.meaning) for column in metadata.columns.get("data.csv", [])],
        column_names={column.name for column in metadata.columns.get("data.csv", [])},
        has_line=any(run.arena.line.pieces for run in facts.runs),
        mapped_runs=sum(run.path is not None for run in facts.runs),
        sensors=[_sensor(facts, number) for number in range(len(metadata.sensors))],
        camera_table=_camera_table(records, media.sensor_run),
        table_runs=spread(facts.runs, _MAX_TABLE_RUNS),
        state_sheets=[
            (named(state), [(image.run, image.number, f"{image.t_s:.1f} s") for image in images])
            for state, images in media.state_sheets.items()
        ],
        draws=[_draw_row(field, one_run=len(records) == 1) for field in drawn_fields(facts.runs, metadata.scenario)],
        image_count=sum(len(images.numbers) for images in facts.images),
        outlier_images=sum(len(group.numbers) for group in facts.outliers),
        outlier_sheet=outliers[:MAX_OUTLIERS],
        outlier_list=outliers[MAX_OUTLIERS : MAX_OUTLIERS + _MAX_LISTED_OUTLIERS],
        run_warnings=[(record.run, one_line(text)) for record in metadata.runs for text in record.warnings],
        board_events=[
            (record.run, ", ".join(f"{count} {name}" for name, count in record.board.events.items()))
            for record in metadata.runs
            if record.board is not None and record.board.events
        ],
        failed_runs=[(failed.run, failed.stage, one_line(failed.problem)) for failed in metadata.failed_runs],
        provenance=_provenance(metadata, whole.render_devices),
        scenario=json.dumps(metadata.scenario, indent=2, ensure_ascii=False, sort_keys=True),
    )


def _provenance(metadata: Metadata, render_devices: Sequence[str]) -> list[tuple[str, object]]:
    """Return the rows of the table of provenance."""
    return [
        ("Seed", metadata.seed),
        ("Made with", ", ".join(f"{name} {version}" for name, version in sorted(metadata.made_with.items()))),
        *([("Rendered on", ", ".join(render_devices))] if render_devices else []),
        *(("Rendering", text) for text in sorted({run.rendering.text for run in metadata.runs if run.rendering})),
        ("Format", f"{metadata.format} {metadata.format_version}"),
    ]


def _sections(facts: ReleaseFacts, media: Media) -> dict[str, str]:
    """Return the titles of the parts that have a content."""
    empty = {"sensors"} if not facts.metadata.sensors else set()
    empty |= {"cameras"} if not media.cameras else set()
    empty |= {"states", "images"} if not facts.images else set()
    empty |= {"splits"} if facts.balance is None else set()
    return {name: title for name, title in _SECTIONS.items() if name not in empty}


def _camera_table(records: Sequence[RunRecord], run: str) -> list[tuple[str, int, str, str]]:
    """Return name, number of images, size and period of each further camera of a run."""
    cameras = next((record.cameras for record in records if record.run == run), {})
    return [
        (name, one.images, f"{one.image_width_px} x {one.image_height_px} px", f"{one.period_s:g} s")
        for name, one in sorted(cameras.items())
    ]


def _contents(facts: ReleaseFacts) -> list[tuple[str, str]]:
    """Return what is in the release, by name; size and licence are those of a release only."""
    records = [run.record for run in facts.runs]
    names, first = [record.run for record in records], records[0]
    sizes = sorted({f"{record.image_width_px} x {record.image_height_px} px" for record in records})
    size = f"{facts.size_bytes / 1e6:.1f} MB in {grouped(facts.files)} files, the whole release"
    listed = ", ".join(names) if len(names) <= _MAX_RUN_NAMES else f"{names[0]} to {names[-1]}"
    duration_s, distance_m = sum(record.duration_s for record in records), sum(record.distance_m for record in records)
    rows, images = sum(record.rows for record in records), sum(record.images for record in records)
    image_rate = [f"{first.rates.camera_hz:g} per second"] if images and first.rates else []
    return [
        *([("Licence", facts.metadata.licence)] if facts.is_released else []),
        ("Runs", f"{len(records)}: {listed}"),
        ("Driving", f"{seconds(duration_s)}, {distance_m:.2f} m"),
        ("Rows", ", ".join([grouped(rows), *([f"{first.rates.control_hz} per second"] if first.rates else [])])),
        ("Images", ", ".join([grouped(images), *image_rate, *(sizes if images else [])])),
        ("Annotations", ", ".join(first.annotations) or "none"),
        *([("Size", size)] if facts.is_released else []),
    ]


@dataclass(frozen=True)
class SensorRows:
    """A sensor of `robot.sensors`: what it measures, and unit, smallest and largest value of each column."""

    name: str
    meaning: str
    columns: Sequence[tuple[str, str, str, str, str]]
    """Name, unit, smallest value, largest value and meaning."""


def _sensor(facts: ReleaseFacts, number: int) -> SensorRows:
    table = facts.metadata.sensor_tables[number]
    limits = [run.sensor_limits[number] for run in facts.runs]
    rows = [
        (
            column.title,
            column.unit,
            f"{min(limit[0, i] for limit in limits):.{column.decimals}f}",
            f"{max(limit[1, i] for limit in limits):.{column.decimals}f}",
            column.meaning,
        )
        for i, column in enumerate(table.columns[1:])
    ]
    return SensorRows(table.name, table.meaning, rows)


@dataclass(frozen=True)
class DrawRow:
    """One row of the table of drawn fields."""

    field: str
    distribution: str
    numbers: Sequence[str]
    """The value of the only run, or the smallest value, the median and the largest value of several runs."""
    options: str
    """Number of runs with each option, if the values are not numbers."""
    strip: Strip | None


def _draw_row(field: DrawnField, *, one_run: bool) -> DrawRow:
    distribution, numbers = in_words(field.distribution), field.numbers
    if one_run:
        return DrawRow(field.field, distribution, [_number(field.values[0])], "", None)
    if numbers is None:
        options = [f"{value} {count}" for value, count in field.counts[:_MAX_OPTIONS]]
        more = f" and {len(field.counts) - _MAX_OPTIONS} more" if len(field.counts) > _MAX_OPTIONS else ""
        return DrawRow(field.field, distribution, ["", "", ""], ", ".join(options) + more, None)
    summary = [_number(value) for value in (min(numbers), median(numbers), max(numbers))]
    return DrawRow(field.field, distribution, summary, "", strip(numbers, field.distribution))


def _number(value: float | str | bool) -> str:  # noqa: FBT001 - as a scenario holds it
    return f"{value:.4g}" if isinstance(value, float) else str(value)
