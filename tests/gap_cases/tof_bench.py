"""A range sensor before targets."""

from collections.abc import Mapping, Sequence

import numpy as np

from .case import Array, Bench, Columns, Frame, World
from .disturbances import AS_STATED, Day
from .motor_law import column
from .noise import OUTLIER_SIGMAS, correlated, share

NO_TARGET_M = 8.190
ROW_S = 2.0
REFERENCE_C = 25.0
LOG_FROM_M = 0.18
REFLECTANCE = {"white_paper": 0.85, "grey_card": 0.18, "black_card": 0.05, "wood": 0.45, "plastic": 0.6}
POLYNOMIAL_MM = [1.4, 4.88, 2.51, 1.15]
SLOPE_FROM_M = 0.1
SIGNED = 0.4
"""Share of the benches with several angles that log to which side a target is turned."""
BLOCK = 10
"""Rows that are held out together."""


def draw(rng: np.random.Generator, rows: str) -> Bench:
    n = {"few": 60, "some": 150, "usual": 400}[rows]
    inputs = _inputs(rng, rows, n)
    blocks = n // BLOCK
    held = rng.choice(blocks, max(1, round(0.25 * blocks)), replace=False)
    inputs["split"] = np.where(np.isin(np.arange(n) // BLOCK, held), "holdout", "fit")
    unseen = 40 if rows == "few" else 120
    blind = _inputs(rng, rows, unseen)
    blind["t_s"] = blind["t_s"] + ROW_S * n
    if rows != "few" and rng.random() < SIGNED:
        for columns in (inputs, blind):
            angle = columns["incidence_rad"]
            columns["incidence_rad"] = np.where(rng.random(len(angle)) < 0.5, angle, 0.0 - angle)
    nominal = {
        "kind": "tof_bench",
        "tof": {
            "range_offset_m": {"value": 0, "tolerance": 0.0005},
            "range_scale": {"value": 1, "tolerance": 0.002},
            "reference_temperature_C": 25,
            "resolution_m": 0.001,
            "reflectance": REFLECTANCE,
        },
        "noise": {"polynomial_mm": POLYNOMIAL_MM, "polynomial_origin_m": LOG_FROM_M},
    }
    return Bench(nominal, inputs, {"blind_inputs.csv": blind})


def _inputs(rng: np.random.Generator, rows: str, n: int) -> dict:
    common = {"row": np.arange(1, n + 1), "t_s": ROW_S * np.arange(n)}
    if rows == "few":
        return {
            **common,
            "distance_m": np.round(rng.permutation(np.linspace(0.04, 1.0, n)), 3),
            "material": np.full(n, "white_paper"),
            "incidence_rad": np.zeros(n),
            "temperature_C": np.round(REFERENCE_C + 0.3 * rng.standard_normal(n), 1),
            "ambient_lux": np.full(n, 300.0),
        }
    lux = rng.choice([50.0, 300.0, 1000.0, 5000.0], n)
    return {
        **common,
        "distance_m": np.round(0.02 * rng.integers(2, 51, n), 3),
        "material": rng.choice(list(REFLECTANCE), n),
        "incidence_rad": np.round(np.radians(rng.choice([0.0, 15.0, 30.0, 45.0], n, p=[0.4, 0.2, 0.2, 0.2])), 4),
        "temperature_C": np.round(rng.choice([15.0, 20.0, 25.0, 32.0, 40.0], n) + 0.3 * rng.standard_normal(n), 1),
        "ambient_lux": np.round(lux * rng.uniform(0.9, 1.1, n)),
    }


def mean(inputs: Columns, worlds: Sequence[World]) -> Array:
    """Readings without noise and rounding, (V, rows)."""
    return np.minimum(unlimited(inputs, worlds), column([limit_m(w) for w in worlds]))


def limit_m(world: World) -> float:
    return world.value("range_saturation", "saturation_m", np.inf)


def unlimited(inputs: Columns, worlds: Sequence[World]) -> Array:
    """The same before the sensor's upper limit, which acts on a reading with its noise."""
    distance, time = inputs["distance_m"], inputs["t_s"]

    def own(name: str) -> Array:
        return column([w.own[name] for w in worlds])

    def effect(name: str, parameter: str, absent: float = 0.0) -> Array:
        return column([w.value(name, parameter, absent) for w in worlds])

    def beyond(name: str, parameter: str, absent: float = 0.0) -> Array:
        return column([w.beyond(name, parameter, absent) for w in worlds])

    reflectance = np.array([REFLECTANCE[name] for name in inputs["material"]])
    reading = own("range_scale") * effect("range_scale", "scale", 1.0) * distance
    reading = reading / (1.0 + effect("cover_crosstalk", "strength_per_m2") * distance**2 / reflectance)
    reading = reading + own("range_offset_m") + effect("range_offset", "offset_m")
    reading = reading + effect("log_range_error", "coefficient_m") * np.log(np.maximum(distance / LOG_FROM_M, 1.0))
    warmer = inputs["temperature_C"] - REFERENCE_C
    reading = reading + effect("temperature_drift", "coefficient_m_per_K") * warmer
    for name in REFLECTANCE:
        here = column([w.value("material_bias", "offset_m", 0.0, name) for w in worlds])
        slope = column([w.value("material_slope", "coefficient", 0.0, name) for w in worlds])
        reading = reading + (here + slope * (distance - SLOPE_FROM_M)) * (inputs["material"] == name)
    tilt = np.sin(inputs["incidence_rad"]) ** 2
    reading = reading + effect("incidence_bias", "coefficient") * distance * tilt
    reading = reading + effect("tilt_asymmetry", "coefficient_m_per_rad") * inputs["incidence_rad"]
    decay = effect("near_field_error", "decay_length_m", 1.0)
    reading = reading + effect("near_field_error", "amplitude_m") * np.exp(-distance / decay)
    slow = effect("warmup_drift", "time_constant_s", 1.0)
    reading = reading + effect("warmup_drift", "amplitude_m") * np.exp(-time / slow)
    wave = 2.0 * np.pi * distance / beyond("cyclic_error", "wavelength_m", 1.0) + beyond("cyclic_error", "phase_rad")
    reading = reading + beyond("cyclic_error", "amplitude_m") * np.sin(wave)
    reading = reading + beyond("bumped", "offset_m") * (time >= beyond("bumped", "begins_s", np.inf))
    before = np.concatenate([distance[:1], distance[:-1]])
    reading = reading + beyond("memory", "share") * (before - distance)
    reading = reading + beyond("mode_switch", "offset_m") * (distance >= beyond("mode_switch", "from_m", np.inf))
    local = (distance - beyond("local_bump", "distance_m")) / beyond("local_bump", "width_m", 1.0)
    return reading + beyond("local_bump", "amplitude_m") * np.exp(-(local**2))


def sd(inputs: Columns, worlds: Sequence[World], polynomial_mm: Sequence[float] = POLYNOMIAL_MM) -> Array:
    """Of the noise, (V, rows)."""
    beyond = np.maximum(inputs["distance_m"] - LOG_FROM_M, 0.0)
    nominal = 1e-3 * sum(p * beyond**k for k, p in enumerate(polynomial_mm))
    scale = column([w.value("noise_scale", "scale", 1.0) for w in worlds])
    light = column([w.value("ambient_noise", "coefficient_per_klux", 0.0) for w in worlds])
    return nominal * scale * np.sqrt(1.0 + light * inputs["ambient_lux"] / 1000.0)


def observe(
    bench: Bench, world: World, rng: np.random.Generator, day: Day = AS_STATED
) -> tuple[Columns, Mapping[str, Columns]]:
    """Columns of data.csv, and the inputs of unseen runs; the noise of the bench is the true one."""
    lost, odd = share(rng, 0.03), share(rng, 0.02)
    noise = bench.nominal["noise"]
    spread = sd(bench.inputs, [world], noise["polynomial_mm"])[0]
    clamp_is_last = day.clamp_is_last is not False
    reading = (unlimited if clamp_is_last else mean)(bench.inputs, [world])[0]
    good = correlated(rng, (len(spread),), noise.get("lag1_correlation", 0.0), day.degrees)
    if sd_m := world.value("range_wander", "sd_m", 0.0):
        tau_s = world.value("range_wander", "time_constant_s", np.inf)
        reading = reading + sd_m * wandering(rng, bench.inputs["t_s"], tau_s)
    reading = reading + spread * (good + day.zero("reading_m", bench.inputs["row"] * 0.0, bench.inputs["t_s"]))
    reading = np.minimum(reading, limit_m(world)) if clamp_is_last else reading
    hit = rng.random(len(reading))
    far = rng.uniform(*OUTLIER_SIGMAS, len(reading)) * rng.choice([-1.0, 1.0], len(reading))
    struck = day.struck(len(reading)).get("reading_m", np.where(hit < 0.5 * odd, far, 0.0))
    reading = reading + struck * spread
    reading = np.where((hit >= 0.5 * odd) & (hit < odd), NO_TARGET_M, reading)
    reading = np.where(rng.random(len(reading)) < lost, np.nan, np.round(np.maximum(reading, 0.0), 3))
    return {**bench.inputs, "reading_m": reading}, bench.blind


def wandering(rng: np.random.Generator, t_s: Array, tau_s: float) -> Array:
    """A walk of variance 1 that forgets as exp(-t / tau), at rising times."""
    kept = np.exp(-np.diff(t_s, prepend=-np.inf) / tau_s)
    walk, now = np.zeros(len(t_s)), 0.0
    for k, deviate in enumerate(rng.standard_normal(len(t_s))):
        now = walk[k] = kept[k] * now + np.sqrt(1.0 - kept[k] ** 2) * deviate
    return walk


def frame(bench: Bench, columns: Columns) -> Frame:
    n = len(columns["row"])
    reading, noise = columns["reading_m"], bench.nominal["noise"]
    zeros = np.zeros(n, dtype=np.int64)
    return Frame(
        measured=np.where(reading > NO_TARGET_M - 0.001, np.nan, reading),
        sigma=sd(columns, [bench.textbook()], noise["polynomial_mm"])[0],
        holdout=columns["split"] == "holdout",
        stage=zeros,
        run=zeros,
        correlation=np.full(n, noise.get("lag1_correlation", 0.0)),
        usable=np.ones(n, dtype=bool),
    )


def predict(bench: Bench, columns: Columns, worlds: Sequence[World]) -> Array:
    del bench
    return mean(columns, worlds)
