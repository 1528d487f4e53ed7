"""`symolo download`: fetches a release from an object store or a folder."""

from typing import Annotated

import typer

from pipeline.commands.options import (
    AllowHttp,
    Endpoint,
    NewFolder,
    Url,
)
from symolo.core.progress import plural

_MEGABYTE = 1_000_000


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
    remote = Remote.from_store(store_of(url, endpoint, allow_http=allow_http))
    content = f"{plural(remote.file_count, 'file')}, {remote.size_bytes / _MEGABYTE:.1f} MB"
    if dry_run:
        typer.echo(f"{remote.store.url}: {content}")
        return
    fetched = downloaded(remote, out, report_here())
    typer.echo(f"{out}: {content}; {fetched} of them fetched now")
