"""A release in other formats, in the folders `OUT/<format>/`, and a file that names the release."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

from symolo.core.errors import InputError, nearest
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.disk_space import check_disk
from symolo.core.files.file_hashes import canonical_json, sha256_of
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.progress import Report
from symolo.core.versions import versions
from symolo.dataset.folder_kind import dataset_above
from symolo.dataset.layout import SIDE
from symolo.dataset.manifest import MANIFEST
from symolo.exporters import FORMATS
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.reader.dataset import Dataset, load
from symolo.verification.inventory import Inventory

_BLOCK_BYTES = 4096
"""Usual block size of a disk; even a small file occupies one block."""
SOURCE = "export.json"
"""File at the top of an export that names the release, its runs and splits, and the programs."""

_CURES = MappingProxyType(
    {
        name: f"`symolo pack` writes {file} (docs/publishing.md)"
        for name, file in (
            ("croissant", "croissant.json"),
            ("datacite", "datacite.json"),
            ("ro-crate", "ro-crate-metadata.json"),
        )
    }
    | {"csv": "the tables of a release are CSV files already: ROUTE/test_N/data.csv and those of ROUTE/test_N/side"}
    | dict.fromkeys(("ros2", "rosbag2", "foxglove"), "a bag of ROS 2 is the format mcap")
)
"""Advice by the name of a format that no exporter writes, but another format or command covers."""


@dataclass(frozen=True)
class PlannedFormat:
    """The files of a format before any of them is made."""

    exporter: Exporter
    files: tuple[ExportedFile, ...]

    def size_bytes(self) -> int:
        """Return the size of the files; those of an unknown size are made for it."""
        return sum(file.size_bytes() for file in self.files)


def exporters_of(names: Sequence[str], where: str) -> tuple[Exporter, ...]:
    """Return the exporter of each name once, in the order of `names`.

    Raises:
        InputError: There is no exporter of a name.
    """
    for name in names:
        if name not in FORMATS:
            cure = _CURES.get(name.lower(), "")
            hint = "" if cure else nearest(name, FORMATS)
            raise InputError(where, got=name, allowed=", ".join(FORMATS), nearest=hint, cure=cure)
    return tuple(import_module(f"symolo.exporters.{name}").EXPORTER for name in dict.fromkeys(names))


def open_release(root: Path, runs: str | None) -> Dataset:
    """Return a release without damage, or only the runs of it whose name matches a pattern.

    Raises:
        InputError: It is not a release, it is damaged, or no run matches.
    """
    data = load(root)
    if data.metadata is None:
        whole = dataset_above(root)
        if whole is None and not (root / SIDE).is_dir():
            cure = "name a release; `symolo import` makes one of a log"
            raise InputError("is a case or a log, and no release", where=str(root), cure=cure)
        whole = whole or "the folder of the release"
        cure = f"name {whole}, and choose the run with --runs '{data.runs[0].name}'"
        raise InputError("is a single run, which has no checksums", where=str(root), cure=cure)
    Inventory.of_whole(data.root)
    return data.matching(runs)


def plan(data: Dataset, exporters: Sequence[Exporter], settings: ExportSettings) -> tuple[PlannedFormat, ...]:
    """Return the files of each format before any of them is made.

    Raises:
        InputError: The release lacks what a format needs.
    """
    return tuple(PlannedFormat(exporter, tuple(exporter.files(data, settings))) for exporter in exporters)


def check_room(planned: Sequence[PlannedFormat], out: Path) -> None:
    """Raise EnvironmentLacking, with the needed and the free space, if the disk of `out` has too little space."""
    sizes = (file.room_bytes() for one in planned for file in one.files)
    check_disk(out, sum(-(-size // _BLOCK_BYTES) * _BLOCK_BYTES for size in sizes), "choose fewer runs with --runs")


def export(data: Dataset, planned: Sequence[PlannedFormat], out: Path, report: Report) -> dict[str, int]:
    """Write an export completely or not at all, and return the number of bytes of each format and of export.json.

    Args:
        data: The result of `open_release`.
        planned: The result of `plan` for `data`.
        out: A new or empty folder.
        report: Receives the progress.

    Raises:
        InputError: `out` is not empty, or a file of the release is damaged.
    """
    check_new(out, data.root)
    files = [(one.exporter.name, file) for one in planned for file in one.files]
    written = {one.exporter.name: 0 for one in planned}
    with new_folder(out) as folder:
        with report.stage("export", len(files), "files") as stage:
            for number, (name, file) in enumerate(files, start=1):
                content = file.content()
                place = folder / name / file.name
                make_folder(place.parent)
                write_file(place, content)
                written[name] += len(content)
                stage.update("all", number)
        source = _source(data, planned)
        write_file(folder / SOURCE, source)
    return {**written, SOURCE: len(source)}


def _source(data: Dataset, planned: Sequence[PlannedFormat]) -> bytes:
    """Return the content of export.json, which identifies the release with the checksum of the manifest."""
    metadata = data.metadata
    return canonical_json(
        {
            "formats": {one.exporter.name: one.exporter.what for one in planned},
            "licence": metadata.licence if metadata else "",
            "made_with": versions("symolo"),
            "manifest_sha256": sha256_of(data.root / MANIFEST),
            "name": metadata.name if metadata else data.root.name,
            "runs": [run.name for run in data.runs],
            **({"splits": data.splits.model_dump(mode="json")} if data.splits else {}),
        }
    )
