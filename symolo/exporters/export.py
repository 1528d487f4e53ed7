"""A release in other formats, all of them derived from it alone: `OUT/<format>/`, and what they were made from."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path

from symolo.core.errors import InputError, nearest
from symolo.core.files.atomic_files import make_folder, write_file
from symolo.core.files.disk_space import check_disk
from symolo.core.files.file_hashes import canonical_json, sha256_of
from symolo.core.files.new_folder import check_new, new_folder
from symolo.core.progress import Report
from symolo.core.versions import versions
from symolo.dataset.manifest import MANIFEST
from symolo.exporters import EXPORTERS
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.reader.dataset import Dataset, load
from symolo.verification.inventory import Inventory

_BLOCK_BYTES = 4096
"""What a disk gives to a file at a time, commonly; a small file takes one."""
SOURCE = "export.json"
"""At the top of an export: which release it is of."""


@dataclass(frozen=True)
class Planned:
    """What a format will be made of."""

    exporter: Exporter
    files: tuple[ExportedFile, ...]


def exporters_of(names: Sequence[str], where: str) -> tuple[Exporter, ...]:
    """Each once, in the order of `names`.

    Raises:
        InputError: There is none of a name.
    """
    known = {exporter.name: exporter for exporter in EXPORTERS}
    for name in names:
        if name not in known:
            hint = nearest(name, known)
            raise InputError(where, got=name, allowed=", ".join(known), nearest=hint)
    return tuple(known[name] for name in dict.fromkeys(names))


def open_release(root: Path, runs: str | None) -> Dataset:
    """A release that is as it was released, or those of its runs whose name a pattern matches.

    Raises:
        InputError: It is no release or a damaged one, or no run matches.
    """
    data = load(root)
    if data.metadata is None and data.runs[0].is_rerendered:
        what = "holds pictures of `symolo rerender`, which are no release: they have no specification and no checksums"
        raise InputError(what, where=str(root), cure="export the release that their run is of")
    if data.metadata is None:
        cure = "name the folder of the release, and the run by --runs"
        raise InputError("is one run, which has no checksums to rely on", where=str(root), cure=cure)
    Inventory.of_whole(data.root)
    if runs is None:
        return data
    chosen = tuple(run for run in data.runs if fnmatchcase(run.name, runs))
    if not chosen:
        names = ", ".join(run.name for run in data.runs[:5])
        raise InputError("--runs", got=runs, allowed=f"a pattern of names such as {names}")
    return replace(data, runs=chosen)


def plan(data: Dataset, exporters: Sequence[Exporter], settings: ExportSettings) -> tuple[Planned, ...]:
    """What would be written.

    Raises:
        InputError: The release lacks what a format needs.
    """
    return tuple(Planned(exporter, tuple(exporter.files(data, settings))) for exporter in exporters)


def check_room(planned: Sequence[Planned], out: Path) -> None:
    """Refuse what would fill the disk.

    Raises:
        EnvironmentLacking: There is no room where `out` will be; says what is needed and what is free.
    """
    sizes = (file.room_bytes() for one in planned for file in one.files)
    check_disk(out, sum(-(-size // _BLOCK_BYTES) * _BLOCK_BYTES for size in sizes), "choose runs by --runs")


def export(data: Dataset, planned: Sequence[Planned], out: Path, report: Report) -> int:
    """Write an export, which comes into being at once; the number of its bytes.

    Args:
        data: What `open_release` gave.
        planned: What `plan` gave for it.
        out: New or empty.
        report: Where to tell.

    Raises:
        InputError: There is something at `out`, or a file of the release cannot be read as what it should be.
    """
    check_new(out, data.root)
    with new_folder(out) as partial:
        return _fill(partial, data, planned, report)


def _fill(folder: Path, data: Dataset, planned: Sequence[Planned], report: Report) -> int:
    files = list(_named(planned))
    written = 0
    with report.stage("export", len(files), "files") as stage:
        for number, (name, file) in enumerate(files, start=1):
            content = file.content()
            make_folder((folder / name).parent)
            write_file(folder / name, content)
            written += len(content)
            stage.update("all", number)
    about = _source(data, planned)
    write_file(folder / SOURCE, about)
    return written + len(about)


def _named(planned: Sequence[Planned]) -> Iterator[tuple[str, ExportedFile]]:
    for one in planned:
        yield from ((f"{one.exporter.name}/{file.name}", file) for file in one.files)


def _source(data: Dataset, planned: Sequence[Planned]) -> bytes:
    """Which release, known by the checksum of its checksums, which runs, and what made it."""
    told = data.metadata
    return canonical_json(
        {
            "formats": {one.exporter.name: one.exporter.what for one in planned},
            "licence": told.licence if told else "",
            "made_with": versions("symolo"),
            "manifest_sha256": sha256_of(data.root / MANIFEST),
            "name": told.name if told else data.root.name,
            "runs": [run.name for run in data.runs],
        }
    )
