"""Commands that generate data: plan, simulate, render, assemble, release, rerender."""

import shlex
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.options import (
    Address,
    AllowHttp,
    Device,
    Endpoint,
    ExecutorName,
    GpuShare,
    OnDevice,
    Out,
    Part,
    Scenario,
    Settings,
    WorkedBy,
    WorkerMemory,
    Workers,
    checked_input,
    checked_new_folder,
    if_given,
    names,
    with_device,
)
from symolo.core.errors import InputError

if TYPE_CHECKING:
    from pipeline.stages.upload import Along, Destination
    from pipeline.work.batch import Batch
    from symolo.core.progress import Report
    from symolo.dataset.documents.metadata import FailedRun

RUN_FAILED = 3
STAGES = ("simulate", "render", "assemble")


def plan(
    scenario: Scenario,
    *,
    settings: Settings = None,
    images: Annotated[
        int | None,
        typer.Option(min=1, max=10**12, metavar="N", help="Estimate the cost of N images: a few are made and timed."),
    ] = None,
    device: OnDevice = None,
) -> None:
    """Show what a scenario will produce, its size and how long it takes. Writes nothing.

    Example: symolo plan symolo --set render.quality=high

    Cost of a million images in core-hours and terabytes, measured in a minute: symolo plan symolo --images 1000000
    """
    from configs.loader import load_scenario
    from pipeline.planning.drawing import draw_reported
    from pipeline.planning.plan import ScenarioPlan
    from pipeline.work.supervisor import cores
    from symolo.core.progress import report_here

    overrides = with_device(settings, device)
    if images is not None:
        from pipeline.planning.price import measure

        price, about = measure(scenario, overrides, report_here())
        typer.echo(price.text(images, about))
        return
    specs = draw_reported(load_scenario(scenario, overrides), report_here())
    typer.echo(ScenarioPlan.of(specs, cores()).text())


def simulate(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    workers: Workers = None,
    memory: WorkerMemory = None,
    part: Part = None,
) -> int:
    """Stage 1: simulate every run in PyBullet and store its trajectory and sensor readings.

    Example: symolo simulate smoke --out data
    """
    return _make("simulate", scenario, out, settings, workers, memory=memory, part=part)


def render(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    part: Part = None,
) -> int:
    """Stage 2: render the images of every simulated run in Blender, with the annotations of the scenario.

    Example: symolo render smoke --out data

    One of ten jobs, each on another machine: symolo render smoke --out data --part 3/10
    """
    return _make("render", scenario, out, settings, workers, device, memory, part)


def assemble(
    scenario: Scenario, out: Out, *, settings: Settings = None, workers: Workers = None, device: OnDevice = None
) -> int:
    """Stage 3: assemble the dataset with description, metadata and checksums.

    Example: symolo assemble smoke --out data
    """
    return _make("assemble", scenario, out, settings, workers, device)


def release(
    scenario: Scenario,
    out: Out,
    *,
    settings: Settings = None,
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
            help="Send each run there as soon as it is complete, and the lists of checksums at the end: "
            "s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER.",
        ),
    ] = None,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
) -> int:
    """Make a dataset from a scenario: all three stages.

    Example: symolo release smoke --out data

    The same command continues after an interruption. Only what has changed is made again: with another look, only the
    images.

    On a cluster: symolo release symolo --out /shared/data --executor ray --address head:6379

    Upload while it runs: symolo release smoke --out data --upload file:///mnt/shelf/data
    """
    if executor is ExecutorName.RAY and workers is not None:
        raise InputError("--workers", got=workers, cure="leave it out: the size of the cluster decides")
    if executor is not ExecutorName.RAY and gpu_share is not None:
        raise InputError(
            "--gpu-share", got=gpu_share, cure="leave it out: without Ray, workers take the graphics cards in turn"
        )
    where = address if executor is ExecutorName.RAY else None
    to = _destination(out, upload, endpoint, allow_http=allow_http)
    return _make(
        "release", scenario, out, settings, workers, device, memory, address=where, card_share=gpu_share, to=to
    )


def _destination(out: Path, url: str | None, endpoint: str | None, *, allow_http: bool) -> "Destination | None":
    if url is None:
        if endpoint or allow_http:
            raise InputError("--endpoint" if endpoint else "--allow-http", cure="name the destination by --upload")
        return None
    from pipeline.stages.upload import Destination
    from symolo.storage.address import store_of

    options = [*(["--endpoint", endpoint] if endpoint else []), *(["--allow-http"] if allow_http else [])]
    command = shlex.join(["symolo", "upload", str(out), url, *options])
    return Destination(store_of(url, endpoint, allow_http=allow_http), command)


def _make(  # noqa: PLR0917 - the options of the commands
    command: str,
    scenario: str,
    out: Path,
    settings: Sequence[str] | None,
    workers: int | None,
    device: Device | None = None,
    memory: float | None = None,
    part: str | None = None,
    address: str | None = None,
    card_share: float | None = None,
    to: "Destination | None" = None,
) -> int:
    """Do one stage, or all of them for `release`."""
    from pipeline.executors import chosen
    from pipeline.work.batch import Batch
    from symolo.core.progress import report_here

    executor = chosen(workers, memory, part, address, card_share)
    stages = STAGES if command == "release" else (command,)
    report = report_here()
    overrides, renders = with_device(settings, device), command != "simulate"
    batch = Batch.open(scenario, overrides, out, executor, report, renders=renders)
    failures = batch.simulated() if "simulate" not in stages else []
    if "assemble" in stages and "render" not in stages:
        failures += batch.rendered(failures)
    if "simulate" in stages:
        batch.prepare_boards()
    with ExitStack() as held:
        along = held.enter_context(to.opened(batch.workspace, batch.loaded.tree, batch.specs, report)) if to else None
        held.enter_context(batch.workspace.locked(alone=executor.does_all))
        failures = _done(batch, stages, failures, report, along)
        if part is not None:
            return _concluded_part(failures, command, part, out)
        code = conclude(failures, len(batch.specs), command, out)
        if along is not None:
            typer.echo(along.finish(complete=not failures))
    return code


