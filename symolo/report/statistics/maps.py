"""Groups of runs that share a map: those of one route with the same line, walls and obstacles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from symolo.arena.geometry import Arena
from symolo.report.statistics.run_facts import RunFacts


@dataclass(frozen=True)
class RouteMap:
    """One arena from above with the paths of some runs."""

    route: str
    arena: Arena
    runs: tuple[RunFacts, ...]
    """Runs whose path is drawn, in their order."""
    duration_s: float
    """Duration of the longest run, during which obstacles move."""

    @property
    def title(self) -> str:
        names = [facts.record.run.partition("/")[2] for facts in self.runs]
        listed = ", ".join(names) if len(names) <= 3 else f"{names[0]} to {names[-1]}, {len(names)} runs"
        return f"{self.route}: {listed}"


def route_maps(facts: Sequence[RunFacts]) -> tuple[RouteMap, ...]:
    """Return the maps in the order of their first runs; runs without a path are left out."""
    groups: dict[tuple[object, ...], list[RunFacts]] = {}
    for run in facts:
        if run.path is not None:
            # How light the floor and the line are does not show on a map.
            layout = replace(run.arena, floor_reflectance=0.0, line=replace(run.arena.line, reflectance=0.0))
            groups.setdefault((run.route, layout), []).append(run)
    return tuple(
        RouteMap(runs[0].route, runs[0].arena, tuple(runs), max(run.record.duration_s for run in runs))
        for runs in groups.values()
    )
