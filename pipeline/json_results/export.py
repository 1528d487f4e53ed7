"""The result of `symolo export --json`."""

from collections.abc import Mapping, Sequence

from pipeline.json_results.base import JsonPart, JsonResult
from symolo.exporters.export import PlannedFormat


class ExportedFormatPart(JsonPart):
    """Size of the files of one format."""

    format: str
    """Name of the format, which is also that of its folder."""
    files: int
    """Number of its files."""
    bytes: int
    """Size of its files."""

    @classmethod
    def from_plan(cls, planned: PlannedFormat, size_bytes: int) -> "ExportedFormatPart":
        return cls(format=planned.exporter.name, files=len(planned.files), bytes=size_bytes)


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
    """What the formats leave out or change, and what is wrong with splits by image."""

    @classmethod
    def from_plans(
        cls,
        folder: str,
        planned: Sequence[PlannedFormat],
        runs: Sequence[str],
        warnings: Sequence[str],
        written: Mapping[str, int],
    ) -> "ExportResult":
        """Return the result.

        Args:
            folder: The output folder.
            planned: The formats.
            runs: Names of the runs.
            warnings: What was printed as warnings.
            written: Size of the written files of each format [bytes]; empty if nothing was written.
        """
        sizes = written or {one.exporter.name: one.size_bytes() for one in planned}
        formats = [ExportedFormatPart.from_plan(one, sizes[one.exporter.name]) for one in planned]
        return cls(folder=folder, written=bool(written), formats=formats, runs=list(runs), warnings=list(warnings))
