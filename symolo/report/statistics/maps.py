"""Which runs share a map: those of one route among the same line, walls and obstacles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from symolo.arena.geometry import Arena
from symolo.report.statistics.run_facts import RunFacts


@dataclass(frozen=True)
class Map:
    route: str
    arena: Arena
    runs: tuple[RunFacts, ...]
    """Those whose track is drawn, in their order."""
    duration_s: float
    """Of the longest of them: how long obstacles move."""

    @property
    def title(self) -> str:
        names = [facts.record.run.partition("/")[2] for facts in self.runs]
        told = ", ".join(names) if len(names) <= 3 else f"{names[0]} to {names[-1]}, {len(names)} runs"
        return f"{self.route}: {told}"


def maps_of(facts: Sequence[RunFacts]) -> tuple[Map, ...]:
    """In the order of their first runs; runs without a track are left out."""
    groups: dict[tuple[object, ...], list[RunFacts]] = {}
    for one in facts:
        if one.track is not None:
            groups.setdefault((one.route, _layout(one.arena)), []).append(one)
    return tuple(
        Map(runs[0].route, runs[0].arena, tuple(runs), max(one.record.duration_s for one in runs))
        for runs in groups.values()
    )


def _layout(arena: Arena) -> Arena:
    """What of an arena is on a map; how light floor and line are is not."""
    return replace(arena, floor_reflectance=0.0, line=replace(arena.line, reflectance=0.0))
