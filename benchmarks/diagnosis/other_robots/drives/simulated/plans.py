"""Paths of the trials, and all random numbers of a run."""

from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S
from benchmarks.diagnosis.other_robots.draws import Array, autoregressive, log_uniform, pick
from benchmarks.diagnosis.other_robots.drives.robot import Robot

CORRELATION_TIME_S = 0.1
"""Of the outside torque."""


@dataclass
class Plan:
    """How a trial is driven."""

    kind: str
    points: Array
    ramp: float
    pauses: bool


@dataclass
class Draws:
    """All random numbers of a run, so that a run with other effects can have the same."""

    rows: list[int]
    gaps: Array
    plans: list[Plan]
    first: Array
    push: Array
    slip: Array
    camera: Array
    reading: Array
    seed: int


def _draw_plan(rng: np.random.Generator, bot: Robot) -> Plan:
    """Return a path inside the room."""
    margin = min(0.75 * bot.track + 0.05, 0.3 * min(bot.room))
    low, high = np.array([margin, margin]), np.array(bot.room) - margin
    kind = pick(rng, ["rectangle", "laps", "points", "stop_and_go", "arcs", "eight"])
    middle, half = (low + high) / 2, (high - low) / 2
    if kind == "rectangle":
        f = rng.uniform(0.5, 1, 2)
        points = middle + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half * f
    elif kind in {"laps", "eight"}:
        a = np.linspace(0, 2 * np.pi, 25)[:-1]
        f = rng.uniform(0.5, 0.95, 2)
        points = middle + np.column_stack([np.cos(a), np.sin(a if kind == "laps" else 2 * a)]) * half * f
    else:
        points = rng.uniform(low, high, (60, 2))
    if rng.random() < 0.5:
        points = points[::-1]
    ramp = log_uniform(rng, 0.5, 4)
    return Plan(kind, np.array(points), float(pick(rng, [0.0, ramp])), kind == "stop_and_go")


def draw_run(rng: np.random.Generator, bot: Robot) -> Draws:
    """Return the trials and their random numbers."""
    trials = pick(rng, [2, 3, 4])
    lengths = [401, 601, 801, 1001] if trials < 4 else [401, 601]
    rows = [pick(rng, lengths) for _ in range(trials)]
    n = sum(rows)
    push = np.array([autoregressive(rng, n, float(np.exp(-WHEEL_DT_S / CORRELATION_TIME_S))) for _ in range(2)])
    places = rng.uniform(0.25, 0.75, (trials, 2)) * bot.room
    return Draws(
        rows,
        first=np.column_stack([places, rng.uniform(-np.pi, np.pi, trials)]),
        push=push,
        gaps=rng.uniform(2, 60, trials),
        plans=[_draw_plan(rng, bot) for _ in range(trials)],
        slip=rng.normal(size=(2, n)),
        camera=rng.normal(size=(3, n)),
        reading=rng.normal(size=(3, n)),
        seed=int(rng.integers(1 << 30)),
    )
