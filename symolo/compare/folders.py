"""Comparison of two folders, file by file: identical, equal within a tolerance, different, or only in one of them."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from symolo.compare import documents, images, tables
from symolo.compare.likeness import EQUAL, Likeness, shown_db
from symolo.core.errors import InputError, one_line
from symolo.core.files.plain_files import FileKind, open_file, read_file
from symolo.core.text_enum import TextEnum
from symolo.dataset.bag import BAG_INFO, DECLARATION
from symolo.dataset.layout import DESCRIPTION, STAGES
from symolo.dataset.manifest import MANIFEST, SEALS, TAG_MANIFEST

KINDS: dict[str, Callable[[bytes, bytes, str], Likeness]] = {
    **dict.fromkeys(images.SUFFIXES, images.likeness),
    **dict.fromkeys(tables.SEPARATORS, tables.likeness),
    ".json": documents.likeness,
}
"""Comparing function by suffix; all other files are identical or different."""

FOLLOWS = frozenset({DESCRIPTION, MANIFEST, TAG_MANIFEST, BAG_INFO, DECLARATION})
"""Files at the top that are written from the others, or describe how they were made."""

_CHUNK_BYTES = 1 << 20


class Verdict(TextEnum):
    """Result of the comparison of one file."""

    IDENTICAL = "identical"
    CLOSE = "equal within"
    """Other bytes, with values that are equal within the tolerance."""
    FOLLOWS = "follows"
    """A file of `FOLLOWS` with other bytes."""
    DIFFERENT = "different"
    ONLY_A = "only in A"
    ONLY_B = "only in B"


@dataclass(frozen=True)
class FileResult:
    """Result of the comparison of one file."""

    name: str
    """Path within both folders."""
    verdict: Verdict
    likeness: Likeness = EQUAL

    def __str__(self) -> str:
        level_db, what = self.likeness.level_db, self.likeness.what
        text = {
            Verdict.CLOSE: f"{'equal within ' if math.isfinite(level_db) else ''}{shown_db(level_db)}: {what}",
            Verdict.DIFFERENT: f"different ({shown_db(level_db)}): {what}",
            Verdict.FOLLOWS: "differs, because it lists or describes the other files",
        }.get(self.verdict, self.verdict.value)
        return one_line(f"{self.name}: {text}")


def compare(a: Path, b: Path, tolerance_db: float) -> Iterator[FileResult]:
    """Yield the result of each file of two folders, in the order of names, or that of two files.

    Args:
        a: A dataset, a run, a folder of images, or a file.
        b: Another one.
        tolerance_db: Level from which files count as equal [dB].

    Raises:
        InputError: A path does not exist, one is a file and the other a folder, or both folders are empty.
    """
    for path in (a, b):
        if not path.exists():
            raise InputError("no such file or folder", where=str(path), cure="name two datasets, runs or images")
    if a.is_dir() != b.is_dir():
        raise InputError(f"{a} and {b}", allowed="two folders or two files")
    if not a.is_dir():
        yield _compared(a, b, a.name, tolerance_db)
        return
    names_a, names_b = _names(a), _names(b)
    if not names_a and not names_b:
        raise InputError("both folders are empty", where=f"{a} and {b}", cure="name two datasets, runs or images")
    for name in sorted(names_a | names_b):
        if name not in names_b:
            yield FileResult(name, Verdict.ONLY_A)
        elif name not in names_a:
            yield FileResult(name, Verdict.ONLY_B)
        else:
            yield _compared(a / name, b / name, name, tolerance_db)


def _names(root: Path) -> set[str]:
    """Return the paths within `root` of all files but signatures and the hidden stages of an output folder."""
    paths = (path for path in root.rglob("*") if path.is_symlink() or not path.is_dir())
    inner = ((path, path.relative_to(root)) for path in paths)
    return {name.as_posix() for _, name in inner if name.parts[0] != STAGES} - set(SEALS)


def _compared(a: Path, b: Path, name: str, tolerance_db: float) -> FileResult:
    for path in (a, b):
        if path.is_symlink() or not path.is_file():
            return FileResult(name, Verdict.DIFFERENT, Likeness.none(f"{path} is no regular file"))
    try:
        if _same_bytes(a, b):
            return FileResult(name, Verdict.IDENTICAL)
        if name in FOLLOWS:
            return FileResult(name, Verdict.FOLLOWS)
        kind = KINDS.get(PurePosixPath(name).suffix.lower())
        if kind is None:
            likeness = Likeness.none("other bytes")
        else:
            likeness = kind(read_file(a, FileKind.ANY), read_file(b, FileKind.ANY), name)
    except OSError as error:
        likeness = Likeness.none(f"cannot be read: {error.strerror}")
    return FileResult(name, Verdict.CLOSE if likeness.level_db >= tolerance_db else Verdict.DIFFERENT, likeness)


def _same_bytes(a: Path, b: Path) -> bool:
    if a.stat().st_size != b.stat().st_size:
        return False
    with open_file(a) as one, open_file(b) as other:
        while chunk := one.read(_CHUNK_BYTES):
            if chunk != other.read(_CHUNK_BYTES):
                return False
    return True
