"""A dataset of LeRobot (https://huggingface.co/docs/lerobot/lerobot-dataset-v3): one episode per run.

Each image is a frame, of the type `image`: the Parquet files contain the unchanged bytes of the image files. On request
it is of the type `video`. The writer of lerobot 0.4.4 is not used: it needs torch, diffusers, wandb and a rerun-sdk
that needs numpy 2, with which Blender's module does not load.
"""

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
import pandas as pd

from symolo.core.batches import batches
from symolo.core.errors import InputError
from symolo.core.extras import optional_module
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.plain_files import FileKind, read_file
from symolo.dataset.tables.rows import LINE, RANGES
from symolo.dataset.tables.sensor_tables import LOGGED
from symolo.dataset.tables.side_tables import WHEELS
from symolo.exporters.base import ExportedFile, Exporter, ExportSettings, check_images, image_bytes
from symolo.exporters.lerobot.frames import image_hz, images_of_frames
from symolo.exporters.lerobot.stats import Levels, Stats, vector_stats
from symolo.exporters.lerobot.video import check_video, video_bytes, video_info
from symolo.exporters.shared.features import Feature, image_file, parquet_bytes, value, vector
from symolo.exporters.shared.hub_card import hub_card
from symolo.exporters.shared.splits import OPTION, runs_of_splits
from symolo.exporters.shared.stereo import first_camera
from symolo.reader.camera_run import CameraRun
from symolo.reader.dataset import Dataset
from symolo.reader.run import Run
from symolo.reader.run_folder import Image, RunFolder
from symolo.reader.sensor import RunSensor

_VERSION = "v3.0"
_IMAGES = "observation.images."
_FRONT, _STATE, _ACTION, _POSE = f"{_IMAGES}front", "observation.state", "action", "pose"
"""Names of features; the pose is not an observation, since policies must not see the true pose."""
_WHEEL_NAMES = ("speed_right", "speed_left")
_READINGS = (*RANGES.columns, *LINE.columns)
_BODY_SPEEDS = ("v", "w")
"""Columns of data.csv in the state of a run whose wheels were not logged."""
_COUNTS = ("frame_index", "episode_index", "index", "task_index")
_FRONT_MATTER = (
    "task_categories:",
    "- robotics",
    "tags:",
    "- LeRobot",
    "configs:",
    "- config_name: default",
    "  data_files: data/*/*.parquet",
)
"""Lines by which the Hugging Face Hub recognises a dataset of LeRobot."""
_FILES_PER_CHUNK = 1000
_FRAMES_PER_GROUP = 100
_STATS_BYTES = 10_000
"""Approximate size of the statistics of an episode."""
_DATA_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_VIDEO_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"


