"""Commands that share a release: export, pack, bag, upload, download."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.exit_codes import FAULTS
from pipeline.commands.options import AllowHttp, Dataset, DryRun, Endpoint, Json, NewFolder, Runs, checked_input, names
from symolo.core.errors import InputError
from symolo.core.progress import plural

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symolo.exporters.export import PlannedFormat

DOCUMENTS = 7
"""Number of descriptions in a folder of `pack`."""
_MEGABYTE = 1_000_000

Url = Annotated[
    str,
    typer.Argument(
        metavar="URL",
        help="s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER, which must contain only this release.",
    ),
]


def export(
    folder: Dataset,
    *,
    formats: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="NAMES",
            help="Formats: tum, kitti, euroc, coco, yolo, webdataset, parquet, mcap, ros1, hdf5, huggingface, lerobot, "
            "rerun; for several, write commas between them.",
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
    from pipeline.commands.datasets.splits import split_line, with_splits
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
        typer.echo(ExportResult.of(str(out), planned, run_names, warnings, written).to_json())
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


def pack(
    folder: Dataset,
    *,
    about: Annotated[
        Path,
        typer.Option(
            metavar="FILE", callback=checked_input, help="YAML file with title, authors, published, publisher."
        ),
    ],
    out: NewFolder,
    shard_gb: Annotated[
        float, typer.Option(min=0.00001, max=50, metavar="GB", help="Largest size of a tar file; 1 GB is 1e9 bytes.")
    ] = 10.0,
    dry_run: DryRun = False,
) -> None:
    """Pack a release for Zenodo, the Hugging Face Hub or a similar archive: tar files and descriptions.

    The tar files contain the unchanged release. The folder also has the tables of all runs as CSV, README.md (a dataset
    card), CITATION.cff, croissant.json (MLCommons), datacite.json, scenario.yaml, ro-crate-metadata.json and
    SHA256SUMS. A damaged release is refused. The same release gives the same bytes.

    Example: symolo pack data --about about.yaml --out upload
    """
    from datetime import datetime, timezone

    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here
    from symolo.publishing.about import read_about
    from symolo.publishing.limits import fits_archives
    from symolo.publishing.pack import pack as packed
    from symolo.publishing.pack import plan

    description = read_about(about)
    check_new(out, folder)
    planned = plan(folder, description, round(shard_gb * 1e9))
    for text in (*description.doubts(datetime.now(tz=timezone.utc).date()), *planned.warnings()):
        typer.echo(f"warning: {text}", err=True)
    if dry_run:
        for shard in planned.shards:
            typer.echo(f"{shard.name}: {plural(len(shard.members), 'file')}, {shard.size / 1e6:.3f} MB")
        for table in planned.tables:
            typer.echo(f"{table.file}: {table.source} of {plural(len(table.files), 'run')}, {table.size / 1e6:.3f} MB")
    else:
        written = packed(planned, out, report_here())
        parts = f"{plural(len(planned.shards), 'shard')}, {plural(len(planned.tables), 'table')}, {DOCUMENTS} documents"
        typer.echo(f"{out}: {parts}, {written / 1e6:.1f} MB")
    for line in fits_archives([*(file.size for file in (*planned.shards, *planned.tables)), *[0] * DOCUMENTS]):
        typer.echo(line)


def bag(folder: Dataset, out: NewFolder) -> None:
    """Copy a dataset into a bag (BagIt 1.0, RFC 8493) for an archive.

    OUT/data is the same dataset, unchanged. A damaged dataset is refused.

    Example: symolo bag data --out bag
    """
    from symolo.core.progress import report_here
    from symolo.publishing.bagging import make_bag

    count = make_bag(folder, out, report_here())
    typer.echo(f"{out}: a bag of {plural(count, 'file')}")


def upload(
    folder: Dataset,
    url: Url,
    *,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Send nothing; list the files that are missing or different at the address, and end with exit code 4 "
            "if there are any.",
        ),
    ] = False,
    dry_run: DryRun = False,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
) -> int:
    """Send a release to an object store or another folder. The same command continues after an interruption.

    The release is verified first, and a damaged release is refused. The lists of checksums are sent last; without them,
    a copy does not count as finished. If the address holds a different release, nothing is sent. Access keys are read
    from environment variables only.

    Example: symolo upload data file:///mnt/shelf/data
    """
    from symolo.core.progress import report_here
    from symolo.storage.address import store_of
    from symolo.storage.comparison import compare, released_files
    from symolo.storage.upload import check_apart, planned
    from symolo.storage.upload import upload as uploaded

    store = store_of(url, endpoint, allow_http=allow_http)
    check_apart(folder, store)
    files, report = released_files(folder), report_here()
    if check:
        findings = list(compare(files, store, report).findings())
        for finding in findings:
            typer.echo(str(finding))
        result = plural(len(findings), "fault") if findings else f"all {len(files)} files, none missing or different"
        typer.echo(f"{store.url}: {result}", err=bool(findings))
        return FAULTS if findings else 0
    comparison = (planned if dry_run else uploaded)(files, store, report)
    size = sum(file.size_bytes for file in comparison.to_send) / _MEGABYTE
    done = "would be sent" if dry_run else "sent"
    count = plural(len(comparison.to_send), "file")
    typer.echo(f"{store.url}: {count} {done}, {size:.1f} MB; {len(comparison.same)} were already there")
    return 0


def download(
    url: Url,
    *,
    out: NewFolder,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print what would be fetched; fetch only the lists of checksums.")
    ] = False,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
) -> None:
    """Fetch a release that `upload` or another tool has sent, and check all checksums.

    The output folder appears only when it is complete. The same command continues after an interruption.

    Example: symolo download file:///mnt/shelf/data --out fetched
    """
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here
    from symolo.storage.address import store_of
    from symolo.storage.download import Remote
    from symolo.storage.download import download as downloaded

    check_new(out)
    remote = Remote.of(store_of(url, endpoint, allow_http=allow_http))
    content = f"{plural(remote.file_count, 'file')}, {remote.size_bytes / _MEGABYTE:.1f} MB"
    if dry_run:
        typer.echo(f"{remote.store.url}: {content}")
        return
    fetched = downloaded(remote, out, report_here())
    typer.echo(f"{out}: {content}; {fetched} of them fetched now")
