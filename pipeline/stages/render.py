"""Stage 2: renders the frames of every good run in blocks; after an interruption it continues with the next frame."""

import hashlib
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from blender_scenes.annotations.job import AnnotationJob
from blender_scenes.render.devices import DeviceKind
from blender_scenes.render.frame_files import Ledger
from blender_scenes.render.job import FramePose, RenderJob, build_job
from blender_scenes.render.job_file import job_path, job_sha256, write_job
from blender_scenes.render.probe import is_decided
from blender_scenes.render.protocol import Work
from blender_scenes.render.sampling import TracingSettings
from configs.schema.appearance.look import LookConfig
from configs.schema.arena import ArenaConfig
from configs.schema.robot import RobotConfig
from configs.schema.scenario import Render, SceneSpec
from pipeline.executors.base import Executor
from pipeline.run_folder.workspace import FAILED, StageFolder, input_key, mark_done
from pipeline.run_warnings.camera_inside import things_around
from pipeline.stages.cameras import RunCamera
from pipeline.stages.rendering_facts import FRAMES, rendering_facts
from pipeline.stages.simulate_runs import failed_runs
from pipeline.work.processors import cpu_class
from pipeline.work.supervisor import AnyEvent, AnyUnit, FrameGivenUp
from pipeline.work.unit_progress import report_event
from pipeline.work.units import RenderUnit
from sensors.camera.exposure_guard import Extremes, all_black, exposure_warnings
from symolo.arena.geometry import Arena
from symolo.core.child_process import Failed, Finished
from symolo.core.files.atomic_files import make_folder, remove_file, remove_folder, write_file
from symolo.core.files.file_hashes import canonical_json, sha256_of
from symolo.core.files.file_locks import locked
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.geometry.robot_path import RobotPath
from symolo.core.progress import Report, plural
from symolo.core.random_streams import stream
from symolo.core.versions import versions
from symolo.dataset.documents.metadata import FailedRun
from symolo.dataset.layout import DONE, IMAGES, JOB, frame_name
from symolo.dataset.tables.camera_rows import path_of
from symolo.dataset.tables.rows import Rows

INPUTS = "inputs.json"

OnComplete = Callable[[str], None]


@dataclass(frozen=True)
class Appearance:
    """Everything that the images of a run depend on except the pose of the robot."""

    arena: ArenaConfig
    robot: RobotConfig
    look: LookConfig
    render: Render
    seed: int
    """Seed of the run, not of the scenario: no two runs share stains and noise."""
    device: DeviceKind = "CPU"
    """Device on this machine for `render.device`."""
    noise_seed: int | None = None
    """Seed of path tracing and camera noise; None for that of the run. A further camera has one of its own."""

    @classmethod
    def from_spec(cls, spec: SceneSpec, device: DeviceKind = "CPU", camera: str = "") -> "Appearance":
        """Return the appearance of a run; for a further camera, `spec` has it in the place of that of data.csv."""
        seed = image_seed(spec.seed, *spec.drawn_as)
        noise_seed = image_seed(spec.seed, *spec.drawn_as, camera) if camera else None
        return cls(spec.arena, spec.robot, spec.look, spec.render, seed, device, noise_seed)

    def job(self, arena: Arena, frames: Sequence[FramePose], path: RobotPath) -> RenderJob:
        """Return the job that renders these frames; `arena` is that of `self.arena`."""
        robot, look, render, seed = self.robot, self.look, self.render, self.seed
        return build_job(arena, robot, look, render, frames, seed, path, self.device, self.noise_seed)


def image_seed(seed: int, route: str, run: int, *camera: str) -> int:
    """Return the seed of 31 bits for the renderer, which depends on the run only, or on a further camera too."""
    return int(stream(seed, route, run, "render", *camera).integers(2**31))


@dataclass(frozen=True)
class ImageFindings:
    """The result of a check of the files of a run."""

    warnings: tuple[str, ...] = ()
    problem: str = ""
    """Reason why the run cannot be released; empty where it can."""


