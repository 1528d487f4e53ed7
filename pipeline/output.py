"""Whether an output folder may be used; asked before any work starts."""

import shutil
import tempfile
from pathlib import Path

from configs.errors import EnvironmentLacking, InputError
from pipeline.paths import nearest_existing
from pipeline.workspace import STAGES

NEW_OR_EMPTY = "name a folder that is new or empty"


def check_out(out: Path) -> None:
    """Refuse a folder that cannot or should not be written to, before any work starts.

    Raises:
        InputError: It is a file, foreign and not empty, or not writable.
    """
    where = f"--out {out}"
    if out.exists() and not out.is_dir():
        raise InputError("is a file, not a folder", where=where, cure=NEW_OR_EMPTY)
    if out.is_dir() and not (out / STAGES).is_dir() and any(out.iterdir()):
        raise InputError("holds files that symolo did not make", where=where, cure=NEW_OR_EMPTY)
    nearest = nearest_existing(out)
    if not nearest.is_dir():
        raise InputError(f"lies below the file {nearest}", where=where, cure=NEW_OR_EMPTY)
    try:
        tempfile.TemporaryFile(dir=nearest).close()
    except OSError as error:
        what = f"cannot be written: {nearest}: {error.strerror}"
        raise InputError(what, where=where, cure="name another folder") from None


def check_disk(out: Path, needed_bytes: int) -> None:
    """Raise EnvironmentLacking when there is no room for `needed_bytes` where `out` is or will be."""
    free = shutil.disk_usage(nearest_existing(out)).free
    there = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    if free + there < needed_bytes:
        raise EnvironmentLacking(
            f"--out {out}: about {needed_bytes / 1e6:.0f} MB are needed and {free / 1e6:.0f} MB are free; "
            "free some space, name a folder on another disk, or lower render.width_px and render.height_px"
        )
