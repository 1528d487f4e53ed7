"""Voltages of a trial."""

from collections.abc import Callable

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array, pick

DT_S = 0.005


def _levels(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return levels of random size and duration."""
    u, first = np.zeros(samples), int(rng.integers(4, 40))
    while first < samples:
        hold = int(rng.integers(25, 180))
        u[first : first + hold] = 0 if rng.random() < 0.15 else rng.uniform(-top, top)
        first += hold
    return u


def _binary(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return two levels in random order."""
    hold = int(rng.integers(8, 50))
    return np.repeat(rng.choice([-1, 1], size=samples // hold + 1), hold)[:samples] * top * rng.uniform(0.4, 1)


def _ramps(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return a triangle wave."""
    t = _times(samples)
    return top * (2 / np.pi) * np.arcsin(np.sin(2 * np.pi * t / t[-1] * rng.integers(1, 4)))


def _chirp(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return a sine of rising frequency."""
    t = _times(samples)
    turns = rng.uniform(0.3, 1.0) * t + rng.uniform(0.3, 2.5) * t * t / t[-1]
    return top * rng.uniform(0.5, 1) * np.sin(2 * np.pi * turns)


def _step_and_brake(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return one step, then zero."""
    t = _times(samples)
    return np.where((t > 0.1) & (t < t[-1] * rng.uniform(0.4, 0.7)), top * float(pick(rng, [-1, 1])), 0.0)


def _stairs(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return levels that rise."""
    t, steps = _times(samples), int(rng.integers(4, 10))
    return top * np.floor(t / t[-1] * steps) / steps * float(pick(rng, [-1, 1]))


def _random_walk(rng: np.random.Generator, samples: int, top: float) -> Array:
    """Return a random walk within the top voltage."""
    return np.clip(np.cumsum(rng.normal(size=samples)) * 0.06 * top, -top, top)


def _times(samples: int) -> Array:
    """Return the times of the samples of a trial."""
    return np.arange(1, samples + 1) * DT_S


INPUTS: dict[str, tuple[float, Callable[[np.random.Generator, int, float], Array]]] = {
    "levels": (3, _levels),
    "binary": (1.5, _binary),
    "ramps": (1, _ramps),
    "chirp": (1, _chirp),
    "step_and_brake": (1.5, _step_and_brake),
    "stairs": (1, _stairs),
    "random_walk": (1, _random_walk),
}
"""Weight and function of each input."""


def draw_commands(rng: np.random.Generator, samples: int, top: float) -> tuple[Array, str]:
    """Return the voltage of one trial and the name of the input."""
    name = pick(rng, list(INPUTS), [weight for weight, _ in INPUTS.values()])
    return np.round(INPUTS[name][1](rng, samples, top), 3), name
