"""Runs and images of each split, for formats that know splits."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from symolo.arena.fingerprint import arena_fingerprint
from symolo.arena.geometry import Arena
from symolo.core.errors import InputError
from symolo.dataset.documents.splits_record import Grouping, SplitName, SplitsRecord
from symolo.dataset.layout import camera_folder
from symolo.dataset.splits import SplitMember, SplitRule, assign
from symolo.reader.camera_run import CameraRun
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image, RunFolder

OPTION = "--splits"
MAX_FAILED = 5
"""Largest number of failed runs in a message."""

ImagesOfSplits = tuple[tuple[SplitName | None, tuple[Image, ...]], ...]
"""Each split with its images; None for a dataset that is not divided."""


@dataclass(frozen=True)
class FurtherCamera:
    """The images of one further camera in all runs."""

    folder: str
    """Folder in an export, such as `cameras/left`; the camera of data.csv has the folder above it."""
    runs: tuple[CameraRun, ...]
    splits: ImagesOfSplits


def divided(data: Dataset, rule: SplitRule | None) -> Dataset:
    """Return the dataset with splits in place of those of its metadata, or without splits for None.

    Raises:
        InputError: The rule cannot be applied to its runs.
    """
    splits = None
    if rule is not None:
        members = [_member(run, rule.by) for run in data.runs]
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
    for name in data.splits.empty:
        cure = f"choose other splits with {OPTION}, or none with {OPTION} none"
        raise InputError(f"split {name} is empty{_failures(data)}", where=str(data.root), cure=cure)
    splits = data.splits.only(chosen)
    for name in splits.empty:
        what = f"split {name} has no {'images' if splits.by == 'image' else 'runs'} among those that are exported"
        cure = f"choose more runs with --runs, or other splits with {OPTION}, or none with {OPTION} none"
        raise InputError(what, where=str(data.root), cure=cure)
    return _with_splits(data, splits)


def _failures(data: Dataset) -> str:
    """Return the runs that are not in the dataset because they failed, as the end of a sentence."""
    failed = [run.run for run in data.metadata.failed_runs] if data.metadata else []
    more = f" and {len(failed) - MAX_FAILED} more" if len(failed) > MAX_FAILED else ""
    return f": {', '.join(failed[:MAX_FAILED])}{more} failed when the dataset was made" if failed else ""


def _member(run: Run, by: Grouping | None) -> SplitMember:
    """Return the properties of a run; data.csv is read only for the numbers of its images."""
    spec, numbers = run.spec, run.numbers if by == "image" else ()
    arena = arena_fingerprint(Arena.from_config(spec.arena)) if by == "arena" else ""
    return SplitMember(run.name, spec.look.name, spec.robot.name, spec.seed, spec.origin, numbers, arena)


def _with_splits(data: Dataset, splits: SplitsRecord | None) -> Dataset:
    if data.metadata is None:
        raise ValueError("a run alone has no splits")
    return replace(data, metadata=data.metadata.model_copy(update={"splits": splits}))


def runs_of_splits(data: Dataset) -> tuple[tuple[SplitName | None, Dataset], ...]:
    """Return each split with its runs; without splits of runs, None with all runs."""
    if data.splits is None or data.splits.by == "image":
        return ((None, data),)
    return tuple((name, data.split(name)) for name in data.splits.names)


def images_of_splits(data: Dataset) -> ImagesOfSplits:
    """Return each split with its images; without splits, None with all images."""
    if data.splits is None:
        return ((None, data.images),)
    return tuple((name, data.split_images(name)) for name in data.splits.names)


def by_run(images: Iterable[Image]) -> Iterator[tuple[RunFolder, tuple[Image, ...]]]:
    """Yield each run, or its further camera, with its images, which follow each other."""
    for _, group in groupby(images, lambda image: image.run.name):
        run_images = tuple(group)
        yield run_images[0].run, run_images


def further_cameras_of_splits(data: Dataset, annotation: str = "") -> Iterator[FurtherCamera]:
    """Yield the further cameras by name, with their images of each split; splits without an image are left out.

    If images are divided, an image is in the split of the newest image of the camera of data.csv at its time, so that
    images of one instant are in one split.

    Args:
        data: Dataset with or without splits.
        annotation: Kind of annotations that the images must have; cameras without them are left out of a run.
    """
    for name in sorted({name for run in data.runs for name in run.cameras}):
        cameras = [
            (run, run.cameras[name])
            for run in data.runs
            if name in run.cameras and run.cameras[name].numbers and _is_annotated(run.cameras[name], annotation)
        ]
        images_by_split: dict[SplitName | None, list[Image]] = {}
        for run, camera in cameras:
            for split, image in zip(_splits_of(data, run, camera), camera.images, strict=True):
                images_by_split.setdefault(split, []).append(image)
        order: tuple[SplitName | None, ...] = data.splits.names if data.splits else (None,)
        splits: ImagesOfSplits = tuple(
            (split, tuple(images_by_split[split])) for split in order if split in images_by_split
        )
        if splits:
            yield FurtherCamera(camera_folder(name), tuple(camera for _, camera in cameras), splits)


def _is_annotated(camera: CameraRun, annotation: str) -> bool:
    return not annotation or (camera.has_annotations and annotation in camera.annotations.kinds)


def _splits_of(data: Dataset, run: Run, camera: CameraRun) -> list[SplitName | None]:
    """Return the split of each image of a further camera."""
    if data.splits is None:
        return [None] * len(camera.images)
    if data.splits.by != "image":
        return [data.splits.split_by_run.get(run.name)] * len(camera.images)
    split_by_image, times_s = data.splits.split_by_image, [image.t_s for image in run.images]
    newest = np.searchsorted(times_s, [image.t_s + 1e-9 for image in camera.images], side="right") - 1
    return [split_by_image.get((run.name, run.images[index].number)) for index in np.maximum(newest, 0)]
