"""The result of `symolo export --json`."""

from collections.abc import Sequence

from pipeline.json_results.base import JsonPart, JsonResult
from symolo.exporters.export import PlannedFormat


class ExportedFormatPart(JsonPart):
    format: str
    """Name of the format, which is also that of its folder."""
    files: int
    """Number of its files."""
    bytes: int
    """Size of its files."""

    @classmethod
    def of(cls, planned: PlannedFormat) -> "ExportedFormatPart":
        size = sum(file.size_bytes() for file in planned.files)
        return cls(format=planned.exporter.name, files=len(planned.files), bytes=size)


class ExportResult(JsonResult):
    """What an export contains, or would contain with --dry-run."""

    command: str = "export"
    """Name of the command."""
    folder: str
    """The output folder, as it was named."""
    written: bool
    """Whether the files were written; false with --dry-run."""
    formats: list[ExportedFormatPart]
    """The formats in the order in which they were named."""
    runs: list[str]
    """Names of the runs."""
    warnings: list[str]
    """What the formats leave out or change."""

    @classmethod
    def of(
        cls,
        folder: str,
        planned: Sequence[PlannedFormat],
        runs: Sequence[str],
        warnings: Sequence[str],
        *,
        written: bool,
    ) -> "ExportResult":
        formats = [ExportedFormatPart.of(one) for one in planned]
        return cls(folder=folder, written=written, formats=formats, runs=list(runs), warnings=list(warnings))
