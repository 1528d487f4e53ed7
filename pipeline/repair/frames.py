"""Images and annotations of single frames, rendered again from the run's specification and its data.csv."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath

from blender_scenes.annotations.document import document
from blender_scenes.annotations.job import AnnotationJob, record_file
from blender_scenes.annotations.record import FrameRecord
from blender_scenes.render.job_file import job_path, read_job
from blender_scenes.render.job_file import write_job as write_job_file
from configs.schema.scenario import SceneSpec
from pipeline.executors.local import Local
from pipeline.repair.repair_state import RepairState, RepairTools
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.annotate import AnnotationTask
from pipeline.stages.cameras import RunCamera, cameras_of
from pipeline.stages.render import IMAGES, Appearance, FrameJob, FrameTask, RenderTask, blocks
from pipeline.work.unit_progress import report_event
from symolo.core.errors import InputError
from symolo.core.files.atomic_files import make_folder
from symolo.core.files.file_hashes import holds
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import Report
from symolo.dataset.annotations import DOCUMENT, RECORD_KINDS
from symolo.dataset.layout import ANNOTATIONS, DATA
from symolo.dataset.tables.rows import read_rows


@dataclass(frozen=True)
class _Work:
    """Frames of one run that are rendered again."""

    run: str
    inner: str
    """Folder of the files within that of the run."""
    task: FrameTask
    """Task with the needed frames only; the job in its folder has all."""
    wanted: frozenset[str]
    """Paths of the needed files in that folder."""


def render_frames(state: RepairState, specs: Mapping[str, SceneSpec], tools: RepairTools) -> None:
    """Restore images and annotations of damaged frames, of the runs whose specifications are known.

    Raises:
        EnvironmentLacking: Blender does not start, or a graphics card is not there.
    """
    work = []
    for run, spec in specs.items():
        wanted = state.runs().get(run, set())
        try:
            for camera in cameras_of(spec):
                images, annotations = (_names_in(wanted, camera.inner(folder)) for folder in (IMAGES, ANNOTATIONS))
                if images or annotations:
                    work += _ordered(state, camera, tools, images, annotations)
        except InputError as error:
            state.tried |= {f"{run}/{inner}": str(error) for inner in wanted}
    render_tasks([each.task for each in work], tools.workers, tools.report)
    for each in work:
        for file in sorted(each.wanted):
            name = f"{each.run}/{each.inner}/{file}"
            try:
                data = _document(each.task) if file == DOCUMENT else read_file(each.task.files / file, FileKind.ANY)
            except OSError:
                state.tried[name] = "it cannot be rendered again"
            else:
                how = "annotated again" if file == DOCUMENT else "rendered again"
                state.put(name, data, how, tools.excuse(each.run))


def _names_in(files: Iterable[str], folder: str) -> frozenset[str]:
    start = f"{folder}/"
    return frozenset(file.removeprefix(start) for file in files if file.startswith(start))


def _ordered(
    state: RepairState, camera: RunCamera, tools: RepairTools, images: frozenset[str], annotations: frozenset[str]
) -> list[_Work]:
    spec, run = camera.spec, camera.spec.key
    if state.read(f"{run}/{DATA}") is None:
        raise InputError("it needs the poses in data.csv, which is not restored")
    user_files = state.workspace.user_files
    if images:
        check_user_images(spec, user_files)
    rows = read_rows(state.out / run / DATA)
    device, scratch = tools.devices.get(run, "CPU"), Workspace(tools.scratch)
    frame_job = RenderTask.of_camera(camera, rows, scratch.render(run, camera.name), user_files, device)
    write_job(frame_job)
    work = [_Work(run, camera.inner(IMAGES), only_frames(frame_job.task, images), images)] if images else []
    if annotations:
        appearance = Appearance.from_spec(spec, device, camera.name)
        frame_job = AnnotationTask.from_images(frame_job.task, appearance, scratch.annotate(run, camera.name))
        write_job(frame_job)
        task = frame_job.task if DOCUMENT in annotations else only_frames(frame_job.task, annotations)
        work.append(_Work(run, camera.inner(ANNOTATIONS), task, annotations))
    return work


def check_user_images(spec: SceneSpec, folder: Path) -> None:
    """Check that the user's own images that a run shows are still in `.stages`.

    Raises:
        InputError: One of them is missing or has changed.
    """
    if not holds(folder, {file.sha256: file.sha256 for file in spec.look.files}):
        raise InputError("it shows your own images, and .stages/assets no longer contains them")


def write_job(frame_job: FrameJob) -> None:
    """Write the job of a task into its folder."""
    make_folder(frame_job.task.files)
    write_job_file(frame_job.task.folder.path, frame_job.job_text)


def only_frames(task: FrameTask, files: Iterable[str]) -> FrameTask:
    """Return the task with the frames of these files, which are named by their numbers."""
    stems = {PurePosixPath(file).stem for file in files}
    return replace(task, frames=tuple(frame for frame in task.frames if f"{frame.number:06d}" in stems))


def render_tasks(tasks: list[FrameTask], workers: int, report: Report) -> None:
    """Render the frames of these tasks, whose jobs are written; a frame that fails is left out and reported.

    Raises:
        EnvironmentLacking: Blender does not start, or a graphics card is not there.
    """
    tasks = [task for task in tasks if task.frames]
    if not tasks:
        return
    local = Local(workers)
    with report.stage("render", sum(len(task.frames) for task in tasks), "frames") as stage:
        for failure in local.do(blocks(tasks, local), partial(report_event, stage)):
            report.say(f"render: {failure.unit.name}: {failure.text}")


def _document(task: FrameTask) -> bytes:
    job = AnnotationJob.from_json(read_job(job_path(task.folder.path)).decode())
    names = [record_file(frame.number) for frame in task.frames] if {*RECORD_KINDS} & {*job.kinds} else []
    records = [FrameRecord.from_json(read_file(task.files / name, FileKind.JOB)) for name in names]
    return document(job, IMAGES, records).to_json()
