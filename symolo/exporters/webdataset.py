"""Tar shards for WebDataset (https://github.com/webdataset/webdataset), with one sample for each image.

The files of a sample have the same name up to the first dot: `CW/test_1/000001.jpg`, `.json`, `.depth.png`...
The writer of webdataset 1.0.2 is not used: it starts a new shard only after the limit is exceeded, it knows the size
of a shard only after writing it, and the shards of `symolo pack` need our tar files anyway.
"""

from collections.abc import Iterator

from symolo.core.files.tar_files import Member, shards, tar_bytes, tar_chunks
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_images
from symolo.exporters.shared.labels import label_files
from symolo.exporters.shared.record import record_of
from symolo.exporters.shared.splits import ImagesOfSplits, further_cameras_of_splits, images_of_splits
from symolo.reader.dataset import Dataset
from symolo.reader.run_folder import Image


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    """Yield the shards, with samples sorted by name; only a shard with a single sample may be larger than the limit."""
    check_images(data, "webdataset")
    yield from label_files(data)
    yield from _shards("", images_of_splits(data), settings)
    for camera in further_cameras_of_splits(data):
        yield from _shards(f"{camera.folder}/", camera.splits, settings)


def _shards(folder: str, splits: ImagesOfSplits, settings: ExportSettings) -> Iterator[ExportedFile]:
    for split, images in splits:
        samples = (_sample(image) for image in sorted(images, key=_key))
        for number, members in enumerate(shards(samples, settings.shard_bytes)):
            yield ExportedFile(
                folder + "-".join(("symolo", *([split] if split else []), f"{number:06d}.tar")),
                lambda members=members: b"".join(tar_chunks(members)),
                exact_bytes=lambda members=members: tar_bytes(members),
            )


def _key(image: Image) -> str:
    return f"{image.run.name}/{image.number:06d}"


def _sample(image: Image) -> tuple[Member, ...]:
    key = _key(image)
    members = [Member(f"{key}.json", record_of(image)), Member(f"{key}{image.path.suffix}", image.path)]
    members += [Member(f"{key}.{kind}.png", path) for kind, path in image.annotation_files.items()]
    return tuple(sorted(members, key=lambda member: member.name))


EXPORTER = Exporter("webdataset", "tar shards with a sample for each image: image, readings, pose, annotations", _files)
