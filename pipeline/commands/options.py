"""Arguments and options that several commands share, and the checks of their values."""

import json
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Annotated, TypeVar

import typer

from pipeline.work.processors import use_one_thread
from symolo.core.errors import InputError
from symolo.core.files.paths import BELOW_CHARS, check_new_path, check_path
from symolo.core.files.plain_files import FileKind, UnsafeFileError, read_named_file
from symolo.core.text_enum import TextEnum

Value = TypeVar("Value")


def checked_input(path: Path) -> Path:
    """Check the path of a file or folder to read."""
    check_path(path, "argument")
    return path


def checked_inputs(
    paths: Collection,
) -> list[Path]:  # bare, because Typer on Python 3.10 takes `list[Path]` for a class
    """Check the paths of files or folders to read."""
    return [checked_input(path) for path in paths]


def in_one_thread(check: Callable[[Value], Value]) -> Callable[[Value], Value]:
    """Return the same check, which limits the threads of linear algebra in this process before."""

    def checked(value: Value) -> Value:
        use_one_thread()
        return check(value)

    return checked


def read_input(path: Path, kind: FileKind) -> bytes:
    """Return the bytes of a file that the command line names.

    Raises:
        InputError: It is missing, no plain file, larger than its kind may be, or cannot be read.
    """
    if path.is_dir():
        raise InputError("is a folder, not a file", where=str(path), cure="name the file")
    try:
        return read_named_file(path, kind)
    except UnsafeFileError:
        raise
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None


def checked_new_folder(path: Path) -> Path:
    """Check the path of a folder to write."""
    from symolo.dataset.folder_kind import check_outside

    check_new_path(path, "--out", BELOW_CHARS)
    check_outside(path)
    return path


def new_file_check(*suffixes: str, option: str = "--out") -> Callable[[Path], Path]:
    """Return a check of the path of a file to write, whose name must end in one of these suffixes.

    Args:
        suffixes: The endings, such as `.html`.
        option: Name of the option in a message.
    """

    def checked(path: Path) -> Path:
        from symolo.dataset.folder_kind import check_outside

        check_new_path(path, option)
        if path.suffix not in suffixes or path.is_dir() or not path.absolute().parent.is_dir():
            allowed = f"a file name ending in {' or '.join(suffixes)} in a folder that exists"
            raise InputError(option, got=str(path), allowed=allowed)
        check_outside(path, f"{option} {path}")
        return path

    return checked


def absent_file_check(*suffixes: str, option: str = "--out") -> Callable[[Path], Path]:
    """Return the same check for a file that users change by hand, which is not replaced."""
    check = new_file_check(*suffixes, option=option)

    def checked(path: Path) -> Path:
        if check(path).exists():
            raise InputError(
                "exists already", where=str(path), cure=f"name another file with {option}, or remove this one"
            )
        return path

    return checked


checked_new_image = new_file_check(".jpg", ".png")


def if_given(check: Callable[[Path], Path]) -> Callable[[Path | None], Path | None]:
    """Return the same check for an option that may be left out."""
    return lambda path: None if path is None else check(path)


Scenario = Annotated[str, typer.Argument(metavar="SCENARIO", help="Name of a shipped scenario, or a YAML file.")]
Dataset = Annotated[
    Path, typer.Argument(metavar="DIR", callback=checked_input, help="Dataset: the folder that holds metadata.json.")
]
Shown = Annotated[
    Path,
    typer.Argument(
        metavar="DIR",
        callback=checked_input,
        help="Dataset, run folder, output folder of simulate, or a data.csv.",
    ),
]
Out = Annotated[
    Path,
    typer.Option(
        "--out",
        metavar="DIR",
        callback=checked_new_folder,
        help="Output folder: new, empty, or one that symolo made before.",
    ),
]
NewFolder = Annotated[
    Path, typer.Option("--out", metavar="OUT", callback=checked_new_folder, help="Output folder: new or empty.")
]
Robot = Annotated[str, typer.Option("--robot", metavar="NAME", help="Name of a shipped robot, or a YAML file.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Override one field, such as render.quality=high; may be repeated. The value is YAML and may be a "
        "distribution, such as '{uniform: [4, 8]}'.",
    ),
]
Like = Annotated[
    Path | None,
    typer.Option(
        "--like",
        metavar="DIAGNOSIS",
        callback=if_given(checked_input),
        help="Draw the robot of each run from the posterior of a diagnosis: the output folder of `symolo diagnose`, or "
        "its posterior.yaml.",
    ),
]
Seed = Annotated[
    int, typer.Option("--seed", min=0, max=2**63 - 1, metavar="N", help="Seed of all values that are drawn at random.")
]
Runs = Annotated[
    str | None, typer.Option("--runs", metavar="GLOB", help="Include only runs whose name matches, such as 'CW/*'.")
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Print what would be written or sent, and do nothing else.")]
Replace = Annotated[
    bool,
    typer.Option(
        "--replace",
        help="Continue even if a finished release in the output folder loses something: it has another name, runs, "
        "cameras or annotations in it are no longer made, a run in it fails now or is measured again, or it is signed "
        "and would change.",
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Print the result as one JSON object, and nothing else on standard output.")
]
ImporterName = Annotated[
    str | None,
    typer.Option("--importer", metavar="NAME", help="Kind of data; by default symolo recognises it from the files."),
]

Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, max=256, metavar="N", help="Number of worker processes; by default one per core."),
]
WorkerMemory = Annotated[
    float | None,
    typer.Option(
        "--worker-memory",
        min=0.5,
        max=10000,
        metavar="GB",
        help="Maximum memory of a worker with its Blender; by default nine tenths of the machine's memory. A worker "
        "that uses more is stopped, and its image or run is tried again, up to three times in all.",
    ),
]
Part = Annotated[
    str | None,
    typer.Option(
        metavar="K/N",
        help="Do only the K-th of N parts of the work, such as 3/10. Parts may run at the same time on machines "
        "that share the output folder; `release` finishes the dataset afterwards.",
    ),
]


