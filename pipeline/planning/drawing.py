"""Random draws of all runs of a scenario, with a progress report where they take long."""

from collections.abc import Sequence

from configs.draw import draw_all, draw_each
from configs.loader import LoadedScenario
from configs.schema.scenario import RunSpec
from configs.schema.splits import Splits
from symolo.arena.fingerprint import arena_fingerprint
from symolo.arena.geometry import Arena
from symolo.core.progress import Report
from symolo.dataset.splits import SplitMember, check

MANY_RUNS = 50
"""Number of runs from which progress is reported; a random arena takes 60 ms."""


def draw_reported(loaded: LoadedScenario, report: Report) -> tuple[RunSpec, ...]:
    """Draw all runs, with a progress report where there are many.

    Raises:
        InputError: When the values drawn for a run make an impossible world, or the drawn arenas are too few for the
            splits.
    """
    specs = _drawn(loaded, report)
    _check_arenas(loaded, specs)
    return specs


def _drawn(loaded: LoadedScenario, report: Report) -> tuple[RunSpec, ...]:
    total = sum(route.runs for route in loaded.routes)
    if total < MANY_RUNS:
        return tuple(draw_all(loaded))
    specs = []
    with report.stage("draw", total, "runs") as stage:
        for spec in draw_each(loaded):
            specs.append(spec)
            stage.update("all", len(specs))
    return tuple(specs)


def _check_arenas(loaded: LoadedScenario, specs: Sequence[RunSpec]) -> None:
    """Refuse splits by arena if there are fewer arenas than splits."""
    settings = loaded.tree.get("splits")
    if settings is None or settings.get("by") != "arena":
        return
    fingerprints = [arena_fingerprint(Arena.from_config(spec.arena)) for spec in specs]
    members = [
        SplitMember(spec.key, spec.look.name, spec.robot.name, spec.seed, arena=fingerprint)
        for spec, fingerprint in zip(specs, fingerprints, strict=True)
    ]
    check(Splits.model_validate(settings).rule(loaded.seed), members, loaded.root.place_of(("splits",)))
