"""A scenario and an output folder: does the stages of all runs and collects the failures."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from blender_scenes.render.devices import DeviceKind, device_for
from configs.loader import LoadedScenario, load_scenario
from configs.schema.scenario import RunSpec, SceneSpec
from pipeline.executors.base import Executor
from pipeline.planning.drawing import draw_reported
from pipeline.planning.plan import ScenarioPlan
from pipeline.run_folder.output import check_out
from pipeline.run_folder.user_image_copies import copy_user_images
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.assemble import assemble
from pipeline.stages.cameras import cameras_of
from pipeline.stages.render import FrameJob, FrameTask
from pipeline.stages.render_specs import annotation_jobs, noted, render_jobs, render_specs
from pipeline.stages.simulate_runs import problems_of, simulate_runs, simulation_key
from pipeline.work.supervisor import cores
from symolo.core.errors import InputError
from symolo.core.files.disk_space import check_disk
from symolo.core.progress import Report
from symolo.dataset.documents.metadata import FailedRun
from symolo.dataset.folder_kind import Kind


@dataclass(frozen=True)
class Batch:
    """The scenario, runs and output folder of a command. Nothing is written before a stage begins."""

    loaded: LoadedScenario
    specs: tuple[RunSpec, ...]
    workspace: Workspace
    executor: Executor
    device: DeviceKind = "CPU"
    notes: tuple[str, ...] = ()
    """Lines for the user before the runs are simulated, such as suspicious starts."""

    @classmethod
    def open(
        cls,
        scenario: str,
        overrides: Sequence[str],
        out: Path,
        executor: Executor,
        report: Report,
        *,
        renders: bool = True,
    ) -> "Batch":
        """Load and draw the scenario, check the disk space, and choose the device if the command `renders`.

        Raises:
            InputError: The scenario or the output folder cannot be used.
            EnvironmentLacking: The disk is too full, or a graphics card is required and there is none.
        """
        loaded = load_scenario(scenario, overrides)
        executor.check()
        specs = draw_reported(loaded, report)
        check_out(out, Kind.DATASET)
        plan = ScenarioPlan.from_specs(specs, cores(), loaded.like, replaced_draws=loaded.replaced_draws)
        check_disk(out, plan.bytes_needed)
        renders = renders and any(map(cameras_of, specs))
        device = device_for(specs[0].render.device) if renders else "CPU"
        return cls(loaded, specs, Workspace(out.absolute()), executor.on(device), device, tuple(plan.notes()))

    @property
    def has_images(self) -> bool:
        """Whether any run has images to render."""
        return any(map(cameras_of, self.specs))

    def copy_user_images(self) -> None:
        """Copy the user's files for the renderers. Call it before the simulation, during which they could change.

        Raises:
            InputError: One of them is missing or has changed.
        """
        copy_user_images((spec.look for spec in self.specs), self.loaded.assets, self.workspace.user_files)

    def simulate(self, report: Report) -> list[FailedRun]:
        return simulate_runs(self.workspace, self.specs, self.executor, report)

    def simulated(self) -> list[FailedRun]:
        """Return the problems of runs that were simulated before.

        Raises:
            InputError: A run is not simulated yet, or from other inputs.
        """
        for spec in self.specs:
            if not self.workspace.simulate(spec.key).is_done(simulation_key(spec)):
                raise self._not_done(spec.key, "simulate")
        return problems_of(self.workspace, self.specs)

    def render(
        self,
        failures: Sequence[FailedRun],
        report: Report,
        on_complete: Callable[[SceneSpec], None] = lambda _spec: None,
    ) -> list[FailedRun]:
        """Render all images and then their annotations; call `on_complete` with each run that is complete."""
        return render_specs(
            self.workspace,
            self.specs,
            self.executor,
            self.device,
            failures=failures,
            report=report,
            on_complete=on_complete,
        )

    def rendered(self, failures: Sequence[FailedRun]) -> list[FailedRun]:
        """Return the problems of runs that were rendered before.

        Raises:
            InputError: A good run is not rendered or annotated yet, or from other inputs.
        """
        tasks: dict[str, FrameTask] = {}
        frame_jobs = render_jobs(self.workspace, self.specs, self.device, failures)
        failed = self._problems(noted(frame_jobs, tasks))
        annotations = annotation_jobs(self.workspace, self.specs, self.device, tasks.values(), failed)
        return failed + self._problems(annotations)

    def assemble(self, failures: Sequence[FailedRun], report: Report, protected: frozenset[str]) -> None:
        assemble(self.workspace, self.loaded.tree, self.specs, failures, report, protected=protected)

    def _problems(self, frame_jobs: Iterable[FrameJob]) -> list[FailedRun]:
        failed = []
        for task in (frame_job.task for frame_job in frame_jobs):
            if problem := task.folder.problem(task.key):
                failed.append(task.failed(task.STAGE, problem))
            elif not task.folder.is_done(task.key):
                raise self._not_done(task.name, "render")
        return failed

    def _not_done(self, run: str, stage: str) -> InputError:
        return InputError(
            f"there is no finished stage '{stage}' of run {run} of this scenario",
            where=f"--out {self.workspace.out}",
            cure=f"run `symolo {stage}` with the same scenario first, or `symolo release` for all stages",
        )
