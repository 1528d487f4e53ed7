"""A release wrapped as a bag (BagIt 1.0, RFC 8493): its files below `data/`, checksums and bag-info.txt beside it."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import Report
from symolo.dataset.bag import BAG_INFO, DECLARATION, bag_info, read_cpu_classes
from symolo.dataset.documents.metadata import METADATA, Metadata
from symolo.dataset.manifest import MANIFEST, TAG_MANIFEST, manifest
from symolo.verification.inventory import Inventory

PAYLOAD = "data"
DECLARED = b"BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n"


def make_bag(root: Path, out: Path, report: Report) -> int:
    """Copy a whole release into a bag, which comes into being at once; the number of its payload files.

    Args:
        root: The release.
        out: New or empty.
        report: Where to tell.

    Raises:
        InputError: The release is damaged, or there is something at `out`.
    """
    check_new(out)
    inventory = Inventory.of_whole(root)
    with new_folder(out) as partial:
        return _fill(partial, root, inventory.files.digests, report)


def _fill(partial: Path, root: Path, digests: Mapping[str, str], report: Report) -> int:
    make_folder(partial / PAYLOAD)
    sizes: list[int] = []
    with report.stage("bag", len(digests), "files") as stage:
        for name, digest in sorted(digests.items()):
            data = read_file(root / name, FileKind.ANY)
            if hashlib.sha256(data).hexdigest() != digest:
                raise InputError("has changed meanwhile", where=str(root / name), cure="run the command again")
            copy = partial / PAYLOAD / name
            make_folder(copy.parent)
            write_file(copy, data)
            sizes.append(len(data))
            stage.update("all", len(sizes))
    for name, data in tag_files(root, digests).items():
        write_file(partial / name, data)
    return len(sizes)


def tag_files(release: Path, digests: Mapping[str, str]) -> dict[str, bytes]:
    """The files of a bag beside `data/`, which follow from what it holds.

    Args:
        release: What lies, or will lie, in `data/`.
        digests: SHA-256 of each of its files.
    """
    metadata = Metadata.model_validate_json(read_file(release / METADATA, FileKind.DOCUMENT))
    sizes = {name: (release / name).stat().st_size for name in digests}
    tags = {
        DECLARATION: DECLARED,
        BAG_INFO: bag_info(metadata.name, metadata.description, sizes, read_cpu_classes(release)),
        MANIFEST: manifest({f"{PAYLOAD}/{name}": digest for name, digest in digests.items()}),
    }
    tags[TAG_MANIFEST] = manifest({name: hashlib.sha256(data).hexdigest() for name, data in tags.items()})
    return tags
