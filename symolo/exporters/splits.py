"""Runs and images of each split, for formats that know splits."""

from dataclasses import replace

from symolo.core.errors import InputError
from symolo.dataset.documents.splits_record import SplitName, SplitsRecord
from symolo.dataset.splits import SplitMember, SplitRule, assign
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image

OPTION = "--splits"


def divided(data: Dataset, rule: SplitRule | None) -> Dataset:
    """Return the dataset with splits in place of those of its metadata, or without splits for None.

    Raises:
        InputError: The rule cannot be applied to its runs.
    """
    splits = None
    if rule is not None:
        members = [_member(run, has_images=rule.by == "image") for run in data.runs]
        splits = assign(rule, members, OPTION)
    return _with_splits(data, splits)


def check_splits(data: Dataset) -> Dataset:
    """Return the dataset with the splits of only its runs.

    Raises:
        InputError: A split has no run, because the run failed or was not chosen with `--runs`.
    """
    if data.splits is None:
        return data
    chosen = {run.name for run in data.runs}
    splits = data.splits.only(chosen)
    for name in splits.names:
        if not splits.runs.get(name) and not any(splits.images.get(name, {}).values()):
            what = f"split {name} has no {'images' if splits.by == 'image' else 'runs'} among those that are exported"
            cure = f"choose more runs with --runs, or other splits with {OPTION}, or none with {OPTION} none"
            raise InputError(what, where=str(data.root), cure=cure)
    return _with_splits(data, splits)


def _member(run: Run, *, has_images: bool) -> SplitMember:
    """Return the properties of a run; data.csv is read only for the numbers of its images."""
    spec, numbers = run.spec, run.numbers if has_images else ()
    return SplitMember(run.name, spec.look.name, spec.robot.name, spec.seed, spec.origin, numbers)


def _with_splits(data: Dataset, splits: SplitsRecord | None) -> Dataset:
    if data.metadata is None:
        raise ValueError("a run alone has no splits")
    return replace(data, metadata=data.metadata.model_copy(update={"splits": splits}))


def runs_of_splits(data: Dataset) -> tuple[tuple[SplitName | None, Dataset], ...]:
    """Return each split with its runs; without splits of runs, None with all runs."""
    if data.splits is None or data.splits.by == "image":
        return ((None, data),)
    return tuple((name, data.split(name)) for name in data.splits.names)


def images_of_splits(data: Dataset) -> tuple[tuple[SplitName | None, tuple[Image, ...]], ...]:
    """Return each split with its images; without splits, None with all images."""
    if data.splits is None:
        return ((None, data.images),)
    return tuple((name, data.split_images(name)) for name in data.splits.names)