class ExecutorName(TextEnum):
    """Machines that do the work."""

    LOCAL = "local"
    RAY = "ray"


WorkedBy = Annotated[
    ExecutorName,
    typer.Option(
        "--executor",
        help="Where the work is done: on this machine, or on a Ray cluster whose nodes share the output folder.",
    ),
]
Address = Annotated[
    str,
    typer.Option(
        metavar="HOST:PORT", help="Address of the Ray cluster; auto means the cluster that was started on this machine."
    ),
]
GpuShare = Annotated[
    float | None,
    typer.Option(
        "--gpu-share",
        min=0.01,
        max=1.0,
        metavar="SHARE",
        help="Share of a graphics card for each task on the Ray cluster, with --device auto or gpu; by default 0.5, "
        "so two tasks share a card.",
    ),
]
Url = Annotated[
    str,
    typer.Argument(
        metavar="URL",
        help="s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER, which must contain only this release.",
    ),
]
Endpoint = Annotated[
    str | None,
    typer.Option(
        metavar="URL",
        help="Address of a server with the S3 protocol, such as MinIO; by default AWS_ENDPOINT_URL, or Amazon.",
    ),
]
AllowHttp = Annotated[
    bool, typer.Option("--allow-http", help="Allow unencrypted requests, such as to a server on the same machine.")
]


class Device(TextEnum):
    """Kinds of device that render."""

    AUTO = "auto"
    CPU = "cpu"
    GPU = "gpu"


OnDevice = Annotated[
    Device | None,
    typer.Option(
        "--device",
        help="Device that renders: cpu gives the same bytes on processors of one class; auto uses a graphics card if "
        "there is one (OptiX, CUDA, HIP, Metal, oneAPI); gpu requires one. Overrides render.device of the scenario.",
    ),
]


def with_device(settings: Sequence[str] | None, device: Device | None) -> tuple[str, ...]:
    """Return the overrides with that of `--device` at the end, where it wins."""
    return (*(settings or ()), *([f"render.device={device}"] if device else []))


def with_like(settings: Sequence[str] | None, like: Path | None) -> tuple[str, ...]:
    """Return the overrides with the posterior of `--like` at the end, where it wins."""
    return (*(settings or ()), *([f"like={json.dumps(str(like))}"] if like else []))


ALL_LOOKS = "all"
"""Word for all shipped looks where a command takes several."""


def look_names(text: str) -> tuple[str, ...]:
    """Return the looks of `--look`: names and files in a list, or all shipped ones."""
    from configs.references import shipped_names

    return shipped_names("look") if text == ALL_LOOKS else names(text, "--look")


def names(text: str, where: str) -> tuple[str, ...]:
    """Return the names in a list with commas between them."""
    result = tuple(name.strip() for name in text.split(","))
    if not all(result):
        raise InputError(where, got=text, allowed="names separated by commas, such as classroom,lab")
    return result


def load_effects(files: Sequence[Path]) -> None:
    """Load the effects of the user in these files, so that a diagnosis tries them, too."""
    if files:
        from pipeline.effects.check import load_to_fit

        for file in files:
            load_to_fit(file)
