"""Commands that do the stages of a dataset: plan, simulate, render, assemble, release."""

import shlex
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.exit_codes import RUN_FAILED
from pipeline.commands.options import (
    Address,
    AllowHttp,
    Endpoint,
    ExecutorName,
    GpuShare,
    Json,
    Like,
    OnDevice,
    Out,
    Part,
    Replace,
    Scenario,
    Settings,
    WorkedBy,
    WorkerMemory,
    Workers,
    with_device,
    with_like,
)
from symolo.core.errors import InputError
from symolo.core.extras import check_installed

if TYPE_CHECKING:
    from pipeline.executors import Executor
    from pipeline.stages.upload import Destination, ReleaseUpload
    from pipeline.work.batch import Batch
    from symolo.core.progress import Report
    from symolo.dataset.documents.metadata import FailedRun

STAGES = ("simulate", "render", "assemble")


def plan(
    scenario: Scenario,
    *,
    settings: Settings = None,
    like: Like = None,
    images: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=10**12,
            metavar="N",
            help="Estimate the cost of N images by timing a few.",
        ),
    ] = None,
    device: OnDevice = None,
    workers: Workers = None,
    as_json: Json = False,
) -> None:
    """Show what a scenario will produce, its size and how long it takes. Nothing is written.

    Example: symolo plan symolo --set render.quality=high

    Cost of a million images in core-hours and terabytes, measured in a minute: symolo plan symolo --images 1000000
    """
    from configs.loader import load_scenario
    from pipeline.planning.drawing import draw_reported
    from pipeline.planning.plan import ScenarioPlan
    from pipeline.work.supervisor import cores
    from symolo.core.progress import report_here

    overrides = with_device(with_like(settings, like), device)
    if images is not None:
        if workers is not None:
            raise InputError("--workers", got=workers, cure="leave it out: the cost of --images is that of all cores")
        from pipeline.planning.price import measure

        price, about = measure(scenario, overrides, report_here())
        if as_json:
            from pipeline.json_results.plan import PlanResult

            typer.echo(PlanResult.of_price(scenario, cores(), price, images).to_json())
        else:
            typer.echo(price.text(images, about))
        return
    loaded = load_scenario(scenario, overrides)
    specs = draw_reported(loaded, report_here())
    planned = ScenarioPlan.of(specs, cores(), loaded.like, workers, loaded.replaced_draws)
    if as_json:
        from pipeline.json_results.plan import PlanResult

        typer.echo(PlanResult.of(scenario, planned).to_json())
    else:
        typer.echo(planned.text())


def simulate(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    memory: WorkerMemory = None,
    part: Part = None,
) -> int:
    """Simulate every run in PyBullet, and store its trajectory and sensor readings.

    They are in the hidden folder DIR/.stages, for `view`, `video`, `baselines` and the next stage.

    Example: symolo simulate smoke --out data

    As a dataset without images: symolo release smoke --set rates.camera_hz=0 --out tables

    Robots that agree with a diagnosis: symolo simulate smoke --like diagnosis --out data
    """
    from pipeline.executors import chosen

    return _make(["simulate"], scenario, with_like(settings, like), out, chosen(workers, memory, part), part=part)


def render(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    part: Part = None,
) -> int:
    """Render the images of every simulated run in Blender, and make the annotations that the scenario names.

    Example: symolo render smoke --out data

    One of ten jobs on different machines: symolo render smoke --out data --part 3/10
    """
    from pipeline.executors import chosen

    return _make(
        ["render"],
        scenario,
        with_device(with_like(settings, like), device),
        out,
        chosen(workers, memory, part),
        part=part,
    )


def assemble(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    device: OnDevice = None,
    replace: Replace = False,
) -> int:
    """Assemble the dataset from the rendered runs, with description, metadata and checksums.

    Example: symolo assemble smoke --out data
    """
    from pipeline.executors import chosen

    overrides = with_device(with_like(settings, like), device)
    return _make(["assemble"], scenario, overrides, out, chosen(workers), replace=replace)


def release(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    like: Like = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    executor: WorkedBy = ExecutorName.LOCAL,
    address: Address = "auto",
    gpu_share: GpuShare = None,
    upload: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            help="Send each run to this address as soon as it is complete, and the lists of checksums at the end: "
            "s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER.",
        ),
    ] = None,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
    replace: Replace = False,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Print what would be lost, made again and kept, and do nothing else.",
        ),
    ] = False,
    as_json: Json = False,
) -> int:
    """Make a dataset from a scenario: simulate, render and assemble.

    Example: symolo release smoke --out data

    The same command continues after an interruption. It repeats only the work whose inputs have changed: after a change
    of the look, it renders again, but does not simulate again.

    What a command with other inputs would do: symolo release smoke --out data --set render.quality=high --dry-run

    With --dry-run --json, the key `up_to_date` states whether there is nothing to do, as far as the settings and the
    names of the files show; `symolo status DIR --check` also hashes the files.

    Robots that agree with a diagnosis, another one in each run: symolo release smoke --like diagnosis --out data

    On a cluster: symolo release symolo --out /shared/data --executor ray --address head:6379

    Upload while it runs: symolo release smoke --out data --upload file:///mnt/shelf/data
    """
    if executor is ExecutorName.RAY and workers is not None:
        raise InputError("--workers", got=workers, cure="leave it out: the size of the cluster decides")
    if executor is not ExecutorName.RAY and gpu_share is not None:
        raise InputError(
            "--gpu-share", got=gpu_share, cure="leave it out: without Ray, workers use the graphics cards alternately"
        )
    if as_json and not dry_run:
        raise InputError("--json is for --dry-run", cure="add --dry-run; metadata.json states what a release has")
    from pipeline.executors import chosen

    cluster = address if executor is ExecutorName.RAY else None
    workplace = chosen(workers, memory, address=cluster, card_share=gpu_share)
    to = _destination(out, upload, endpoint, allow_http=allow_http)
    overrides = with_device(with_like(settings, like), device)
    return _make(STAGES, scenario, overrides, out, workplace, to=to, replace=replace, dry_run=dry_run, as_json=as_json)


def _destination(out: Path, url: str | None, endpoint: str | None, *, allow_http: bool) -> "Destination | None":
    if url is None:
        if endpoint or allow_http:
            raise InputError("--endpoint" if endpoint else "--allow-http", cure="name the destination with --upload")
        return None
    from pipeline.stages.upload import Destination
    from symolo.storage.address import store_of

    options = [*(["--endpoint", endpoint] if endpoint else []), *(["--allow-http"] if allow_http else [])]
    command = shlex.join(["symolo", "upload", str(out), url, *options])
    return Destination(store_of(url, endpoint, allow_http=allow_http), command)


def _make(
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
        typer.echo(ReleaseResult.of(str(out), runs, losses, is_whole=not missing_from_release(workspace)).to_json())


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
