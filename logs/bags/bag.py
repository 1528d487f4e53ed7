"""A bag as its topics: read by a child process with limits of memory and time."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from logs.bags.streams import INDEX, POSE, PROGRESS, ImageStream, Index, Stream
from symolo.core.arrays import Array
from symolo.core.errors import InputError
from symolo.core.extras import check_installed
from symolo.core.files.npz_file import Numbers, arrays_of
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.progress import Report, StageReport

_MAX_BYTES = 2_000_000_000
"""Maximum size of all numbers of a bag, unpacked."""


@dataclass(frozen=True)
class Topic:
    """The messages of a stream, in the order of time."""

    stream: Stream
    t_s: Array
    """(N,), since the first message of the bag."""
    values: Array
    """(N, columns)."""

    @property
    def is_pose(self) -> bool:
        return self.stream.columns[: len(POSE)] == POSE

    @property
    def frames(self) -> str:
        """Name of a transform, such as `map:base_link`."""
        return f"{self.stream.parent}:{self.stream.child}"

    def column(self, name: str) -> Array:
        return self.values[:, self.stream.columns.index(name)]


@dataclass(frozen=True)
class ImageTopic:
    """The images of a topic, in the order of time."""

    topic: str
    type: str
    frame: str
    problem: str
    """Why they are not taken; empty where they are."""
    t_s: Array
    """(N,), since the first message of the bag."""
    files: tuple[bytes, ...]
    """(N,), JPEG or PNG files that have not been decoded yet."""


@dataclass(frozen=True)
class Bag:
    """The topics of a bag whose messages are read."""

    path: Path
    topics: tuple[Topic, ...]
    images: tuple[ImageTopic, ...]
    left_out: Mapping[str, str]
    """Type of each topic that is not read."""


def read_bag(path: Path, report: Report | None = None) -> Bag:
    """Read all topics of numbers of a bag, and report the progress.

    Raises:
        InputError: It is no bag, or needs too much memory or time.
        EnvironmentLacking: The library that reads bags is not installed.
    """
    check_installed("rosbags")
    with scratch_folder() as scratch:
        out = scratch / "topics.npz"
        command = [sys.executable, "-P", "-m", "logs.bags.child", str(path.absolute()), str(out)]
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        last, code = _last_line(command, environment, path, report)
        try:
            index = INDEX.validate_json(last)
        except ValidationError:
            last = last or (f"signal {-code}" if code < 0 else f"exit code {code}")
            cure = "record or filter the bag again with the topics of the robot alone"
            raise InputError(f"takes too long to read or ends its reader: {last}", where=str(path), cure=cure) from None
        return bag_of(path, index, out)


def _last_line(
    command: Sequence[str], environment: Mapping[str, str], path: Path, report: Report | None
) -> tuple[str, int]:
    """Run the child and report its progress; return the last other line that it printed, and its exit code."""
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, "errors": "replace"}
    last = ""
    with subprocess.Popen(command, env=environment, **streams) as child, ExitStack() as stack:
        stack.callback(child.kill)  # if the command is interrupted; a child that has ended is not touched
        stage: StageReport | None = None
        for line in child.stdout or ():
            if not line.startswith(f"{PROGRESS} "):
                last = line.strip() or last
                continue
            done, total = map(int, line.split()[1:])
            if stage is None and report is not None:
                stage = stack.enter_context(report.stage(f"read {path.name}", total, "messages"))
            if stage is not None:
                stage.update("all", done)
        return last, child.wait()


def bag_of(path: Path, index: Index, out: Path) -> Bag:
    """Return the bag at `path` from the index that the child printed and the numbers that it wrote to `out`.

    Raises:
        InputError: The child could not read the bag.
    """
    if index.error:
        raise InputError(index.error, where=str(path))
    arrays = arrays_of(read_file(out, FileKind.ANY), _MAX_BYTES)
    times = [array for name, array in arrays.items() if name.startswith(("t", "image_t")) and array.size]
    first_ns = min((array.min() for array in times), default=0)
    topics = []
    for i, stream in enumerate(index.streams):
        order = np.argsort(arrays[f"t{i}"], kind="stable")
        t_s = 1e-9 * (arrays[f"t{i}"][order] - first_ns)
        topics.append(Topic(stream, t_s, arrays[f"v{i}"][order].reshape(len(t_s), -1)))
    images = tuple(
        _images(stream, arrays[f"image_t{i}"], arrays[f"image_n{i}"], arrays[f"image_v{i}"], first_ns)
        for i, stream in enumerate(index.images)
    )
    return Bag(path, tuple(topics), images, index.left_out)


def _images(stream: ImageStream, t_ns: Numbers, sizes: Numbers, data: Numbers, first_ns: int) -> ImageTopic:
    ends, content = np.cumsum(sizes).tolist(), data.tobytes()
    files = [content[end - size : end] for end, size in zip(ends, sizes.tolist(), strict=True)]
    order = np.argsort(t_ns, kind="stable")
    t_s = 1e-9 * (t_ns[order] - first_ns)
    return ImageTopic(
        stream.topic, stream.type, stream.frame, stream.problem, t_s, tuple(files[number] for number in order)
    )
