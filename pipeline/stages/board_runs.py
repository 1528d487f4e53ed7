"""Runs with a board in the loop, one after the other in this process, with a live view on a terminal."""

import sys
from collections.abc import Sequence

from configs.schema.scenario import RunSpec
from hil.links.serial_link import SerialLink
from pipeline.run_folder.workspace import Workspace
from pipeline.stages.simulate_runs import prepare_controllers, problems_of, read_outcome, simulate_into, simulation_key
from symolo.core.errors import RunFailed
from symolo.core.progress import Report, plural
from symolo.dataset.documents.metadata import FailedRun


def check_board(workspace: Workspace, specs: Sequence[RunSpec], port: str) -> None:
    """Check that the board can be used, before anything is written.

    Raises:
        InputError: The port cannot be opened, or the robot's numbers do not fit the firmware.
        EnvironmentLacking: A tool that builds the simulated board is missing.
    """
    if not port:
        prepare_controllers(workspace, specs)
        return
    for spec in specs:
        if spec.board:
            SerialLink(port, spec.board.bits_per_s).close()
            return


def drive_runs(workspace: Workspace, specs: Sequence[RunSpec], port: str, report: Report) -> list[FailedRun]:
    """Drive the runs that are not driven yet, and return all failures, now or before.

    Args:
        workspace: Output folder.
        specs: Runs, each with a board.
        port: Serial port of the real board; empty for the simulated one.
        report: Progress report.
    """
    # A real board may succeed at the next try; the simulated one does the same every time.
    due = []
    for spec in specs:
        folder = workspace.simulate(spec.key)
        done = folder.is_done(simulation_key(spec))
        if not done or (port and read_outcome(folder.path).problems):
            due.append(spec)
    if len(due) < len(specs):
        report.say(f"hil: {len(specs) - len(due)} of {plural(len(specs), 'run')} done before")
    failures: list[FailedRun] = []
    for spec in due:
        try:
            _drive(workspace, spec, port, report)
        except RunFailed as error:
            failures.append(FailedRun.from_error(spec.key, "simulate", str(error)))
    lost = {failure.run for failure in failures}
    return failures + problems_of(workspace, [spec for spec in specs if spec.key not in lost])


def _drive(workspace: Workspace, spec: RunSpec, port: str, report: Report) -> None:
    folder, key, text = workspace.simulate(spec.key).path, simulation_key(spec), spec.model_dump_json()
    if not sys.stderr.isatty():
        with report.stage(f"hil {spec.key}", 100, "%") as stage:
            simulate_into(text, folder, key, lambda share: stage.update(spec.key, 100.0 * share), port=port)
        return
    from pipeline.work.board_view import live_view  # noqa: PLC0415 - a terminal alone has one

    with live_view(spec) as view:
        simulate_into(text, folder, key, lambda _share: None, port=port, watch=view.show)
