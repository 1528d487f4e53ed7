"""Commands for object stores and folders elsewhere: upload, download."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.checks import FAULTS
from pipeline.commands.maintenance import Released
from pipeline.commands.options import AllowHttp, Endpoint, checked_new_folder

_MEGABYTE = 1_000_000

Url = Annotated[
    str,
    typer.Argument(
        metavar="URL", help="s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER, for this release alone."
    ),
]


def upload(
    folder: Released,
    url: Url,
    *,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Send nothing; list what is missing or different there, and end with exit code 4 if there is any.",
        ),
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print what would be sent; send nothing.")] = False,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
) -> int:
    """Send a release to an object store or another folder. The same command continues after an interruption.

    The release is verified first; a damaged one is refused. The lists of checksums are sent last: without them the
    copy is not finished. Another release there is never replaced. Access keys are read from the environment only.

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
        result = f"{len(findings)} faults" if findings else f"all {len(files)} files, none missing or different"
        typer.echo(f"{store.url}: {result}", err=bool(findings))
        return FAULTS if findings else 0
    comparison = (planned if dry_run else uploaded)(files, store, report)
    size = sum(file.size_bytes for file in comparison.to_send) / _MEGABYTE
    done = "would be sent" if dry_run else "sent"
    typer.echo(f"{store.url}: {len(comparison.to_send)} files {done}, {size:.1f} MB; {len(comparison.same)} were there")
    return 0


def download(
    url: Url,
    *,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", callback=checked_new_folder, help="Output folder: new or empty.")
    ],
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print what would be fetched; fetch only the lists of checksums.")
    ] = False,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
) -> None:
    """Fetch a release that `upload` or another tool has sent, and check every checksum.

    The folder appears when it is complete. The same command continues after an interruption.

    Example: symolo download file:///mnt/shelf/data --out fetched
    """
    from symolo.core.files.new_folder import check_new
    from symolo.core.progress import report_here
    from symolo.storage.address import store_of
    from symolo.storage.download import Remote
    from symolo.storage.download import download as downloaded

    check_new(out)
    remote = Remote.of(store_of(url, endpoint, allow_http=allow_http))
    size = remote.size_bytes / _MEGABYTE
    if dry_run:
        typer.echo(f"{remote.store.url}: {len(remote.digests)} files and their lists, {size:.1f} MB")
        return
    fetched = downloaded(remote, out, report_here())
    typer.echo(f"{out}: {len(remote.digests)} files and their lists, {size:.1f} MB; {fetched} of them fetched now")