@dataclass(frozen=True)
class _Episode:
    run: Run
    index: int
    first: int
    """Index of the first frame among the frames of all episodes."""
    task_index: int
    exact_hz: int | None = None
    """Rate whose periods the times are exactly, as frames of a video are; None for the times of the images."""

    def __len__(self) -> int:
        return len(self._taken)

    @cached_property
    def _camera(self) -> RunFolder:
        """The camera whose images are the frames."""
        return first_camera(self.run)

    @cached_property
    def _taken(self) -> tuple[Image, ...]:
        return images_of_frames(self.run)

    @cached_property
    def vectors(self) -> dict[str, tuple[str, ...]]:
        """Components of state, action and pose by the name of the feature; without wheels there is no action."""
        columns = self.run.table.columns
        has_wheels = WHEELS.name in self.run.side_names
        speeds = _WHEEL_NAMES if has_wheels else tuple(name for name in _BODY_SPEEDS if name in columns)
        state = (*speeds, *(column.name for column in _READINGS if column.name in columns), *self._sensor_names)
        action = {_ACTION: _WHEEL_NAMES} if has_wheels else {}
        return {**({_STATE: state} if state else {}), **action, _POSE: ("x", "y", "theta")}

    @cached_property
    def images(self) -> dict[str, tuple[Image, ...]]:
        """The image of each frame by the name of the feature; of the other cameras the newest that was delivered."""
        frame_key = f"{_IMAGES}{self._camera.camera_name}" if isinstance(self._camera, CameraRun) else _FRONT
        images = {frame_key: self._taken}
        for name, camera in self.run.cameras.items():
            if camera is self._camera or not camera.numbers:
                continue
            feature, taken = f"{_IMAGES}{name}", camera.images
            feature += "_further" if feature == _FRONT else ""
            images[feature] = tuple(taken[i] for i in camera.delivered(self._stamps_s).tolist())
        return images

    @property
    def features(self) -> tuple[object, ...]:
        """What all episodes must have in common."""
        sizes = {name: (one[0].run.camera.height_px, one[0].run.camera.width_px) for name, one in self.images.items()}
        return sizes, self.vectors

    @cached_property
    def size_bytes(self) -> int:
        """Size of the images of all frames."""
        return sum(map(image_bytes, self.images.values()))

    @cached_property
    def _stamps_s(self) -> np.ndarray:
        return np.array([image.t_s for image in self._taken])

    @property
    def _sensors(self) -> list[RunSensor]:
        """Sensors of `robot.sensors`; tables of an imported log may have gaps, which no state may have."""
        return [sensor for sensor in self.run.sensors.values() if sensor.kind != LOGGED]

    @property
    def _sensor_names(self) -> tuple[str, ...]:
        return tuple(f"{sensor.name}.{cell.name}" for sensor in self._sensors for cell in sensor.side_table.cells[1:])

    @cached_property
    def numbers(self) -> dict[str, np.ndarray]:
        """All features except the images, (frames,) or (frames, components)."""
        rows = self._camera.image_rows.iloc[[image.index for image in self._taken]].reset_index(drop=True)
        vectors = {}
        if _ACTION in self.vectors:
            at = np.searchsorted(self.run.t_s, self._stamps_s, side="right") - 1
            drive, wheels = self.run.spec.robot.drive, self.run.side("wheels").iloc[at]
            rows[[*_WHEEL_NAMES]] = wheels[["speed_r", "speed_l"]].to_numpy()
            v_m_s, w_rad_s = (wheels[f"command_{one}"].to_numpy() for one in "vw")
            turn_m_s = 0.5 * drive.track_m * w_rad_s
            commanded_m_s = np.column_stack((v_m_s + turn_m_s, v_m_s - turn_m_s))  # right and left wheel
            vectors[_ACTION] = (commanded_m_s / (0.5 * drive.wheel_diameter_m)).astype(np.float32)
        named = {
            name: [one for one in self.vectors[name] if one in rows] for name in (_STATE, _POSE) if name in self.vectors
        }
        vectors |= {name: rows[names].to_numpy(np.float32) for name, names in named.items()}
        if further := [sensor.numbers[sensor.delivered(self._stamps_s), 1:] for sensor in self._sensors]:
            vectors[_STATE] = np.column_stack((vectors[_STATE], *further)).astype(np.float32)
        vectors = {name: vectors[name] for name in self.vectors}
        count = np.arange(len(self))
        hz = image_hz(self.run) if isinstance(self._camera, CameraRun) else self.exact_hz
        times_s = count / hz if hz else self._stamps_s - self._stamps_s[0]
        vectors["timestamp"] = times_s.astype(np.float32)
        counts = (count, np.full_like(count, self.index), self.first + count, np.full_like(count, self.task_index))
        return vectors | {name: one.astype(np.int64) for name, one in zip(_COUNTS, counts, strict=True)}

    @cached_property
    def levels(self) -> dict[str, Levels]:
        """Levels of all frames by the name of the feature."""
        return {name: Levels.from_images(image.pixels() for image in images) for name, images in self.images.items()}


@dataclass(frozen=True)
class _Plan:
    """All contents of the export except the images."""

    data: Dataset
    tasks: tuple[str, ...]
    files: tuple[tuple[_Episode, ...], ...]
    """Episodes of each file of frames; each episode is in one file."""
    max_bytes: int
    video: bool = False
    """Whether the images are in videos, one beside each file of frames."""

    @property
    def episodes(self) -> tuple[_Episode, ...]:
        return tuple(one for file in self.files for one in file)


