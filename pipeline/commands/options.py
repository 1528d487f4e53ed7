"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from configs.errors import InputError
from pipeline.paths import BELOW_CHARS, check_new_path, check_path


def checked_input(path: Path) -> Path:
    """A file or folder to read."""
    check_path(path, "argument")
    return path


def _checked_new_picture(path: Path) -> Path:
    """A picture file to write."""
    check_new_path(path, "--out")
    if path.suffix not in {".jpg", ".png"} or path.is_dir() or not path.absolute().parent.is_dir():
        allowed = "a file name ending in .jpg or .png in a folder that exists"
        raise InputError("--out", got=str(path), allowed=allowed)
    return path


def _checked_new_folder(path: Path) -> Path:
    check_new_path(path, "--out", BELOW_CHARS)
    return path


Scenario = Annotated[str, typer.Argument(metavar="SCENARIO", help="Name of a shipped scenario, or a YAML file.")]
Out = Annotated[
    Path,
    typer.Option(
        "--out",
        metavar="DIR",
        callback=_checked_new_folder,
        help="Output folder: new, empty, or one that symolo made before.",
    ),
]
OutPicture = Annotated[
    Path,
    typer.Option("--out", metavar="FILE", callback=_checked_new_picture, help="Picture to write, .jpg or .png."),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Override one field, such as render.samples=16; may be given again. The value is YAML and may be a "
        "distribution, such as '{uniform: [4, 8]}'.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=256, metavar="N", help="Child processes at a time; all cores by default."),
]


def names(text: str, where: str) -> tuple[str, ...]:
    """The names of a list with commas between them."""
    found = tuple(name.strip() for name in text.split(","))
    if not all(found):
        raise InputError(where, got=text, allowed="names with commas between them, such as classroom,lab")
    return found
