"""Checks of an output folder, before any work starts."""

from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.paths import nearest_existing, not_writable, writing_error
from symolo.dataset.folder_kind import DATASETS, Kind, kind_of
from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST

NEW_OR_EMPTY = "name a folder that is new or empty"
MADE_BY = {
    Kind.DATASET: "release",
    Kind.IMPORTED: "import",
    Kind.RERENDERED: "rerender",
    Kind.VALIDATION: "validate",
    Kind.DIAGNOSIS: "diagnose",
    Kind.CAMERA_IDENTIFICATION: "identify-camera",
}
"""Command of symolo that makes each kind of folder."""


def check_out(out: Path, kind: Kind) -> None:
    """Refuse a folder that cannot or should not be written to, before any work starts.

    Raises:
        InputError: It is a file, foreign and not empty, of another kind, or not writable.
    """
    where = f"--out {out}"
    if out.exists() and not out.is_dir():
        raise InputError("is a file, not a folder", where=where, cure=NEW_OR_EMPTY)
    if out.is_dir():
        _check_kind(out, kind, where)
    nearest = nearest_existing(out)
    if not nearest.is_dir():
        raise InputError(f"is below the file {nearest}", where=where, cure=NEW_OR_EMPTY)
    if (error := writing_error(nearest)) is not None:
        raise not_writable(nearest, error, where)


def check_finished(root: Path) -> None:
    """Refuse an output folder whose release was interrupted, which is no damage.

    Raises:
        InputError: Both lists of checksums are missing in a folder of the stages.
    """
    kind = kind_of(root)
    if kind is not None and kind in DATASETS and not any((root / name).exists() for name in (MANIFEST, TAG_MANIFEST)):
        several = "the command that makes it, such as `symolo release`,"
        command = several if kind == Kind.DATASET else f"`symolo {MADE_BY[kind]}`"
        cure = (
            f"repeat {command} with the same options; "
            f"`symolo status {root}` shows what is missing, and why a run failed"
        )
        raise InputError("the release is not finished", where=str(root), cure=cure)


def _check_kind(out: Path, kind: Kind, where: str) -> None:
    if (out / STAGES).is_symlink():
        what = f"{STAGES} in it is a link to another folder"
        raise InputError(what, where=where, cure="put the folder itself there, or give a different --out")
    there = kind_of(out)
    if there is None and not (out / STAGES).is_dir() and any(out.iterdir()):
        raise InputError("holds files that symolo did not make", where=where, cure=NEW_OR_EMPTY)
    if there is not None and there != kind:
        raise InputError(f"holds the output of `symolo {MADE_BY[there]}`", where=where, cure=NEW_OR_EMPTY)
