"""The command that shows what a scenario's pictures would look like."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.options import (
    OnDevice,
    Scenario,
    Settings,
    Workers,
    checked_new_picture,
    if_given,
    names,
    with_device,
)
from pipeline.preview import Engine

RUN_FAILED = 3
_MAX_WIDE_PX = 2048


def preview(
    scenario: Scenario,
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            callback=if_given(checked_new_picture),
            help="Picture to write, .jpg or .png; SCENARIO-preview.jpg in this folder by default.",
        ),
    ] = None,
    count: Annotated[int, typer.Option("-n", "--n", min=1, max=1000, metavar="N", help="Pictures on the sheet.")] = 24,
    engine: Annotated[
        Engine,
        typer.Option(help="cycles: path-traced as in a release, at quality draft; flat: without Blender, in seconds."),
    ] = Engine.CYCLES,
    look: Annotated[
        str | None,
        typer.Option("--look", "--looks", metavar="NAME,...", help="Looks to show in turn; else the scenario's own."),
    ] = None,
    settings: Settings = None,
    width_px: Annotated[int, typer.Option(min=32, max=_MAX_WIDE_PX, help="Width of each picture.")] = 320,
    columns: Annotated[int, typer.Option(min=1, max=100, help="Pictures in a row.")] = 6,
    workers: Workers = None,
    device: OnDevice = None,
) -> int:
    """Show what a scenario's pictures would look like, on one sheet; simulates nothing and stores nothing else.

    Every picture shows another run, its arena, robot and look drawn as for a release: the routes take turns, and runs
    beyond those of the scenario are drawn as if it had more. With several looks, each run is shown under all of them.

    Places are spread evenly over the way round the arena, which is not driven: the robot stands on the middle of the
    line or, where walls join its ends, beside them, faces along, and is no closer to what stands ahead than where its
    controller would turn aside. Each picture is exposed by its own light.

    Example: symolo preview symolo -n 24

    In seconds, without textures and gloss: symolo preview symolo --engine flat --look classroom,lab --out preview.jpg
    """
    from pipeline.preview.engines import check_size, pictures, sheet
    from pipeline.preview.views import views
    from pipeline.work.supervisor import cores
    from symolo.core.errors import RunFailed
    from symolo.core.progress import report_here
    from symolo.pages.sheet import save

    looks = names(look, "--look") if look is not None else ()
    drawn = views(scenario, with_device(settings, device), looks, count, width_px)
    first = next(drawn)
    check_size(first, count, columns)
    sheet_file = out or checked_new_picture(Path(f"{Path(scenario).stem}-preview.jpg"))
    chosen = [first, *drawn]
    made, failures = pictures(engine, chosen, workers or cores(), report_here())
    for failure in failures:
        typer.echo(f"failed: picture {failure.run}: {failure.problem}", err=True)
    if not made:
        raise RunFailed("preview: no picture could be made")
    save(sheet(chosen, made, columns), sheet_file)
    typer.echo(f"{sheet_file}: {len(made)} of {count} pictures")
    return RUN_FAILED if failures else 0
