"""Effects that a case hides: draws that are visible, their likelihood ratios and the names that fit as well.

The likelihood ratio of an effect is the rise of the smallest weighted sum of squares (tolerances included) when the
effect is left out and everything else is fitted again, on noise-free data of the fit rows. It is the expected value of
twice the logarithm of the likelihood ratio, up to the number of parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.diagnosis.other_robots.draws import HIDDEN, Array, log_uniform, pick, significant
from benchmarks.diagnosis.other_robots.effects import Effect, Key, Ratios, Table, draw_shapes, first_size, label, scaled
from benchmarks.diagnosis.other_robots.fits import Problem

MIN_RATIO = 30.0
MAX_RATIO = 20000.0
EQUAL, NEAR = 3.0, 12.0
"""Names that cost less are equal to the true one, or near rivals of it."""


@dataclass
class Hidden:
    """Effects with their parameters and likelihood ratios."""

    keys: list[Key] = field(default_factory=list)
    values: list[list[float]] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)

    def theta(self, deviations: Array) -> Array:
        """Return all columns of theta."""
        return np.concatenate([deviations, *[np.asarray(v, float) for v in self.values]])

    def without(self, i: int) -> "Hidden":
        """Return all effects but one."""
        return Hidden(self.keys[:i] + self.keys[i + 1 :], self.values[:i] + self.values[i + 1 :])

    def size(self, name: str) -> float | None:
        """Return the size of an effect, or None where it is not hidden."""
        return next((values[0] for key, values in zip(self.keys, self.values, strict=True) if key[0] == name), None)


@dataclass
class Entries:
    """What truth.json holds of the hidden effects."""

    effects: list[dict[str, Any]] = field(default_factory=list)
    outside: list[dict[str, Any]] = field(default_factory=list)
    near_rivals: Ratios = field(default_factory=dict)

    def add(self, entry: dict[str, Any], costs: Ratios) -> None:
        """Add a listed effect and the names that explain the data as well, or nearly as well, in its place."""
        equal = sorted(name for name, cost in costs.items() if cost < EQUAL)
        self.effects.append({**entry, "equal": equal} if equal else entry)
        near = {name.split("[")[0]: round(cost, 1) for name, cost in costs.items() if cost < NEAR}
        self.near_rivals.update(near)

    def add_outside(self, entry: dict[str, Any], best: tuple[str, float | None] | None) -> None:
        """Add an effect that the format does not list, and what the best listed name leaves of it."""
        name, left = best or (None, None)
        self.outside.append({**entry, "best_name": name, "beyond_best_name": left})


def describe(table: Table, key: Key, values: list[float], ratio: float) -> dict[str, Any]:
    """Return an effect as it stands in truth.json."""
    effect = table[key[0]]
    parameters: dict[str, float | str | None] = {p.name: v for p, v in zip(effect.parameters, values, strict=True)}
    if effect.discrete:
        parameters[effect.discrete[0]] = key[1]
    return {"name": key[0], "parameters": parameters, "lr": round(float(ratio), 1)}


def ratios_of(problem: Problem, hidden: Hidden, deviations: Array) -> list[float]:
    """Return the likelihood ratio of each effect beside the tolerances and the other effects."""
    full = hidden.theta(deviations)
    target = problem.predict(hidden.keys, full[None])[0]
    base = problem.minimum(target, hidden.keys, full, rounds=3)
    ratios = []
    for i in range(len(hidden.keys)):
        rest = hidden.without(i)
        start = rest.theta(deviations)
        cost = problem.minimum(target, rest.keys, start)
        if cost - base < 40 * MIN_RATIO:  # near the limit of visibility: start at the nominal parameters too
            start[: problem.nominal] = 0
            cost = min(cost, problem.minimum(target, rest.keys, start))
        ratios.append(cost - base)
    return ratios


def _grow(problem: Problem, hidden: Hidden, targets: list[float], deviations: Array) -> None:
    """Change the sizes until the likelihood ratios are near their targets."""
    effects = [problem.table[name] for name, _ in hidden.keys]
    for turn in range(6):
        hidden.ratios = ratios_of(problem, hidden, deviations)
        pairs = list(zip(hidden.ratios, targets, strict=True))
        close = [effect.threshold or 0.5 < r / t < 2 for effect, (r, t) in zip(effects, pairs, strict=True)]
        if all(close) or turn == 5:
            return
        for effect, values, (ratio, target) in zip(effects, hidden.values, pairs, strict=True):
            if not effect.threshold:
                by = float(np.clip(np.sqrt(target / max(ratio, 1e-3)), 0.05, 8))
                values[0] = scaled(effect, values[0], by)


def _final_size(rng: np.random.Generator, effect: Effect, size: float, ratio: float) -> float:
    """Return the size; where the range ended first, a draw between barely visible and the end of the range."""
    p = effect.parameters[0]
    if size in {p.low, p.high} and not effect.threshold and ratio > 2 * MIN_RATIO:
        size = scaled(effect, size, log_uniform(rng, np.sqrt(1.5 * MIN_RATIO / ratio), 1))
    return significant(size, 5)


def draw_effects(
    rng: np.random.Generator, problem: Problem, names: Sequence[str], deviations: Array, *, count: int, attempts: int
) -> Hidden | None:
    """Return `count` effects, each visible beside the tolerances and the other one, or None."""
    for _ in range(attempts):
        hidden, targets = Hidden(), []
        for name in map(str, rng.choice(names, size=count, replace=False)):
            effect = problem.table[name]
            hidden.keys.append((name, pick(rng, effect.discrete[1]) if effect.discrete else None))
            hidden.values.append([first_size(rng, effect), *draw_shapes(rng, effect)])
            targets.append(log_uniform(rng, MIN_RATIO * 1.4, MAX_RATIO))
        _grow(problem, hidden, targets, deviations)
        for values, (name, _), ratio in zip(hidden.values, hidden.keys, hidden.ratios, strict=True):
            values[0] = _final_size(rng, problem.table[name], values[0], ratio)
        hidden.ratios = ratios_of(problem, hidden, deviations)
        if min(hidden.ratios) >= MIN_RATIO:
            return hidden
    return None


@dataclass
class Search:
    """How the effects of a case are drawn and compared with other names."""

    problem: Problem
    named: Table
    outside: Table
    deviations: Array
    attempts: int
    min_beyond: float
    """What the best listed name must leave of an effect outside the list."""
    starts: int = 2
    """Starts of the fit of a rival with several parameters."""

    def _start(self, rng: np.random.Generator, name: str, rest: Hidden, k: int) -> Array:
        """Return the k-th start of a fit of a rival beside the other effects."""
        effect = self.named[name]
        p, size = effect.parameters[0], first_size(rng, effect)
        if effect.threshold:
            size = p.low + (0.85 if k == 0 else 0.4) * (p.high - p.low)
        return Hidden([], [*rest.values, [size, *draw_shapes(rng, effect)]]).theta(self.deviations)

    def rivals(self, rng: np.random.Generator, target: Array, base: float, rest: Hidden, names: list[str]) -> Ratios:
        """Return how much worse each other name explains the data in place of the true one."""
        costs: Ratios = {}
        for key in [(name, variant) for name in names for variant in self.named[name].variants()]:
            if key in rest.keys:
                continue
            keys = [*rest.keys, key]
            starts = self.starts if len(self.named[key[0]].parameters) > 1 else 1
            fits = [self.problem.minimum(target, keys, self._start(rng, key[0], rest, k)) for k in range(starts)]
            costs[label(key)] = min(fits) - base
        return costs

    def hide(
        self, rng: np.random.Generator, category: str, names: Sequence[str], entries: Entries, count: int | None = None
    ) -> Hidden | None:
        """Draw the effects of a case and describe them; None where none is visible or a listed name explains it."""
        count = HIDDEN[category] if count is None else count
        if not count:
            return Hidden()
        hidden = draw_effects(rng, self.problem, names, self.deviations, count=count, attempts=self.attempts)
        if hidden is None:
            return None
        theta = hidden.theta(self.deviations)
        target = self.problem.predict(hidden.keys, theta[None])[0]
        base = self.problem.minimum(target, hidden.keys, theta, rounds=3)
        described = [
            describe(self.problem.table, *each) for each in zip(hidden.keys, hidden.values, hidden.ratios, strict=True)
        ]
        if category == "outside":
            best = min(self.rivals(rng, target, base, Hidden(), list(self.named)).items(), key=lambda cost: cost[1])
            entries.add_outside(described[0], best)
            return hidden if best[1] >= self.min_beyond else None
        hidden_names = {name for name, _ in hidden.keys}
        others = [name for name in self.named if self.named[name].discrete or name not in hidden_names]
        for i, key in enumerate(hidden.keys):
            costs = self.rivals(rng, target, base, hidden.without(i), others)
            costs.pop(label(key), None)
            entries.add(described[i], costs)
        return hidden
