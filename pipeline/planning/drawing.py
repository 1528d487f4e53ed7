"""All runs of a scenario, drawn, with a word on how far it is where that takes a while."""

from configs.draw import draw_all, draw_each
from configs.loader import LoadedScenario
from configs.schema.scenario import RunSpec
from symolo.core.progress import Report

MANY_RUNS = 50
"""Fewer are drawn in a moment, random arenas (60 ms each) among them."""


def draw_reported(loaded: LoadedScenario, report: Report) -> tuple[RunSpec, ...]:
    """Like `draw_all`, as a stage of its own where there are many.

    Raises:
        InputError: When the values drawn for a run make an impossible world.
    """
    total = sum(route.runs for route in loaded.routes)
    if total < MANY_RUNS:
        return tuple(draw_all(loaded))
    specs = []
    with report.stage("draw", total, "runs") as stage:
        for spec in draw_each(loaded):
            specs.append(spec)
            stage.update("all", len(specs))
    return tuple(specs)
