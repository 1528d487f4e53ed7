"""The command `symolo rerender`: new images for existing trajectories, as a release."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.commands.log_options import (
    BodyAt,
    Forward,
    HeadingFromPath,
    LogFormat,
    Mapping,
    PoseHz,
    RowHz,
    Topics,
    Up,
    Yes,
    checked_name,
    describe_logs,
    read_settings,
)
from pipeline.commands.options import (
    DryRun,
    OnDevice,
    Replace,
    Settings,
    WorkerMemory,
    Workers,
    checked_inputs,
    checked_new_folder,
    if_given,
    names,
    with_device,
)
from pipeline.commands.stages import conclude
from symolo.core.errors import InputError

if TYPE_CHECKING:
    from pipeline.rerendering.rerender import Rerendering


def rerender(
    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="SOURCE...",
            callback=checked_inputs,
            help="A dataset, or a run folder of one; or logs of other programs, each with one run or several.",
        ),
    ],
    *,
    look: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Name of a shipped look, or a YAML file; runs keep their names."),
    ] = None,
    looks: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Several looks; the runs of draw k of a look are in the folder ROUTE-LOOK_k, with k from 1.",
        ),
    ] = None,
    draws: Annotated[
        int | None,
        typer.Option(
            "-n",
            "--draws",
            min=1,
            max=1000,
            metavar="N",
            help="Number of random draws of each look; by default 1.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            callback=if_given(checked_new_folder),
            help="Output folder: new, empty, or one that symolo made before; by default a folder named after the "
            "source and the looks, such as CW-test_1-classroom-night.",
        ),
    ] = None,
    runs: Annotated[
        str | None,
        typer.Option(metavar="PATTERN", help="Only these runs of a dataset, such as 'CW/*'; by default all."),
    ] = None,
    arena: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Shipped arena, or a YAML file; by default that of the run, for a log an empty floor that fits its "
            "path.",
        ),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Shipped robot, or a YAML file, whose camera takes the images; by default that of the run, for a log "
            "nominal.",
        ),
    ] = None,
    camera_hz: Annotated[
        float | None,
        typer.Option(min=0.001, max=1000, metavar="HZ", help="Image rate; by default that of the run, for a log 5 Hz."),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=2**63 - 1, metavar="N", help="Seed of the look; by default that of each run."),
    ] = None,
    name: Annotated[
        str | None, typer.Option(metavar="NAME", help="Name of the new dataset; by default of the source and looks.")
    ] = None,
    settings: Settings = None,
    form: LogFormat = None,
    mapping: Mapping = None,
    yes: Yes = False,
    up: Up = None,
    forward: Forward = None,
    heading_from_path: HeadingFromPath = False,
    body_at: BodyAt = None,
    pose_hz: PoseHz = None,
    row_hz: RowHz = None,
    topic: Topics = None,
    licence: Annotated[
        str, typer.Option(metavar="SPDX", help="Licence of the logs, such as CC-BY-4.0; a dataset keeps its own.")
    ] = "NOASSERTION",
    workers: Workers = None,
    device: OnDevice = None,
    memory: WorkerMemory = None,
    dry_run: DryRun = False,
    replace: Replace = False,
) -> int:
    """Render images of existing trajectories under other looks, without simulating.

    The output is a dataset as `release` makes it: `verify`, `report`, `export` and `diagnose` take it. Its metadata
    say where the trajectories come from.

    Example: symolo rerender data --look lab --out lab

    Ten draws of each of two looks, of one run: symolo rerender data/CW/test_1 --looks classroom,night --draws 10

    A log of another program: symolo rerender groundtruth.txt --looks classroom,lab,night --out images

    The first draw of a look is the same as with --look; the others have different seeds, which are in metadata.json.
    """
    from pipeline.executors.local import Local
    from pipeline.importing.imported_runs import ImportRequest
    from pipeline.rerendering.rerender import (
        RerenderRequest,
        check_overrides,
        check_place,
        folder_name,
        make_release,
        prepare,
    )
    from pipeline.rerendering.sources import read_sources
    from symolo.core.progress import report_here

    chosen = _chosen_looks(look, looks, draws)
    option = "--look" if looks is None else "--looks"
    if name is not None:
        checked_name("--name", name)
    overrides = with_device(settings, device)
    request = RerenderRequest(chosen, draws or 1, arena, robot, camera_hz, seed, overrides, option, name)
    check_overrides(request)
    reading = read_settings(mapping, up, forward, pose_hz, topic, heading_from_path=heading_from_path, body_at=body_at)
    read = read_sources(
        sources, runs, ImportRequest(tuple(sources), form, reading, row_hz, arena, robot, licence=licence)
    )
    rerendering = prepare(read, request)
    where = out or checked_new_folder(Path(folder_name(read, request)))
    report = report_here()
    check_place(rerendering, where, report, is_default=out is None, replace=replace, dry_run=dry_run)
    if read.imported is not None:
        describe_logs(read.imported, yes=yes or dry_run)
    if recorded := read.recorded_cameras:
        where_they_are = "`symolo import` keeps them" if read.imported else f"they stay in {sources[0]}"
        typer.echo(f"the recorded images of {', '.join(recorded)} are left out; {where_they_are}")
    if dry_run:
        _print_plan(rerendering, where)
        return 0
    executor = Local.from_options(workers, memory).on(rerendering.device)
    failures = make_release(rerendering, where, executor, report, replace=replace)
    return conclude(failures, len(rerendering.runs), "rerender", where)


def _chosen_looks(look: str | None, looks: str | None, draws: int | None) -> tuple[str, ...]:
    """Return the looks of `--look` or `--looks`, of which exactly one must be given."""
    from configs.references import shipped_names

    if look is not None and looks is not None:
        raise InputError("--look and --looks are both given", cure="keep one of them")
    if looks is not None:
        return names(looks, "--looks")
    if look is None:
        allowed = "--look NAME for one look, or --looks NAME,... for several"
        cure = f"shipped looks are {', '.join(shipped_names('look'))}"
        raise InputError("no look is named", allowed=allowed, cure=cure)
    if draws is not None:
        raise InputError("--draws", got=draws, cure="name the looks with --looks")
    return (look,)


def _print_plan(rerendering: "Rerendering", out: Path) -> None:
    """Print what would be rendered: each run with its look and its number of images, then size and time."""
    from pipeline.rerendering.rerender import cost_of
    from symolo.core.progress import plural, seconds

    for text in rerendering.warnings:
        typer.echo(f"warning: {text}")
    costs = [cost_of(run) for run in rerendering.runs]
    for run, cost in zip(rerendering.runs, costs, strict=True):
        typer.echo(f"{run.spec.key}: look {run.spec.look.name}, {plural(cost.images, 'image')}")
    images, megabytes = sum(cost.images for cost in costs), sum(cost.bytes_needed for cost in costs) / 1e6
    duration = seconds(sum(cost.core_s for cost in costs))
    typer.echo(f"on one core without a graphics card about {duration}; disk about {megabytes:.0f} MB, stages included")
    typer.echo(f"{out}: {plural(len(costs), 'run')}, {plural(images, 'image')}; nothing was rendered")
