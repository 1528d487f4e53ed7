"""A case of kind tof_bench."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import (
    HIDDEN,
    Array,
    bad_rows,
    draw_deviations,
    lost_share,
    outlier_share,
    outlier_sizes,
    pick,
)
from benchmarks.diagnosis.other_robots.effects import Key
from benchmarks.diagnosis.other_robots.files import Case, truth_entry
from benchmarks.diagnosis.other_robots.fits import Problem
from benchmarks.diagnosis.other_robots.hidden import MIN_RATIO, Entries, Hidden, Search
from benchmarks.diagnosis.other_robots.range_noise import ROUNDING_M2
from benchmarks.diagnosis.other_robots.ranges.bench import RangeBench
from benchmarks.diagnosis.other_robots.ranges.noise_effects import (
    JUMP_CHANCE,
    PARAMETERS,
    NoiseEffect,
    dark_noise,
    draw_noise_effect,
    two_states,
)
from benchmarks.diagnosis.other_robots.ranges.readings import NOMINAL, readings
from benchmarks.diagnosis.other_robots.ranges.table import named_table, outside_table

MIN_BEYOND = 25.0
NO_TARGET_M = 8.190
HEADER = [
    "row",
    "split",
    "t_s",
    "distance_m",
    "material",
    "incidence_rad",
    "temperature_C",
    "ambient_lux",
    "reading_m",
]


class RangeCase:
    """The bench of a case, its noise, and what it hides."""

    def __init__(self, rng: np.random.Generator) -> None:
        b = self.bench = RangeBench(rng)
        self.fit = ~self._holdout(rng)
        self.named, self.outside = named_table(b), outside_table(b)
        self.table = {**self.named, **self.outside}
        self.deviations = draw_deviations(rng, NOMINAL)
        self.noise, self.sd = b.noise, np.sqrt(b.noise**2 + ROUNDING_M2)
        self.noise_effect: NoiseEffect | None = None
        self.two_states = False
        self.hidden = Hidden()
        self.entries = Entries()

    def _holdout(self, rng: np.random.Generator) -> Array:
        """Return the rows that are not to be fitted, in blocks or alone."""
        n = self.bench.n
        holdout = np.zeros(n, bool)
        if rng.random() < 0.5:
            length = 10 if n >= 60 else max(3, n // 6)
            for first in rng.permutation(np.arange(0, n, length))[: max(1, round(n / length / 4))]:
                holdout[first : first + length] = True
        else:
            holdout[rng.choice(n, size=max(4, n // 4), replace=False)] = True
        return holdout

    def predict(self, keys: list[Key], thetas: Array) -> Array:
        """Return readings without noise."""
        return readings(self.bench, self.table, keys, thetas)

    def whiten(self, r: Array) -> Array:
        """Return the residuals of the fit rows in units of their noise."""
        return r[:, self.fit] / self.sd[self.fit]

    def problem(self) -> Problem:
        """Return the problem of the fits in the present noise."""
        return Problem(self.predict, self.whiten, self.table, NOMINAL)

    def hide(self, rng: np.random.Generator, category: str) -> bool:
        """Draw the effects; False where none is visible or a listed name explains it."""
        count = HIDDEN[category]
        if category in {"one", "two"} and rng.random() < 0.22:
            if not self._hide_in_noise(rng):
                return False
            count -= 1
        if category == "outside" and rng.random() < 0.2:
            self.two_states = pick(rng, ["noise_on_dark", "two_states"]) == "two_states"
            return self.two_states or self._hide_dark_noise(rng)
        search = Search(self.problem(), self.named, self.outside, self.deviations, attempts=12, min_beyond=MIN_BEYOND)
        names = list(self.outside if category == "outside" else self.named)
        hidden = search.hide(rng, category, names, self.entries, count)
        self.hidden = hidden or Hidden()
        return hidden is not None and self._shows(hidden)

    def _hide_in_noise(self, rng: np.random.Generator) -> bool:
        """Draw a listed effect on the noise; False where none is visible."""
        effect = draw_noise_effect(rng, self.bench, self.fit)
        if effect is None:
            return False
        self.noise_effect = effect
        self.noise, self.sd = effect.noise(self.bench), effect.spread(self.bench)
        parameters = dict(zip(PARAMETERS[effect.name], effect.values, strict=True))
        self.entries.add({"name": effect.name, "parameters": parameters, "lr": round(effect.ratio, 1)}, {})
        return True

    def _hide_dark_noise(self, rng: np.random.Generator) -> bool:
        """Make the noise larger on dark targets; False where that is not visible."""
        factors, per_row = dark_noise(rng, self.bench, self.fit)
        self.noise = self.noise * factors
        ratio = float(self.fit.sum()) * per_row
        parameters = {"largest_noise_factor": float(factors.max())}
        self.entries.add_outside(
            {"name": "noise_on_dark", "parameters": parameters, "lr": round(ratio, 1)}, ("noise_scale", ratio)
        )
        return self.bench.n * 0.75 * per_row >= MIN_RATIO

    def _shows(self, hidden: Hidden) -> bool:
        """Return whether steps are coarse beside the noise, and whether enough rows are saturated."""
        step, saturation = hidden.size("coarse_steps"), hidden.size("range_saturation")
        coarse = step is None or step >= 3 * float(np.median(self.sd))
        return coarse and (saturation is None or int(np.sum(self.bench.d[self.fit] > saturation)) >= 4)

    def _jumping(self, rng: np.random.Generator, clean: Array) -> Array:
        """Return readings of a sensor that jumps between two states, and enter this cause."""
        error, jump = two_states(rng, self.bench)
        problem, start = self.problem(), self.deviations
        ratio = problem.minimum(clean + error, [], start) - problem.minimum(clean, [], start, rounds=3)
        parameters = {"jump": jump, "chance_per_row": JUMP_CHANCE}
        self.entries.add_outside({"name": "two_states", "parameters": parameters, "lr": round(ratio, 1)}, None)
        return clean + error

    def measure(self, rng: np.random.Generator) -> tuple[Array, bool]:
        """Return readings with noise, and whether a saturation acts after the noise."""
        clamp_after = bool(rng.random() < 0.5)
        clean = self.predict(self.hidden.keys, self.hidden.theta(self.deviations)[None])[0]
        error = self.noise * rng.normal(size=self.bench.n)
        if self.noise_effect:
            error = error + self.noise_effect.wander(rng, self.bench)
        if self.two_states:
            clean = self._jumping(rng, clean)
        value = clean + error
        saturation, step = self.hidden.size("range_saturation"), self.hidden.size("coarse_steps")
        if saturation is not None and clamp_after:
            value = np.minimum(value, saturation)
        if step is not None:
            value = np.round(value / step) * step  # steps come after the noise
        return np.round(np.maximum(value, 0), 3), clamp_after

    def add_outliers(self, rng: np.random.Generator, value: Array) -> float:
        """Add outliers to the readings, some of them without a target, and return their share."""
        share = outlier_share(rng, 0.005, 0.06)
        bad = bad_rows(rng, self.bench.n, share)
        sizes = outlier_sizes(rng, self.bench.n, self.noise, 60)
        no_target_share = rng.uniform(0, 0.4)
        for k in np.flatnonzero(bad):
            no_target = rng.random() < no_target_share
            value[k] = NO_TARGET_M if no_target else max(0.0, np.round(value[k] + sizes[k], 3))
        return share

    def rows(self, value: Array, lost: Array) -> list[list[str]]:
        """Return the rows of data.csv."""
        b = self.bench
        return [
            [
                str(k + 1),
                "fit" if self.fit[k] else "holdout",
                f"{b.t[k]:.1f}",
                f"{b.d[k]:.3f}",
                str(b.material[k]),
                f"{b.angle[k]:.4f}",
                f"{b.temperature[k]:.1f}",
                f"{b.lux[k]:.0f}",
                "" if lost[k] else f"{value[k]:.3f}",
            ]
            for k in range(b.n)
        ]

    def nominal(self) -> dict[str, object]:
        """Return the content of nominal.yaml."""
        b = self.bench
        return {
            "kind": "tof_bench",
            "tof": {
                "range_offset_m": {"value": 0, "tolerance": b.tolerance[0]},
                "range_scale": {"value": 1, "tolerance": b.tolerance[1]},
                "reference_temperature_C": b.reference,
                "resolution_m": 0.001,
                "reflectance": b.reflectance,
            },
            "noise": {"polynomial_mm": b.polynomial, "polynomial_origin_m": b.origin},
        }


def make(rng: np.random.Generator, category: str) -> Case | None:
    """Return a case, or None when no visible effect was drawn for its bench."""
    case = RangeCase(rng)
    if not case.hide(rng, category):
        return None
    value, clamp_after = case.measure(rng)
    share = case.add_outliers(rng, value)
    lost = lost_share(rng, 0.05)
    rows = case.rows(value, bad_rows(rng, case.bench.n, lost))
    disturbances = {"noise_factor": {"reading_m": 1.0}, "outlier_share": share, "dropout_share": lost}
    setting = {
        "rows": case.bench.n,
        "reach_m": case.bench.reach,
        "order": case.bench.order,
        "materials": len(case.bench.reflectance),
        "angles": len(set(case.bench.angle)),
        "clamp_after_noise": clamp_after,
        "tolerances": list(case.bench.tolerance),
        "deviations": case.deviations.tolist(),
    }
    return Case(case.nominal(), HEADER, rows, truth_entry("tof_bench", category, case.entries, disturbances, setting))
