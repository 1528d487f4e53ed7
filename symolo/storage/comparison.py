"""A release beside what a store holds, by listing and by checksums that the store tells: no content is sent for it."""

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from symolo.core.progress import Report
from symolo.dataset.manifest import SEALS
from symolo.storage.base import LocalFile, Store
from symolo.storage.side_by_side import side_by_side
from symolo.verification.findings import Finding
from symolo.verification.inventory import LISTS, Inventory


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
        problems = {file.name: "is missing" for file in self.missing} | dict(self.other)
        problems |= dict.fromkeys(self.extra, "is no part of the release")
        yield from (Finding(name, problems[name]) for name in sorted(problems))


def _place(file: LocalFile) -> tuple[int, str]:
    return (LISTS.index(file.name) + 1 if file.name in LISTS else 0), file.name


def released_files(root: Path) -> tuple[LocalFile, ...]:
    """All files of a release that is as it was released, its lists of checksums among them.

    Raises:
        InputError: It is not.
    """
    digests = Inventory.of_whole(root).files.digests
    return tuple(LocalFile(name, root / name, (root / name).stat().st_size, digest) for name, digest in digests.items())


def compare(
    files: Sequence[LocalFile], store: Store, report: Report, known: Mapping[str, str] = MappingProxyType({})
) -> Comparison:
    """What of a release a store holds.

    Args:
        files: Of the release.
        store: Where they are looked for.
        report: Where to tell.
        known: SHA-256 of objects that this process has sent or asked for, which are not asked for again.

    Raises:
        InputError: There is no such place.
        EnvironmentLacking: The store cannot be reached.
    """
    sizes = store.sizes()
    asked = [file for file in _of_right_size(files, sizes) if file.name not in known]
    if not asked:
        return compare_listed(files, sizes, store, known)
    with report.stage("compare", len(asked), "files") as stage:
        return compare_listed(files, sizes, store, known, lambda done: stage.update("all", done))


def compare_listed(
    files: Sequence[LocalFile],
    sizes: Mapping[str, int],
    store: Store,
    known: Mapping[str, str] = MappingProxyType({}),
    tell: Callable[[int], None] = lambda _done: None,
) -> Comparison:
    """The same by a listing that was made before; `tell` is called with the number of files that were asked for."""
    missing = tuple(file for file in files if file.name not in sizes)
    alike = _of_right_size(files, sizes)
    other = {
        file.name: f"has {sizes[file.name]} bytes in place of {file.size_bytes}"
        for file in files
        if sizes.get(file.name, file.size_bytes) != file.size_bytes
    }
    digests = {file.name: known[file.name] for file in alike if file.name in known}
    unknown = [file.name for file in alike if file.name not in digests]
    for done, (name, digest) in enumerate(side_by_side(lambda name: digest_of(store, name), unknown), start=1):
        digests[name] = digest
        tell(done)
    other |= {file.name: _difference(digests[file.name]) for file in alike if digests[file.name] != file.digest}
    extra = tuple(sorted(sizes.keys() - {file.name for file in files} - {*SEALS}))
    same = tuple(file for file in alike if file.name not in other)
    return Comparison(missing, other, same, extra, tuple(files))


def _of_right_size(files: Sequence[LocalFile], sizes: Mapping[str, int]) -> list[LocalFile]:
    return [file for file in files if sizes.get(file.name) == file.size_bytes]


def digest_of(store: Store, name: str) -> str:
    """Return the SHA-256 of an object; the lists of checksums are read, since their stated digests may be missing."""
    if name in LISTS:
        return hashlib.sha256(store.get(name) or b"").hexdigest()
    return store.digest(name)


def _difference(digest: str) -> str:
    return "has another SHA-256" if digest else "bears no SHA-256, so that only a download would tell"
