"""Cases of kind tof_bench: a range sensor before flat targets at known distances."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases import disturbances
from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick, significant
from benchmarks.diagnosis.independent_cases.motors.motor import draw_individual, value_with_tolerance
from benchmarks.diagnosis.independent_cases.ranges import errors as range_errors
from benchmarks.diagnosis.independent_cases.ranges.errors import (
    Bench,
    clean_reading,
    draw_polynomial,
    noise_sd,
    wander_covariance,
)
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Mask, Recipe, Toleranced, Variant
from benchmarks.diagnosis.independent_cases.setting import CaseFiles, Setting, Table

CHANNEL = "reading_m"
NO_TARGET_M = 8.190
ROUNDING_M2 = 1e-6 / 12  # variance of rounding to 1 mm
MATERIALS = {  # ranges of the reflectance
    "white_paper": (0.8, 0.92),
    "grey_card": (0.15, 0.3),
    "black_card": (0.03, 0.08),
    "wood": (0.35, 0.55),
    "plastic": (0.5, 0.75),
    "cardboard": (0.3, 0.5),
    "metal": (0.5, 0.8),
    "concrete": (0.2, 0.4),
}


@dataclass(frozen=True)
class _Layout:
    """How the rows of a bench are drawn."""

    rich: bool  # whether material, incidence, temperature and light vary
    materials: list[str]
    reflectance: dict[str, float]
    step_s: float
    far_m: float

    def bench(self, rng: np.random.Generator, rows: int, order: str, start_s: float = 0.0) -> Bench:
        """Draw the conditions of some rows; the reference temperature is to follow."""
        distance = self._distances(rng, rows, order)
        temperature = np.round(25 + rng.normal(0, 0.3, rows), 1)
        lux = np.full(rows, float(pick(rng, [50, 200, 300, 500])))
        incidence, signed = self._incidence(rng, rows)
        if self.rich and rng.random() < 0.8:
            temperature = _temperature_C(rng, rows)
        if self.rich and rng.random() < 0.8:
            lux = np.round(np.exp(rng.uniform(np.log(40), np.log(5500), rows)))
        material = rng.choice(self.materials, rows)
        return Bench(
            distance_m=distance,
            material=material,
            incidence_rad=np.round(incidence, 4) + 0.0,  # no minus before zero
            temperature_C=temperature,
            reference_C=np.nan,
            lux=lux,
            t_s=start_s + np.arange(rows) * self.step_s,
            reflectance=np.array([self.reflectance[m] for m in material]),
            signed=signed,
        )

    def _distances(self, rng: np.random.Generator, rows: int, order: str) -> Array:
        """Draw distances (m) on a grid, in random order or in sweeps."""
        if not self.rich:
            grid = np.round(np.linspace(0.04, self.far_m, max(rows, 2)), 3)
            return rng.permutation(np.resize(grid, rows)) if order == "random" else grid[:rows]
        grid = np.round(np.arange(0.04, self.far_m + 1e-9, 0.02), 3)
        if order == "random":
            return rng.choice(grid, rows)
        return np.resize(np.concatenate([np.sort(grid), np.sort(grid)[::-1]]), rows)

    def _incidence(self, rng: np.random.Generator, rows: int) -> tuple[Array, bool]:
        """Draw angles of incidence (rad), and whether they have a sign."""
        if not (self.rich and rng.random() < 0.8):
            return np.zeros(rows), False
        choices = np.deg2rad(pick(rng, [[0, 15, 30, 45], [0, 0, 10, 20, 25], [0, 20, 40, 60]]))
        incidence = rng.choice(choices, rows)
        signed = bool(rng.random() < 0.3)
        return incidence * rng.choice([-1.0, 1.0], rows) if signed else incidence, signed


def _temperature_C(rng: np.random.Generator, rows: int) -> Array:
    """Draw temperatures that vary at random or rise over the session."""
    if rng.random() < 0.6:
        return np.round(rng.uniform(14, 41, rows), 1)
    return np.round(20 + rng.uniform(8, 20) * np.linspace(0, 1, rows) + rng.normal(0, 0.4, rows), 1)


def _draw_layout(rng: np.random.Generator) -> tuple[str, int, _Layout]:
    """Draw the size of the bench, its number of rows and its layout."""
    size = pick(rng, ["large", "large", "medium", "small", "small"])
    rows = {"large": rng.integers(150, 401), "medium": rng.integers(60, 150), "small": rng.integers(20, 61)}
    rich, every = size != "small", sorted(MATERIALS)
    shuffled = list(rng.permutation(every))
    materials = shuffled[: int(rng.integers(3, 7)) if rich else int(pick(rng, [1, 1, 2]))]
    listed = sorted(set(materials) | set(rng.permutation(every)[:2]), key=every.index)
    reflectance = {m: round(rng.uniform(*MATERIALS[m]), 2) for m in listed}
    step, far = pick(rng, [1.0, 2.0, 2.0, 5.0]), pick(rng, [0.6, 1.0, 1.0, 1.2, 1.6, 2.0])
    return size, int(rows[size]), _Layout(rich, materials, reflectance, step, far)


def _draw_holdout(rng: np.random.Generator, rows: int, *, rich: bool) -> Mask:
    """Draw the hold-out rows: blocks of ten, or the end of a small bench."""
    holdout = np.zeros(rows, bool)
    if not rich:
        holdout[rows - max(4, rows // 5) :] = True
        return holdout
    for block in rng.permutation(rows // 10)[: max(1, rows // 40)]:
        holdout[10 * block : 10 * block + 10] = True
    return holdout


def _draw_nominal(rng: np.random.Generator) -> dict[str, Toleranced]:
    """Draw offset (m) and scale of the nominal sensor with tolerances."""
    plain = rng.random() < 0.7
    offset = 0.0 if plain else round(rng.uniform(-0.02, 0.02), 3), significant(log_uniform(rng, 3e-4, 2e-3), 2)
    scale = 1.0 if plain else round(rng.uniform(0.97, 1.03), 3), significant(log_uniform(rng, 1e-3, 4e-3), 2)
    return {"range_offset": offset, "range_scale": scale}


def _divergence(true: Array, other: Array) -> float:
    """Return twice the Kullback-Leibler divergence of a zero-mean Gaussian from the true one, by covariances."""
    lower = np.linalg.inv(np.linalg.cholesky(other))
    values = np.linalg.eigvalsh(lower @ true @ lower.T)
    return float(np.sum(values - 1 - np.log(np.maximum(values, 1e-12))))


def first_order_path(rng: np.random.Generator, t_s: Array, sd_m: float, time_constant_s: float) -> Array:
    """Draw one path (m) of a stationary first-order Gauss-Markov error at times t_s."""
    path = np.empty(len(t_s))
    path[0] = sd_m * rng.standard_normal()
    for i in range(1, len(t_s)):
        keep = np.exp(-(t_s[i] - t_s[i - 1]) / time_constant_s)
        path[i] = keep * path[i - 1] + sd_m * np.sqrt(1 - keep**2) * rng.standard_normal()
    return path


class RangeSetting(Setting):
    """Bench of a range sensor."""

    KIND = "tof_bench"
    PLACE = range_errors.PLACE
    OUTSIDE = list(range_errors.OUTSIDE_RECIPES)
    IN_NOISE = ("noise_scale", "ambient_noise", "range_wander")
    tolerance_names = ["range_offset", "range_scale"]

    def __init__(self, rng: np.random.Generator) -> None:
        """Draw bench, sensor, individual and noise."""
        self.size, rows, layout = _draw_layout(rng)
        self.order = pick(rng, ["random", "random", "sweep"])
        self.bench = layout.bench(rng, rows, self.order)
        self.blind = layout.bench(rng, int(pick(rng, [40, 80, 120])), "random", rows * layout.step_s)
        if not self.bench.signed:
            self.blind.incidence_rad = np.abs(self.blind.incidence_rad)
        self.holdout = _draw_holdout(rng, rows, rich=layout.rich)
        self.nominal = _draw_nominal(rng)
        self.reflectance = layout.reflectance
        self.tolerance_factor = disturbances.draw_tolerance_factor(rng)
        self.polynomial_mm, self.origin_m = draw_polynomial(rng)
        self.individual = draw_individual(rng, self.nominal, self.tolerance_factor)
        self.bench.reference_C = self.blind.reference_C = float(pick(rng, [20, 25, 25]))
        self.saturation_after_noise = bool(rng.random() < 0.5)
        self.no_target_share = round(rng.uniform(0, 0.03), 4) if rng.random() < 0.4 else 0.0
        self.plan = disturbances.draw_plan(rng, [CHANNEL])

    def prepare(self, names: Sequence[str], rng: np.random.Generator) -> bool:
        """Make the stated noise exact beside an effect of the noise, and give tilts a sign for tilt_asymmetry.

        Returns False where the fit rows do not show tilts of both signs although they must.
        """
        if any(name in self.IN_NOISE for name in names):
            self.plan.noise_factor = {CHANNEL: 1.0}
            self.plan.lag1 = 0.0
        if "tilt_asymmetry" not in names:
            return True
        for bench in (self.bench, self.blind):
            if not bench.signed:
                bench.incidence_rad = bench.incidence_rad * rng.choice([-1.0, 1.0], len(bench.t_s)) + 0.0
                bench.signed = True
        shown = self.bench.incidence_rad[~self.holdout]
        return bool(shown.min() < 0 < shown.max())

    def plausible(self, variant: Variant) -> bool:
        """Return whether all readings are beyond 5 mm, so that none is clipped at zero."""
        return bool(np.all(self.predict(variant) > 0.005))

    @property
    def rival_names(self) -> list[str]:
        """Listed names that act on the mean reading; tilt_asymmetry only where tilts have a sign."""
        return [name for name in super().rival_names if name != "tilt_asymmetry" or self.bench.signed]

    def recipe(self, name: str, rng: np.random.Generator) -> Recipe:
        return range_errors.range_recipe(name, self.bench, rng)

    def predict(self, variant: Variant) -> Array:
        """Return the clean readings (m) of the bench."""
        individual = variant.individual(self.individual, self.nominal)
        return clean_reading(self.bench, individual, variant.effects, variant.outside)

    def _sd(self, effects: Sequence[Effect] = ()) -> Array:
        """Return the true noise (m) of the rows before rounding; range_wander is left out."""
        sd = noise_sd(self.bench.distance_m, self.polynomial_mm, self.origin_m) * self.plan.noise_factor[CHANNEL]
        for name, p in effects:
            if name == "noise_scale":
                sd = sd * p["scale"]
            elif name == "ambient_noise":
                sd = sd * np.sqrt(1 + p["coefficient_per_klux"] * self.bench.lux / 1000)
        return sd

    def _rounded_sd(self, effects: Sequence[Effect] = ()) -> Array:
        """Return the true noise (m) of the rows with rounding; range_wander is left out."""
        return np.sqrt(self._sd(effects) ** 2 + ROUNDING_M2)

    def _wander(self, effects: Sequence[Effect], sd: Array) -> Array | None:
        """Return the covariance of a range_wander among the effects in the fit rows, over their variance."""
        for name, p in effects:
            if name == "range_wander":
                t = self.bench.t_s[~self.holdout]
                return wander_covariance(t, p["sd_m"], p["time_constant_s"]) / np.outer(sd, sd)
        return None

    def noise_ratio(self, effect: Effect, others: Sequence[Effect]) -> float:
        """Compare ambient_noise with the best constant noise scale, and range_wander with the best offset and scale."""
        fit = ~self.holdout
        base = self._rounded_sd(others)[fit]
        rows = len(base)
        wander = self._wander([effect], base)
        if wander is not None:
            offset, scale = (self.nominal[key][1] for key in ("range_offset", "range_scale"))
            columns = np.stack([np.ones(rows) * offset, self.bench.distance_m[fit] * scale], axis=1) / base[:, None]
            lower = np.linalg.inv(np.linalg.cholesky(np.eye(rows) + columns @ columns.T))
            extra = np.clip(np.linalg.eigvalsh(lower @ wander @ lower.T), 0, None)
            return float(np.sum(extra - np.log1p(extra)))
        ratio = self._rounded_sd([*others, effect])[fit] ** 2 / base**2
        slow = self._wander(others, base)
        if slow is not None:
            scales = np.geomspace(0.8, 1.25, 9) * np.mean(ratio) if effect.name == "ambient_noise" else [1.0]
            return min(_divergence(np.diag(ratio) + slow, np.eye(rows) * c + slow) for c in scales)
        if effect.name == "ambient_noise":
            return float(len(ratio) * np.log(np.mean(ratio)) - np.sum(np.log(ratio)))
        return float(np.sum(ratio - 1 - np.log(ratio)))

    def noise_covariance(self, effects: Sequence[Effect], level: float = 1.0, correlation: float = 0.0) -> Array:
        """Return the covariance (m2) of the fit rows by the noise, its effects, and tolerances of offset and scale.

        Args:
            effects: Effects, of which those of the noise count.
            level: Variance of the white noise, relative to the true one.
            correlation: Of neighbours, in that noise.
        """
        fit = ~self.holdout
        sd, row = self._rounded_sd(effects)[fit], np.arange(fit.sum())
        offset, scale = (self.nominal[key][1] for key in ("range_offset", "range_scale"))
        columns = np.stack([np.ones(len(sd)) * offset, self.bench.distance_m[fit] * scale], axis=1)
        slow = self._wander(effects, sd)
        noise = level * correlation ** np.abs(np.subtract.outer(row, row)) + (0.0 if slow is None else slow)
        return np.outer(sd, sd) * noise + columns @ columns.T

    def signatures(self, variants: Sequence[Variant], noise_effects: Sequence[Effect]) -> Array:
        sd, fit = self._rounded_sd(noise_effects), ~self.holdout
        z = np.stack([self.predict(variant) for variant in variants]) / sd
        slow = self._wander(noise_effects, sd[fit])
        if slow is not None:
            return np.linalg.solve(np.linalg.cholesky(np.eye(fit.sum()) + slow), z[:, fit].T).T
        return disturbances.whitened(z, self.plan.lag1)[:, fit]

    def produce(self, variant: Variant, rng: np.random.Generator) -> CaseFiles:
        plan, rows, listed = self.plan, len(self.bench.t_s), dict(variant.effects)
        clean, sd = self.predict(variant), self._sd(variant.effects)
        if "range_wander" in listed:
            clean = clean + first_order_path(rng, self.bench.t_s, **listed["range_wander"])
        values = clean + sd * disturbances.correlated_noise(rng, (rows,), plan.lag1, plan.tail_degrees)
        if "range_saturation" in listed and self.saturation_after_noise:
            values = np.minimum(values, listed["range_saturation"]["saturation_m"])
        mask = disturbances.outlier_masks(rng, rows, [CHANNEL], plan)[CHANNEL]
        values = values + np.where(mask, disturbances.spikes(rng, sd), 0.0)
        lost = rng.random(rows) < self.no_target_share
        values = np.where(lost, NO_TARGET_M, np.round(np.maximum(values, 0.0), 3))
        values = np.where(disturbances.dropouts(rng, rows, plan.dropout_share), np.nan, values)
        data = _number(self.bench)
        data = {"row": data["row"], "split": (np.where(self.holdout, "holdout", "fit"), "%s")} | data
        data[CHANNEL] = (values, "%.3f")
        return CaseFiles(self._nominal(), {"data.csv": data, "blind_inputs.csv": _number(self.blind)})

    def _nominal(self) -> dict[str, Any]:
        """Return the content of nominal.yaml."""
        section = {
            "range_offset_m": value_with_tolerance(self.nominal["range_offset"]),
            "range_scale": value_with_tolerance(self.nominal["range_scale"]),
            "reference_temperature_C": self.bench.reference_C,
            "resolution_m": 0.001,
            "reflectance": self.reflectance,
        }
        stated = {"polynomial_mm": self.polynomial_mm, "polynomial_origin_m": self.origin_m}
        return {"kind": self.KIND, "tof": section, "noise": stated}

    def describe(self) -> dict[str, Any]:
        return {
            "layout": self.size,
            "order": self.order,
            "rows": len(self.holdout),
            "rows_fit": int((~self.holdout).sum()),
            "signed_incidence": self.bench.signed,
            "saturation_after_noise": self.saturation_after_noise,
            "no_target_share": self.no_target_share,
        }


def _number(bench: Bench) -> Table:
    """Return numbered rows of the input columns in the order of the format."""
    return {
        "row": (np.arange(1, len(bench.t_s) + 1), "%d"),
        "t_s": (bench.t_s, "%.1f"),
        "distance_m": (bench.distance_m, "%.3f"),
        "material": (bench.material, "%s"),
        "incidence_rad": (bench.incidence_rad, "%.4f"),
        "temperature_C": (bench.temperature_C, "%.1f"),
        "ambient_lux": (bench.lux, "%d"),
    }
