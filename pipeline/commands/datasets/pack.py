"""`symolo pack`: packs a release for an archive."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Dataset, DryRun, NewFolder, checked_input
from symolo.core.progress import plural

DOCUMENTS = 7
"""Number of descriptions in a folder of `pack`."""


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
