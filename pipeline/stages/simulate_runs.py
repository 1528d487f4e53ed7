"""Stage 1: simulates every run of a scenario into a folder of its own."""

import io
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from configs.schema.board import Board
from configs.schema.scenario import RunSpec, SceneSpec
from hil.board_runner import BoardRunner, build_for, connected_board, counted, firmware_id_of
from hil.loop import BoardEvent
from physics.run.controller_runner import controller_class
from pipeline.executors.base import Executor
from pipeline.run_folder.first_stage import TRAJECTORY
from pipeline.run_folder.workspace import StageFolder, Workspace, input_key, mark_done
from pipeline.run_warnings.observed_range import range_warnings
from pipeline.run_warnings.simulated_run import planned_texts, run_warnings
from pipeline.user_code import hashes_of_controller, hashes_of_files
from pipeline.work.processors import cpu_class
from pipeline.work.supervisor import UnitFailure
from pipeline.work.unit_progress import report_event
from pipeline.work.units import SimulateUnit
from symolo.core.errors import InputError, RunFailed
from symolo.core.files.atomic_files import write_file
from symolo.core.files.file_hashes import canonical_json
from symolo.core.files.plain_files import FileKind, read_file
from symolo.core.progress import Report, plural
from symolo.core.versions import versions
from symolo.dataset.codes import BOARD_EVENT_COLUMNS
from symolo.dataset.documents.metadata import FailedRun
from symolo.dataset.documents.run_records import BoardRecord, ControllerRecord
from symolo.dataset.layout import SPEC
from symolo.dataset.tables.camera_rows import main_camera_rows
from symolo.dataset.tables.rows import Rows

if TYPE_CHECKING:
    from pipeline.stages.simulate import DriveOutcome, Watch

FORMAT = 3
"""Version of the files of a simulation: from 2 on with the mean voltages of the wheels, from 3 on with a
filter of the speed that does not hold it."""

OUTCOME = "outcome.json"
MAX_EVENTS = 1000


class RunOutcome(BaseModel):
    """outcome.json: how a run ended."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    finished: bool
    problems: tuple[str, ...]
    """Problems with place and time; empty if the run is good."""
    lap_time_s: float | None
    rows: int
    images: int
    cpu: str = ""
    """Class of the processor; empty where it was not noted."""
    board: BoardRecord | None = None
    """The board that drove the robot in place of the built-in controller."""
    controller: ControllerRecord | None = Field(default=None, exclude_if=lambda controller: controller is None)
    """The controller of the user that drove the robot."""
    events: tuple[str, ...] = ()
    """Events on the line to the board with their times, at most MAX_EVENTS."""
    beyond_ranges: tuple[str, ...] = Field(default=(), exclude_if=lambda texts: not texts)
    """Warnings about effects outside the range in which they were observed."""
    suspicions: tuple[str, ...] = Field(default=(), exclude_if=lambda texts: not texts)
    """Reasons why the run is probably not what the scenario was meant to make."""

    @classmethod
    def of_rows(
        cls,
        rows: Rows,
        lap_time_s: float | None = None,
        board: BoardRecord | None = None,
        controller: ControllerRecord | None = None,
        suspicions: Sequence[str] = (),
    ) -> "RunOutcome":
        """Return the outcome of a run whose trajectory was not simulated here, with its images at rows."""
        return cls(
            finished=True,
            problems=(),
            lap_time_s=lap_time_s,
            rows=len(rows.t_ms),
            images=len(main_camera_rows(rows, None).t_ms),
            board=board,
            controller=controller,
            suspicions=tuple(suspicions),
        )

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings for users of the run."""
        board, simulation_warnings = self.board, (*self.suspicions, *self.beyond_ranges)
        if board is None or not (board.rows_unanswered or board.events):
            return simulation_warnings
        faults = [f"{plural(board.rows_unanswered, 'row')} unanswered"] if board.rows_unanswered else []
        faults += [f"{count} {name.replace('_', ' ')}" for name, count in board.events.items()]
        return (f"the line to the board was disturbed: {', '.join(faults)}", *simulation_warnings)


