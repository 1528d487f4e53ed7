"""A release signed by the owner of a key, so that a forged one is found even when its checksums fit."""

import os
import re
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_file
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA, Metadata
from symolo.dataset.layout import NAME_PATTERN
from symolo.dataset.manifest import PROVENANCE, PROVENANCE_SIGNATURE, SIGNATURE, TAG_MANIFEST
from symolo.publishing.documents.provenance import provenance
from symolo.signing.secret_key import SecretKey
from symolo.verification.run_checks import SpecCheck
from symolo.verification.verify import accepted, verify

EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"
"""Variable with the time in seconds that tools for reproducible builds take in place of the clock."""
TIME_FORMAT = "%Y-%m-%dT%H:%M:%SZ"
UNTRUSTED = "signature of a dataset by symolo; minisign verifies it too"


@dataclass(frozen=True)
class SignedFacts:
    """What the trusted comment of a signature states beside the name of the release."""

    version: str
    """Version of the release, such as 1.0.0."""
    time: datetime
    """Time of the signature, in UTC."""

    def comment(self, name: str, file: str) -> str:
        """Return the trusted comment of the signature of one file."""
        return f"dataset:{name} version:{self.version} time:{self.time.strftime(TIME_FORMAT)} file:{file}"


def signing_time(text: str | None) -> datetime:
    """Return the time that a signature states: that of the text, of SOURCE_DATE_EPOCH, or now.

    Raises:
        InputError: The text or the variable is no time.
    """
    try:
        if text is not None:
            return datetime.strptime(text, TIME_FORMAT).replace(tzinfo=timezone.utc)
        epoch = os.environ.get(EPOCH_VARIABLE)
        return datetime.fromtimestamp(int(epoch), timezone.utc) if epoch else datetime.now(timezone.utc)
    except (ValueError, OverflowError, OSError):
        where, got = ("--time", text) if text is not None else (EPOCH_VARIABLE, os.environ.get(EPOCH_VARIABLE))
        allowed = "such as 2026-11-23T16:00:00Z" if text is not None else "a number of seconds since 1970"
        raise InputError(where, got=got, allowed=allowed) from None


def sign_release(
    root: Path,
    key: SecretKey,
    facts: SignedFacts,
    check_spec: SpecCheck = accepted,
    *,
    with_provenance: bool = False,
) -> str:
    """Sign a release that `verify` finds no fault in, and return the trusted comment of the signature.

    Args:
        root: The release. It gets the signature, and the statement of provenance with a signature of its own.
        key: The key of its owner.
        facts: Facts that the trusted comments state.
        check_spec: As for `verify`.
        with_provenance: Whether the statement is written; one that is there is written again in any case.

    Raises:
        InputError: It is a bag, or damaged.
        EnvironmentLacking: The extra `sign` is not installed.
    """
    if (root / DECLARATION).is_file():
        raise InputError("is a bag", where=str(root), cure="sign the dataset, and bag it then")
    if fault := next(verify(root, check_spec), None):
        raise InputError(
            f"is not signed, since it has faults: {fault}", where=str(root), cure=f"see `symolo verify {root}`"
        )
    metadata = Metadata.model_validate_json(read_file(root / METADATA, FileKind.DOCUMENT))
    if not re.fullmatch(NAME_PATTERN, metadata.name):
        allowed = "up to 64 letters, digits, _ and -"
        raise InputError("name", where=str(root / METADATA), got=metadata.name, allowed=allowed)
    if with_provenance or (root / PROVENANCE).exists():
        statement = provenance(root, metadata)
        write_file(root / PROVENANCE, statement)
        _write_signature(root / PROVENANCE_SIGNATURE, statement, key, facts.comment(metadata.name, PROVENANCE))
    comment = facts.comment(metadata.name, TAG_MANIFEST)
    _write_signature(root / SIGNATURE, read_file(root / TAG_MANIFEST, FileKind.DOCUMENT), key, comment)
    return comment


def _write_signature(path: Path, data: bytes, key: SecretKey, comment: str) -> None:
    write_file(path, key.sign(data, comment).to_bytes(UNTRUSTED))
