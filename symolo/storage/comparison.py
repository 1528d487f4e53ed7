"""Comparison of a release with a store, by names, sizes and stated checksums: no content is sent for it."""

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
class StoreComparison:
    """The differences between a release and a store."""

    missing: tuple[LocalFile, ...]
    different: Mapping[str, str]
    """Difference of each object that has another size or checksum than the file, by path."""
    same: tuple[LocalFile, ...]
    extra: tuple[str, ...]
    """Paths of objects that are no part of the release."""
    files: tuple[LocalFile, ...]
    """All files of the release."""

    @property
    def to_send(self) -> tuple[LocalFile, ...]:
        """Files that are missing or different, run by run, with the lists of checksums last."""
        lacking = {file.name for file in self.missing} | self.different.keys()
        order = {name: number for number, name in enumerate(LISTS, start=1)}
        files = (file for file in self.files if file.name in lacking)
        return tuple(sorted(files, key=lambda file: (order.get(file.name, 0), file.name)))

    def findings(self) -> Iterator[Finding]:
        problems = {file.name: "is missing" for file in self.missing} | dict(self.different)
        problems |= dict.fromkeys(self.extra, "is not part of the release")
        yield from (Finding(name, problems[name]) for name in sorted(problems))


def released_files(root: Path) -> tuple[LocalFile, ...]:
    """Return all files of a release, including its lists of checksums.

    Raises:
        InputError: The release is damaged.
    """
    digests = Inventory.of_whole(root).files.digests
    return tuple(LocalFile(name, root / name, (root / name).stat().st_size, digest) for name, digest in digests.items())


def compare(
    files: Sequence[LocalFile], store: Store, report: Report, known: Mapping[str, str] = MappingProxyType({})
) -> StoreComparison:
    """Compare the files of a release with the objects of a store.

    Args:
        files: Files of the release.
        store: The store.
        report: Receives the progress.
        known: SHA-256 of objects that this process has sent or requested already.

    Raises:
        InputError: There is no such place.
        EnvironmentLacking: The store cannot be reached.
    """
    sizes = store.sizes()
    requests = sum(file.name not in known for file in files if sizes.get(file.name) == file.size_bytes)
    if not requests:
        return compare_listed(files, sizes, store, known)
    with report.stage("compare", requests, "files") as stage:
        return compare_listed(files, sizes, store, known, lambda done: stage.update("all", done))


def compare_listed(
    files: Sequence[LocalFile],
    sizes: Mapping[str, int],
    store: Store,
    known: Mapping[str, str] = MappingProxyType({}),
    progress: Callable[[int], None] = lambda _done: None,
) -> StoreComparison:
    """Compare with a listing that was made before; `progress` is called with the number of requests so far."""
    missing = tuple(file for file in files if file.name not in sizes)
    same_size = [file for file in files if sizes.get(file.name) == file.size_bytes]
    different = {
        file.name: f"has {sizes[file.name]} bytes in place of {file.size_bytes}"
        for file in files
        if sizes.get(file.name, file.size_bytes) != file.size_bytes
    }
    digests = {file.name: known[file.name] for file in same_size if file.name in known}
    unknown = [file.name for file in same_size if file.name not in digests]
    for done, (name, digest) in enumerate(side_by_side(lambda name: digest_of(store, name), unknown), start=1):
        digests[name] = digest
        progress(done)
    for file in same_size:
        digest = digests[file.name]
        if digest != file.digest:
            what = (
                "has a different SHA-256"
                if digest
                else "has no SHA-256 in its metadata, so only a download could check it"
            )
            different[file.name] = what
    extra = tuple(sorted(sizes.keys() - {file.name for file in files} - {*SEALS}))
    same = tuple(file for file in same_size if file.name not in different)
    return StoreComparison(missing, different, same, extra, tuple(files))


def digest_of(store: Store, name: str) -> str:
    """Return the SHA-256 of an object; the lists of checksums are read, since their stated digests may be missing."""
    if name in LISTS:
        return hashlib.sha256(store.get(name) or b"").hexdigest()
    return store.digest(name)
