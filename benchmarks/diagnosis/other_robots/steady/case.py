"""A case of kind motor_steady."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import (
    Array,
    autoregressive,
    bad_rows,
    draw_deviations,
    log_uniform,
    lost_share,
    noise_factor,
    outlier_share,
    outlier_sizes,
    pick,
    significant,
    whitened,
)
from benchmarks.diagnosis.other_robots.effects import Key
from benchmarks.diagnosis.other_robots.files import Case, truth_entry
from benchmarks.diagnosis.other_robots.fits import Problem
from benchmarks.diagnosis.other_robots.hidden import Entries, Hidden, Search
from benchmarks.diagnosis.other_robots.motor import draw_motor
from benchmarks.diagnosis.other_robots.steady.bench import NOMINAL, SteadyBench
from benchmarks.diagnosis.other_robots.steady.table import named_table, outside_table

MIN_BEYOND = 30.0
LEVELS = 21
HEADER = ["row", "sweep", "split", "t_s", "u_cmd_V", "current_A", "omega_rad_s"]


class SteadyCase:
    """The bench of a case, its noise, and what it hides."""

    def __init__(self, rng: np.random.Generator) -> None:
        m = self.motor = draw_motor(rng, inertia=False)
        usual = m.supply >= 5.5 and rng.random() < 0.6
        self.top = 5.0 if usual else significant(m.supply * rng.uniform(0.6, 1.0), 2)
        self.sweeps = pick(rng, [1, 2, 4, 8], [0.3, 0.15, 0.2, 0.35])
        up = np.round(np.linspace(0, self.top, LEVELS), 4)
        parts = [(1, 1, -1, -1)[s % 4] * (up if s % 2 == 0 else up[::-1]) for s in range(self.sweeps)]
        self.sweep = np.repeat(np.arange(1, self.sweeps + 1), LEVELS)
        u = np.concatenate(parts)
        self.n = len(u)
        spacing = significant(log_uniform(rng, 1, 12), 2)
        self.bench = SteadyBench(m, u, np.round(np.arange(self.n) * spacing, 1))
        self.fit = ~self._holdout(rng)
        self.stated = (
            significant(m.no_load_current(self.top) * log_uniform(rng, 0.003, 0.04), 3),
            significant(self.top / m.K * log_uniform(rng, 0.001, 0.01), 3),
        )
        self.factors = (noise_factor(rng), noise_factor(rng))
        self.sd = (self.stated[0] * self.factors[0], self.stated[1] * self.factors[1])
        self.rho = float(rng.uniform(0.15, 0.45)) if rng.random() < 0.15 else 0.0
        last = float(self.bench.t.max())
        self.named, self.outside = named_table(m, self.top, last), outside_table(m, self.top, last, self.sweeps)
        self.table = {**self.named, **self.outside}
        self.deviations = draw_deviations(rng, NOMINAL)

    def _holdout(self, rng: np.random.Generator) -> Array:
        """Return the rows that are not to be fitted."""
        holdout = np.zeros(self.n, bool)
        if self.sweeps == 8:
            holdout[self.sweep >= 7] = True
        elif self.sweeps == 2 and rng.random() < 0.5:
            holdout[self.sweep == 2] = True
        else:
            holdout[rng.choice(self.n, size=self.n // 4, replace=False)] = True
        return holdout

    def predict(self, keys: list[Key], thetas: Array) -> Array:
        """Return currents and, behind them, speeds."""
        return np.concatenate(self.bench.readings(self.table, keys, thetas), axis=1)

    def whiten(self, r: Array) -> Array:
        """Return the residuals of the fit rows in units of their noise."""
        white = [whitened(part / sd, self.rho) for part, sd in zip(np.split(r, 2, axis=1), self.sd, strict=True)]
        return np.concatenate([part[:, self.fit] for part in white], axis=1)

    def hide(self, rng: np.random.Generator, category: str, entries: Entries) -> Hidden | None:
        """Draw the effects."""
        problem = Problem(self.predict, self.whiten, self.table, NOMINAL)
        search = Search(problem, self.named, self.outside, self.deviations, attempts=12, min_beyond=MIN_BEYOND)
        names = list(self.outside if category == "outside" else self.named)
        if category != "outside" and self.sweeps <= 2:
            names.remove("friction_asymmetry")
        return search.hide(rng, category, names, entries)

    def measure(self, rng: np.random.Generator, hidden: Hidden) -> tuple[Array, Array, bool]:
        """Return readings of current and speed with noise, and whether a motor at rest reads exactly zero."""
        i, w = self.bench.readings(self.table, hidden.keys, hidden.theta(self.deviations)[None])
        exact_rest = bool(rng.random() < 0.6)
        current = i[0] + self.sd[0] * autoregressive(rng, self.n, self.rho)
        noisy = w[0] + self.sd[1] * autoregressive(rng, self.n, self.rho)
        step = hidden.size("current_quantised")
        if step is not None:
            current = np.round(current / step) * step  # the converter reads the noise too
        return current, np.where((w[0] == 0) & exact_rest, 0.0, noisy), exact_rest

    def rows(self, current: Array, speed: Array, no_current: Array, no_speed: Array) -> list[list[str]]:
        """Return the rows of data.csv."""
        return [
            [
                str(k + 1),
                str(self.sweep[k]),
                "fit" if self.fit[k] else "holdout",
                f"{self.bench.t[k]:.1f}",
                f"{self.bench.u[k]:.4f}",
                "" if no_current[k] else f"{current[k]:.6f}",
                "" if no_speed[k] else f"{speed[k]:.5f}",
            ]
            for k in range(self.n)
        ]


def make(rng: np.random.Generator, category: str) -> Case | None:
    """Return a case, or None when no visible effect was drawn for its bench."""
    case, entries = SteadyCase(rng), Entries()
    hidden = case.hide(rng, category, entries)
    if hidden is None:
        return None
    current, speed, exact_rest = case.measure(rng, hidden)
    share = outlier_share(rng, 0.005, 0.06)
    together = bool(rng.random() < 0.3)
    bad = bad_rows(rng, case.n, share)
    bad_speed = bad if together else bad_rows(rng, case.n, share * rng.uniform(0, 1))
    current[bad] += outlier_sizes(rng, int(bad.sum()), case.sd[0], 80)
    speed[bad_speed] += outlier_sizes(rng, int(bad_speed.sum()), case.sd[1], 80)
    lost = lost_share(rng, 0.04)
    rows = case.rows(current, speed, bad_rows(rng, case.n, lost), bad_rows(rng, case.n, lost))
    nominal = {
        "kind": "motor_steady",
        "motor": case.motor.entries,
        "noise": {"current_A": case.stated[0], "omega_rad_s": case.stated[1]},
    }
    disturbances = {
        "noise_factor": dict(zip(HEADER[-2:], case.factors, strict=True)),
        "lag1": case.rho,
        "outlier_share": share,
        "outliers_together": together,
        "dropout_share": lost,
    }
    setting = {
        "sweeps": case.sweeps,
        "top_V": case.top,
        "supply_V": case.motor.supply,
        "rest_is_exact_zero": exact_rest,
        "deviations": case.deviations.tolist(),
        "tolerances": {name: value for name, value in case.motor.relative.items() if name != "J"},
    }
    return Case(nominal, HEADER, rows, truth_entry("motor_steady", category, entries, disturbances, setting))
