"""Arguments and options that several commands share."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from symolo.core.errors import InputError
from symolo.core.paths import BELOW_CHARS, check_new_path, check_path
from symolo.core.text_enum import TextEnum


def checked_input(path: Path) -> Path:
    """A file or folder to read."""
    check_path(path, "argument")
    return path


def checked_new_picture(path: Path) -> Path:
    """A picture file to write."""
    from symolo.dataset.folder_kind import check_outside

    check_new_path(path, "--out")
    if path.suffix not in {".jpg", ".png"} or path.is_dir() or not path.absolute().parent.is_dir():
        allowed = "a file name ending in .jpg or .png in a folder that exists"
        raise InputError("--out", got=str(path), allowed=allowed)
    check_outside(path)
    return path


def checked_new_folder(path: Path) -> Path:
    """A folder to write."""
    from symolo.dataset.folder_kind import check_outside

    check_new_path(path, "--out", BELOW_CHARS)
    check_outside(path)
    return path


def if_given(check: Callable[[Path], Path]) -> Callable[[Path | None], Path | None]:
    """The same check of an option that may be left out."""
    return lambda path: None if path is None else check(path)


Scenario = Annotated[str, typer.Argument(metavar="SCENARIO", help="Name of a shipped scenario, or a YAML file.")]
Out = Annotated[
    Path,
    typer.Option(
        "--out",
        metavar="DIR",
        callback=checked_new_folder,
        help="Output folder: new, empty, or one that symolo made before.",
    ),
]
OutPicture = Annotated[
    Path,
    typer.Option("--out", metavar="FILE", callback=checked_new_picture, help="Picture to write, .jpg or .png."),
]
Robot = Annotated[str, typer.Option("--robot", metavar="NAME", help="Name of a shipped robot, or a YAML file.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Override one field, such as render.quality=high; may be given again. The value is YAML and may be a "
        "distribution, such as '{uniform: [4, 8]}'.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=256, metavar="N", help="Child processes at a time; all cores by default."),
]

WorkerMemory = Annotated[
    float | None,
    typer.Option(
        "--worker-memory",
        min=0.5,
        max=10000,
        metavar="GB",
        help="Memory that a worker may take with its Blender; nine tenths of the machine's by default. One that takes "
        "more is ended, and its frame or run is tried again, three times in all.",
    ),
]


Part = Annotated[
    str | None,
    typer.Option(
        metavar="K/N",
        help="Only the K-th of N parts of the work, such as 3/10, in a folder that all of them share; several may be "
        "made at the same time, on any machine that sees the folder. `release` finishes what the parts have made.",
    ),
]


class ExecutorName(TextEnum):
    """Where work is done."""

    LOCAL = "local"
    RAY = "ray"


WorkedBy = Annotated[
    ExecutorName,
    typer.Option(
        "--executor",
        help="Where the work is done: by child processes here, or by a Ray cluster whose nodes see the output folder.",
    ),
]
Address = Annotated[
    str, typer.Option(metavar="HOST:PORT", help="Of the Ray cluster; auto is the one that was started on this machine.")
]


GpuShare = Annotated[
    float | None,
    typer.Option(
        "--gpu-share",
        min=0.01,
        max=1.0,
        metavar="SHARE",
        help="Of a graphics card that each task on the Ray cluster takes, with --device auto or gpu; 0.5 by default, "
        "which is two on a card.",
    ),
]


Endpoint = Annotated[
    str | None,
    typer.Option(metavar="URL", help="Server that speaks S3, such as MinIO; without it Amazon's, or AWS_ENDPOINT_URL."),
]
AllowHttp = Annotated[
    bool, typer.Option("--allow-http", help="Let requests go unencrypted, as to a server on the same machine.")
]


class Device(TextEnum):
    """What renders."""

    AUTO = "auto"
    CPU = "cpu"
    GPU = "gpu"


OnDevice = Annotated[
    Device | None,
    typer.Option(
        "--device",
        help="What renders: cpu gives the same bytes on machines of one class; auto takes a graphics card where Cycles "
        "lists one (OptiX, CUDA, HIP, Metal, oneAPI); gpu insists on it. In place of the scenario's render.device.",
    ),
]


def with_device(settings: Sequence[str] | None, device: Device | None) -> tuple[str, ...]:
    """The overrides with that of `--device`, which comes last and so counts."""
    return (*(settings or ()), *([f"render.device={device}"] if device else []))


def names(text: str, where: str) -> tuple[str, ...]:
    """The names of a list with commas between them."""
    found = tuple(name.strip() for name in text.split(","))
    if not all(found):
        raise InputError(where, got=text, allowed="names with commas between them, such as classroom,lab")
    return found
