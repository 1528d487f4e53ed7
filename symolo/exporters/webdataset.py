"""Tar shards of samples, one for each image, as WebDataset reads them (https://github.com/webdataset/webdataset).

The files of a sample have the same name up to the first dot: `CW/test_1/000001.jpg`, `.json`, `.depth.png`...
"""

from collections.abc import Iterator
from dataclasses import dataclass

from symolo.core.files.tar_files import Member, shards, tar_bytes, tar_chunks
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings
from symolo.exporters.record import record_of
from symolo.reader.dataset import Dataset
from symolo.reader.run import Image


@dataclass(frozen=True)
class _Shard:
    name: str
    members: tuple[Member, ...]

    def size_bytes(self) -> int:
        return tar_bytes(self.members)

    def room_bytes(self) -> int:
        return self.size_bytes()

    def content(self) -> bytes:
        return b"".join(tar_chunks(self.members))


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    """Samples in the order of their names; a shard is larger than asked for only where one sample alone is."""
    samples = (_sample(image) for image in sorted(data.images, key=_key))
    for number, members in enumerate(shards(samples, settings.shard_bytes)):
        yield _Shard(f"symolo-{number:06d}.tar", members)


def _key(image: Image) -> str:
    return f"{image.run.name}/{image.number:06d}"


def _sample(image: Image) -> tuple[Member, ...]:
    key = _key(image)
    members = [Member(f"{key}.json", record_of(image)), Member(f"{key}{image.path.suffix}", image.path)]
    for kind in image.run.annotation_pictures:
        path = image.run.annotation_picture(kind, image.number)
        if path.is_file():  # the last image has no flow
            members.append(Member(f"{key}.{kind}.png", path))
    return tuple(sorted(members, key=lambda member: member.name))


EXPORTER = Exporter(
    "webdataset", "tar shards with a sample for each image: picture, readings, pose, annotations", _files
)
