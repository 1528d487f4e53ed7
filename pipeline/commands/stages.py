"""What the commands of the stages share: doing one stage or all, and printing what failed."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from pipeline.commands.exit_codes import RUN_FAILED
from symolo.core.extras import check_installed

if TYPE_CHECKING:
    from pipeline.executors import Executor
    from pipeline.stages.upload import Destination, ReleaseUpload
    from pipeline.work.batch import Batch
    from symolo.core.progress import Report
    from symolo.dataset.documents.metadata import FailedRun


def make(
    stages: Sequence[str],
    scenario: str,
    overrides: Sequence[str],
    out: Path,
    executor: "Executor",
    *,
    part: str | None = None,
    to: "Destination | None" = None,
    replace: bool = False,
    dry_run: bool = False,
    as_json: bool = False,
) -> int:
    """Do one stage, or all of them for `release`, and return the exit code."""
    from pipeline.run_folder.losses import check_losses
    from pipeline.stages.simulate_runs import prepare_controllers
    from pipeline.work.batch import Batch
    from symolo.core.progress import report_here

    command = stages[0] if len(stages) == 1 else "release"
    report = report_here()
    if "simulate" in stages:
        check_installed("pybullet")
    batch = Batch.open(scenario, overrides, out, executor, report, renders=command != "simulate")
    if dry_run:
        _dry_run(batch, out, report, replace=replace, as_json=as_json)
        return 0
    if "assemble" in stages:
        check_losses(batch.workspace, batch.loaded.tree, batch.specs, report, replace=replace)
    if "render" in stages and batch.has_images:
        check_installed("bpy")
    failures = batch.simulated() if "simulate" not in stages else []
    if command == "assemble":
        failures += batch.rendered(failures)
    if "simulate" in stages:
        prepare_controllers(batch.workspace, batch.specs)
    with ExitStack() as held:
        upload = held.enter_context(to.opened(batch.workspace, batch.loaded.tree, batch.specs, report)) if to else None
        held.enter_context(batch.workspace.locked(alone=executor.does_all))
        failures = _do_stages(batch, stages, failures, report, upload, replace=replace)
        if part is not None:
            print_failures(failures)
            typer.echo(f"{command}: part {part} is done, in {out}; when all parts are done, `symolo release` finishes")
            return RUN_FAILED if failures else 0
        code = conclude(failures, len(batch.specs), command, out)
        if upload is not None:
            typer.echo(upload.finish(complete=not failures))
    return code


def _dry_run(batch: "Batch", out: Path, report: "Report", *, replace: bool, as_json: bool) -> None:
    """Print what a release of these runs would take away, do and keep.

    Raises:
        InputError: Something would be lost, without `replace`; the JSON is not printed then.
    """
    from pipeline.json_results.release import ReleaseResult
    from pipeline.run_folder.losses import check_losses, losses_of
    from pipeline.run_folder.status import missing_from_release, run_status
    from pipeline.run_folder.status_text import dry_run

    workspace, tree, specs = batch.workspace, batch.loaded.tree, batch.specs
    runs, losses = [run_status(workspace, spec.key, spec) for spec in specs], losses_of(workspace, tree, specs)
    for line in () if as_json else dry_run(runs, losses):
        typer.echo(line)
    check_losses(workspace, tree, specs, report, replace=replace, dry_run=True)
    if as_json:
        typer.echo(
            ReleaseResult.from_status(str(out), runs, losses, is_whole=not missing_from_release(workspace)).to_json()
        )


def _do_stages(
    batch: "Batch",
    stages: Sequence[str],
    failures: "Sequence[FailedRun]",
    report: "Report",
    upload: "ReleaseUpload | None",
    *,
    replace: bool,
) -> "list[FailedRun]":
    """Do the stages and return all failures; `upload` uploads each run as soon as it is complete."""
    from pipeline.run_folder.losses import protected_runs
    from pipeline.run_folder.status import again

    protected: frozenset[str] = frozenset()
    if "assemble" in stages:
        protected = protected_runs(batch.workspace, batch.loaded.tree, batch.specs, report, replace=replace)
    failed = [*failures]
    for line in (*(batch.notes if "simulate" in stages else ()), *again(batch.workspace, batch.specs)):
        report.say(line)
    if "render" in stages and batch.has_images:
        batch.copy_user_images()
    if "simulate" in stages:
        failed += batch.simulate(report)
    if "render" in stages:
        # A finished dataset stays as it is until no run can fail any more.
        on_complete = [upload.run_done] if upload and not protected else []
        failed += batch.render(failed, report, *on_complete)
    if upload:
        upload.assembled()
    if "assemble" in stages:
        batch.assemble(failed, report, protected)
    return failed


def print_failures(failures: "Sequence[FailedRun]") -> None:
    for failure in failures:
        typer.echo(f"failed: {failure.run}: {failure.stage}: {failure.problem}", err=True)


def conclude(failures: "Sequence[FailedRun]", runs: int, command: str, out: Path, unit: str = "run") -> int:
    """Print what failed and how many runs are good, and return the exit code."""
    from symolo.core.progress import plural

    print_failures(failures)
    good = runs - len({failure.run for failure in failures})
    typer.echo(f"{command}: {good} of {plural(runs, unit)}, in {out}")
    return RUN_FAILED if failures else 0
