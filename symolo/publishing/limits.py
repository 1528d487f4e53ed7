"""Limits of archives by their own documentation; docs/publishing.md has the sources.

Zenodo: 50 GB and 100 files in a record. Hugging Face Hub: files of at most 50 GB, better below 20 GB.
"""

from collections.abc import Sequence

GB = 1_000_000_000
_ZENODO_BYTES, _ZENODO_FILES = 50 * GB, 100
_HUB_BYTES, _HUB_GOOD_BYTES = 50 * GB, 20 * GB


def fits_archives(sizes: Sequence[int]) -> tuple[str, str]:
    """Return a line for each archive that says whether files of these sizes [bytes] fit."""
    total, largest = sum(sizes), max(sizes)
    zenodo = "fits a record"
    if total > _ZENODO_BYTES:
        zenodo = f"{total / GB:.1f} GB are more than the 50 GB of a record; ask for a quota or release fewer runs"
    elif len(sizes) > _ZENODO_FILES:
        zenodo = f"{len(sizes)} files are more than the 100 of a record; raise --shard-gb"
    hub = "fits"
    if largest > _HUB_BYTES:
        hub = f"a file of {largest / GB:.1f} GB is larger than the 50 GB that it takes; lower --shard-gb"
    elif largest > _HUB_GOOD_BYTES:
        hub = f"a file of {largest / GB:.1f} GB is larger than the 20 GB that it advises; lower --shard-gb"
    return f"Zenodo: {zenodo}", f"Hugging Face Hub: {hub}"