def _files(data: Dataset, settings: ExportSettings) -> Iterator[ExportedFile]:
    optional_module("pyarrow")
    plan = _plan(data, settings.shard_bytes, video=settings.video)
    yield ExportedFile("README.md", lambda: hub_card(data, _FRONT_MATTER))
    yield ExportedFile("meta/info.json", lambda: canonical_json(_info(plan)))
    yield ExportedFile("meta/stats.json", lambda: canonical_json(_stats(plan.episodes)), lambda: _STATS_BYTES)
    yield ExportedFile("meta/tasks.parquet", lambda: _tasks(plan))
    estimated_bytes = _STATS_BYTES * len(plan.episodes)
    yield ExportedFile(f"meta/episodes/{_data_file(0)}", lambda: _episodes(plan), lambda: estimated_bytes)
    for number, episodes in enumerate(plan.files):
        size = sum(one.size_bytes for one in episodes)
        name = f"data/{_data_file(number)}"
        if not plan.video:
            yield ExportedFile(name, lambda episodes=episodes: _frames(episodes), lambda size=size: size)
            continue
        yield ExportedFile(name, lambda episodes=episodes: _frames(episodes, with_images=False))
        hz = image_hz(data.runs[0])
        for feature in episodes[0].images:
            images = [image for one in episodes for image in one.images[feature]]
            size = image_bytes(images)  # H.264 of this quality is no larger than the JPEG files.
            place = _video_file(feature, number)
            yield ExportedFile(place, lambda images=images, hz=hz: video_bytes(images, hz), lambda size=size: size)


def _plan(data: Dataset, max_bytes: int, *, video: bool) -> _Plan:
    check_images(data, "lerobot")
    first_hz = image_hz(data.runs[0])
    for run in data.runs:
        if image_hz(run) != first_hz:
            what, cure = "has a different camera rate than the first run", "export them separately with --runs"
            raise InputError(what, where=str(run.folder), cure=cure)
    names = tuple(dict.fromkeys(_task(run) for run in data.runs))
    runs = [run for _, part in _splits(data) for run in part.runs]
    episodes: list[_Episode] = []
    for run in runs:
        first = episodes[-1].first + len(episodes[-1]) if episodes else 0
        episodes.append(_Episode(run, len(episodes), first, names.index(_task(run)), first_hz if video else None))
    for episode in episodes:
        if episode.features != episodes[0].features:
            what, cure = "has other cameras or readings than the first run", "export them separately with --runs"
            raise InputError(what, where=str(episode.run.folder), cure=cure)
    if video:
        for name in episodes[0].images:
            check_video([episode.images[name][0].run for episode in episodes])
    files = batches(episodes, lambda episode: episode.size_bytes, max_bytes)
    return _Plan(data, names, tuple(files), max_bytes, video)


def _splits(data: Dataset) -> tuple[tuple[str, Dataset], ...]:
    """Return the splits in their order: LeRobot stores each as a range of episodes.

    Raises:
        InputError: The dataset is divided by image.
    """
    if data.splits is not None and data.splits.by == "image":
        what, cure = "splits by image: a split of lerobot is a range of whole runs", f"divide by run, or {OPTION} none"
        raise InputError(what, where=str(data.root), cure=cure)
    return tuple((name or "train", part) for name, part in runs_of_splits(data))


def _ranges(data: Dataset) -> dict[str, str]:
    """Return the range of episodes of each split; the first number is in it, the last is not."""
    splits = _splits(data)
    ends = [*accumulate((len(part) for _, part in splits), initial=0)]
    return {name: f"{first}:{end}" for (name, _), (first, end) in zip(splits, pairwise(ends), strict=True)}


def _task(run: Run) -> str:
    log = run.spec.origin.log if run.spec.origin else None
    if log:
        return f"Drive along the path of {log.file}"
    return f"Follow the line and the walls and pass the obstacles, route {run.spec.route}"


def _data_file(number: int) -> str:
    chunk, file = divmod(number, _FILES_PER_CHUNK)
    return _DATA_FILE.format(chunk_index=chunk, file_index=file)


def _video_file(feature: str, number: int) -> str:
    chunk, file = divmod(number, _FILES_PER_CHUNK)
    return f"videos/{feature}/{_VIDEO_FILE.format(chunk_index=chunk, file_index=file)}"


