"""Suspicious properties of runs, and the numbers among their settings."""

from collections.abc import Iterator
from dataclasses import dataclass

from configs.schema.scenario import RunSpec


@dataclass(frozen=True)
class Suspicion:
    """Something suspicious about a run, before it is simulated."""

    about: str
    """Subject, which is the same for all runs whose texts differ in numbers alone."""
    text: str


def settings_of(spec: RunSpec) -> Iterator[tuple[str, float]]:
    """Yield field path and value of each number of robot, arena, look, images and end of a run that was not drawn.

    Effects are left out, and of the arena all but the line and the directions and motions of the obstacles.
    """
    sections = {
        "robot": spec.robot.model_dump(exclude={"effects"}),
        "arena": {
            "line": spec.arena.line.model_dump(),
            "obstacles": [obstacle.model_dump(include={"yaw_deg", "motion"}) for obstacle in spec.arena.obstacles],
        },
        "look": spec.look.model_dump(exclude={"assets"}),
        "rates": spec.rates.model_dump(),
        "render": spec.render.model_dump(),
        "stop": spec.stop.model_dump(),
    }
    return ((field, value) for field, value in _numbers(sections, ()) if field not in spec.drawn)


def _numbers(settings: object, path: tuple[str, ...]) -> Iterator[tuple[str, float]]:
    if isinstance(settings, dict):
        for key, value in settings.items():
            yield from _numbers(value, (*path, str(key)))
    elif isinstance(settings, list | tuple):
        for index, value in enumerate(settings):
            yield from _numbers(value, (*path, str(index)))
    elif isinstance(settings, int | float) and not isinstance(settings, bool):
        yield ".".join(path), settings