@dataclass(frozen=True)
class FrameTask(ABC):
    """Files for each frame of one run, and the folder for them."""

    STAGE: ClassVar[str]
    """Name of the stage in its input key."""
    FILES: ClassVar[str]
    """Name of the folder, within that of the task, that is filled frame by frame."""
    WORK: ClassVar[Work]
    """Work of the Blender process."""

    run: str
    folder: StageFolder
    job_sha256: str
    frames: tuple[FramePose, ...]
    sampling: TracingSettings
    """Settings with which the files are made."""
    user_files: Path | None = None
    """Folder of the user's own files by their SHA-256; None where none is shown."""
    camera: str = ""
    """Name of the further camera whose images these are; empty for the camera of data.csv."""
    inside: Mapping[int, str] = field(default_factory=dict)
    """Wall or obstacle by the number of each image that is taken from inside it."""

    @classmethod
    def frame_job(
        cls,
        run: str,
        folder: StageFolder,
        job: RenderJob | AnnotationJob,
        frames: tuple[FramePose, ...],
        user_files: Path | None = None,
        *,
        camera: str = "",
        inside: Mapping[int, str] | None = None,
    ) -> "FrameJob":
        text = job.to_json()
        digest = hashlib.sha256(text.encode()).hexdigest()
        return FrameJob(cls(run, folder, digest, frames, job.sampling, user_files, camera, inside or {}), text)

    @property
    def name(self) -> str:
        """Name in messages: the run, and the camera if it is a further one."""
        return f"{self.run} camera {self.camera}" if self.camera else self.run

    def failed(self, stage: str, problem: str) -> FailedRun:
        """Return the record of a problem with which the run cannot be released."""
        of_camera = f"camera {self.camera}: " if self.camera else ""
        return FailedRun(run=self.run, stage=stage, problem=f"{of_camera}{problem}")

    @property
    def key(self) -> str:
        """Input key of the stage."""
        programs = versions("symolo", "bpy", "numpy", "opencv-python-headless")
        return input_key(self.STAGE, job=self.job_sha256, versions=programs)

    @property
    def files(self) -> Path:
        return self.folder.path / self.FILES

    def whole_files(self) -> dict[str, str]:
        """Return the SHA-256 by path in `files` of every file in the journal that is unchanged."""
        known = Ledger(self.files, self.job_sha256).whole_files()
        return {name: frame.sha256 for name, frame in known.items()}

    @abstractmethod
    def names(self) -> list[str]:
        """Return the paths in `files` of all files that are to be made."""

    @abstractmethod
    def finish(self, hashes: Mapping[str, str]) -> ImageFindings:
        """Write the list of the files, and mark the folder done unless there is a problem.

        Args:
            hashes: SHA-256 of each of `names`, from the journal; no other file counts.
        """


@dataclass(frozen=True)
class FrameJob:
    """A task with the text of its job file. The text is long, so those of many runs are built one after the other."""

    task: FrameTask
    job_text: str


class RenderTask(FrameTask):
    """The images of one run."""

    STAGE, FILES, WORK = "render", IMAGES, "images"

    @classmethod
    def of_camera(
        cls,
        camera: RunCamera,
        rows: Rows,
        folder: StageFolder,
        user_files: Path | None = None,
        device: DeviceKind = "CPU",
    ) -> FrameJob:
        """Return the task with its job for the images of any camera of a run; the rows are those of data.csv."""
        frames = frame_poses(camera.rows(rows))
        appearance = Appearance.from_spec(camera.spec, device, camera.name)
        job = appearance.job(Arena.from_config(appearance.arena), frames, path_of(rows))
        inside = things_around(camera, rows)
        return cls.frame_job(camera.spec.key, folder, job, frames, user_files, camera=camera.name, inside=inside)

    def names(self) -> list[str]:
        return [frame_name(frame.number) for frame in self.frames]

    def whole_files(self) -> dict[str, str]:
        # Without the decision, nobody could tell how the images were made: they are made again.
        return super().whole_files() if is_decided(self.sampling, self.files, self.job_sha256) else {}

    def finish(self, hashes: Mapping[str, str]) -> ImageFindings:
        extremes = {name: Extremes.from_jpeg(read_file(self.files / name, FileKind.IMAGE)) for name in self.names()}
        inside = {frame_name(number): thing for number, thing in self.inside.items()}
        if problem := all_black(extremes, inside):
            return ImageFindings(problem=problem)
        records = [
            {
                "number": frame.number,
                "file": f"{IMAGES}/{name}",
                "sha256": hashes[name],
                "t_s": frame.t_s,
                "x_m": frame.x_m,
                "y_m": frame.y_m,
                "yaw_rad": frame.yaw_rad,
                "black_share": round(extremes[name].black, 4),
                "burnt_share": round(extremes[name].burnt, 4),
            }
            for frame, name in zip(self.frames, self.names(), strict=True)
        ]
        rendering, error_warnings = rendering_facts(self.sampling, self.files, self.job_sha256)
        warnings = (*exposure_warnings(extremes, inside), *error_warnings)
        cpus = Ledger(self.files, self.job_sha256).processors() or (cpu_class(),)
        cpu = cpus[0] if len(cpus) == 1 else list(cpus)
        document = {
            "cpu": cpu,
            "device": self.sampling.device,
            "frames": records,
            "rendering": rendering.model_dump(mode="json"),
            "warnings": list(warnings),
        }
        write_file(self.folder.path / FRAMES, canonical_json(document))
        images = {record["file"]: record["sha256"] for record in records}
        texts = {name: sha256_of(self.folder.path / name) for name in (JOB, FRAMES)}
        mark_done(self.folder.path, self.key, {**texts, **images})
        return ImageFindings(warnings)


def frame_poses(rows: Rows) -> tuple[FramePose, ...]:
    """Return the pose of the robot at each exposure."""
    return tuple(
        FramePose(number=int(rows.image[i]), t_s=float(rows.t_ms[i]) / 1000, x_m=x, y_m=y, yaw_rad=yaw)
        for i, (x, y, yaw) in enumerate(rows.pose.tolist())
        if rows.image[i] > 0
    )


