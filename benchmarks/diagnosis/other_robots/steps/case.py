"""A case of kind motor_step."""

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
from benchmarks.diagnosis.other_robots.steps.bench import NOMINAL, StepBench
from benchmarks.diagnosis.other_robots.steps.commands import DT_S, draw_commands
from benchmarks.diagnosis.other_robots.steps.table import named_table, outside_table

MIN_BEYOND = 30.0
FINE_SUBSTEPS = 20
HEADER = ["trial", "split", "session_time_s", "t_s", "u_cmd_V", "current_A", "omega_rad_s"]


class StepCase:
    """The trials of a case, their noise, and what they hide."""

    def __init__(self, rng: np.random.Generator) -> None:
        m = self.motor = draw_motor(rng, inertia=True)
        self.shares = (significant(rng.uniform(0.25, 0.8), 2), significant(rng.uniform(0.25, 0.75), 2))
        self.top = significant(m.supply * rng.uniform(0.4, 1.0), 3)
        self.trials = int(rng.integers(2, 7))
        self.samples = pick(rng, [300, 400, 500, 600, 800])
        drawn = [draw_commands(rng, self.samples, self.top) for _ in range(self.trials)]
        self.commands, self.inputs = np.array([u for u, _ in drawn]), [name for _, name in drawn]
        pause = 0.0 if rng.random() < 0.5 else float(rng.integers(1, 40))
        self.starts = np.arange(self.trials) * (self.samples * DT_S + pause)
        self.fit = self._fit(rng)
        self.stated = (
            significant(self.top / m.R * log_uniform(rng, 0.002, 0.02), 3),
            significant(self.top / m.K * log_uniform(rng, 0.002, 0.02), 3),
        )
        correlation = rng.uniform(0.05, 0.6)
        self.stated_rho = significant(float(pick(rng, [0.0, correlation], [0.2, 0.8])), 2)
        self.rho = self.stated_rho if rng.random() < 0.7 else float(rng.uniform(0, 0.7))
        self.factors = (noise_factor(rng), noise_factor(rng))
        self.sd = (self.stated[0] * self.factors[0], self.stated[1] * self.factors[1])
        self.named, self.outside = named_table(m, self.top), outside_table(m, self.top)
        self.table = {**self.named, **self.outside}
        self.deviations = draw_deviations(rng, NOMINAL)
        self.fit_bench = self._bench(self.fit)

    def _fit(self, rng: np.random.Generator) -> Array:
        """Return the trials that are to be fitted."""
        held = max(1, self.trials // 3)
        fit = np.ones(self.trials, bool)
        if rng.random() < 0.6:
            fit[self.trials - held :] = False
        else:
            fit[rng.choice(self.trials, size=held, replace=False)] = False
        return fit

    def _bench(self, trials: Array) -> StepBench:
        """Return the bench of some trials."""
        session = float(self.starts[-1] + self.samples * DT_S)
        return StepBench(
            self.motor,
            self.commands[trials],
            self.starts[trials],
            session=session,
            shares=self.shares,
            top=self.top,
        )

    def predict(self, keys: list[Key], thetas: Array) -> Array:
        """Return currents of the fit trials and, behind them, speeds."""
        return self.fit_bench.readings(self.table, keys, thetas)

    def whiten(self, r: Array) -> Array:
        """Return the residuals in units of their noise."""
        halves = zip(np.split(r, 2, axis=1), self.sd, strict=True)
        return np.concatenate([whitened(part / sd, self.rho) for part, sd in halves], axis=1)

    def hide(self, rng: np.random.Generator, category: str, entries: Entries) -> Hidden | None:
        """Draw the effects."""
        problem = Problem(self.predict, self.whiten, self.table, NOMINAL, rounds=9)
        search = Search(problem, self.named, self.outside, self.deviations, attempts=4, min_beyond=MIN_BEYOND, starts=1)
        hidden = search.hide(rng, category, list(self.outside if category == "outside" else self.named), entries)
        step = hidden.size("speed_coarse") if hidden else None
        return None if step is not None and step < 3 * self.sd[1] else hidden

    def measure(self, rng: np.random.Generator, hidden: Hidden) -> tuple[Array, bool]:
        """Return readings with noise, (2, rows), and whether limits act after the noise."""
        bench = self._bench(np.ones(self.trials, bool))
        theta = hidden.theta(self.deviations)[None]
        clean = bench.readings(self.table, hidden.keys, theta, FINE_SUBSTEPS)[0]
        noise = [[sd * autoregressive(rng, self.samples, self.rho) for _ in range(self.trials)] for sd in self.sd]
        value = clean.reshape(2, -1) + np.array(noise).reshape(2, -1)
        clamp_after = bool(rng.random() < 0.4)
        for name, channel in (("current_limit", 0), ("current_clamped", 0), ("speed_clamped", 1)):
            highest = hidden.size(name)
            if clamp_after and highest is not None:
                value[channel] = np.clip(value[channel], -highest, highest)
        step = hidden.size("speed_coarse")
        if step is not None:
            value[1] = np.round(value[1] / step) * step
        return value, clamp_after

    def rows(self, value: Array, lost: list[Array]) -> list[list[str]]:
        """Return the rows of data.csv."""
        grain = [10 ** np.floor(np.log10(sd / 3)) for sd in self.stated]
        digits = [int(max(0, -np.log10(g) + 1e-9)) for g in grain]
        value = np.round(value / np.array(grain)[:, None]) * np.array(grain)[:, None]
        rows = []
        for k in range(self.trials * self.samples):
            q, s = divmod(k, self.samples)
            t = (s + 1) * DT_S
            cells = ["" if lost[c][k] else f"{value[c, k]:.{digits[c]}f}" for c in range(2)]
            times = [f"{self.starts[q] + t:.4f}", f"{t:.4f}", f"{self.commands[q, s]:.3f}"]
            rows.append([str(q + 1), "fit" if self.fit[q] else "holdout", *times, *cells])
        return rows

    def nominal(self) -> dict[str, object]:
        """Return the content of nominal.yaml."""
        shares = {"motor_side_inertia_fraction": self.shares[0], "motor_side_friction_fraction": self.shares[1]}
        noise = {"current_A": self.stated[0], "omega_rad_s": self.stated[1], "lag1_correlation": self.stated_rho}
        return {
            "kind": "motor_step",
            "motor": {**self.motor.entries, **shares},
            "sample_rate_Hz": 200,
            "noise": noise,
        }


def make(rng: np.random.Generator, category: str) -> Case | None:
    """Return a case, or None when no visible effect was drawn for its bench."""
    case, entries = StepCase(rng), Entries()
    hidden = case.hide(rng, category, entries)
    if hidden is None:
        return None
    value, clamp_after = case.measure(rng, hidden)
    count = value.shape[1]
    share = outlier_share(rng, 0.002, 0.06)
    together = bool(rng.random() < 0.3)
    bad = [bad_rows(rng, count, share), bad_rows(rng, count, share * rng.uniform(0, 1))]
    if together:
        bad[1] = bad[0]
    for c in range(2):
        value[c, bad[c]] += outlier_sizes(rng, int(bad[c].sum()), case.sd[c], 60)
    lost = lost_share(rng, 0.04)
    rows = case.rows(value, [bad_rows(rng, count, lost) for _ in range(2)])
    disturbances = {
        "noise_factor": dict(zip(HEADER[-2:], case.factors, strict=True)),
        "lag1": case.rho,
        "outlier_share": share,
        "outliers_together": together,
        "dropout_share": lost,
    }
    setting = {
        "trials": case.trials,
        "samples": case.samples,
        "inputs": case.inputs,
        "top_V": case.top,
        "supply_V": case.motor.supply,
        "clamp_after_noise": clamp_after,
        "deviations": case.deviations.tolist(),
        "tolerances": case.motor.relative,
    }
    return Case(case.nominal(), HEADER, rows, truth_entry("motor_step", category, entries, disturbances, setting))
