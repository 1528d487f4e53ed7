"""A released dataset or one run of it, for users and exporters."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path

import pandas as pd
from pydantic import ValidationError

from symolo.core.errors import InputError, nearest
from symolo.core.files.paths import check_folder
from symolo.core.files.plain_files import FileKind, check_folders, read_file
from symolo.core.progress import plural
from symolo.dataset.bag import DECLARATION
from symolo.dataset.documents.metadata import METADATA, Metadata, read_metadata
from symolo.dataset.documents.splits_record import SplitsRecord
from symolo.dataset.folder_kind import NAME_DATASET
from symolo.dataset.layout import DATA, SIDE, SPEC
from symolo.dataset.tables.side_reading import first_fault
from symolo.publishing.bagging import PAYLOAD
from symolo.reader.run import Run
from symolo.reader.run_folder import Image

RUN = "run"
"""The column that `Dataset.rows` has beside those of data.csv."""


@dataclass(frozen=True)
class Dataset:
    """The runs of a release, or a single run, with their metadata; nothing is read before it is used."""

    root: Path
    """The folder that holds metadata.json, or that of the one run."""
    metadata: Metadata | None
    """Content of metadata.json; None for a run that was named by its own folder."""
    runs: tuple[Run, ...]
    failures: Mapping[str, str] = field(default_factory=dict)
    """Why a run failed, by its name: runs that are not released yet are loaded with those that failed."""

    def __repr__(self) -> str:
        return f"Dataset({str(self.root)!r}, {plural(len(self.runs), 'run')})"

    def __getitem__(self, name: str) -> Run:
        """Return a run by its name.

        Raises:
            InputError: There is none of this name.
        """
        named = next((run for run in self.runs if run.name == name), None)
        if named is None:
            names = [run.name for run in self.runs]
            allowed = ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
            hint = nearest(name, names)
            raise InputError(f"has no run {name}", where=str(self.root), allowed=allowed, nearest=hint)
        return named

    def __iter__(self) -> Iterator[Run]:
        return iter(self.runs)

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.runs)

    def matching(self, pattern: str | None) -> "Dataset":
        """Return the dataset with only the runs whose name matches a pattern such as `CW/*`; with all for None.

        Raises:
            InputError: No run matches.
        """
        if pattern is None:
            return self
        runs = tuple(run for run in self.runs if fnmatchcase(run.name, pattern))
        if not runs:
            names = ", ".join(run.name for run in self.runs[:5])
            raise InputError("no run matches", got=pattern, allowed=f"a pattern of names such as {names}")
        return replace(self, runs=runs)

    @property
    def title(self) -> str:
        """Name of the dataset; of a single run that of its scenario, and of other runs that of the folder."""
        if self.metadata:
            return self.metadata.name
        is_run = [run.folder for run in self.runs] == [self.root] and (self.root / SIDE / SPEC).is_file()
        return self.runs[0].spec.scenario if is_run else self.root.absolute().name

    @property
    def splits(self) -> SplitsRecord | None:
        """Division into training, validation and test; None if the dataset is not divided."""
        return self.metadata.splits if self.metadata else None

    def split(self, name: str) -> "Dataset":
        """Return the dataset with only the runs of a split: `train`, `validation` or `test`.

        Raises:
            InputError: There is no such split, it has no runs, or the splits divide runs.
        """
        splits = self._with_split(name)
        if splits.by == "image":
            what, cure = "is divided by image, so its runs are in no split", "take `split_images`"
            raise InputError(what, where=str(self.root), cure=cure)
        split_by_run = splits.split_by_run
        runs = tuple(run for run in self.runs if split_by_run.get(run.name) == name)
        if not runs:
            raise InputError(f"split {name} has no runs", where=str(self.root), cure="choose another split")
        return replace(self, runs=runs)

    def split_images(self, name: str) -> tuple[Image, ...]:
        """Return the images of a split, `train`, `validation` or `test`; no file is opened.

        Raises:
            InputError: There is no such split.
        """
        splits = self._with_split(name)
        if splits.by == "image":
            split_by_image = splits.split_by_image
            return tuple(image for image in self.images if split_by_image.get((image.run.name, image.number)) == name)
        split_by_run = splits.split_by_run
        return tuple(image for run in self.runs if split_by_run.get(run.name) == name for image in run.images)

    def _with_split(self, name: str) -> SplitsRecord:
        """Return the splits, among which is this one."""
        if self.splits is None:
            cure = "set `splits` in its scenario and repeat `symolo release` with the same --out"
            raise InputError("is not divided into splits", where=str(self.root), cure=cure)
        if name not in self.splits.names:
            names = self.splits.names
            hint = nearest(name, names)
            raise InputError(f"has no split {name}", where=str(self.root), allowed=", ".join(names), nearest=hint)
        return self.splits

    @property
    def rows(self) -> pd.DataFrame:
        """The rows of all runs under each other, with the name of the run in the column `run`."""
        tables = [run.rows for run in self.runs]
        stacked = pd.concat(tables, ignore_index=True)
        stacked.insert(
            0, RUN, [run.name for run, table in zip(self.runs, tables, strict=True) for _ in range(len(table))]
        )
        stacked.attrs = tables[0].attrs | {"units": {RUN: "-"} | tables[0].attrs["units"]}
        return stacked

    @property
    def images(self) -> tuple[Image, ...]:
        """Images of all runs; no file is opened."""
        return tuple(image for run in self.runs for image in run.images)


def load(path: str | Path) -> Dataset:
    """Load a release, a bag that holds one, or the folder of one run.

    Each file is read when it is needed, and is checked strictly; `symolo verify` checks the checksums.

    Raises:
        InputError: `path` is none of these, metadata.json is damaged, or a run that it names is missing.
    """
    root = Path(path)
    check_folder(root, NAME_DATASET)
    if (root / DECLARATION).is_file():
        check_folders(root, PAYLOAD)
        root /= PAYLOAD
    if (root / METADATA).is_file():
        metadata = _metadata(root / METADATA)
        names = [record.run for record in metadata.runs]
        if twice := [name for name, count in Counter(names).items() if count > 1]:
            raise InputError(f"names the run {twice[0]} twice", where=str(root / METADATA), cure="see `symolo repair`")
        return Dataset(root, metadata, tuple(_run(root, name, metadata) for name in names))
    if (root / DATA).is_file():
        check_folders(root, "")
        absolute = root.absolute()
        name = f"{absolute.parent.name}/{absolute.name}"
        release = read_metadata(absolute.parents[1])
        is_released = release is not None and any(record.run == name for record in release.runs)
        return Dataset(root, None, (Run(root, name, release.sensor_tables if release and is_released else ()),))
    what = f"is neither a release nor a run: there is no {METADATA} and no {DATA} in it"
    raise InputError(what, where=str(root), cure="name a folder that `symolo release` made, or a run's within it")


def _metadata(path: Path) -> Metadata:
    try:
        return Metadata.model_validate_json(read_file(path, FileKind.DOCUMENT))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", where=str(path)) from None
    except ValidationError as error:
        raise InputError(f"is damaged: {first_fault(error)}", where=str(path), cure="see `symolo repair`") from None


def _run(root: Path, name: str, metadata: Metadata) -> Run:
    if name.startswith("/") or ".." in name.split("/"):
        raise InputError(f"run {name} leads out of the dataset", where=str(root / METADATA))
    check_folders(root, name)
    run = Run(root / name, name, metadata.sensor_tables)
    if not (run.folder / DATA).is_file():
        cure = "see `symolo verify` and `symolo repair`"
        raise InputError(f"is missing, and {METADATA} names the run", where=str(run.folder / DATA), cure=cure)
    return run
