"""Whether an output folder may be used; asked before any work starts."""

import shutil
import tempfile
from pathlib import Path

from pipeline.run_folder.workspace import KIND, STAGES, Kind
from pipeline.stages.assemble import read_metadata
from symolo.core.errors import EnvironmentLacking, InputError
from symolo.core.file_hashes import sizes_below
from symolo.core.os_errors import NOT_THERE
from symolo.core.paths import nearest_existing
from symolo.dataset.bag import DECLARATION
from symolo.dataset.manifest import MANIFEST

NEW_OR_EMPTY = "name a folder that is new or empty"


MADE_BY = {
    Kind.DATASET: "release",
    Kind.PICTURES: "rerender --look",
    Kind.LOOKS: "rerender --looks",
    Kind.VALIDATION: "validate",
    Kind.DIAGNOSIS: "diagnose",
    Kind.PICTURE_DIAGNOSIS: "pictures",
}


def check_out(out: Path, kind: Kind, *, within_looks: bool = False) -> None:
    """Refuse a folder that cannot or should not be written to, before any work starts.

    `within_looks` allows one of the draws of `rerender --looks`, which only that command may touch.

    Raises:
        InputError: It is a file, foreign and not empty, of another kind, one of many draws, or not writable.
    """
    where = f"--out {out}"
    if out.exists() and not out.is_dir():
        raise InputError("is a file, not a folder", where=where, cure=NEW_OR_EMPTY)
    if out.is_dir():
        _check_kind(out, kind, where)
    if kind_of(out.absolute().parent) is Kind.LOOKS and not within_looks:
        raise InputError(f"is a folder of what symolo {MADE_BY[Kind.LOOKS]} made", where=where, cure=NEW_OR_EMPTY)
    nearest = nearest_existing(out)
    if not nearest.is_dir():
        raise InputError(f"lies below the file {nearest}", where=where, cure=NEW_OR_EMPTY)
    try:
        tempfile.TemporaryFile(dir=nearest).close()
    except OSError as error:
        what = f"cannot be written: {nearest}: {error.strerror}"
        raise InputError(what, where=where, cure="name another folder") from None


def check_outside(out: Path, where: str = "") -> None:
    """Refuse a place within a dataset or a bag, which would no longer be what its checksums say.

    `where` is what names it in the refusal, if not --out.

    Raises:
        InputError: It lies there.
    """
    for folder in out.resolve().parents:
        if kind_of(folder) is Kind.DATASET:
            what = "release"
        elif (folder / DECLARATION).is_file() and (folder / MANIFEST).is_file():
            what = "bag"
        else:
            continue
        told = f"lies within the {what} {folder}"
        raise InputError(told, where=where or f"--out {out}", cure="name a place outside of it")


def _check_kind(out: Path, kind: Kind, where: str) -> None:
    if (out / STAGES).is_symlink():
        what = f"{STAGES} in it is a link, and what lies behind it is not this folder's"
        raise InputError(what, where=where, cure="put the folder itself there, or name another --out")
    there = kind_of(out)
    if there is None and not (out / STAGES).is_dir() and any(out.iterdir()):
        raise InputError("holds files that symolo did not make", where=where, cure=NEW_OR_EMPTY)
    if there is not None and there != kind:
        raise InputError(f"holds what symolo {MADE_BY[there]} made", where=where, cure=NEW_OR_EMPTY)


def kind_of(out: Path) -> Kind | None:
    """What a folder of ours holds; None where nothing tells.

    Without `.stages` a dataset is known by its metadata and manifest, so that `.stages` may be deleted.
    """
    try:
        return Kind((out / STAGES / KIND).read_text(encoding="ascii").strip())
    except (*NOT_THERE, ValueError):
        released = (out / MANIFEST).is_file() and read_metadata(out) is not None
        return Kind.DATASET if released or (out / STAGES / "simulate").is_dir() else None


def check_disk(out: Path, needed_bytes: int, or_else: str = "lower render.width_px and render.height_px") -> None:
    """Raise EnvironmentLacking when there is no room for `needed_bytes` where `out` is or will be."""
    there = sum(size for _, size in sizes_below(out))
    cure = f"name a folder on another disk, or {or_else}"
    _check_room(nearest_existing(out), needed_bytes - there, f"--out {out}", needed_bytes, cure)


def check_room(out: Path, lacking_bytes: int) -> None:
    """Raise EnvironmentLacking when there is no room for so many more where `out` will be."""
    cure = "or name a folder on another disk"
    _check_room(nearest_existing(out), lacking_bytes, f"--out {out}", lacking_bytes, cure)


def check_scratch(needed_bytes: int, cure: str) -> None:
    """The same of the folder for temporary files."""
    scratch = Path(tempfile.gettempdir())
    _check_room(scratch, needed_bytes, f"temporary files in {scratch}", needed_bytes, f"set TMPDIR, or {cure}")


def _check_room(folder: Path, lacking_bytes: int, where: str, needed_bytes: int, cure: str) -> None:
    free = shutil.disk_usage(folder).free
    if free < lacking_bytes:
        needed = f"about {needed_bytes / 1e6:.0f} MB are needed and {free / 1e6:.0f} MB are free"
        raise EnvironmentLacking(f"{where}: {needed}; free some space, {cure}")
