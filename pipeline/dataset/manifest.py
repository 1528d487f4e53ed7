"""manifest-sha256.txt: the SHA-256 of every released file, as `sha256sum -c` reads it."""

from pathlib import Path

from pipeline.files import hashes_of
from pipeline.workspace import STAGES

MANIFEST = "manifest-sha256.txt"


def manifest(hashes: dict[str, str]) -> bytes:
    return "".join(f"{digest}  {name}\n" for name, digest in sorted(hashes.items())).encode()


def read_manifest(data: bytes) -> dict[str, str]:
    """SHA-256 by path; raises ValueError with the number of the first line that is not of this form."""
    hashes: dict[str, str] = {}
    for number, line in enumerate(data.decode("utf-8", errors="replace").splitlines(), start=1):
        digest, separator, name = line.partition("  ")
        if not separator or not name or len(digest) != 64 or set(digest) - set("0123456789abcdef") or name in hashes:
            raise ValueError(f"line {number} is not a checksum, two spaces and a new file name")
        hashes[name] = digest
    return hashes


def released_hashes(out: Path) -> dict[str, str]:
    """SHA-256 of every file of a dataset but the manifest and the hidden stages."""
    return hashes_of(out, skip=(STAGES, MANIFEST))
