"""A release in other formats, all of them derived from it alone: `OUT/<format>/`, and what they were made from."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path

from configs.errors import InputError, nearest
from configs.whole_files import make_folder, remove_folder, replace_folder, write_file
from pipeline import output
from pipeline.dataset.inventory import Inventory
from pipeline.dataset.manifest import MANIFEST
from pipeline.exporters import EXPORTERS
from pipeline.exporters.base import ExportedFile, Exporter, ExportSettings
from pipeline.files import canonical_json, sha256_of
from pipeline.progress import Report
from pipeline.reader.dataset import Dataset, load
from pipeline.versions import versions

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


def check_new(out: Path, data: Dataset) -> None:
    """Refuse a place that is taken, or that would make the release another one.

    Raises:
        InputError: There is something, or it lies within the release.
    """
    output.check_new(out)
    if out.resolve().is_relative_to(data.root.resolve()):
        raise InputError("lies within the release", where=f"--out {out}", cure="name a folder beside it")


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
    check_new(out, data)
    place = out.resolve()
    partial = place.with_name(f".{place.name}.export")
    remove_folder(partial)
    try:
        written = _fill(partial, data, planned, report)
        replace_folder(partial, place)
    except BaseException:
        remove_folder(partial)
        raise
    return written


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
