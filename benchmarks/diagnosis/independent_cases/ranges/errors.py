"""What a range sensor reads on the bench: listed and outside effects as changes of the clean reading."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import draw_sign, log_uniform, pick
from benchmarks.diagnosis.independent_cases.recipes import Array, Draft, Effect, Parameters, Recipe


@dataclass
class Bench:
    """Conditions of the rows of a bench; every array is (rows,)."""

    distance_m: Array
    material: Array
    incidence_rad: Array
    temperature_C: Array
    reference_C: float  # temperature without drift
    lux: Array
    t_s: Array  # since power-on
    reflectance: Array
    signed: bool  # whether the incidence has a sign


@dataclass(frozen=True)
class RangeDraft(Draft):
    """A draft with what the plausible sizes depend on."""

    material: str
    far_m: float  # largest distance
    span_s: float  # duration of the session


def _noise_scale(d: RangeDraft) -> Recipe:
    """Draw a factor outside 0.5 to 2, by which the stated noise may be wrong without an effect."""
    return d.fixed(scale=log_uniform(d.rng, 2.3, 4.5))


def _near_field_error(d: RangeDraft) -> Recipe:
    return d.signed(1e-3, 0.08, "amplitude_m", decay_length_m=log_uniform(d.rng, 0.02, 0.1))


def _warmup_drift(d: RangeDraft) -> Recipe:
    return d.signed(1e-3, 0.06, "amplitude_m", time_constant_s=d.span_s * log_uniform(d.rng, 0.05, 0.5))


def _range_wander(d: RangeDraft) -> Recipe:
    return d.positive(5e-4, 0.04, "sd_m", time_constant_s=d.span_s * log_uniform(d.rng, 0.02, 0.2))


def _tilt_asymmetry(d: RangeDraft) -> Recipe:
    return d.signed(1e-3, 0.1, "coefficient_m_per_rad", axis=pick(d.rng, ["forward", "sideways"]))


def _periodic_error(d: RangeDraft) -> Recipe:
    wave, phase = log_uniform(d.rng, 0.05, 0.3), d.rng.uniform(-np.pi, np.pi)
    recipe = d.positive(5e-4, 0.05, "amplitude_m", wavelength_m=wave, phase_rad=phase)
    return recipe.seen_in("reading_m", "distance_m", "an error periodic in distance")


RECIPES: dict[str, tuple[str, Callable[[RangeDraft], Recipe]]] = {
    "range_offset": ("constant", lambda d: d.signed(1e-3, 0.05, "offset_m")),
    "range_scale": ("distance", lambda d: d.scaled(2e-3, 0.2)),
    "log_range_error": ("distance", lambda d: d.signed(1e-3, 0.08, "coefficient_m")),
    "temperature_drift": ("temperature", lambda d: d.signed(2e-5, 3e-3, "coefficient_m_per_K")),
    "material_bias": ("material", lambda d: d.signed(1e-3, 0.05, "offset_m", {"material": d.material})),
    "incidence_bias": ("angle", lambda d: d.signed(2e-3, 0.4, "coefficient")),
    "cover_crosstalk": ("crosstalk", lambda d: d.positive(2e-4, 0.5, "strength_per_m2")),
    "near_field_error": ("near", _near_field_error),
    "range_saturation": ("far", lambda d: d.grows(0.005, 0.7, lambda size: {"saturation_m": d.far_m * (1 - size)})),
    "warmup_drift": ("time", _warmup_drift),
    "noise_scale": ("noise", _noise_scale),
    "ambient_noise": ("noise", lambda d: d.positive(0.02, 30, "coefficient_per_klux")),
    "range_wander": ("time", _range_wander),
    "tilt_asymmetry": ("angle", _tilt_asymmetry),
    "material_slope": ("material", lambda d: d.signed(2e-3, 0.3, "coefficient", {"material": d.material})),
}
"""Place and recipe of every listed effect."""
PLACE = {name: place for name, (place, _) in RECIPES.items()}
OUTSIDE_RECIPES: dict[str, Callable[[RangeDraft], Recipe]] = {
    "periodic_error": _periodic_error,
    "memory": lambda d: d.positive(2e-3, 0.4, "share").seen_in(
        "reading_m", "previous_distance_m", "a share of the previous reading is in every reading"
    ),
    "jump": lambda d: d.signed(1e-3, 0.06, "step_m", time_s=d.span_s * d.rng.uniform(0.25, 0.7)).seen_in(
        "reading_m", "t_s", "the offset jumps at one moment"
    ),
    "distance_bump": lambda d: d.signed(
        1e-3,
        0.08,
        "amplitude_m",
        at_m=d.rng.uniform(0.25, 0.75) * d.far_m,
        width_m=d.rng.uniform(0.05, 0.12) * d.far_m,
    ).seen_in("reading_m", "distance_m", "a local error around one distance"),
    "scale_drift": lambda d: d.signed(3e-3, 0.2, "change", span_s=d.span_s).seen_in(
        "reading_m", "t_s", "the scale drifts linearly in time"
    ),
    "approach_hysteresis": lambda d: d.signed(5e-4, 0.04, "amplitude_m").seen_in(
        "reading_m", "previous_distance_m", "reads more after an approach than after a retreat, or less"
    ),
    "near_floor": lambda d: d.positive(0.05, 0.4, "floor_m").seen_in(
        "reading_m", "distance_m", "never reads less than a floor"
    ),
    "light_bias": lambda d: d.signed(1e-4, 0.02, "coefficient_m_per_klux").seen_in(
        "reading_m", "ambient_lux", "the mean reading moves with ambient light"
    ),
    "material_angle": lambda d: d.signed(2e-3, 0.2, "coefficient_m", {"material": d.material}).seen_in(
        "reading_m", "incidence_rad", "an error with sin^2 of the incidence on one material only"
    ),
    "coarse_steps": lambda d: d.positive(0.004, 0.08, "step_m").seen_in(
        "reading_m", "distance_m", "reads in coarse steps"
    ),
}


def range_recipe(name: str, bench: Bench, rng: np.random.Generator) -> Recipe:
    """Draw how a listed or outside effect grows with its size."""
    direction, material = draw_sign(rng), pick(rng, sorted(set(bench.material)))
    far, span = float(bench.distance_m.max()), float(bench.t_s[-1])
    place, recipe = RECIPES[name] if name in RECIPES else ("outside", OUTSIDE_RECIPES[name])
    return recipe(RangeDraft(name, place, rng, direction, material, far, span))


# Errors (m) that a listed effect adds to the reading.
ADDED: dict[str, Callable[[Bench, Parameters], Array | float]] = {
    "range_offset": lambda _, p: p["offset_m"],
    "log_range_error": lambda b, p: p["coefficient_m"] * np.log(np.maximum(b.distance_m, 0.18) / 0.18),
    "temperature_drift": lambda b, p: p["coefficient_m_per_K"] * (b.temperature_C - b.reference_C),
    "material_bias": lambda b, p: p["offset_m"] * (b.material == p["material"]),
    "material_slope": lambda b, p: p["coefficient"] * (b.distance_m - 0.1) * (b.material == p["material"]),
    "incidence_bias": lambda b, p: p["coefficient"] * b.distance_m * np.sin(b.incidence_rad) ** 2,
    "tilt_asymmetry": lambda b, p: p["coefficient_m_per_rad"] * b.incidence_rad,
    "near_field_error": lambda b, p: p["amplitude_m"] * np.exp(-b.distance_m / p["decay_length_m"]),
    "warmup_drift": lambda b, p: p["amplitude_m"] * np.exp(-b.t_s / p["time_constant_s"]),
}


def _retreat(distance: Array) -> Array:
    """Return +1 where the target is farther than in the row before, -1 where it is nearer."""
    return np.sign(distance - np.concatenate([distance[:1], distance[:-1]]))


# Readings (m) with an outside effect.
CHANGED: dict[str, Callable[[Array, Bench, Parameters], Array]] = {
    "periodic_error": lambda r, b, p: (
        r + p["amplitude_m"] * np.sin(2 * np.pi * b.distance_m / p["wavelength_m"] + p["phase_rad"])
    ),
    "memory": lambda r, _, p: r + p["share"] * np.concatenate([[0.0], r[:-1] - r[1:]]),
    "jump": lambda r, b, p: r + p["step_m"] * (b.t_s >= p["time_s"]),
    "distance_bump": lambda r, b, p: r + p["amplitude_m"] * np.exp(-(((b.distance_m - p["at_m"]) / p["width_m"]) ** 2)),
    "scale_drift": lambda r, b, p: r * (1 + p["change"] * b.t_s / p["span_s"]),
    "approach_hysteresis": lambda r, b, p: r - p["amplitude_m"] * _retreat(b.distance_m),
    "near_floor": lambda r, _, p: np.maximum(r, p["floor_m"]),
    "light_bias": lambda r, b, p: r + p["coefficient_m_per_klux"] * b.lux / 1000,
    "material_angle": lambda r, b, p: (
        r + p["coefficient_m"] * np.sin(b.incidence_rad) ** 2 * (b.material == p["material"])
    ),
    "coarse_steps": lambda r, _, p: np.round(r / p["step_m"]) * p["step_m"],
}


def clean_reading(
    bench: Bench, individual: dict[str, float], effects: Sequence[Effect], outside: Sequence[Effect]
) -> Array:
    """Return the readings (m) without noise; crosstalk comes first and saturation last."""
    listed = dict(effects)
    shown, scale = bench.distance_m, individual["range_scale"]
    if "cover_crosstalk" in listed:
        strength = listed["cover_crosstalk"]["strength_per_m2"]
        shown = bench.distance_m / (1 + strength * bench.distance_m**2 / bench.reflectance)
    if "range_scale" in listed:
        scale = individual["range_scale"] * listed["range_scale"]["scale"]
    reading = individual["range_offset"] + scale * shown
    for name, p in effects:
        if name in ADDED:
            reading = reading + ADDED[name](bench, p)
    for name, p in outside:
        reading = CHANGED[name](reading, bench, p)
    if "range_saturation" in listed:
        reading = np.minimum(reading, listed["range_saturation"]["saturation_m"])
    return reading


def noise_sd(distance_m: Array, polynomial_mm: Sequence[float], origin_m: float) -> Array:
    """Return the stated noise (m) at a distance: a cubic in mm of the metres beyond the origin."""
    x = np.maximum(0.0, distance_m - origin_m)
    p = polynomial_mm
    return 1e-3 * (p[0] + p[1] * x + p[2] * x**2 + p[3] * x**3)


def wander_covariance(t_s: Array, sd_m: float, time_constant_s: float) -> Array:
    """Return the covariance (m2) of a stationary first-order Gauss-Markov error at times t_s."""
    return sd_m**2 * np.exp(-np.abs(t_s[:, None] - t_s[None, :]) / time_constant_s)


def draw_polynomial(rng: np.random.Generator) -> tuple[list[float], float]:
    """Draw the polynomial (mm) and the origin (m) of the noise of a range sensor, from quiet to loud."""
    if rng.random() < 0.3:
        return [1.4, 4.88, 2.51, 1.15], 0.18
    level = log_uniform(rng, 0.6, 4)
    rest = [level * rng.uniform(0.5, 4), level * rng.uniform(0, 2.5), level * rng.uniform(0, 1.0)]
    return [round(level, 2)] + [round(x, 2) for x in rest], float(pick(rng, [0.0, 0.1, 0.18, 0.18, 0.3]))
