"""`symolo export`: converts a release to other formats."""

from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import Dataset, DryRun, Json, NewFolder, Runs, names
from symolo.core.errors import InputError
from symolo.core.progress import plural
from symolo.exporters import FORMATS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symolo.exporters.export import PlannedFormat


_MEGABYTE = 1_000_000


def export(
    folder: Dataset,
    *,
    formats: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="NAMES",
            help=f"Formats: {', '.join(FORMATS)}; for several, write commas between them.",
        ),
    ],
    out: NewFolder,
    runs: Runs = None,
    splits: Annotated[
        str | None,
        typer.Option(
            metavar="RULE",
            help="Training, validation and test, in place of the splits of the release: a YAML file or text, such as "
            "'{by: route, shares: {train: 0.5, test: 0.5}}' or '{runs: {train: [CW/*], test: [CCW/*]}}', with the keys "
            "of `splits` in a scenario; `none` for no splits.",
        ),
    ] = None,
    shard_mb: Annotated[
        int,
        typer.Option(
            min=1, max=2000, metavar="MB", help="Largest size of a shard, for webdataset, huggingface and lerobot."
        ),
    ] = 100,
    video: Annotated[
        bool,
        typer.Option(
            "--video",
            help="Store the images of lerobot as MP4 (H.264), which changes pixels; needs the extra `video`.",
        ),
    ] = False,
    polygons: Annotated[
        bool,
        typer.Option(
            "--polygons",
            help="Labels of yolo for segmentation: polygons of walls, obstacles and the line in place of boxes; needs "
            "the annotation kind `instance`.",
        ),
    ] = False,
    dry_run: DryRun = False,
    as_json: Json = False,
) -> None:
    """Convert a release to other formats; each format gets a folder of its name in OUT.

    The release is checked first, and a damaged one is refused. OUT is written completely or not at all. The same
    release always gives the same bytes.

    Example: symolo export data --format tum,kitti --out exported

    Training and test: symolo export data --format coco --splits '{by: run, shares: {train: 0.8, test: 0.2}}' --out coco
    """
    from pipeline.commands.splits import split_line, with_splits
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here
    from symolo.dataset.documents.splits_record import NEIGHBOURS_WARNING
    from symolo.exporters.base import ExportSettings
    from symolo.exporters.export import check_room, exporters_of, open_release, plan
    from symolo.exporters.export import export as exported

    exporters = exporters_of(names(formats, "--format"), "--format")
    if video and not any(exporter.name == "lerobot" for exporter in exporters):
        raise InputError("--video", got=formats, allowed="--format lerobot")
    if polygons and not any(exporter.name == "yolo" for exporter in exporters):
        raise InputError("--polygons", got=formats, allowed="--format yolo")
    data = with_splits(open_release(folder, runs), splits)
    check_new(out, data.root)
    planned = plan(data, exporters, ExportSettings(shard_mb * _MEGABYTE, video, polygons))
    warnings = [NEIGHBOURS_WARNING] if data.splits is not None and data.splits.by == "image" else []
    warnings += [f"{exporter.name}: {text}" for exporter in exporters for text in exporter.warnings(data)]
    for text in warnings:
        typer.echo(f"warning: {text}", err=True)
    if not as_json:
        _print_formats(planned if dry_run else ())
        if data.splits is not None:
            typer.echo(split_line(data))
    written: dict[str, int] = {}
    if not dry_run:
        check_room(planned, out)
        written = exported(data, planned, out, report_here())
    if as_json:
        from pipeline.json_results.export import ExportResult

        run_names = [run.name for run in data.runs]
        typer.echo(ExportResult.from_plans(str(out), planned, run_names, warnings, written).to_json())
    elif not dry_run:
        typer.echo(
            f"{out}: {', '.join(each.exporter.name for each in planned)}, {sum(written.values()) / _MEGABYTE:.1f} MB"
        )


def _print_formats(planned: "Sequence[PlannedFormat]") -> None:
    """Print the number and the size of the files of each format."""
    for export_plan in planned:
        files, exporter = export_plan.files, export_plan.exporter
        size = export_plan.size_bytes() / _MEGABYTE
        typer.echo(f"{exporter.name}: {plural(len(files), 'file')}, {size:.3f} MB: {exporter.what}")
