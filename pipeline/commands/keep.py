"""Commands that keep data whole: bag."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import Out, checked_input

Released = Annotated[
    Path, typer.Argument(metavar="DIR", callback=checked_input, help="Dataset: the folder that holds metadata.json.")
]


def bag(folder: Released, out: Out) -> None:
    """Wrap a dataset as a bag (BagIt 1.0, RFC 8493), to hand it to an archive.

    The files lie below BAG/data as they are, so that BAG/data is the same dataset. A damaged one is refused.

    Example: symolo bag data --out bag
    """
    from pipeline.dataset.bagging import make_bag
    from pipeline.progress import report_here

    count = make_bag(folder, out, report_here())
    typer.echo(f"{out}: a bag of {count} files")
