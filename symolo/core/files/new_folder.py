"""A folder that comes into being at once, whole or not at all, in a place that is free."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, remove_folder, replace_folder


def check_new(out: Path, source: Path | None = None) -> None:
    """Refuse a place that is taken, or that would make what is read another one.

    Args:
        out: Where the folder will be.
        source: The folder that is read; none where nothing is.

    Raises:
        InputError: There is something at `out`, or it lies within `source`.
    """
    where = f"--out {out}"
    if out.is_symlink() or (out.exists() and not (out.is_dir() and not any(out.iterdir()))):
        raise InputError("is there already", where=where, cure="name a folder that is new or empty")
    if source is not None and out.resolve().is_relative_to(source.resolve()):
        raise InputError("lies within the release", where=where, cure="name a folder next to it")


@contextmanager
def new_folder(out: Path) -> Iterator[Path]:
    """A folder to fill, which gets its place when the block ends, and is gone when it ends by an exception.

    Args:
        out: New or empty.
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
