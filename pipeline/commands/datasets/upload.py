"""`symolo upload`: sends a release to an object store or a folder."""

from typing import Annotated

import typer

from pipeline.commands.exit_codes import FAULTS
from pipeline.commands.options import AllowHttp, Dataset, DryRun, Endpoint, Url
from symolo.core.progress import plural

_MEGABYTE = 1_000_000


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
