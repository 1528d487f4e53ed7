"""Tar shards of samples, one for each image, as WebDataset reads them (https://github.com/webdataset/webdataset).

The files of a sample have the same name up to the first dot: `CW/test_1/000001.jpg`, `.json`, `.depth.png`...
"""

import io
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pipeline.exporters.base import ExportedFile, Exporter, ExportSettings
from pipeline.exporters.record import record_of
from pipeline.reader.dataset import Dataset
from pipeline.reader.image import Image

_END_BYTES = 2 * tarfile.BLOCKSIZE


@dataclass(frozen=True)
class _Member:
    """A file in a shard: bytes, or where they lie."""

    name: str
    source: bytes | Path

    @property
    def size(self) -> int:
        return len(self.source) if isinstance(self.source, bytes) else self.source.stat().st_size

    @property
    def content(self) -> bytes:
        return self.source if isinstance(self.source, bytes) else self.source.read_bytes()

    @property
    def head(self) -> bytes:
        """Nothing of the machine, the user or the day."""
        info = tarfile.TarInfo(self.name)
        info.size, info.mode, info.mtime = self.size, 0o644, 0
        return info.tobuf(tarfile.USTAR_FORMAT)

    @property
    def padded(self) -> int:
        """Bytes in the shard."""
        return len(self.head) + -(-self.size // tarfile.BLOCKSIZE) * tarfile.BLOCKSIZE


_Sample = tuple[_Member, ...]


@dataclass(frozen=True)
class _Shard:
    name: str
    samples: tuple[_Sample, ...]

    @property
    def _used(self) -> int:
        return sum(member.padded for sample in self.samples for member in sample) + _END_BYTES

    def size_bytes(self) -> int:
        return -(-self._used // tarfile.RECORDSIZE) * tarfile.RECORDSIZE

    def room_bytes(self) -> int:
        return self.size_bytes()

    def content(self) -> bytes:
        file = io.BytesIO()
        for sample in self.samples:
            for member in sample:
                data = member.content
                file.write(member.head + data + b"\0" * (-len(data) % tarfile.BLOCKSIZE))
        return file.getvalue() + b"\0" * (self.size_bytes() - file.tell())


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    for number, samples in enumerate(_shards(data, settings.shard_bytes)):
        yield _Shard(f"symolo-{number:06d}.tar", samples)


def _shards(data: Dataset, most_bytes: int) -> Iterator[tuple[_Sample, ...]]:
    """Samples in the order of their names; a shard is larger than `most_bytes` only where one sample alone is."""
    room = most_bytes // tarfile.RECORDSIZE * tarfile.RECORDSIZE - _END_BYTES
    samples: list[_Sample] = []
    used = 0
    for image in sorted(data.images, key=_key):
        sample = _sample(image)
        size = sum(member.padded for member in sample)
        if samples and used + size > room:
            yield tuple(samples)
            samples, used = [], 0
        samples.append(sample)
        used += size
    if samples:
        yield tuple(samples)


def _key(image: Image) -> str:
    return f"{image.run.name}/{image.number:06d}"


def _sample(image: Image) -> _Sample:
    key = _key(image)
    members = [_Member(f"{key}.json", record_of(image)), _Member(f"{key}{image.path.suffix}", image.path)]
    for kind in image.run.annotation_pictures:
        path = image.run.annotation_picture(kind, image.number)
        if path.is_file():  # the last image has no flow
            members.append(_Member(f"{key}.{kind}.png", path))
    return tuple(sorted(members, key=lambda member: member.name))


EXPORTER = Exporter(
    "webdataset", "tar shards with a sample for each image: picture, readings, pose, annotations", _files
)
