"""Choice of the images that are shown for each state (the paper's Fig. 28)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from symolo.report.statistics.run_facts import RunFacts
from symolo.report.statistics.spread import spread

MAX_IMAGES = 6
"""Images of each state."""


@dataclass(frozen=True)
class StateImage:
    """An image by its run and number, and the time [s] at which it was taken."""

    run: str
    number: int
    t_s: float


def images_of_states(facts: Sequence[RunFacts]) -> Mapping[int, tuple[StateImage, ...]]:
    """Return at most `MAX_IMAGES` images of each state, from as many runs as possible, by the number of the state."""
    by_state: dict[int, dict[str, list[StateImage]]] = {}
    for run in facts:
        for number, state, t_s in run.images:
            by_run = by_state.setdefault(state, {})
            by_run.setdefault(run.record.run, []).append(StateImage(run.record.run, number, t_s))
    return {state: _choose(list(by_state[state].values())) for state in sorted(by_state)}


def _choose(images_by_run: Sequence[Sequence[StateImage]]) -> tuple[StateImage, ...]:
    """Return about as many images from each run, each run at other parts of its time."""
    runs = spread(images_by_run, MAX_IMAGES)
    chosen: dict[StateImage, None] = {}  # a run with few images would be shown twice
    for i, images in enumerate(runs):
        count = (i + 1) * MAX_IMAGES // len(runs) - i * MAX_IMAGES // len(runs)
        for k in range(count):
            # Runs are offset against each other, so that together they cover the time evenly.
            share = (k + (i + 0.5) / len(runs)) / count
            chosen[images[int(share * len(images))]] = None
    return tuple(chosen)