def render_runs(
    frame_jobs: Iterable[FrameJob],
    executor: Executor,
    report: Report,
    name: str = "render",
    on_complete: OnComplete = lambda _run: None,
) -> list[FailedRun]:
    """Render the files that are missing; frames from before an interruption are kept if their job is the same.

    All jobs are written before the first one begins. An executor that does only a part of the units leaves the folders
    unfinished; an executor that does all units finishes them.

    Args:
        frame_jobs: Tasks of the runs with their jobs.
        executor: Executor that does them.
        report: Progress report.
        name: Name of the stage.
        on_complete: Called with the name of each task that finishes without a problem, while others go on.
    """
    pending, done_before = [], 0
    for frame_job in frame_jobs:
        if frame_job.task.folder.is_done(frame_job.task.key):
            done_before += 1
            on_complete(frame_job.task.name)
        else:
            _prepare(frame_job)
            pending.append(frame_job.task)
    if done_before:
        report.say(f"{name}: {done_before} of {plural(done_before + len(pending), 'run')} done before")
    if not pending:
        return []
    if (device := pending[0].sampling.device) != "CPU":
        report.say(
            f"{name}: on a graphics card ({device}); if Blender has no kernels for it, its driver first compiles them,"
            " once for this machine, which can take many minutes"
        )
    units = [unit for unit in blocks(pending, executor) if executor.mine(unit)]
    finishing = _Finishing(pending if executor.does_all else (), units, name, report, on_complete)
    with report.stage(name, sum(len(unit.numbers) for unit in units), "images") as stage:

        def on_event(unit: AnyUnit, event: AnyEvent) -> None:
            report_event(stage, unit, event)
            finishing.take(unit, event)

        failures = executor.do(units, on_event)
    runs = {task.name: task.run for task in pending}
    failed = failed_runs(name, failures, report, runs)
    return failed + finishing.rest({failure.unit.name for failure in failures})


class _Finishing:
    """Finishes each run as soon as the last of its blocks is done."""

    def __init__(
        self,
        tasks: Sequence[FrameTask],
        units: Sequence[RenderUnit],
        name: str,
        report: Report,
        on_complete: OnComplete,
    ) -> None:
        self._tasks = {task.name: task for task in tasks}
        self._left = Counter(unit.name for unit in units)
        self._name, self._report, self._on_complete = name, report, on_complete
        self._failed: list[FailedRun] = []

    def take(self, unit: AnyUnit, event: AnyEvent) -> None:
        if isinstance(event, Failed | FrameGivenUp):
            self._tasks.pop(unit.name, None)
        elif isinstance(event, Finished):
            self._left[unit.name] -= 1
            if not self._left[unit.name] and (task := self._tasks.pop(unit.name, None)):
                self._finish(task)

    def rest(self, failed: Collection[str]) -> list[FailedRun]:
        """Finish the remaining runs except those that `failed`, and return all failures."""
        for task in self._tasks.values():
            if task.name not in failed:
                self._finish(task)
        return self._failed

    def _finish(self, task: FrameTask) -> None:
        hashes = task.whole_files()
        if lost := [file for file in task.names() if file not in hashes]:
            # The folder is not marked as failed, so the next command makes the file again.
            problem = f"{lost[0]} is not on the disk as it was written; run the same command again"
        else:
            findings = task.finish(hashes)
            for warning in findings.warnings:
                self._report.say(f"{self._name}: {task.name}: {warning}")
            if problem := findings.problem:
                task.folder.fail(task.key, problem)
        if problem:
            self._failed.append(task.failed(self._name, problem))
        else:
            self._on_complete(task.name)


def blocks(tasks: Sequence[FrameTask], executor: Executor) -> list[RenderUnit]:
    """Return the frames of each run in blocks of the size that the executor wants."""
    parts: list[tuple[FrameTask, tuple[int, ...]]] = []
    for task in tasks:
        numbers = tuple(frame.number for frame in task.frames)
        size = executor.block_frames(len(numbers), len(tasks))
        parts += [(task, numbers[start : start + size]) for start in range(0, len(numbers), size)]
    threads = executor.threads(len(parts))
    return [
        RenderUnit(
            work=task.WORK,
            name=task.name,
            job=job_path(task.folder.path),
            folder=task.files,
            numbers=numbers,
            threads=threads,
            user_files=task.user_files,
        )
        for task, numbers in parts
    ]


def _prepare(frame_job: FrameJob) -> None:
    """Prepare a folder; several parts of the work may do this at the same time."""
    task, path = frame_job.task, frame_job.task.folder.path
    inputs = canonical_json({"key": task.key})
    make_folder(path.parent)
    with locked(path.parent):
        if not (path / INPUTS).is_file() or read_file(path / INPUTS, FileKind.JOB) != inputs:
            remove_folder(path)
        make_folder(task.files)
        for name in (DONE, FAILED):
            remove_file(path / name)
        write_job(path, frame_job.job_text)
        write_file(path / INPUTS, inputs)


def journal(folder: StageFolder, files: str) -> Ledger:
    """Return the journal of a folder whose job is written; `files` is the folder within it that is filled."""
    return Ledger(folder.path / files, job_sha256(job_path(folder.path)))
