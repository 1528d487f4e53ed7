"""The command `symolo export`: a release in other formats."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.maintenance import Released
from pipeline.commands.options import checked_new_folder, names

_MEGABYTE = 1_000_000


def export(
    folder: Released,
    *,
    formats: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="NAMES",
            help="tum, kitti, coco, webdataset, parquet, mcap, ros1, hdf5, huggingface, lerobot, rerun; several with "
            "commas between them.",
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="OUT", callback=checked_new_folder, help="Output folder: new or empty.")
    ],
    runs: Annotated[
        str | None, typer.Option("--runs", metavar="GLOB", help="Include only runs whose name matches, such as 'CW/*'.")
    ] = None,
    shard_mb: Annotated[
        int,
        typer.Option(
            "--shard-mb",
            min=1,
            max=2000,
            metavar="MB",
            help="Largest size of a shard of webdataset, huggingface, lerobot.",
        ),
    ] = 100,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print what would be written; write nothing.")] = False,
) -> None:
    """Convert a release to other formats, each in a folder of its name in OUT.

    The release is checked first; a damaged one is refused. OUT is written completely or not at all. The same release
    gives the same bytes.

    Example: symolo export data --format tum,kitti --out exported
    """
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here
    from symolo.exporters.base import ExportSettings
    from symolo.exporters.export import check_room, exporters_of, open_release, plan
    from symolo.exporters.export import export as exported

    exporters = exporters_of(names(formats, "--format"), "--format")
    data = open_release(folder, runs)
    check_new(out, data.root)
    planned = plan(data, exporters, ExportSettings(shard_mb * _MEGABYTE))
    if dry_run:
        for one in planned:
            size = sum(file.size_bytes() for file in one.files)
            typer.echo(f"{one.exporter.name}: {len(one.files)} files, {size / _MEGABYTE:.3f} MB: {one.exporter.what}")
        return
    check_room(planned, out)
    written = exported(data, planned, out, report_here())
    typer.echo(f"{out}: {', '.join(one.exporter.name for one in planned)}, {written / _MEGABYTE:.1f} MB")