def simulation_inputs(spec: SceneSpec) -> dict:
    """Return everything that the trajectory depends on: the run without look, images and camera."""
    inputs = spec.model_dump(mode="json", exclude={"look": True, "render": True, "robot": {"camera"}})
    image_fields = ("look.", "render.", "robot.camera.")
    inputs["drawn"] = {path: value for path, value in spec.drawn.items() if not path.startswith(image_fields)}
    return inputs


def simulation_key(spec: RunSpec) -> str:
    programs = versions("symolo", "pybullet", "numpy", "scipy")
    inputs = {"format": FORMAT, "run": simulation_inputs(spec), "versions": programs}
    if files := hashes_of_files(spec):
        inputs["files"] = files
    if spec.board and spec.board.kind == "simulated":
        inputs["firmware"] = firmware_id_of(spec.robot, spec.board)
    return input_key("simulate", **inputs)


def simulate_runs(
    workspace: Workspace, specs: Sequence[RunSpec], executor: Executor, report: Report
) -> list[FailedRun]:
    """Simulate the runs that are not done yet, and return all failures, now or before."""
    units: list[SimulateUnit] = []
    for spec in specs:
        folder, key = workspace.simulate(spec.key), simulation_key(spec)
        if folder.is_done(key):
            refresh_spec(folder, key, spec)
        else:
            units.append(SimulateUnit(name=spec.key, spec=spec.model_dump_json(), folder=folder.path, key=key))
    if len(units) < len(specs):
        report.say(f"simulate: {len(specs) - len(units)} of {plural(len(specs), 'run')} done before")
    others = {unit.name for unit in units if not executor.mine(unit)}
    units = [unit for unit in units if unit.name not in others]
    failures: list[FailedRun] = []
    if units:
        # A lap ends before its time limit, so how much of the limit has passed says little about the rest.
        is_even = not any(spec.stop.lap for spec in specs)
        with report.stage("simulate", len(units), "runs", is_even=is_even) as stage:
            failures = failed_runs("simulate", executor.do(units, partial(report_event, stage)), report)
            begun = {unit.name for unit in units} - {failure.run for failure in failures}
            stage.fail(len(failures) + len(problems_of(workspace, [spec for spec in specs if spec.key in begun])))
    stopped = {failure.run for failure in failures} | others
    for spec in specs:
        if spec.key not in stopped:
            outcome = read_outcome(workspace.simulate(spec.key).path)
            before = planned_texts(spec) if outcome.suspicions else ()  # a command states these first
            for text in (*outcome.suspicions, *outcome.beyond_ranges):
                if text not in before:
                    report.say(f"simulate: {spec.key}: {text}")
    return failures + problems_of(workspace, [spec for spec in specs if spec.key not in stopped])


def problems_of(workspace: Workspace, specs: Sequence[RunSpec]) -> list[FailedRun]:
    """Return the problems of runs that were driven to an end."""
    return [
        FailedRun(run=spec.key, stage="simulate", problem=text)
        for spec in specs
        for text in read_outcome(workspace.simulate(spec.key).path).problems
    ]


def prepare_controllers(workspace: Workspace, specs: Sequence[RunSpec]) -> None:
    """Build the simulated board and firmware for the runs that are not done yet, before any of them begins, and check
    that there is their controller.

    Raises:
        InputError: A real board is required, which only `symolo hil` can use, or a controller's class or program is not
            there.
        EnvironmentLacking: A compiler or library is missing.
    """
    for spec in specs:
        if spec.controller is not None:
            controller_class(spec.controller)
        if spec.board is None or workspace.simulate(spec.key).is_done(simulation_key(spec)):
            continue
        if spec.board.kind == "serial":
            raise InputError("board.kind", got="serial", cure="drive its runs with `symolo hil --port PORT` first")
        build_for(spec.robot, spec.board)


def failed_runs(
    stage: str, failures: Sequence[UnitFailure], report: Report, runs: Mapping[str, str] | None = None
) -> list[FailedRun]:
    """Return the failures for the dataset, and report the rest of their texts, such as a log.

    Args:
        stage: Name of the stage.
        failures: Failures of units.
        report: Progress report.
        runs: Run of each unit by the name of the unit; by default the name is the run.
    """
    failed = []
    for failure in failures:
        name = failure.unit.name
        run = FailedRun.from_error((runs or {}).get(name, name), stage, failure.text)
        if failure.text != run.problem:  # the command itself prints `run.problem` at its end
            report.say(f"{stage}: {name}: {failure.text}")
        failed.append(run)
    return failed


