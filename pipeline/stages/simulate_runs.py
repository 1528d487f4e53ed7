"""First stage: every run of a scenario simulated into a folder of its own."""

import io
from collections.abc import Callable, Sequence
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from configs.schema.scenario import RunSpec
from configs.whole_files import write_file
from physics.trajectory import Recording
from pipeline.cpu import cpu_class
from pipeline.dataset.metadata import FailedRun
from pipeline.files import canonical_json
from pipeline.progress import Report
from pipeline.units import Finished, Progress, SimulateUnit
from pipeline.versions import versions
from pipeline.worker_process import Limits
from pipeline.workers import BY_LIMITS, AnyEvent, AnyUnit, Retried, UnitFailure, run_units
from pipeline.workspace import StageFolder, Workspace, input_key, mark_done

FORMAT = 3
"""Of what a simulation leaves for the later stages: from 2 on with the mean voltages of the wheels, from 3 on with a
filter of the speed that does not hold it."""

SPEC, TRAJECTORY, OUTCOME = "spec.json", "trajectory.npz", "outcome.json"


class RunOutcome(BaseModel):
    """outcome.json: how a run ended."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    finished: bool
    problems: tuple[str, ...]
    """What went wrong, where and when; empty when the run is good."""
    lap_time_s: float | None
    rows: int
    images: int
    cpu: str = ""
    """Class of the processor; empty where it was not noted."""


def simulation_inputs(spec: RunSpec) -> dict:
    """What the trajectory depends on: the run but for its look, its pictures and the camera's mounting."""
    inputs = spec.model_dump(mode="json", exclude={"look": True, "render": True, "robot": {"camera"}})
    for_pictures = ("look.", "render.", "robot.camera.")
    inputs["drawn"] = {path: value for path, value in spec.drawn.items() if not path.startswith(for_pictures)}
    return inputs


def simulation_key(spec: RunSpec) -> str:
    programs = versions("symolo", "pybullet", "numpy", "scipy")
    return input_key("simulate", format=FORMAT, run=simulation_inputs(spec), versions=programs)


def simulate_runs(
    workspace: Workspace, specs: Sequence[RunSpec], workers: int, report: Report, limits: Limits = BY_LIMITS
) -> list[FailedRun]:
    """Simulate the runs that are not done yet, and tell of all that failed, now or before."""
    units = []
    for spec in specs:
        folder, key = workspace.simulate(spec.key), simulation_key(spec)
        if folder.is_done(key):
            _refresh_spec(folder, key, spec)
        else:
            units.append(SimulateUnit(name=spec.key, spec=spec.model_dump_json(), folder=folder.path, key=key))
    if len(units) < len(specs):
        report.say(f"simulate: {len(specs) - len(units)} of {len(specs)} runs are there already")
    failures = _do(units, workers, report, limits) if units else []
    stopped = {failure.run for failure in failures}
    for spec in specs:
        if spec.key not in stopped:
            outcome = read_outcome(workspace.simulate(spec.key).path)
            failures += [FailedRun(run=spec.key, stage="simulate", problem=text) for text in outcome.problems]
    return failures


def _do(units: Sequence[SimulateUnit], workers: int, report: Report, limits: Limits) -> list[FailedRun]:
    with report.stage("simulate", len(units), "runs") as stage:

        def on_event(unit: AnyUnit, event: AnyEvent) -> None:
            if isinstance(event, Progress):
                stage.update(unit.name, event.share)
            elif isinstance(event, Finished):
                stage.update(unit.name, 1.0)
            elif isinstance(event, Retried):
                stage.say(event.text)

        failures = run_units(units, workers, on_event, limits=limits)
    return failed_runs("simulate", failures, report)


def failed_runs(stage: str, failures: Sequence[UnitFailure], report: Report) -> list[FailedRun]:
    """What the dataset holds of the failures; what it may not hold, such as a log, is said here."""
    failed = [FailedRun.of(failure.unit.name, stage, failure.text) for failure in failures]
    for run, failure in zip(failed, failures, strict=True):
        if failure.text != run.problem:  # else the command's own last lines say it
            report.say(f"{stage}: {run.run}: {failure.text}")
    return failed


def simulate_into(spec_json: str, path: Path, key: str, progress: Callable[[float], None]) -> None:
    """Simulate one run and leave its folder whole; runs in a worker, the only one that loads the engine."""
    from pipeline.stages.simulate import simulate  # noqa: PLC0415 - loads pybullet

    spec = RunSpec.model_validate_json(spec_json)
    outcome = simulate(spec, lambda done_s, total_s: progress(min(1.0, done_s / total_s)))
    recording = outcome.recording
    folder = StageFolder(path)
    partial = folder.start()
    archive = io.BytesIO()
    recording.save(archive)
    write_file(partial / TRAJECTORY, archive.getvalue())
    write_file(partial / SPEC, spec_text(spec))
    summary = RunOutcome(
        finished=outcome.finished,
        problems=outcome.problems,
        lap_time_s=outcome.lap_time_s,
        rows=len(recording.trajectory.t_s),
        images=int((recording["image"].values > 0).sum()),
        cpu=cpu_class(),
    )
    write_file(partial / OUTCOME, canonical_json(summary.model_dump(mode="json")))
    folder.publish(partial, key)


def spec_text(spec: RunSpec) -> bytes:
    return canonical_json(spec.model_dump(mode="json"))


def read_outcome(path: Path) -> RunOutcome:
    return RunOutcome.model_validate_json((path / OUTCOME).read_bytes())


def read_recording(path: Path) -> Recording:
    # Read first: what unpacks the archive takes a fault of the disk for a damaged archive.
    return Recording.load(io.BytesIO((path / TRAJECTORY).read_bytes()))


def _refresh_spec(folder: StageFolder, key: str, spec: RunSpec) -> None:
    """Let `spec.json` say the look that is asked for now; the trajectory does not depend on it."""
    text = spec_text(spec)
    if (folder.path / SPEC).read_bytes() != text:
        write_file(folder.path / SPEC, text)
        mark_done(folder.path, key)
