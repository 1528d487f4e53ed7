"""The command `symolo report`: one HTML page about a release."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.maintenance import Released
from symolo.core.errors import InputError
from symolo.core.files.paths import check_new_path


def _checked_new_page(path: Path) -> Path:
    from symolo.dataset.folder_kind import check_outside

    check_new_path(path, "--out")
    if path.suffix != ".html" or path.is_dir() or not path.absolute().parent.is_dir():
        allowed = "a file name ending in .html in a folder that exists"
        raise InputError("--out", got=str(path), allowed=allowed)
    check_outside(path)
    return path


def report(
    folder: Released,
    *,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", callback=_checked_new_page, help="Page to write, .html.")
    ],
    runs: Annotated[
        str | None, typer.Option("--runs", metavar="GLOB", help="Include only runs whose name matches, such as 'CW/*'.")
    ] = None,
    detail: Annotated[
        int,
        typer.Option(
            "--detail", min=0, max=200, metavar="N", help="Largest number of runs that get a section of their own."
        ),
    ] = 12,
) -> None:
    """Make one HTML page about a release: content, paths, runs, images, random draws, warnings, provenance.

    The page is one file that loads nothing from elsewhere. The release is checked first; a damaged one is refused. The
    same release gives the same bytes.

    Example: symolo report data --out report.html
    """
    from symolo.core.files.atomic_files import write_file
    from symolo.core.progress import report_here
    from symolo.exporters.export import open_release
    from symolo.report.build import release_report

    data = open_release(folder, runs)
    page = release_report(data, detail, report_here())
    write_file(out, page)
    typer.echo(f"{out}: {len(data)} runs, {len(page) / 1e6:.1f} MB")
