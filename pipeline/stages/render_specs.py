"""Images and annotations of all runs whose first stage is done."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from blender_scenes.render.devices import DeviceKind
from configs.schema.scenario import SceneSpec
from pipeline.executors.base import Executor
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.annotate import AnnotationTask
from pipeline.stages.cameras import RunCamera, cameras_of
from pipeline.stages.render import Appearance, FrameJob, FrameTask, RenderTask, render_runs
from pipeline.stages.run_tables import stage_rows
from symolo.core.progress import Report
from symolo.dataset.documents.metadata import FailedRun


def render_specs(
    workspace: Workspace,
    specs: Sequence[SceneSpec],
    executor: Executor,
    device: DeviceKind,
    *,
    failures: Sequence[FailedRun],
    report: Report,
    on_complete: Callable[[SceneSpec], None] = lambda _spec: None,
) -> list[FailedRun]:
    """Render all images and then their annotations, and return the failures.

    Args:
        workspace: The output folder.
        specs: All runs.
        executor: Executor that does the work.
        device: Device that renders.
        failures: Runs that failed before and are left out.
        report: Progress report.
        on_complete: Called with each run that is complete, while others go on.
    """
    by_key, cameras = {spec.key: spec for spec in specs}, _cameras(specs)
    left = {run: sum(1 + bool(c.spec.render.annotations) for c in run_cameras) for run, run_cameras in cameras.items()}
    tasks: dict[str, FrameTask] = {}
    failed_before = {failure.run for failure in failures}
    for spec in specs:
        if not left[spec.key] and spec.key not in failed_before:  # without images it is complete
            on_complete(spec)

    def on_task(name: str) -> None:
        run = tasks[name].run
        left[run] -= 1
        if not left[run]:
            on_complete(by_key[run])

    frame_jobs = noted(render_jobs(workspace, specs, device, failures), tasks)
    failed = render_runs(frame_jobs, executor, report, on_complete=on_task)
    if any(camera.spec.render.annotations for run_cameras in cameras.values() for camera in run_cameras):
        annotations = annotation_jobs(workspace, specs, device, tasks.values(), failed)
        failed += render_runs(annotations, executor, report, "annotate", on_task)
    return failed


def _cameras(specs: Sequence[SceneSpec]) -> Mapping[str, tuple[RunCamera, ...]]:
    """Return the cameras of each run."""
    return {spec.key: cameras_of(spec) for spec in specs}


def render_jobs(
    workspace: Workspace, specs: Sequence[SceneSpec], device: DeviceKind, failures: Sequence[FailedRun]
) -> Iterator[FrameJob]:
    """Yield the tasks, with their jobs, for the images of all cameras of the runs that did not fail."""
    failed = {failure.run for failure in failures}
    for spec in specs:
        if spec.key not in failed:
            rows = stage_rows(workspace.simulate(spec.key).path)
            for camera in cameras_of(spec):
                folder, user_files = workspace.render(spec.key, camera.name), workspace.user_files
                yield RenderTask.of_camera(camera, rows, folder, user_files, device)


def annotation_jobs(
    workspace: Workspace,
    specs: Sequence[SceneSpec],
    device: DeviceKind,
    images: Iterable[FrameTask],
    failures: Sequence[FailedRun],
) -> Iterator[FrameJob]:
    """Yield the tasks, with their jobs, for the annotations; none where the specifications ask for none."""
    failed = {failure.run for failure in failures}
    appearances = {
        (run, camera.name): Appearance.from_spec(camera.spec, device, camera.name)
        for run, cameras in _cameras(specs).items()
        for camera in cameras
        if camera.spec.render.annotations
    }
    for task in images:
        appearance = appearances.get((task.run, task.camera))
        if appearance is not None and task.run not in failed:
            yield AnnotationTask.from_images(task, appearance, workspace.annotate(task.run, task.camera))


def noted(frame_jobs: Iterable[FrameJob], tasks: dict[str, FrameTask]) -> Iterator[FrameJob]:
    """Yield the frame jobs and add their tasks to `tasks` by name; the long texts of the jobs are not stored."""
    for frame_job in frame_jobs:
        tasks[frame_job.task.name] = frame_job.task
        yield frame_job
