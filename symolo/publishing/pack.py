"""Packs a release for upload: tar shards, tables, documents for people and machines, checksums."""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

from symolo.core.errors import InputError
from symolo.core.files.atomic_files import write_chunks, write_file
from symolo.core.files.disk_space import check_disk
from symolo.core.files.file_hashes import canonical_json, sha256_of
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.files.tar_files import tar_chunks
from symolo.core.progress import Report, StageReport
from symolo.dataset.documents.metadata import METADATA, Metadata
from symolo.dataset.folder_kind import NAME_DATASET, check_is_whole
from symolo.dataset.layout import NAME_PATTERN
from symolo.dataset.manifest import manifest
from symolo.publishing.about import About
from symolo.publishing.dataset import PackedFile, Published
from symolo.publishing.documents.card import card
from symolo.publishing.documents.citation import citation
from symolo.publishing.documents.croissant import croissant
from symolo.publishing.documents.datacite import datacite
from symolo.publishing.documents.ro_crate import CARD, DESCRIPTOR, ro_crate
from symolo.publishing.shards import PlannedShard, planned_shards
from symolo.publishing.tables import PlannedTable, planned_table
from symolo.reader.dataset import load
from symolo.verification.inventory import LISTS, Inventory

SUMS = "SHA256SUMS"
DOCUMENTS_BYTES = 1_000_000
"""Space for the documents beside shards and tables; they usually need a tenth of it."""


@dataclass(frozen=True)
class Plan:
    """The files of a packed release before any of them is made."""

    root: Path
    about: About
    metadata: Metadata
    tables: tuple[PlannedTable, ...]
    shards: tuple[PlannedShard, ...]

    @property
    def size(self) -> int:
        return sum(file.size for file in (*self.shards, *self.tables))

    def warnings(self) -> Iterator[str]:
        """Yield what a reader of the publication would miss."""
        for name in self.metadata.splits.empty if self.metadata.splits else ():
            yield (
                f"the split {name} is empty, because its runs failed or were left out; the descriptions list it "
                "without a run: release again with other splits or repaired runs"
            )


def plan(root: Path, about: About, shard_bytes: int) -> Plan:
    """Return the files of a publication; nothing is written.

    Raises:
        InputError: It is no release, or a damaged one.
    """
    check_is_whole(root, "symolo pack")
    data = load(root)
    inventory = Inventory.of_whole(data.root)
    if data.metadata is None:
        raise InputError("is one run, not a release", where=str(root), cure=NAME_DATASET)
    if not re.fullmatch(NAME_PATTERN, data.metadata.name):  # it becomes the name of a file
        allowed = "up to 64 letters, digits, _ and -"
        raise InputError("name", where=str(data.root / METADATA), got=data.metadata.name, allowed=allowed)
    for run in data.runs:  # it becomes a cell of every table, which a spreadsheet may take for a formula
        if not all(re.fullmatch(NAME_PATTERN, part) for part in run.name.split("/")):
            allowed = "two names of letters, digits, _ and -, with a slash between them"
            raise InputError("run", where=str(data.root / METADATA), got=run.name, allowed=allowed)
    digests = dict(inventory.files.digests) | {name: sha256_of(data.root / name) for name in LISTS}
    shards = planned_shards(data.root, digests, data.metadata.name, shard_bytes)
    runs = [run.name for run in data.runs]
    tables = tuple(
        planned_table(data.root, runs, source, data.metadata.header(source), digests)
        for source in sorted(data.metadata.columns)
    )
    return Plan(data.root, about, data.metadata, tables, tuple(shards))


def pack(planned: Plan, out: Path, report: Report) -> int:
    """Write a publication, which appears complete or not at all, and return the number of its bytes.

    Raises:
        InputError: `out` is not empty, or lies within the release.
        EnvironmentLacking: The disk has too little room, or a file of the release has changed meanwhile.
    """
    check_new(out, planned.root)
    check_disk(out, planned.size + DOCUMENTS_BYTES, "release fewer runs")
    with new_folder(out) as folder:
        shards = []
        with report.stage("pack", sum(len(shard.members) for shard in planned.shards), "files") as stage:
            for shard in planned.shards:
                digest = write_chunks(folder / shard.name, _chunks(shard, stage))
                shards.append(PackedFile(shard.name, shard.size, digest))
        tables = [
            PackedFile(table.file, table.size, write_chunks(folder / table.file, table.chunks()))
            for table in planned.tables
        ]
        planned_and_packed = tuple(zip(planned.tables, tables, strict=True))
        documents = _documents(Published(planned.about, planned.metadata, planned_and_packed, tuple(shards)))
        for name, content in documents.items():
            write_file(folder / name, content)
        sums = {file.name: file.sha256 for file in (*shards, *tables)}
        sums |= {name: hashlib.sha256(content).hexdigest() for name, content in documents.items()}
        write_file(folder / SUMS, manifest(sums))
    return planned.size + sum(map(len, documents.values()))


def _chunks(shard: PlannedShard, stage: StageReport) -> Iterator[bytes]:
    for number, chunk in enumerate(tar_chunks(shard.members), start=1):
        yield chunk
        stage.update(shard.name, min(number, len(shard.members)))  # the last chunk is the tar's end


def _documents(data: Published) -> dict[str, bytes]:
    membership = data.membership
    return {
        **({membership.file: membership.csv()} if membership else {}),
        CARD: card(data),
        data.remaking.settings_file: yaml.safe_dump(
            data.metadata.scenario, sort_keys=False, allow_unicode=True, width=120
        ).encode(),
        "CITATION.cff": citation(data),
        "croissant.json": canonical_json(croissant(data)),
        "datacite.json": canonical_json(datacite(data)),
        DESCRIPTOR: canonical_json(ro_crate(data)),
    }
