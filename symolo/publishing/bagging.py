"""A release wrapped as a bag (BagIt 1.0, RFC 8493): its files below `data/`, checksums and bag-info.txt beside it.

The package bagit 1.9.0 is not used. It declares BagIt 0.97, moves the files of the release into the bag instead of
copying them, does not wait until they are on the disk, and its check of a bag ends at the first wrong total without the
name of a file. It accepts the bags that we write.
"""

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


def dataset_in(root: Path) -> Path:
    """Return the dataset in a bag, or the folder itself where it is no bag."""
    return root / PAYLOAD if (root / DECLARATION).is_file() else root


def make_bag(root: Path, out: Path, report: Report) -> int:
    """Copy a whole release into a bag, which appears complete or not at all; return the number of payload files.

    Args:
        root: The release.
        out: A new or empty folder.
        report: Receives the progress.

    Raises:
        InputError: The release is damaged, or `out` is not empty.
    """
    check_new(out)
    digests = Inventory.of_whole(root).files.digests
    with new_folder(out) as bag:
        make_folder(bag / PAYLOAD)
        with report.stage("bag", len(digests), "files") as stage:
            for number, (name, digest) in enumerate(sorted(digests.items()), start=1):
                data = read_file(root / name, FileKind.ANY)
                if hashlib.sha256(data).hexdigest() != digest:
                    raise InputError("has changed meanwhile", where=str(root / name), cure="run the command again")
                make_folder((bag / PAYLOAD / name).parent)
                write_file(bag / PAYLOAD / name, data)
                stage.update("all", number)
        for name, data in tag_files(root, digests).items():
            write_file(bag / name, data)
    return len(digests)


def tag_files(release: Path, digests: Mapping[str, str]) -> dict[str, bytes]:
    """Return the files of a bag beside `data/`; they follow from the release.

    Args:
        release: The release, which lies or will lie in `data/`.
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
