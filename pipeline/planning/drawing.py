"""Random draws of all runs of a scenario, with a progress report where they take long."""

from configs.draw import draw_all, draw_each
from configs.loader import LoadedScenario
from configs.schema.scenario import RunSpec
from symolo.core.progress import Report

MANY_RUNS = 50
"""Number of runs from which progress is reported; a random arena takes 60 ms."""


def draw_reported(loaded: LoadedScenario, report: Report) -> tuple[RunSpec, ...]:
    """Draw all runs, with a progress report where there are many.

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
