"""Parts of a dataset's README.md that are made from its metadata, as Markdown."""

import html
import re
from collections.abc import Iterable, Sequence

from symolo.core.errors import one_line
from symolo.dataset.documents.metadata import Metadata
from symolo.dataset.documents.splits_record import NEIGHBOURS_WARNING

MAX_NAMED_RUNS = 20
"""Largest number of runs of a split whose names are in its row."""
_END_OF_LINK_TEXT = re.compile(r"\](?=[(:\[])")
"""A bracket that would turn the text after it into a link, such as `javascript:`."""


def columns_part(metadata: Metadata) -> str:
    """Return the section on data.csv: its columns, the range of the sensors, the states."""
    rows = [(c.name, c.unit, c.meaning) for c in metadata.columns["data.csv"]]
    # Sorted, because metadata.json keeps no order, and the same file must give the same text.
    states = [(str(number), meaning) for number, meaning in sorted(metadata.states.items())]
    parts = ["## data.csv", markdown_table(("column", "unit", "meaning"), rows)]
    tof = metadata.runs[0]
    if tof.tof_min_range_m is not None:
        parts.append(
            f"Ranges are valid from {tof.tof_min_range_m:g} to {tof.tof_max_range_m:g} m; where the sensor saw no"
            f" target, the value is {tof.tof_no_target_m:g} m."
        )
    if any(run.is_imported for run in metadata.runs):
        parts.append("A cell is empty where nothing was measured.")
    if states:
        parts.append(markdown_table(("state", "meaning"), states))
    return "\n\n".join(parts)


def frames_part(metadata: Metadata) -> str:
    """Return the section on coordinate frames."""
    inwards = sorted(metadata.frames.items(), reverse=True)  # W, R, C, B: from the world to the camera's body
    return f"## Frames\n\n{markdown_table(('frame', 'meaning'), inwards)}"


def runs_part(metadata: Metadata) -> str:
    """Return the section with a row for each run."""
    rows = [
        (
            run.run,
            f"{run.duration_s:.1f}",
            "-" if run.lap_time_s is None else f"{run.lap_time_s:.2f}",
            f"{run.distance_m:.2f}",
            str(run.rows),
            str(run.images),
            f"{run.image_width_px} x {run.image_height_px}",
            " ".join(map(str, run.state_order)),
        )
        for run in metadata.runs
    ]
    header = ("run", "duration [s]", "lap [s]", "distance [m]", "rows", "images", "size [px]", "order of states")
    return f"## Runs\n\n{markdown_table(header, rows)}"


def splits_part(metadata: Metadata) -> str:
    """Return the section on training, validation and test; empty if the dataset is not divided."""
    splits = metadata.splits
    if splits is None:
        return ""
    images = {run.run: run.images for run in metadata.runs}
    if splits.by == "image":
        table = {name: (splits.images[name], sum(map(len, splits.images[name].values()))) for name in splits.names}
    else:
        table = {name: (splits.runs[name], sum(images[run] for run in splits.runs[name])) for name in splits.names}
    rows = [(name, str(len(runs)), str(count), _names(tuple(runs))) for name, (runs, count) in table.items()]
    warning = f" Warning: {NEIGHBOURS_WARNING}." if splits.by == "image" else ""
    warning += "".join(f" Warning: {name} is empty, because its runs failed." for name in splits.empty)
    header = ("split", "runs", "images", "names of the runs")
    return f"## Splits\n\n{splits.how}{warning}\n\n{markdown_table(header, rows)}"


def _names(runs: Sequence[str]) -> str:
    more = len(runs) - MAX_NAMED_RUNS
    return ", ".join(runs[:MAX_NAMED_RUNS]) + (f" and {more} more, see metadata.json" if more > 0 else "")


def markdown_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of texts."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(plain_text(cell) for cell in line) + " |" for line in lines)


def plain_text(text: str) -> str:
    """Return text of a scenario file as plain text of a Markdown page, whatever it contains."""
    escaped = html.escape(one_line(text), quote=False).replace("|", "\\|")
    return _END_OF_LINK_TEXT.sub(r"\\]", escaped)
