"""A release beside what a store holds, by listing and by checksums that the store tells: no content is sent for it."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.dataset.findings import Finding
from pipeline.dataset.inventory import LISTS, Inventory
from pipeline.progress import Report
from pipeline.storage.base import LocalFile, Store
from pipeline.storage.side_by_side import side_by_side


@dataclass(frozen=True)
class Comparison:
    missing: tuple[LocalFile, ...]
    other: Mapping[str, str]
    """What is not right about an object, by path."""
    same: tuple[LocalFile, ...]
    extra: tuple[str, ...]
    """Objects that are no part of the release."""
    files: tuple[LocalFile, ...]
    """All of the release."""

    @property
    def to_send(self) -> tuple[LocalFile, ...]:
        """In the order of their paths, which is run by run, and the lists of checksums last."""
        absent = {file.name for file in self.missing} | self.other.keys()
        return tuple(sorted((file for file in self.files if file.name in absent), key=_place))

    def findings(self) -> Iterator[Finding]:
        told = {file.name: "is missing" for file in self.missing} | dict(self.other)
        told |= dict.fromkeys(self.extra, "is no part of the release")
        yield from (Finding(name, told[name]) for name in sorted(told))


def _place(file: LocalFile) -> tuple[int, str]:
    return (LISTS.index(file.name) + 1 if file.name in LISTS else 0), file.name


def released_files(root: Path) -> tuple[LocalFile, ...]:
    """All files of a release that is as it was released, its lists of checksums among them.

    Raises:
        InputError: It is not.
    """
    digests = Inventory.of_whole(root).files.digests
    return tuple(LocalFile(name, root / name, (root / name).stat().st_size, digest) for name, digest in digests.items())


def compare(files: Sequence[LocalFile], store: Store, report: Report) -> Comparison:
    """What of a release a store holds.

    Raises:
        InputError: There is no such place.
        EnvironmentLacking: The store cannot be reached.
    """
    sizes = store.sizes()
    missing = tuple(file for file in files if file.name not in sizes)
    of_other_size = {
        file.name: f"has {sizes[file.name]} bytes in place of {file.size_bytes}"
        for file in files
        if sizes.get(file.name, file.size_bytes) != file.size_bytes
    }
    alike = [file for file in files if file.name in sizes and file.name not in of_other_size]
    told: dict[str, str] = {}
    if alike:
        with report.stage("compare", len(alike), "files") as stage:
            for file, digest in side_by_side(lambda file: _digest(store, file.name), alike):
                told[file.name] = digest
                stage.update("all", len(told))
    other = of_other_size | {
        file.name: _difference(told[file.name]) for file in alike if told[file.name] != file.digest
    }
    extra = tuple(sorted(sizes.keys() - {file.name for file in files}))
    same = tuple(file for file in alike if file.name not in other)
    return Comparison(missing, other, same, extra, tuple(files))


def _digest(store: Store, name: str) -> str:
    """Of the lists themselves: whoever put them there may have told no checksum, and much hangs on them."""
    if name in LISTS:
        return hashlib.sha256(store.get(name) or b"").hexdigest()
    return store.digest(name)


def _difference(digest: str) -> str:
    return "has another SHA-256" if digest else "bears no SHA-256, so that only a download would tell"
