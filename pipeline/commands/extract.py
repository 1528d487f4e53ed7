"""The subcommand `extract` of the commands for files of the user's own: effects and sensors."""

from collections.abc import Callable

import typer

from pipeline.commands.options import Dataset, NewFolder

_HELP = """Write the files of the {noun}s that a dataset was made with, to be read before they are used.

No command executes code of a dataset. To make its runs again, read the files, and then name them: symolo --{noun}-file
FILE repair DIR.

Example: symolo {noun} extract data --out {noun}s
"""


def extract_command(noun: str) -> Callable[..., None]:
    """Return the subcommand for one kind of files, for example `effect`."""

    def extract(folder: Dataset, *, out: NewFolder) -> None:
        from configs.user_files import ROBOT_FILES
        from pipeline.code_files import extracted

        kind = next(kind for kind in ROBOT_FILES if kind.noun == noun)
        for file in extracted(folder, out, kind):
            typer.echo(out / file)

    extract.__doc__ = _HELP.format(noun=noun)
    return extract