def _done(
    batch: "Batch",
    stages: Sequence[str],
    failures: "Sequence[FailedRun]",
    report: "Report",
    along: "Along | None",
) -> "list[FailedRun]":
    """Do the stages and return all failures; `along` uploads each run as soon as it is complete."""
    from pipeline.run_folder.status import again

    failed = [*failures]
    for line in again(batch.workspace, batch.specs):
        report.say(line)
    if "render" in stages:
        batch.keep_user_files()
    if "simulate" in stages:
        failed += batch.simulate(report)
    if "render" in stages:
        failed += batch.render(failed, report, along.whole) if along else batch.render(failed, report)
    if along:
        along.assembled()
    if "assemble" in stages:
        batch.assemble(failed, report)
    return failed


def _concluded_part(failures: "Sequence[FailedRun]", command: str, part: str, out: Path) -> int:
    for failure in failures:
        typer.echo(f"failed: {failure.run}: {failure.stage}: {failure.problem}", err=True)
    typer.echo(f"{command}: part {part} is done, in {out}; when all parts are done, `symolo release` finishes")
    return RUN_FAILED if failures else 0


def rerender(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="RUN", callback=checked_input, help="Run folder of a dataset or of .stages, or a data.csv."
        ),
    ],
    *,
    look: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Name of a shipped look, or a YAML file; its images are in DIR."),
    ] = None,
    looks: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...", help="Several looks; the images of draw k of a look are in DIR/LOOK_k, k from 1."
        ),
    ] = None,
    draws: Annotated[
        int | None,
        typer.Option("-n", "--draws", min=1, max=1000, metavar="N", help="Draws of each of --looks; by default 1."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            callback=if_given(checked_new_folder),
            help="Output folder: new, empty, or one that symolo made before; by default a folder named after run and "
            "looks, such as CW-test_1-classroom-night.",
        ),
    ] = None,
    arena: Annotated[
        str | None, typer.Option(metavar="NAME", help="Arena; by default that of the run, or symolo.")
    ] = None,
    robot: Annotated[
        str | None, typer.Option(metavar="NAME", help="Robot; by default that of the run, or nominal.")
    ] = None,
    camera_hz: Annotated[
        float | None,
        typer.Option(
            "--camera-hz", min=0.001, max=1000, metavar="HZ", help="Image rate; by default the column img decides."
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=2**63 - 1, metavar="N", help="Seed of the look; by default that of the run."),
    ] = None,
    settings: Settings = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
) -> int:
    """Render a stored trajectory again under other looks, without simulating.

    Example: symolo rerender data/CW/test_1 --look lab --out lab

    Ten draws of each of two looks: symolo rerender data/CW/test_1 --looks classroom,night --draws 10

    A data.csv alone: symolo rerender elsewhere/data.csv --look classroom --camera-hz 5 --out images

    The first draw of a look equals that of --look; the others have seeds of their own, which are in look.json.
    """
    from pipeline.executors.local import Local
    from pipeline.rerendering.rerender import (
        RerenderRequest,
        check_same,
        folder_name,
        open_folders,
        prepare,
        render_source,
    )
    from symolo.core.progress import report_here

    chosen = _chosen_looks(look, looks, draws)
    option = "--look" if looks is None else "--looks"
    request = RerenderRequest(chosen, draws or 1, arena, robot, camera_hz, seed, with_device(settings, device), option)
    trajectory, drawn = prepare(source, request)
    apart = looks is not None
    where = out or checked_new_folder(Path(folder_name(trajectory, drawn)))
    if out is None:
        check_same(trajectory, drawn, where, apart=apart)
    with open_folders(trajectory, drawn, where, apart=apart) as folders:
        executor = Local.of(workers, memory).on(drawn[0].appearance.device)
        failures = render_source(trajectory, drawn, folders, executor, report_here())
    return conclude(failures, len(drawn), "rerender", where, "draw")


def _chosen_looks(look: str | None, looks: str | None, draws: int | None) -> tuple[str, ...]:
    if (look is None) == (looks is None):
        raise InputError("--look" if looks is None else "--looks", allowed="one look by --look, or several by --looks")
    if looks is None and draws is not None:
        raise InputError("--draws", got=draws, cure="name the looks by --looks")
    return names(looks, "--looks") if looks is not None else (str(look),)


def conclude(failures: "Sequence[FailedRun]", runs: int, command: str, out: Path, unit: str = "run") -> int:
    """Print what failed and how many runs are good, and return the exit code."""
    for failure in failures:
        typer.echo(f"failed: {failure.run}: {failure.stage}: {failure.problem}", err=True)
    good = runs - len({failure.run for failure in failures})
    typer.echo(f"{command}: {good} of {runs} {unit if runs == 1 else f'{unit}s'}, in {out}")
    return RUN_FAILED if failures else 0
