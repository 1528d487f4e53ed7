"""The command `symolo rerender`: a stored trajectory under other looks."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import (
    OnDevice,
    Settings,
    WorkerMemory,
    Workers,
    checked_input,
    checked_new_folder,
    if_given,
    names,
    with_device,
)
from pipeline.commands.stages import conclude
from symolo.core.errors import InputError


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
        typer.Option(metavar="NAME", help="Name of a shipped look, or a YAML file; the images are written into DIR."),
    ] = None,
    looks: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Several looks; the images of draw k of a look are written into DIR/LOOK_k, with k from 1.",
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
            help="Output folder: new, empty, or one that symolo made before; by default a folder named after run and "
            "looks, such as CW-test_1-classroom-night.",
        ),
    ] = None,
    arena: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Shipped arena, or a YAML file; by default the arena of the run, or symolo."),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Shipped robot, or a YAML file; by default the robot of the run, or nominal."
        ),
    ] = None,
    camera_hz: Annotated[
        float | None,
        typer.Option(
            min=0.001, max=1000, metavar="HZ", help="Image rate; by default the column img of data.csv decides."
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

    The first draw of a look is the same as with --look; the others have different seeds, which are in look.json.
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

    option = "--look" if looks is None else "--looks"
    if (look is None) == (looks is None):
        raise InputError(option, allowed="one look with --look, or several looks with --looks")
    if looks is None and draws is not None:
        raise InputError("--draws", got=draws, cure="name the looks with --looks")
    chosen = names(looks, "--looks") if looks is not None else (str(look),)
    request = RerenderRequest(chosen, draws or 1, arena, robot, camera_hz, seed, with_device(settings, device), option)
    trajectory, drawn = prepare(source, request)
    in_subfolders = looks is not None
    where = out or checked_new_folder(Path(folder_name(trajectory, drawn)))
    if out is None:
        check_same(trajectory, drawn, where, in_subfolders=in_subfolders)
    with open_folders(trajectory, drawn, where, in_subfolders=in_subfolders) as folders:
        executor = Local.of(workers, memory).on(drawn[0].appearance.device)
        failures = render_source(trajectory, drawn, folders, executor, report_here())
    return conclude(failures, len(drawn), "rerender", where, "draw")
