"""The shipped effect that resembles an effect most, by what both do to the readings of the experiments."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import numpy as np

from configs.effects.base import Effect
from configs.effects.registry import EFFECTS
from pipeline.effects.probe import Probe, Readings
from pipeline.effects.trial import EffectTrial, trials
from symolo.core.arrays import Array

NOISE: Mapping[str, float] = MappingProxyType(
    {
        "tof": 0.005,
        "range_m": 0.002,
        "range_sd_m": 0.0005,
        "line": 0.01,
        "encoders": 1.0,
        "pose": 0.001,
        "true_pose": 0.001,
        "current_A": 0.01,
        "step_current_A": 0.01,
        "steady_current_A": 0.01,
        "step_speed_rad_s": 0.05,
        "steady_speed_rad_s": 0.05,
    }
)
"""Typical standard deviation of each channel, by which a change of its readings is divided."""
STEP = 0.02
"""Step of a derivative, as a share of the way from the start to a bound."""
SAME_SHARE = 0.9999
"""Share of the change from which two effects are one."""
FIT_FROM = 0.9
"""Share from which the numbers of the other effect are fitted, before both are called one."""
FIT_STEPS = 6


@dataclass(frozen=True)
class Resemblance:
    """How well another effect imitates one."""

    name: str
    share: float
    """Share of the change of the readings that the other effect makes as well, 0 to 1: the squares of what it leaves,
    subtracted from 1."""


def closest(trial: EffectTrial) -> Resemblance | None:
    """Return the shipped effect of the same slot that imitates an effect best; None if there is none.

    Two effects that no measurement shows both are not compared. The change of the readings at the start values is
    projected onto that of the other effect and its derivatives. The numbers of the most similar effect are then fitted.
    """
    change = _change(trial, trial.start)
    size = float(change @ change)
    best: tuple[float, EffectTrial] | None = None
    for other in _rivals(trial):
        share = (
            1.0 - _left(change, _directions(other.effect, tuple(other.choices.items()), other.probe)) / size
            if size
            else 0.0
        )
        if best is None or share > best[0]:
            best = (share, other)
    if best is None:
        return None
    share, other = best
    if share > FIT_FROM:
        share = max(share if share < SAME_SHARE else 0.0, 1.0 - _fitted(change, other) / size)
    return Resemblance(other.name, share)


def _rivals(trial: EffectTrial) -> list[EffectTrial]:
    effect, user_files = trial.effect, EFFECTS.files
    return [
        other
        for kind in EFFECTS.classes()
        if kind is not effect and kind.slot is effect.slot and kind.name not in user_files
        if not set(kind.setups).isdisjoint(effect.setups)
        for other in trials(kind, trial.probe, has_engine=False)
        if all(trial.choices.get(name, value) == value for name, value in other.choices.items())
    ]


def _change(trial: EffectTrial, effect: Effect) -> Array:
    """Return the change of the readings in the twin and on the benches, in standard deviations."""
    some = [place for place in trial.places() if place not in {"engine", "floor"}]
    return np.concatenate([_difference(trial.bare(place), trial.read(place, effect)) for place in some])


def _difference(bare: Readings, changed: Readings) -> Array:
    return np.concatenate(
        [np.nan_to_num((changed[name].astype(float) - bare[name]) / NOISE[name]).ravel() for name in bare]
    )


@cache
def _directions(kind: type[Effect], choices: tuple[tuple[str, str], ...], probe: Probe) -> tuple[Array, ...]:
    """Return the change at the start values, and its derivative by each number."""
    trial = EffectTrial(kind, dict(choices), probe)
    at = _change(trial, trial.start)
    return (at, *_derivatives(trial, trial.start, at))


def _derivatives(trial: EffectTrial, effect: Effect, at: Array) -> list[Array]:
    columns = []
    for name, number in trial.effect.parameters().items():
        value = getattr(effect, name)
        end = number.high if number.high - value > value - number.low else number.low
        step = STEP * (end - value) if abs(end - value) < 10 * abs(number.start) else STEP * abs(number.start)
        step = step if number.low <= value + step <= number.high else -step
        columns.append((_change(trial, effect.model_copy(update={name: value + step})) - at) / step)
    return columns


def _left(change: Array, directions: Sequence[Array]) -> float:
    """Return the squares that remain of a change after its projection onto some directions."""
    columns = np.stack(directions, axis=1)
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > 0] / size[size > 0]
    if not columns.size:
        return float(change @ change)
    rest = change - columns @ np.linalg.lstsq(columns, change, rcond=1e-9)[0]
    return float(rest @ rest)


def _fitted(change: Array, other: EffectTrial) -> float:
    """Return the squares that remain of a change if the numbers of another effect are fitted to it."""
    numbers, effect = other.effect.parameters(), other.start
    best = float("inf")
    for _ in range(FIT_STEPS):
        at = _change(other, effect)
        rest = change - at
        best = min(best, float(rest @ rest))
        columns = np.stack(_derivatives(other, effect, at), axis=1)
        size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        steps = np.linalg.lstsq(columns / size, rest, rcond=1e-9)[0] / size
        values = {
            name: float(np.clip(getattr(effect, name) + step, number.low, number.high))
            for (name, number), step in zip(numbers.items(), steps.tolist(), strict=True)
        }
        effect = effect.model_copy(update=values)
    return best
