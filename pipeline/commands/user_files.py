"""What the commands `effect` and `sensor` share: options, the end of `check`, and the subcommand `extract`."""

import shlex
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.exit_codes import BAD_INPUT
from pipeline.commands.options import Dataset, NewFolder, absent_file_check, if_given

NewCode = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="FILE.py",
        callback=if_given(absent_file_check(".py")),
        help="File to write; by default NAME.py in this folder.",
    ),
]

_HELP = """Write the files of the {noun}s that a dataset was made with, to be read before they are used.

No command executes code of a dataset. To make its runs again, read the files, and then name them: symolo --{noun}-file
FILE repair DIR.

Example: symolo {noun} extract data --out {noun}s
"""


def write_template(name: str, out: Path | None, text: str) -> Path:
    """Write a file to begin with, and return its path: `out`, by default NAME.py in this folder.

    Raises:
        InputError: The file exists.
    """
    from symolo.core.files.atomic_files import write_file

    file = out or absent_file_check(".py")(Path(f"{name}.py"))
    write_file(file, text.encode())
    return file


def conclude_check(file: Path, lines: Iterable[str], trial: Sequence[str] | None) -> int:
    """Print the verdicts about a file and the command that tries it, and return the exit code.

    Args:
        file: The file.
        lines: Lines about the rules.
        trial: Words after `symolo` that try the file; None if it breaks a rule.
    """
    for line in lines:
        typer.echo(line)
    if trial is None:
        typer.echo(f"symolo: {file}: breaks a rule, see above", err=True)
        return BAD_INPUT
    typer.echo(f"{file} keeps every rule; try it: symolo {shlex.join(trial)} --out data")
    return 0


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
