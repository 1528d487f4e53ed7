"""`symolo bag`: copies a dataset into a BagIt bag."""

import typer

from pipeline.commands.options import Dataset, NewFolder
from symolo.core.progress import plural


def bag(folder: Dataset, out: NewFolder) -> None:
    """Copy a dataset into a bag (BagIt 1.0, RFC 8493) for an archive.

    OUT/data is the same dataset, unchanged. A damaged dataset is refused.

    Example: symolo bag data --out bag
    """
    from symolo.core.progress import report_here
    from symolo.publishing.bagging import make_bag

    count = make_bag(folder, out, report_here())
    typer.echo(f"{out}: a bag of {plural(count, 'file')}")
