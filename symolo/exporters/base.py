"""An exporter converts a release to a format: it lists the files, and makes each one when it is written."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from symolo.core.errors import InputError
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.annotations import AnnotationName
from symolo.reader.camera_run import CameraRun
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image, how_to_add


@dataclass(frozen=True)
class ExportedFile:
    """One file of an export; the same release gives the same bytes."""

    name: str
    """Path within the folder of the format."""
    content: Callable[[], bytes]
    """Function that returns the bytes of the file."""
    estimated_bytes: Callable[[], int] | None = None
    """Function that returns the approximate size, for a file that takes long to make."""
    exact_bytes: Callable[[], int] | None = None
    """Function that returns the exact size, if it is known without the content."""

    def size_bytes(self) -> int:
        """Return the exact size; if there is no other way to know it, make the file."""
        return self.exact_bytes() if self.exact_bytes else len(self.content())

    def room_bytes(self) -> int:
        """Return the estimated size if there is one, otherwise the exact size."""
        return self.estimated_bytes() if self.estimated_bytes else self.size_bytes()


def copied_file(name: str, source: Path) -> ExportedFile:
    """Return a file of the release under another name."""
    return ExportedFile(name, lambda: read_file(source, FileKind.ANY), exact_bytes=lambda: source.stat().st_size)


def check_images(data: Dataset, name: str) -> None:
    """Refuse a run without images of any camera, for formats whose entries are images.

    Args:
        data: The release.
        name: Name of the format.

    Raises:
        InputError: A run has no images.
    """
    for run in data.runs:
        if not run.numbers and not any(camera.numbers for camera in run.cameras.values()):
            cure = (
                "render its trajectory with `symolo rerender`, choose other runs with --runs, or leave out this format"
            )
            raise InputError(f"format {name}: run {run.name} has no images", where=str(data.root), cure=cure)


def check_labelled(data: Dataset, name: str, kind: AnnotationName, what: str) -> None:
    """Refuse a run whose images have no annotations of a kind, for formats whose entries are labels.

    Args:
        data: The release.
        name: Name of the format.
        kind: The kind of annotations.
        what: Noun for the content of the annotations.

    Raises:
        InputError: A run has no images, or no such annotations.
    """
    check_images(data, name)
    for run in data.runs:
        if not run.numbers:
            text = f"the images of run {run.name} were recorded, and nobody has labelled them"
            cure = f"render labelled ones: `symolo rerender {data.root} --look lab --set render.annotations=[{kind}]`"
            raise InputError(text, where=str(data.root), cure=cure)
        if not run.has_annotations or kind not in run.annotations.kinds:
            text = f"run {run.name} has no annotations of the kind `{kind}`, which give the {what}"
            raise InputError(text, where=str(data.root), cure=how_to_add(f"`{kind}`"))


def run_of(image: Image) -> dict[str, str]:
    """Return the name of the run of an image, and that of its camera if it is a further one."""
    if isinstance(image.run, CameraRun):
        return {"run": image.run.whole.name, "camera": image.run.camera_name}
    return {"run": image.run.name}


def image_bytes(images: Iterable[Image]) -> int:
    """Return the size of the files of some images, without their annotations."""
    return sum(image.path.stat().st_size for image in images)


@dataclass(frozen=True)
class ExportSettings:
    """Options of `symolo export` that the formats use."""

    shard_bytes: int
    """Largest size of a shard, for formats that have shards."""
    video: bool = False
    """Whether lerobot has the images as videos."""
    polygons: bool = False
    """Whether yolo has polygons of masks in the place of boxes."""


@dataclass(frozen=True)
class Exporter:
    """A format of `symolo export`."""

    name: str
    """Name of the format for `--format`, and name of its output folder."""
    what: str
    """Description of the output in one line."""
    files: Callable[[Dataset, ExportSettings], Iterable[ExportedFile]]
    """Function that lists all files before one is written; it raises InputError if the release lacks what it needs."""
    warnings: Callable[[Dataset], Iterable[str]] = lambda _data: ()
    """Function that lists what readers of the format do not expect in the output; called after `files`."""
