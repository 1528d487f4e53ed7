"""Voltages (V) of step trials, one value per 5 ms sample."""

from collections.abc import Callable
from itertools import cycle

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick
from benchmarks.diagnosis.independent_cases.recipes import Array

DT_S = 0.005


def _held(rng: np.random.Generator, samples: int, low: int, high: int, level: Callable[[], float]) -> Array:
    """Return levels, each held for `low` to `high` samples."""
    parts: list[Array] = []
    while sum(len(part) for part in parts) < samples:
        parts.append(np.full(int(rng.integers(low, high + 1)), level()))
    return np.concatenate(parts)[:samples]


def _steps(rng: np.random.Generator, samples: int, top: float, _: float) -> Array:
    return _held(rng, samples, 40, 160, lambda: 0.0 if rng.random() < 0.25 else rng.uniform(-top, top))


def _square(rng: np.random.Generator, samples: int, _: float, amplitude: float) -> Array:
    t = np.arange(samples) * DT_S
    return amplitude * np.sign(np.sin(2 * np.pi * t / rng.uniform(0.5, 1.6) + 1e-9))


def _staircase(rng: np.random.Generator, samples: int, _: float, amplitude: float) -> Array:
    count = int(rng.integers(4, 9))
    levels = np.concatenate([np.arange(1, count + 1), np.arange(count - 1, -1, -1)]) / count * amplitude
    return np.repeat(levels, -(-samples // len(levels)))[:samples] * (1 if rng.random() < 0.6 else -1)


def _chirp(rng: np.random.Generator, samples: int, _: float, amplitude: float) -> Array:
    t = np.arange(samples) * DT_S
    first, last = log_uniform(rng, 0.2, 0.6), log_uniform(rng, 1.5, 6)
    return amplitude * np.sin(2 * np.pi * (first * t + (last - first) * t**2 / (2 * t[-1])))


def _random_steps(rng: np.random.Generator, samples: int, top: float, _: float) -> Array:
    return _held(rng, samples, 4, 30, lambda: rng.uniform(-top, top))


def _step_and_brake(rng: np.random.Generator, samples: int, _: float, amplitude: float) -> Array:
    return _held(rng, samples, 60, 120, cycle([amplitude, 0, -amplitude, 0]).__next__)


def _ramp(rng: np.random.Generator, samples: int, _: float, amplitude: float) -> Array:
    t = np.arange(samples) * DT_S
    return amplitude * (2 / np.pi) * np.arcsin(np.sin(2 * np.pi * t / rng.uniform(1.0, 2.5)))


STYLES: dict[str, Callable[[np.random.Generator, int, float, float], Array]] = {
    "steps": _steps,
    "square": _square,
    "staircase": _staircase,
    "chirp": _chirp,
    "random_steps": _random_steps,
    "step_and_brake": _step_and_brake,
    "ramp": _ramp,
}


def waveform(rng: np.random.Generator, samples: int, top_V: float, style: str) -> Array:
    """Draw one trial of that style with abs(u) <= top_V; it starts with a pause of 0 to 0.15 s."""
    amplitude = top_V * rng.uniform(0.5, 1.0)
    u = STYLES[style](rng, samples, top_V, amplitude)
    pause = int(rng.integers(0, 31))
    return np.round(np.concatenate([np.zeros(pause), u])[:samples], 3)


def draw_styles(rng: np.random.Generator, trials: int) -> list[str]:
    """Draw the styles of the trials: all alike, or mixed."""
    styles = list(STYLES)
    if rng.random() < 0.4:
        return [pick(rng, styles)] * trials
    return [pick(rng, styles) for _ in range(trials)]