def simulate_into(
    spec_json: str,
    path: Path,
    key: str,
    progress: Callable[[float], None],
    *,
    port: str = "",
    watch: "Watch | None" = None,
) -> None:
    """Simulate one run and write its folder; this loads PyBullet.

    Args:
        spec_json: The run specification.
        path: The stage's folder.
        key: Input key of the stage.
        progress: Called with the share that is done.
        port: Serial port of the board, for a specification with a real one.
        watch: Called at every control tick.
    """
    from pipeline.stages.simulate import simulate  # noqa: PLC0415 - loads pybullet

    spec = RunSpec.model_validate_json(spec_json)

    def on_time(done_s: float, total_s: float) -> None:
        progress(min(1.0, done_s / total_s))

    if spec.board is None:
        _publish(spec, simulate(spec, on_time, watch=watch), StageFolder(path), key)
        return
    if spec.board.kind == "serial" and not port:
        raise RunFailed("a board at a serial port drives this run; use `symolo hil --port PORT`")
    with connected_board(spec.robot, spec.board, spec.rates.control_hz, port) as runner:
        outcome = simulate(spec, on_time, runner, watch)
    _publish(spec, outcome, StageFolder(path), key, runner)


def _publish(
    spec: RunSpec, outcome: "DriveOutcome", folder: StageFolder, key: str, runner: BoardRunner | None = None
) -> None:
    recording = outcome.recording
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
        images=len(main_camera_rows(Rows.from_recording(recording), spec.rates).t_ms),
        cpu=cpu_class(),
        board=_board_record(spec.board, runner) if spec.board and runner else None,
        controller=_controller_record(spec),
        events=_event_lines(runner.events, spec.rates.control_hz) if runner else (),
        beyond_ranges=range_warnings(spec.robot, recording, spec.like.measured if spec.like else ()),
        suspicions=run_warnings(spec, recording),
    )
    write_file(partial / OUTCOME, canonical_json(summary.model_dump(mode="json")))
    folder.publish(partial, key, over=bool(spec.board and spec.board.kind == "serial"))


def _controller_record(spec: RunSpec) -> ControllerRecord | None:
    if spec.controller is None:
        return None
    return ControllerRecord(name=spec.controller.name, files=hashes_of_controller(spec.controller.name))


def _board_record(board: Board, runner: BoardRunner) -> BoardRecord:
    kinds = counted(runner.events)
    return BoardRecord(
        kind=board.kind,
        framing=board.framing,
        bits_per_s=board.bits_per_s,
        actuation_delay_ticks=board.actuation_delay_ticks,
        firmware_id=runner.firmware_id,
        rows_unanswered=kinds["no answer"],
        events={column: kinds[kind] for kind, column in BOARD_EVENT_COLUMNS.items() if kinds[kind]},
    )


def _event_lines(events: Sequence[BoardEvent], control_hz: int) -> tuple[str, ...]:
    lines = [
        f"{event.tick / control_hz:.2f} s: {event.kind}: {event.text}"
        + (f", and {event.count - 1} more" if event.count > 1 else "")
        for event in events[:MAX_EVENTS]
    ]
    left = len(events) - len(lines)
    return (*lines, *([f"and {left} more"] if left else []))


def spec_text(spec: SceneSpec) -> bytes:
    return canonical_json(spec.model_dump(mode="json"))


def read_outcome(path: Path) -> RunOutcome:
    return RunOutcome.model_validate_json(read_file(path / OUTCOME, FileKind.DOCUMENT))


def refresh_spec(folder: StageFolder, key: str, spec: SceneSpec) -> None:
    """Write the current look into `spec.json`; the trajectory does not depend on it."""
    text = spec_text(spec)
    if read_file(folder.path / SPEC, FileKind.DOCUMENT) != text:
        write_file(folder.path / SPEC, text)
        mark_done(folder.path, key)