def _info(plan: _Plan) -> dict[str, Any]:
    first, episodes = plan.data.runs[0], plan.episodes
    robots = {run.spec.robot.name for run in plan.data.runs}
    cameras = {name: images[0].run for name, images in episodes[0].images.items()}
    features: dict[str, Any] = {}
    for name, one in cameras.items():
        shape, axes = [one.camera.height_px, one.camera.width_px, 3], ["height", "width", "channels"]
        features[name] = {"dtype": "image", "shape": shape, "names": axes}
        if plan.video:
            features[name] |= {"dtype": "video", "info": video_info(one, image_hz(first))}
    features |= {
        name: {"dtype": "float32", "shape": [len(components)], "names": list(components)}
        for name, components in episodes[0].vectors.items()
    }
    scalar = {"shape": [1], "names": None}
    features |= {"timestamp": {"dtype": "float32", **scalar}} | {name: {"dtype": "int64", **scalar} for name in _COUNTS}
    return {
        "codebase_version": _VERSION,
        "robot_type": robots.pop() if len(robots) == 1 else "symolo",
        "total_episodes": len(episodes),
        "total_frames": sum(map(len, episodes)),
        "total_tasks": len(plan.tasks),
        "chunks_size": _FILES_PER_CHUNK,
        "data_files_size_in_mb": max(1, plan.max_bytes // 1_000_000),
        "video_files_size_in_mb": 200,
        "fps": image_hz(first),
        "splits": _ranges(plan.data),
        "data_path": f"data/{_DATA_FILE}",
        "video_path": f"videos/{{video_key}}/{_VIDEO_FILE}" if plan.video else None,
        "features": features,
    }


def _stats(episodes: Sequence[_Episode]) -> dict[str, Stats]:
    """Return the statistics of every feature over some episodes."""
    stats = {}
    for name, levels in episodes[0].levels.items():
        stats[name] = sum((one.levels[name] for one in episodes[1:]), start=levels).stats()
    for name in episodes[0].numbers:
        stats[name] = vector_stats(np.concatenate([one.numbers[name] for one in episodes]))
    return stats


def _tasks(plan: _Plan) -> bytes:
    """Return a table of pandas whose index is the text of the task, as LeRobot expects it."""
    table = pd.DataFrame({"task_index": range(len(plan.tasks))}, index=pd.Index(plan.tasks, name="task"))
    file = io.BytesIO()
    table.to_parquet(file, engine="pyarrow")
    return file.getvalue()


def _episodes(plan: _Plan) -> bytes:
    arrow, writer = optional_module("pyarrow"), optional_module("pyarrow.parquet")
    rows, hz = [], image_hz(plan.data.runs[0])
    for number, file in enumerate(plan.files):
        chunk_index, file_index = divmod(number, _FILES_PER_CHUNK)
        for one in file:
            row: dict[str, Any] = {
                "episode_index": one.index,
                "tasks": [plan.tasks[one.task_index]],
                "length": len(one),
                "data/chunk_index": chunk_index,
                "data/file_index": file_index,
                "dataset_from_index": one.first,
                "dataset_to_index": one.first + len(one),
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
            }
            if plan.video:
                start = one.first - file[0].first
                for feature in one.images:
                    row |= {
                        f"videos/{feature}/chunk_index": chunk_index,
                        f"videos/{feature}/file_index": file_index,
                        f"videos/{feature}/from_timestamp": start / hz,
                        f"videos/{feature}/to_timestamp": (start + len(one)) / hz,
                    }
            for name, stats in _stats([one]).items():
                row |= {f"stats/{name}/{key}": value for key, value in stats.items()}
            rows.append(row)
    file = io.BytesIO()
    writer.write_table(arrow.Table.from_pylist(rows), file, compression="zstd")
    return file.getvalue()


def _file(image: Image) -> dict[str, object]:
    return {"bytes": read_file(image.path, FileKind.IMAGE), "path": f"{image.run.name}/{image.path.name}"}


def _frames(episodes: Sequence[_Episode], *, with_images: bool = True) -> bytes:
    columns: dict[str, tuple[Feature, Sequence[Any]]] = {}
    for name in episodes[0].images if with_images else ():
        images = [image for one in episodes for image in one.images[name]]
        columns[name] = image_file(), [_file(image) for image in images]
    number = value("float32")
    for name in episodes[0].numbers:
        stacked = np.concatenate([one.numbers[name] for one in episodes])
        if name in (vectors := episodes[0].vectors):
            columns[name] = vector(number, len(vectors[name])), list(stacked)
        else:
            columns[name] = value(str(stacked.dtype)), stacked.tolist()
    return parquet_bytes(columns, {}, rows_per_group=_FRAMES_PER_GROUP)


EXPORTER = Exporter("lerobot", "episodes of LeRobot v3.0 at the camera's rate: image, state, action, task", _files)
