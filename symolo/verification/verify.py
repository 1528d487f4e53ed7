"""`symolo verify`: everything that can be found wrong with a dataset from its folder alone."""

from collections.abc import Iterator
from pathlib import Path

from pydantic import ValidationError

from symolo.core.errors import InputError
from symolo.core.files.paths import check_folder, folders_of
from symolo.core.files.plain_files import FileKind, check_folders, read_file
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA, Metadata
from symolo.dataset.folder_kind import NAME_DATASET, check_is_whole
from symolo.dataset.layout import DATA, DESCRIPTION, STAGES
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST
from symolo.dataset.tables.side_reading import first_fault
from symolo.publishing.bagging import PAYLOAD
from symolo.signing.minisign import PublicKey
from symolo.verification.bag import bag_findings
from symolo.verification.findings import Finding
from symolo.verification.inventory import Inventory
from symolo.verification.run_checks import SpecCheck, check_run
from symolo.verification.signature import signature_findings


def accepted(_spec: str) -> str:
    """Return that nothing is wrong with a spec.json, whatever it holds."""
    return ""


def verify(root: Path, check_spec: SpecCheck = accepted, key: PublicKey | None = None) -> Iterator[Finding]:
    """Yield each fault with the file that has it; nothing means that the dataset is whole.

    Args:
        root: A dataset, or a bag that holds one.
        check_spec: Returns what is wrong with the text of a run's spec.json, and an empty text where nothing is.
            Without it, only the fields that a reader needs are checked.
        key: Who must have signed it; None asks for no signature.

    Raises:
        InputError: There is no such folder, or it is no dataset.
        EnvironmentLacking: A signature is to be checked, and the extra `sign` is not installed.
    """
    check_folder(root, NAME_DATASET)
    check_is_whole(root, "symolo verify")
    if not _is_dataset(root):
        what = f"is no dataset: there is no {METADATA}, no {MANIFEST} and no run in it"
        raise InputError(what, where=str(root), cure=NAME_DATASET)
    if (root / DECLARATION).is_file():
        payload = [] if (root / PAYLOAD).is_symlink() else _dataset_findings(root / PAYLOAD, check_spec, key)
        findings = [Finding(f"{PAYLOAD}/{finding.file}", finding.what) for finding in payload]
        yield from findings
        reported = {finding.file for finding in findings}
        yield from (finding for finding in bag_findings(root) if finding.file not in reported)
    else:
        yield from _dataset_findings(root, check_spec, key)


def _is_dataset(root: Path) -> bool:
    """Return whether anything in a folder shows that it is a dataset or a bag, however damaged."""
    names = (METADATA, MANIFEST, TAG_MANIFEST, DECLARATION, STAGES)
    return any((root / name).exists() for name in names) or any(root.glob(f"*/test_*/{DATA}"))


def _dataset_findings(root: Path, check_spec: SpecCheck, key: PublicKey | None) -> Iterator[Finding]:
    if key is not None:
        yield from signature_findings(root, key)
    inventory = Inventory.from_folder(root)
    faults = list(inventory.findings())
    yield from faults
    unreadable = inventory.files.strange.keys() | (inventory.expected.keys() - inventory.files.digests.keys())
    content = (finding for finding in _content_findings(root, check_spec) if finding.file not in unreadable)
    if not inventory.trusted or not faults:
        yield from content
        return
    # A file that is proven to be as it was released is not reported for differences from a damaged file.
    wrong = {fault.file for fault in faults}
    known = {*inventory.expected, *inventory.extra}
    intact = {".", *known, *folders_of(known)} - wrong
    yield from (finding for finding in content if finding.file not in intact)


def _content_findings(root: Path, check_spec: SpecCheck) -> Iterator[Finding]:
    """Yield the faults of the content of the files, regardless of their checksums."""
    if not (root / DESCRIPTION).is_file():
        yield Finding(DESCRIPTION, "is missing")
    try:
        metadata = Metadata.model_validate_json(read_file(root / METADATA, FileKind.DOCUMENT))
    except OSError as error:
        yield Finding(METADATA, f"cannot be read: {error.strerror}")
    except ValidationError as error:
        yield Finding(METADATA, first_fault(error))
    else:
        for record in metadata.runs:
            if record.run.startswith("/") or ".." in record.run.split("/"):
                yield Finding(METADATA, f"run {record.run!r} leads out of the dataset")
                continue
            try:
                check_folders(root, record.run)
                yield from check_run(root, record, check_spec, metadata.sensor_tables, metadata.data_columns)
            except OSError as error:  # such as of a sector that the disk has lost; its file is named above
                where = Path(str(error.filename)) if error.filename else root / record.run
                name = where.relative_to(root).as_posix() if where.is_relative_to(root) else record.run
                yield Finding(name, f"cannot be read: {error.strerror}")
        named = {record.run for record in metadata.runs}
        for folder in sorted(path.relative_to(root).as_posix() for path in root.glob("*/test_*")):
            if folder not in named:
                yield Finding(folder, f"is not named in {METADATA}")
