"""A scenario and an output folder: which stages are to be done for which runs, and what came of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from configs.errors import InputError
from configs.loader import LoadedScenario, load_scenario
from configs.schema.scenario import RunSpec
from pipeline.dataset.metadata import FailedRun
from pipeline.dataset.rows import Rows
from pipeline.drawing import draw_reported
from pipeline.output import check_disk, check_out
from pipeline.own_files import keep_own_files
from pipeline.plan import Plan
from pipeline.progress import Report
from pipeline.stages.annotate import AnnotationTask
from pipeline.stages.assemble import assemble
from pipeline.stages.render import Appearance, RenderTask, render_runs
from pipeline.stages.simulate_runs import (
    read_outcome,
    read_recording,
    simulate_runs,
    simulation_key,
)
from pipeline.workers import cores
from pipeline.workspace import Kind, Workspace


@dataclass(frozen=True)
class Batch:
    """What a command works on; nothing is written before one of the stages is asked for."""

    loaded: LoadedScenario
    specs: tuple[RunSpec, ...]
    workspace: Workspace
    workers: int

    @classmethod
    def open(cls, scenario: str, overrides: Sequence[str], out: Path, workers: int | None, report: Report) -> "Batch":
        """Load and draw the scenario and see that there is room for it.

        Raises:
            InputError: The scenario or the output folder cannot be used.
            EnvironmentLacking: The disk is too full.
        """
        loaded = load_scenario(scenario, overrides)
        specs = draw_reported(loaded, report)
        check_out(out, Kind.DATASET)
        check_disk(out, Plan.of(specs, cores()).bytes_needed)
        return cls(loaded, specs, Workspace(out.absolute()), workers or cores())

    def simulate(self, report: Report) -> list[FailedRun]:
        return simulate_runs(self.workspace, self.specs, self.workers, report)

    def simulated(self) -> list[FailedRun]:
        """Problems of runs simulated before.

        Raises:
            InputError: A run is not simulated yet, or from other inputs.
        """
        for spec in self.specs:
            if not self.workspace.simulate(spec.key).is_done(simulation_key(spec)):
                raise self._not_done(spec, "simulate")
        return [
            FailedRun(run=spec.key, stage="simulate", problem=text)
            for spec in self.specs
            for text in read_outcome(self.workspace.simulate(spec.key).path).problems
        ]

    def render(self, failures: Sequence[FailedRun], report: Report) -> list[FailedRun]:
        """Images, and then what is known of those that were rendered."""
        keep_own_files((spec.look for spec in self.specs), self.loaded.assets, self.workspace.own_files)
        failed = render_runs(self._render_tasks(failures), self.workers, report)
        tasks = self._annotation_tasks([*failures, *failed])
        return failed + (render_runs(tasks, self.workers, report, "annotate") if tasks else [])

    def check_rendered(self, failures: Sequence[FailedRun]) -> None:
        """Raise InputError for a good run that is not rendered or annotated yet, or from other inputs."""
        for task in [*self._render_tasks(failures), *self._annotation_tasks(failures)]:
            if not task.folder.is_done(task.key):
                raise self._not_done(next(spec for spec in self.specs if spec.key == task.run), "render")

    def assemble(self, failures: Sequence[FailedRun], report: Report) -> None:
        assemble(self.workspace, self.loaded.tree, self.specs, failures, report)

    def _render_tasks(self, failures: Sequence[FailedRun]) -> list[RenderTask]:
        failed = {failure.run for failure in failures}
        tasks = []
        for spec in self.specs:
            if spec.key not in failed:
                rows = Rows.from_recording(read_recording(self.workspace.simulate(spec.key).path))
                folder, own_files = self.workspace.render(spec.key), self.workspace.own_files
                tasks.append(RenderTask.of(spec.key, Appearance.of(spec), rows, folder, own_files))
        return tasks

    def _annotation_tasks(self, failures: Sequence[FailedRun]) -> list[AnnotationTask]:
        """None where the scenario asks for no annotations."""
        wanted = {spec.key: Appearance.of(spec) for spec in self.specs if spec.render.annotations}
        return [
            AnnotationTask.of(task, wanted[task.run], self.workspace.annotate(task.run))
            for task in (self._render_tasks(failures) if wanted else [])
        ]

    def _not_done(self, spec: RunSpec, stage: str) -> InputError:
        return InputError(
            f"run {spec.key} of this scenario is not there from stage '{stage}'",
            where=f"--out {self.workspace.out}",
            cure=f"run `symolo {stage}` with the same scenario first, or `symolo release` for all stages",
        )
