"""A new folder that appears only when it is complete, at a path where there is nothing yet."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, remove_folder, replace_folder


def check_new(out: Path, source: Path | None = None) -> None:
    """Refuse a folder that is not empty, or that lies inside the release.

    Args:
        out: Path of the folder that will be written.
        source: Folder that is read; None if no folder is read.

    Raises:
        InputError: `out` is a file, a link or a folder that is not empty, or it lies inside `source`.
    """
    where = f"--out {out}"
    if out.is_symlink() or (out.exists() and not (out.is_dir() and not any(out.iterdir()))):
        raise InputError("is there already", where=where, cure="name a folder that is new or empty")
    if source is not None and out.resolve().is_relative_to(source.resolve()):
        raise InputError("lies within the release", where=where, cure="name a folder next to it")


@contextmanager
def new_folder(out: Path) -> Iterator[Path]:
    """Yield a folder to fill, which is moved to `out` at the end of the block, or removed after an exception.

    Args:
        out: Path of a new or empty folder.
    """
    place = out.resolve()
    partial = place.with_name(f".{place.name}.partial")
    remove_folder(partial)
    try:
        make_folder(partial)
        yield partial
        replace_folder(partial, place)
    except BaseException:
        remove_folder(partial)
        raise
