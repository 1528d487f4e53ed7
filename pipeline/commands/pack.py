"""The command `symolo pack`: a release as files for an archive."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.maintenance import Released
from pipeline.commands.options import checked_input, checked_new_folder

DOCUMENTS = 5


def pack(
    folder: Released,
    *,
    about: Annotated[
        Path,
        typer.Option(
            "--about",
            metavar="FILE",
            callback=checked_input,
            help="YAML file with title, authors, published, publisher.",
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="OUT", callback=checked_new_folder, help="Output folder: new or empty.")
    ],
    shard_gb: Annotated[
        float,
        typer.Option(
            "--shard-gb", min=0.00001, max=50, metavar="GB", help="Largest size of a tar file; 1 GB is 1e9 bytes."
        ),
    ] = 10.0,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print what would be written; write nothing.")] = False,
) -> None:
    """Pack a release for Zenodo, the Hugging Face Hub or a similar archive: tar files and descriptions.

    Unpacked, the tar files give the same release. Beside them are the tables of all runs as CSV, README.md (a dataset
    card), CITATION.cff, croissant.json (MLCommons), datacite.json and SHA256SUMS. A damaged release is refused. The
    same release gives the same bytes.

    Example: symolo pack data --about about.yaml --out upload
    """
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here
    from symolo.publishing.about import read_about
    from symolo.publishing.limits import fits_archives
    from symolo.publishing.pack import pack as packed
    from symolo.publishing.pack import plan

    known = read_about(about)
    check_new(out, folder)
    planned = plan(folder, known, round(shard_gb * 1e9))
    if dry_run:
        for shard in planned.shards:
            typer.echo(f"{shard.name}: {len(shard.members)} files, {shard.size / 1e6:.3f} MB")
        for table in planned.tables:
            typer.echo(f"{table.file}: {table.source} of {len(table.files)} runs, {table.size / 1e6:.3f} MB")
    else:
        written = packed(planned, out, report_here())
        parts = f"{len(planned.shards)} shards, {len(planned.tables)} tables, {DOCUMENTS} documents"
        typer.echo(f"{out}: {parts}, {written / 1e6:.1f} MB")
    for line in fits_archives([*(file.size for file in (*planned.shards, *planned.tables)), *[0] * DOCUMENTS]):
        typer.echo(line)
