"""Check of the signatures of a release and of the statement of its provenance."""

from collections.abc import Iterator
from pathlib import Path

from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.manifest import PROVENANCE, PROVENANCE_SIGNATURE, SIGNATURE, TAG_MANIFEST
from symolo.publishing.bagging import dataset_in
from symolo.publishing.documents.provenance import subject_problem
from symolo.signing.minisign import MAX_BYTES, PublicKey, Signature
from symolo.verification.findings import Finding


def signature_findings(root: Path, key: PublicKey) -> Iterator[Finding]:
    """Yield the faults of the signatures of a release; none means that the owner of the key signed its checksum lists.

    This does not compare the files with the lists, which `verify` does.

    Raises:
        EnvironmentLacking: The extra `sign` is not installed.
    """
    if problem := _problem(root, TAG_MANIFEST, SIGNATURE, key):
        yield Finding(SIGNATURE, problem)
    if not _is_there(root / PROVENANCE) and not _is_there(root / PROVENANCE_SIGNATURE):
        return
    if problem := _problem(root, PROVENANCE, PROVENANCE_SIGNATURE, key):
        yield Finding(PROVENANCE_SIGNATURE, problem)
    elif problem := subject_problem(read_file(root / PROVENANCE, FileKind.DOCUMENT), root):
        yield Finding(PROVENANCE, problem)


def trusted_comment(root: Path) -> str:
    """Return the comment in the signature of a release, or of the release in a bag; trust it only if the check passes.

    Raises:
        OSError: There is no signature.
        ValueError: It cannot be read.
    """
    return Signature.from_bytes(read_file(dataset_in(root) / SIGNATURE, FileKind.DOCUMENT)).comment


def _problem(root: Path, signed: str, signature: str, key: PublicKey) -> str:
    """Return the fault of the signature of one file; empty if there is none."""
    try:
        content = read_file(root / signature, FileKind.DOCUMENT)
        data = read_file(root / signed, FileKind.DOCUMENT)
    except FileNotFoundError as error:
        if error.filename == str(root / signature):
            return f"is missing: {signed} is not signed"
        return f"signs {signed}, which is missing"
    except OSError as error:
        return f"cannot be read: {error.strerror}"
    if len(content) > MAX_BYTES:
        return f"is no signature: it has more than {MAX_BYTES} bytes"
    try:
        return Signature.from_bytes(content).problem(key, data)
    except ValueError as error:
        return f"is no signature of minisign: {error}"


def _is_there(path: Path) -> bool:
    return path.is_symlink() or path.exists()
