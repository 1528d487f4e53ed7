"""Folders of valid files of which an input replaces one.

An input that begins with `@NAME` and a line end replaces the file of that name; the reader then reads the whole folder.
`corpus/READER/valid` holds valid files.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest, released_hashes, tag_manifest

CORPUS = Path(__file__).parent / "corpus"


def files(name: str) -> list[bytes]:
    """Return the valid files of a reader as inputs that replace one of them."""
    root = CORPUS / name / "valid"
    paths = sorted(path for path in root.rglob("*") if path.is_file())
    return [f"@{path.relative_to(root).as_posix()}\n".encode() + path.read_bytes() for path in paths]


def valid_copy(name: str, place: Path) -> Path:
    """Copy the valid files of a reader into a folder; a bag gets the dataset as its payload."""
    root = Path(shutil.copytree(CORPUS / name / "valid", place / name))
    if name == "bag":
        shutil.copytree(CORPUS / "dataset" / "valid", root / "data", ignore=shutil.ignore_patterns(STAGES))
    return root


@dataclass(frozen=True)
class Folder:
    """A copy of valid files of which one is replaced at a time."""

    root: Path
    files: tuple[Path, ...]

    @classmethod
    def from_path(cls, root: Path) -> "Folder":
        return cls(root, tuple(sorted(path for path in root.rglob("*") if path.is_file())))

    @contextmanager
    def replaced(self, data: bytes) -> Iterator[Path]:
        """Yield the path of the replaced file; the file is as before at the end."""
        line, _, content = data.partition(b"\n")
        name = line.removeprefix(b"@").decode(errors="replace")
        path = self.root / name
        if path not in self.files:
            path, content = self.files[0], data
        before = path.read_bytes()
        path.write_bytes(content)
        try:
            yield path
        finally:
            path.write_bytes(before)


@contextmanager
def sealed(root: Path, changed: Path) -> Iterator[None]:
    """Give a dataset checksums that fit a changed file, unless that is itself one of the lists or hidden."""
    lists = {name: (root / name).read_bytes() for name in (MANIFEST, TAG_MANIFEST)}
    if STAGES not in changed.parts and changed.name not in lists:
        hashes = released_hashes(root)
        (root / MANIFEST).write_bytes(manifest(hashes))
        (root / TAG_MANIFEST).write_bytes(tag_manifest(hashes))
        try:
            yield
        finally:
            for name, content in lists.items():
                (root / name).write_bytes(content)
    else:
        yield
