"""`symolo repair`: restores damaged files of a dataset."""

from typing import Annotated

import typer

from pipeline.commands.exit_codes import FAULTS
from pipeline.commands.options import Dataset, Workers


def repair(
    folder: Dataset,
    *,
    remove_extra: Annotated[
        bool, typer.Option("--remove-extra", help="Remove files that do not belong to the release.")
    ] = False,
    workers: Workers = None,
) -> int:
    """Restore the damaged files of a dataset, and nothing else.

    Copies of a file elsewhere in the dataset or in .stages are used first. A run is simulated again only if its
    trajectory is lost, and only damaged frames are rendered again. A file is replaced only by one whose SHA-256 is
    that of the manifest. The exit code is 0 if every file is as it was released, and 4 if some files are not; each of
    them is named with the reason.

    Example: symolo repair data
    """
    from pipeline.repair.repair import repair as repaired
    from pipeline.run_folder.output import check_finished
    from pipeline.work.supervisor import cores
    from symolo.core.progress import plural, report_here

    check_finished(folder)
    result = repaired(folder, workers or cores(), report_here(), typer.echo, remove_extra=remove_extra)
    for fault in result.left:
        typer.echo(f"not repaired: {fault}")
    rest = f"{len(result.left)} left" if result.left else "every file is as it was released"
    typer.echo(f"{folder}: {plural(result.repaired, 'fault')} repaired, {rest}", err=bool(result.left))
    return FAULTS if result.left else 0
