"""Checks of a bag by the rules of RFC 8493, section 3: it is complete, and every checksum is right."""

import hashlib
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from pydantic import ValidationError

from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.bag import BAG_INFO, DECLARATION, OXUM
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, read_manifest
from symolo.publishing.bagging import DECLARED, PAYLOAD, tag_files
from symolo.verification.findings import Finding
from symolo.verification.inventory import Files


def bag_findings(root: Path) -> Iterator[Finding]:
    """Yield each fault with the path of its file in the bag."""
    files = Files.from_folder(root)
    yield from (Finding(name, what) for name, what in files.strange.items())
    if DECLARATION in files.digests and read_file(root / DECLARATION, FileKind.DOCUMENT) != DECLARED:
        yield Finding(DECLARATION, "is not the declaration of a bag of version 1.0 in UTF-8")
    payload = {name for name in files.digests if name.startswith(f"{PAYLOAD}/")}
    faults = list(_against(root, MANIFEST, files, payload))
    yield from faults
    tags = list(_against(root, TAG_MANIFEST, files, {*files.digests} - payload - {TAG_MANIFEST}))
    yield from _blamed(root, files, tags)
    if faults or tags:
        return
    stated = re.search(rf"^{OXUM}: (\S+)$", _text(root / BAG_INFO), re.MULTILINE)
    oxum = f"{sum((root / name).stat().st_size for name in payload)}.{len(payload)}"
    if stated is None or stated.group(1) != oxum:
        yield Finding(BAG_INFO, f"{OXUM} is {stated.group(1) if stated else 'missing'}, the payload comes to {oxum}")


def _against(root: Path, name: str, files: Files, held: set[str]) -> Iterator[Finding]:
    try:
        listed = read_manifest(read_file(root / name, FileKind.CHECKSUMS))
    except OSError as error:
        yield Finding(name, f"cannot be read: {error.strerror}")
        return
    except ValueError as error:
        yield Finding(name, str(error))
        return
    for file in sorted({*listed} | held):
        if file not in listed:
            yield Finding(file, f"is not named in {name}")
        elif file not in files.digests:
            yield Finding(file, f"is missing; {name} names it")
        elif files.digests[file] != listed[file]:
            yield Finding(file, f"was changed: its SHA-256 is not that of {name}")


def _blamed(root: Path, files: Files, tags: Sequence[Finding]) -> Iterator[Finding]:
    """Yield the faults, with the list in place of a file that is as it was made: only one of the two has changed."""
    whole = _as_made(root, files)
    for finding in tags:
        if whole.get(finding.file) and files.digests.get(finding.file) == whole[finding.file]:
            yield Finding(TAG_MANIFEST, f"was changed: its entry for {finding.file} is wrong")
        else:
            yield finding


def _as_made(root: Path, files: Files) -> dict[str, str]:
    """Return the SHA-256 of the files beside the payload as they follow from it; empty if the payload is damaged."""
    start = f"{PAYLOAD}/"
    payload = {name.removeprefix(start): digest for name, digest in files.digests.items() if name.startswith(start)}
    try:
        made = tag_files(root / PAYLOAD, payload)
    except (OSError, ValidationError):
        return {}
    return {name: hashlib.sha256(data).hexdigest() for name, data in made.items()}


def _text(path: Path) -> str:
    return read_file(path, FileKind.CHECKSUMS).decode("utf-8", errors="replace") if path.is_file() else ""
