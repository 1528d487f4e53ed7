"""A new folder that appears only when it is complete, at a path where there is nothing yet."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import (
    empty_unfinished_folder,
    make_folder,
    place_folder,
    remove_file,
    remove_unfinished_folder,
)
from symolo.core.files.file_locks import locked_or_refused


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

    Raises:
        InputError: Another command is writing the folder, or has written it in the meantime.
    """
    place = out.resolve()
    partial = place.with_name(f".{place.name}.partial")
    with locked_unfinished_folder(partial, out):
        try:
            empty_unfinished_folder(partial)
            yield partial
            put_in_place(partial, place, out)
        except BaseException:
            if partial.exists():
                remove_unfinished_folder(partial)
            raise


@contextmanager
def locked_unfinished_folder(partial: Path, out: Path) -> Iterator[None]:
    """Make the hidden folder in which `out` is prepared, unless it is there, and lock it for this process.

    Raises:
        InputError: Another command is writing `out`.
    """
    if partial.is_symlink():
        remove_file(partial)
    make_folder(partial)
    with locked_or_refused(partial, f"--out {out}"):
        yield


def put_in_place(partial: Path, place: Path, out: Path) -> None:
    """Move a finished folder to the absolute path `place` of `out`.

    Raises:
        InputError: There is something now; it stays as it is.
    """
    try:
        place_folder(partial, place)
    except FileExistsError:
        what, cure = "another command has written this folder in the meantime", "name a folder that is new or empty"
        raise InputError(what, where=f"--out {out}", cure=cure) from None
