"""Download of a release from a store: complete and checked, or not at all."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import empty_unfinished_folder, make_folder, remove_leftovers, write_file
from symolo.core.files.disk_space import check_room
from symolo.core.files.file_hashes import hashes_of
from symolo.core.files.new_folder import check_new, locked_unfinished_folder, put_in_place
from symolo.core.files.paths import BELOW_CHARS, folders_of
from symolo.core.progress import Report
from symolo.dataset.layout import STAGES
from symolo.dataset.manifest import MANIFEST, SEALS, TAG_MANIFEST, manifest, read_manifest, tag_manifest
from symolo.storage.base import Store
from symolo.storage.folder import Folder
from symolo.storage.side_by_side import side_by_side
from symolo.verification.inventory import LISTS

MAX_BYTES = 1 << 28
"""Largest size of the lists of checksums together; a list has some hundred bytes for each file."""
MAX_SEAL_BYTES = 1 << 24
"""Largest size [byte] of a signature, or of a statement of provenance, which holds a scenario."""


@dataclass(frozen=True)
class Remote:
    """A finished release in a store."""

    store: Store
    digests: Mapping[str, str]
    """SHA-256 by path of all files but the lists."""
    size_bytes: int
    seals: Mapping[str, bytes]
    """Content by path of the signatures and the statement of provenance, where there are any."""

    @property
    def file_count(self) -> int:
        """Number of files, including the lists of checksums and the signatures."""
        return len(self.digests) + len(LISTS) + len(self.seals)

    @classmethod
    def from_store(cls, store: Store) -> "Remote":
        """Return the stored release, as its lists of checksums describe it.

        Raises:
            InputError: There is no finished release, or its lists are damaged or name what is not there.
            EnvironmentLacking: The store cannot be reached.
        """
        sizes = store.sizes()
        if sum(sizes.get(name, 0) for name in LISTS) > MAX_BYTES:
            raise InputError("contains lists of checksums that are too large for a release", where=store.url)
        listed, tags = (store.get(name) if name in sizes else None for name in LISTS)
        if listed is None or tags is None:
            what = f"holds no finished release: there is no {MANIFEST if listed is None else TAG_MANIFEST}"
            cure = "give the address to which it was uploaded, or upload it again completely"
            raise InputError(what, where=store.url, cure=cure)
        digests = _read(listed, tags, store.url)
        missing = [name for name in digests if name not in sizes]
        if missing:
            first, *others = missing
            what = f"{first} is missing" + (f", and {len(others)} more" if others else "")
            raise InputError(what, where=store.url, cure="upload the release again: only what is missing is sent")
        signed = [name for name in SEALS if name in sizes]
        if large := [name for name in signed if sizes[name] > MAX_SEAL_BYTES]:
            raise InputError(f"{large[0]} is too large", where=store.url, allowed=f"{MAX_SEAL_BYTES} bytes")
        seals = {name: store.get(name) or b"" for name in signed}
        return cls(store, digests, sum(sizes[name] for name in (*digests, *LISTS, *signed)), seals)


def _read(listed: bytes, tags: bytes, url: str) -> dict[str, str]:
    try:
        digests = read_manifest(listed)
    except ValueError as error:
        raise InputError(f"{MANIFEST}: {error}", where=url) from None
    if manifest(digests) != listed or tag_manifest(digests) != tags:
        raise InputError(f"{MANIFEST} is not the one that {TAG_MANIFEST} names", where=url)
    folders = folders_of(digests)
    for name in digests:
        parts = name.split("/")
        strange = not {"", ".", ".."}.isdisjoint(parts) or not name.isprintable() or len(name.encode()) > BELOW_CHARS
        if strange or name in folders or parts[0] == STAGES or name in {*LISTS, *SEALS}:
            raise InputError(f"{MANIFEST} names something that is not a file of a release", where=url, got=name)
    return digests


def download(remote: Remote, out: Path, report: Report) -> int:
    """Fetch a release, which appears complete or not at all, and return the number of fetched files.

    After an interruption, the fetched files stay in a hidden folder beside `out` and are not fetched again.

    Args:
        remote: The release.
        out: A new or empty folder.
        report: Receives the progress.

    Raises:
        InputError: `out` is not empty, another command writes it, or an object has another checksum than the lists.
        EnvironmentLacking: The disk has too little room, or the store cannot be reached.
    """
    check_new(out)
    place = out.resolve()
    partial = place.with_name(f".{place.name}.download")
    with locked_unfinished_folder(partial, out):
        fetched = _fill(partial, remote, out, report)
        put_in_place(partial, place, out)
    return fetched


def _fill(partial: Path, remote: Remote, out: Path, report: Report) -> int:
    remove_leftovers(partial, below=True)
    expected = {**remote.digests, **_lists(remote)}
    if _holds_others(partial, {**expected, **dict.fromkeys(remote.seals, "")}):
        empty_unfinished_folder(partial)
    there = hashes_of(partial)
    check_room(out, remote.size_bytes - sum((partial / name).stat().st_size for name in there))
    missing = [name for name in expected if there.get(name) != expected[name]]
    for name in missing:
        make_folder((partial / name).parent)
    fetch = _Fetch(remote.store, partial, expected)
    with report.stage("download", len(missing), "files") as stage:
        for number, _ in enumerate(side_by_side(fetch, missing), start=1):
            stage.update("all", number)
    for name, data in remote.seals.items():
        write_file(partial / name, data)
    return len(missing) + len(remote.seals)


def _holds_others(partial: Path, expected: Mapping[str, str]) -> bool:
    """Return whether the folder holds anything else, such as files of another release that were fetched before."""
    folders = folders_of(expected)
    return any(
        path.is_symlink() or path.relative_to(partial).as_posix() not in (folders if path.is_dir() else expected)
        for path in partial.rglob("*")
    )


def _lists(remote: Remote) -> dict[str, str]:
    texts = {MANIFEST: manifest(remote.digests), TAG_MANIFEST: tag_manifest(remote.digests)}
    return {name: hashlib.sha256(text).hexdigest() for name, text in texts.items()}


@dataclass(frozen=True)
class _Fetch:
    store: Store
    folder: Path
    expected: Mapping[str, str]

    def __call__(self, name: str) -> None:
        data = self.store.get(name)
        if data is None or hashlib.sha256(data).hexdigest() != self.expected[name]:
            what = "is missing" if data is None else f"does not match {MANIFEST}"
            # An upload reads the files of a folder, but believes the checksums that an object store states.
            believed = data is not None and not isinstance(self.store, Folder)
            first = "remove it with the tools of the store, and " if believed else ""
            cure = (
                f"{first}upload the release again, which sends only what is missing or different; what was fetched"
                f" stays in {self.folder} until the same command is repeated"
            )
            raise InputError(what, where=f"{self.store.url}: {name}", cure=cure)
        write_file(self.folder / name, data)
