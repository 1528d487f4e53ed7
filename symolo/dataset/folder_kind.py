"""Kinds of output folders of symolo, and the check that a folder is not inside a release."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict

from symolo.core.errors import InputError
from symolo.core.files.paths import check_folder
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.os_errors import NOT_THERE
from symolo.core.text_enum import TextEnum
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA, read_metadata
from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST

KIND = "kind"
"""File in `.stages` that names the kind of the folder."""


NAME_DATASET = "name the folder that holds metadata.json"
"""Advice for a path that is not a dataset."""


class Kind(TextEnum):
    """Kind of an output folder; a command for one kind does not write into a folder of a different kind."""

    DATASET = "dataset"
    IMPORTED = "imported"
    """Output of `symolo import`: a dataset whose trajectories were imported."""
    RERENDERED = "rerendered"
    """Output of `symolo rerender`: a dataset with trajectories from elsewhere and new images."""
    VALIDATION = "validation"
    """Output of `symolo validate`."""
    DIAGNOSIS = "diagnosis"
    """Output of `symolo diagnose`: of one case, or a folder for each of several."""
    CAMERA_IDENTIFICATION = "camera_identification"
    """Output of `symolo identify-camera`."""


DATASETS = frozenset({Kind.DATASET, Kind.IMPORTED, Kind.RERENDERED})
"""Kinds of folders that hold a dataset with checksums."""


class Done(BaseModel):
    """Content of `done.json`, the last file of a finished stage."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    key: str
    """SHA-256 of all data on which the result of the stage depends."""
    files: dict[str, str]
    """SHA-256 of each file by its path inside the stage's folder."""


def kind_of(out: Path) -> Kind | None:
    """Return the kind of a folder of symolo; None for any other folder.

    Without `.stages`, a dataset is recognised from its metadata and manifest, so `.stages` may be deleted.
    """
    try:
        return Kind(read_file(out / STAGES / KIND, FileKind.DOCUMENT).decode("ascii").strip())
    except (*NOT_THERE, ValueError):
        metadata = read_metadata(out) if (out / MANIFEST).is_file() else None
        if metadata is not None and metadata.runs[0].origin is not None:
            return Kind.RERENDERED if any(run.images for run in metadata.runs) else Kind.IMPORTED
        return Kind.DATASET if metadata is not None or (out / STAGES / "simulate").is_dir() else None


def check_outside(out: Path, where: str = "") -> None:
    """Refuse a folder inside a dataset or a bag, because its checksums would no longer hold.

    Args:
        out: The folder.
        where: Name of the folder in a message; `--out` with its path by default.

    Raises:
        InputError: The folder is inside a dataset or a bag.
    """
    for folder in out.resolve().parents:
        if kind_of(folder) in DATASETS:
            what = "release"
        elif (folder / DECLARATION).is_file() and (folder / MANIFEST).is_file():
            what = "bag"
        else:
            continue
        problem = f"lies within the {what} {folder}"
        raise InputError(problem, where=where or f"--out {out}", cure="name a place outside of it")


def check_dataset(root: Path) -> None:
    """Refuse a path that is no dataset, not even a damaged one.

    Raises:
        InputError: There is nothing at the path, a file, or a folder without metadata and lists of checksums.
    """
    check_folder(root, NAME_DATASET)
    if not any((root / name).exists() for name in (MANIFEST, TAG_MANIFEST, METADATA)):
        raise InputError("is not a dataset", where=str(root), cure=NAME_DATASET)


def check_is_whole(root: Path, command: str) -> None:
    """Refuse a folder inside a dataset, such as that of one run, where a command takes the whole dataset.

    Args:
        root: The folder.
        command: Command that takes the dataset as its argument, such as `symolo verify`.

    Raises:
        InputError: The folder is inside a dataset.
    """
    is_whole = any((root / name).is_file() for name in (METADATA, MANIFEST, DECLARATION))
    if not is_whole and (whole := dataset_above(root)) is not None:
        raise InputError("is a part of a dataset", where=str(root), cure=f"name all of it: `{command} {whole}`")


def dataset_above(folder: Path) -> Path | None:
    """Return the dataset in which a folder lies, as the user would type it; None if there is none."""
    parents = (*folder.parents, *folder.absolute().parents)
    return next((each for each in parents if (each / METADATA).is_file() and kind_of(each) in DATASETS), None)
