"""The command `symolo preview`: images of a scenario without a simulation."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.exit_codes import RUN_FAILED
from pipeline.commands.options import (
    OnDevice,
    Scenario,
    Settings,
    Workers,
    checked_new_image,
    if_given,
    look_names,
    with_device,
)
from pipeline.preview import Engine

_MAX_WIDTH_PX = 2048


def preview(
    scenario: Scenario,
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            callback=if_given(checked_new_image),
            help="Image file to write, .jpg or .png; by default SCENARIO-preview.jpg in the current folder.",
        ),
    ] = None,
    count: Annotated[
        int, typer.Option("-n", "--count", min=1, max=1000, metavar="N", help="Number of images on the sheet.")
    ] = 24,
    engine: Annotated[
        Engine,
        typer.Option(help="cycles: path-traced as in a release, in draft quality; flat: without Blender, in seconds."),
    ] = Engine.CYCLES,
    look: Annotated[
        str | None,
        typer.Option(
            "--look",
            "--looks",
            metavar="NAME,...",
            help="Looks to show for each run, or `all` for all shipped ones; by default the look of the scenario.",
        ),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Further camera of the robot to show, such as left; by default that of data.csv."
        ),
    ] = None,
    settings: Settings = None,
    width_px: Annotated[
        int, typer.Option(min=32, max=_MAX_WIDTH_PX, metavar="PX", help="Width of each image in pixels.")
    ] = 320,
    columns: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=100,
            metavar="N",
            help="Number of images in a row; by default one row of up to six, else three to six with "
            "as few empty places as possible.",
        ),
    ] = None,
    workers: Workers = None,
    device: OnDevice = None,
) -> int:
    """Show what the images of a scenario will look like, on one sheet, without a simulation.

    Each image shows a different run, with the arena, robot and look that a release draws for it. The routes alternate
    from run to run. If the scenario has fewer runs, further ones are drawn. With several looks, each run is shown under
    all of them.

    The robot stands on the line, or next to the walls that join the ends of the line, and faces along it. The places
    are evenly spaced around the arena, and not closer to an obstacle than the controller would drive. The exposure of
    each image is adjusted to its light.

    Example: symolo preview symolo -n 24

    All shipped looks: symolo preview symolo -n 12 --look all --out gallery.jpg

    In seconds, without textures and gloss: symolo preview symolo --engine flat --look classroom,lab --out preview.jpg
    """
    from pipeline.preview.engines import check_size, render_views, sheet, usual_columns
    from pipeline.preview.views import views
    from pipeline.work.supervisor import cores
    from symolo.core.errors import RunFailed
    from symolo.core.progress import plural, report_here
    from symolo.pages.sheet import save

    looks = look_names(look) if look is not None else ()
    drawn = views(scenario, with_device(settings, device), looks, count, width_px, camera=camera or "")
    first = next(drawn)
    columns = columns or usual_columns(count)
    check_size(first, count, columns)
    sheet_file = out or checked_new_image(Path(f"{Path(scenario).stem}-preview.jpg"))
    chosen = [first, *drawn]
    for warning in dict.fromkeys(text for view in chosen for text in view.suspicions):
        typer.echo(f"warning: {warning}", err=True)
    images, failures = render_views(engine, chosen, workers or cores(), report_here())
    for failure in failures:
        typer.echo(f"failed: image {failure.run}: {failure.problem}", err=True)
    if not images:
        raise RunFailed("preview: no image could be made")
    save(sheet(chosen, images, columns), sheet_file)
    typer.echo(f"{sheet_file}: {len(images)} of {plural(count, 'image')}")
    if count < len(looks):
        left_out = ", ".join(looks[count:])
        typer.echo(f"not shown, because -n is smaller than the number of looks: {left_out}")
    if camera is None and first.further_cameras:
        typer.echo(f"not shown: the cameras {', '.join(first.further_cameras)}; see one of them with --camera NAME")
    return RUN_FAILED if failures else 0
