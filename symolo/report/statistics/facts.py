"""All facts of a release that the page shows, gathered before the page is written."""

import hashlib
from dataclasses import dataclass

from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import Report
from symolo.dataset.documents.metadata import Metadata
from symolo.dataset.manifest import MANIFEST, read_manifest
from symolo.reader.balance import Balance, balance
from symolo.reader.dataset import Dataset
from symolo.report.statistics.image_statistics import ImageNumbers, image_numbers
from symolo.report.statistics.outliers import OutlierGroup, outliers
from symolo.report.statistics.run_facts import RunFacts, run_facts
from symolo.report.statistics.spread import spread

MAX_PATHS = 60
"""Paths on all maps together."""


@dataclass(frozen=True)
class ReleaseFacts:
    """The facts of a release that its page shows."""

    metadata: Metadata
    runs: tuple[RunFacts, ...]
    """The selected runs, in the order of the release."""
    images: tuple[ImageNumbers, ...]
    """Statistics of the images of each run that has images."""
    outliers: tuple[OutlierGroup, ...]
    balance: Balance | None
    """Content of training, validation and test; None if the release is not divided."""
    detailed: tuple[str, ...]
    """Names of the runs that are shown in detail."""
    files: int
    """Number of files of the whole release; 0 for runs that are not released."""
    size_bytes: int
    """Size of the whole release; 0 for runs that are not released."""
    manifest_sha256: str
    """Empty for runs that are not released."""

    @property
    def is_released(self) -> bool:
        return bool(self.manifest_sha256)


def release_facts(data: Dataset, metadata: Metadata, max_detailed: int, report: Report) -> ReleaseFacts:
    """Read every table and every image, one run and one image at a time.

    Raises:
        InputError: A file is missing or is not what it should be.
    """
    records = {record.run: record for record in metadata.runs}
    on_map = {run.name for run in spread(data.runs, MAX_PATHS)}
    facts, images = [], []
    image_count = sum(records[run.name].images for run in data.runs)
    # Without images of data.csv, as in an imported log, the tables are all the work.
    total, unit = (image_count, "images") if image_count else (len(data.runs), "runs")
    with report.stage("report", total, unit) as stage:
        for run in data.runs:
            one = run_facts(run, records[run.name], with_path=run.name in on_map)
            facts.append(one)
            if one.images:
                images.append(image_numbers(run, lambda done, name=run.name: stage.update(name, done)))
            elif not image_count:
                stage.update(run.name, 1)
    manifest = read_file(data.root / MANIFEST, FileKind.CHECKSUMS) if (data.root / MANIFEST).is_file() else b""
    sizes = [(data.root / name).stat().st_size for name in read_manifest(manifest)] if manifest else []
    return ReleaseFacts(
        metadata=metadata,
        runs=tuple(facts),
        images=tuple(images),
        outliers=outliers(images) if images else (),
        balance=_balance(data, report) if data.splits else None,
        detailed=tuple(run.name for run in spread(data.runs, max_detailed)),
        files=len(sizes),
        size_bytes=sum(sizes),
        manifest_sha256=hashlib.sha256(manifest).hexdigest() if manifest else "",
    )


def _balance(data: Dataset, report: Report) -> Balance | None:
    with report.stage("splits", len(data.images), "images") as stage:
        return balance(data, lambda done: stage.update("all", done))
