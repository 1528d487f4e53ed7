"""Commands for sensors, also a user's own: `symolo sensor extract`."""

import typer

from pipeline.commands.options import Dataset, NewFolder

HELP = "Write and check a sensor of your own, or look at those that there are."


def extract(folder: Dataset, *, out: NewFolder) -> None:
    """Write the files of the sensors that a dataset was made with, to be read before they are used.

    No command executes code of a dataset. To make its runs again, read the files, and then name them: symolo
    --sensor-file FILE repair DIR.

    Example: symolo sensor extract data --out sensors
    """
    from configs.user_files import SENSOR_FILES
    from pipeline.code_files import extracted

    for file in extracted(folder, out, SENSOR_FILES):
        typer.echo(out / file)


COMMANDS = (extract,)
