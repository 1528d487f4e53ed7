"""manifest-sha256.txt: the SHA-256 of every released file for `sha256sum -c`; and the SHA-256 of this list itself."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from symolo.core.files.file_hashes import hashes_of
from symolo.dataset.bag import BAG_INFO
from symolo.dataset.layout import STAGES

MANIFEST = "manifest-sha256.txt"
TAG_MANIFEST = "tagmanifest-sha256.txt"
"""SHA-256 of the manifest and of bag-info.txt, so that an edited manifest is detected."""
SIGNATURE = f"{TAG_MANIFEST}.minisig"
PROVENANCE = "provenance.intoto.json"
PROVENANCE_SIGNATURE = f"{PROVENANCE}.minisig"
MAX_NAME_CHARS, MAX_FOLDERS = 1024, 32
"""Largest length and number of folders of a path in a list of checksums; a release has at most six folders."""
SEALS = (SIGNATURE, PROVENANCE, PROVENANCE_SIGNATURE)
"""Files that `symolo sign` adds. No list names them, because they are made from the lists."""


def manifest(hashes: Mapping[str, str]) -> bytes:
    return "".join(f"{digest}  {name}\n" for name, digest in sorted(hashes.items())).encode()


def tag_manifest(hashes: Mapping[str, str]) -> bytes:
    """Return the tag manifest of files.

    Args:
        hashes: SHA-256 by name, including bag-info.txt if there is one.
    """
    tags = {MANIFEST: hashlib.sha256(manifest(hashes)).hexdigest()}
    return manifest(tags | {name: digest for name, digest in hashes.items() if name == BAG_INFO})


def read_manifest(data: bytes) -> dict[str, str]:
    """Return SHA-256 by path; raise ValueError with the number of the first line that has a different format.

    A path of thousands of folders is refused too, because code that visits all parents of a path needs time and memory
    in proportion to the square of their number.
    """
    hashes: dict[str, str] = {}
    for number, line in enumerate(data.decode("utf-8", errors="replace").splitlines(), start=1):
        digest, separator, name = line.partition("  ")
        if not separator or not name or len(digest) != 64 or set(digest) - set("0123456789abcdef") or name in hashes:
            raise ValueError(f"line {number} is not a checksum, two spaces and a new file name")
        if len(name) > MAX_NAME_CHARS or name.count("/") > MAX_FOLDERS:
            raise ValueError(f"line {number} names a file in more folders, or with a longer path, than any release has")
        hashes[name] = digest
    return hashes


def repair_cure(path: Path, otherwise: str) -> str:
    """Return the advice about a damaged file: `symolo repair` if it belongs to a release, else `otherwise`."""
    root = next((folder for folder in path.absolute().parents if (folder / MANIFEST).is_file()), None)
    is_released = root is not None and STAGES not in path.absolute().relative_to(root).parts
    return f"restore it with `symolo repair {root}`" if is_released else otherwise


def released_hashes(out: Path) -> dict[str, str]:
    """Return the SHA-256 of every file of a dataset except the manifests, the signatures and the hidden stages."""
    return hashes_of(out, skip=(STAGES, MANIFEST, TAG_MANIFEST, *SEALS))
