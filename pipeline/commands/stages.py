"""Commands that make data: plan, simulate, render, assemble, release, rerender."""

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
    from symolo.dataset.metadata import FailedRun

RUN_FAILED = 3
STAGES = ("simulate", "render", "assemble")


def plan(
    scenario: Scenario,
    *,
    settings: Settings = None,
    frames: Annotated[
        int | None,
        typer.Option(min=1, max=10**12, metavar="N", help="Price so many images, by a few that are made and timed."),
    ] = None,
    device: OnDevice = None,
) -> None:
    """Say what a scenario would make, how large and how long; write nothing.

    Example: symolo plan symolo --set render.quality=high

    What a million images would cost, in core-hours and terabytes, measured here in a minute: symolo plan symolo
    --frames 1000000
    """
    from configs.loader import load_scenario
    from pipeline.planning.drawing import draw_reported
    from pipeline.planning.plan import ScenarioPlan
    from pipeline.work.supervisor import cores
    from symolo.core.progress import report_here

    overrides = with_device(settings, device)
    if frames is not None:
        from pipeline.planning.price import measure

        price, about = measure(scenario, overrides, report_here())
        typer.echo(price.text(frames, about))
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
    """First stage: drive every run in PyBullet and store its trajectory and readings.

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
    """Second stage: render the images of every simulated run in Blender, and annotate them where asked for.

    Example: symolo render smoke --out data

    One job of ten, each on a machine of its own: symolo render smoke --out data --part 3/10
    """
    return _make("render", scenario, out, settings, workers, device, memory, part)


def assemble(
    scenario: Scenario, out: Out, *, settings: Settings = None, workers: Workers = None, device: OnDevice = None
) -> int:
    """Third stage: put the dataset together, with description, metadata and checksums.

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
            help="Send each run there as soon as it is whole, while others are made, and the lists of checksums at the "
            "end: s3://BUCKET/PREFIX, gs://BUCKET/PREFIX or file:///FOLDER.",
        ),
    ] = None,
    endpoint: Endpoint = None,
    allow_http: AllowHttp = False,
) -> int:
    """All stages: from a scenario to a dataset. Given again, it continues where it stopped.

    Example: symolo release smoke --out data

    What is done and unchanged is not done again: with another look only the images are made anew.

    On a cluster: symolo release symolo --out /shared/data --executor ray --address head:6379

    Sent while it is made: symolo release smoke --out data --upload file:///mnt/shelf/data
    """
    if executor is ExecutorName.RAY and workers is not None:
        raise InputError("--workers", got=workers, cure="leave it out: the size of the cluster decides")
    if executor is not ExecutorName.RAY and gpu_share is not None:
        raise InputError("--gpu-share", got=gpu_share, cure="leave it out: here --workers take the cards in turn")
    where = address if executor is ExecutorName.RAY else None
    to = _destination(out, upload, endpoint, allow_http=allow_http)
    return _make(
        "release", scenario, out, settings, workers, device, memory, address=where, card_share=gpu_share, to=to
    )


def _destination(out: Path, url: str | None, endpoint: str | None, *, allow_http: bool) -> "Destination | None":
    if url is None:
        if endpoint or allow_http:
            raise InputError("--endpoint" if endpoint else "--allow-http", cure="name the place by --upload")
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
    """Do one stage, or all for `release`."""
    from pipeline.executors import chosen
    from pipeline.work.batch import Batch
    from symolo.core.progress import report_here

    executor = chosen(workers, memory, part, address, card_share)
    stages = STAGES if command == "release" else (command,)
    report = report_here()
    overrides, pictured = with_device(settings, device), command != "simulate"
    batch = Batch.open(scenario, overrides, out, executor, report, pictured=pictured)
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
    """What failed, before these stages or in them; of a release `along` its way each run leaves as it is whole."""
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
    typer.echo(f"{command}: part {part} is done, in {out}; when all are, `symolo release` finishes")
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
        typer.Option(metavar="NAME", help="Name of a shipped look, or a YAML file; its pictures lie in DIR."),
    ] = None,
    looks: Annotated[
        str | None,
        typer.Option(metavar="NAME,...", help="Looks as above; the pictures of draw k lie in DIR/LOOK_k, k from 1."),
    ] = None,
    draws: Annotated[
        int | None, typer.Option("-n", "--n", min=1, max=1000, metavar="N", help="Draws of each of --looks; else one.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            callback=if_given(checked_new_folder),
            help="Output folder: new, empty, or one that symolo made before; by default one named by run and "
            "looks in this folder, such as CW-test_1-classroom-night.",
        ),
    ] = None,
    arena: Annotated[str | None, typer.Option(metavar="NAME", help="Arena; the run's own, else symolo.")] = None,
    robot: Annotated[str | None, typer.Option(metavar="NAME", help="Robot; the run's own, else nominal.")] = None,
    camera_hz: Annotated[
        float | None,
        typer.Option("--camera-hz", min=0.001, max=1000, metavar="HZ", help="Image rate; else the img column decides."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, max=2**63 - 1, metavar="N", help="Seed of the look; the run's own by default.")
    ] = None,
    settings: Settings = None,
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
) -> int:
    """Render a stored trajectory again under other looks, without simulating.

    Example: symolo rerender data/CW/test_1 --look lab --out lab

    Ten draws of each of two looks: symolo rerender data/CW/test_1 --looks classroom,night --n 10

    A data.csv alone: symolo rerender elsewhere/data.csv --look classroom --camera-hz 5 --out pictures

    The first draw of a look is the one that --look gives; the others have seeds of their own, which look.json
    tells.
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
    found, drawn = prepare(source, request)
    apart = looks is not None
    where = out or checked_new_folder(Path(folder_name(found, drawn)))
    if out is None:
        check_same(found, drawn, where, apart=apart)
    with open_folders(found, drawn, where, apart=apart) as folders:
        executor = Local.of(workers, memory).on(drawn[0].appearance.device)
        failures = render_source(found, drawn, folders, executor, report_here())
    return conclude(failures, len(drawn), "rerender", where, "draw")


def _chosen_looks(look: str | None, looks: str | None, draws: int | None) -> tuple[str, ...]:
    if (look is None) == (looks is None):
        raise InputError("--look" if looks is None else "--looks", allowed="one look by --look, or several by --looks")
    if looks is None and draws is not None:
        raise InputError("--n", got=draws, cure="name the looks by --looks")
    return names(looks, "--looks") if looks is not None else (str(look),)


def conclude(failures: "Sequence[FailedRun]", runs: int, command: str, out: Path, unit: str = "run") -> int:
    """Say what failed and what is there; the exit code."""
    for failure in failures:
        typer.echo(f"failed: {failure.run}: {failure.stage}: {failure.problem}", err=True)
    good = runs - len({failure.run for failure in failures})
    typer.echo(f"{command}: {good} of {runs} {unit if runs == 1 else f'{unit}s'}, in {out}")
    return RUN_FAILED if failures else 0
