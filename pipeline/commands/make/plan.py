"""`symolo plan`: shows what a scenario will produce and cost."""

from typing import Annotated

import typer

from pipeline.commands.options import (
    Json,
    Like,
    OnDevice,
    Scenario,
    Settings,
    Workers,
    with_device,
    with_like,
)
from symolo.core.errors import InputError


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
    planned = ScenarioPlan.from_specs(specs, cores(), loaded.like, workers, loaded.replaced_draws)
    if as_json:
        from pipeline.json_results.plan import PlanResult

        typer.echo(PlanResult.from_plan(scenario, planned).to_json())
    else:
        typer.echo(planned.text())
