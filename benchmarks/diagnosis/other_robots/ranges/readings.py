"""Readings of a range bench without noise and rounding."""

from collections.abc import Callable

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.effects import Key, Table, columns
from benchmarks.diagnosis.other_robots.ranges.bench import RangeBench

NOMINAL = 2
"""Parameters with a tolerance: offset and scale."""
Values = list[Array]


def _carriage_play(b: RangeBench, v: Values) -> Array:
    """Return an offset with the sign of the last move."""
    before = np.concatenate([[0.0], b.d[:-1]])
    return v[0] * np.sign(b.d - before)


OFFSETS: dict[str, Callable[[RangeBench, Values], Array]] = {
    "range_offset": lambda _, v: v[0],
    "log_range_error": lambda b, v: v[0] * np.log(np.maximum(b.d, 0.18) / 0.18),
    "temperature_drift": lambda b, v: v[0] * (b.temperature - b.reference),
    "incidence_bias": lambda b, v: v[0] * b.d * np.sin(b.angle) ** 2,
    "near_field_error": lambda b, v: v[0] * np.exp(-b.d / np.maximum(v[1], 1e-6)),
    "warmup_drift": lambda b, v: v[0] * np.exp(-b.t / np.maximum(v[1], 1e-6)),
    "table_kink": lambda b, v: v[0] * np.maximum(0, b.d - v[1]),
    "second_target": lambda b, v: v[0] * np.exp(-(((b.d - v[1]) / v[2]) ** 2)),
    "phase_ripple": lambda b, v: v[0] * np.sin(2 * np.pi * b.d / v[1] + v[2]),
    "bumped_fixture": lambda b, v: v[0] * (b.t > v[1]),
    "light_shift": lambda b, v: v[0] * np.log10(b.lux / 300),
    "scale_with_temperature": lambda b, v: v[0] * b.d * (b.temperature - b.reference),
    "gain_switch": lambda b, v: v[0] * (b.d > v[1]),
    "carriage_play": _carriage_play,
    "reflection_at_angle": lambda b, v: v[0] * (b.angle > v[1] - 1e-9),
}
"""Effects that add to the reading."""
MATERIAL_OFFSETS: dict[str, Callable[[RangeBench, Values], Array]] = {
    "material_bias": lambda _, v: v[0],
    "material_slope": lambda b, v: v[0] * (b.d - 0.1),
}
"""Effects that add to the reading on one material."""


def _filtered(out: Array, v: Values) -> Array:
    """Return readings of which each keeps a share of the one before."""
    share, filtered = v[0][:, 0], out.copy()
    for k in range(1, filtered.shape[1]):
        filtered[:, k] = share * filtered[:, k - 1] + (1 - share) * out[:, k]
    return filtered


AFTERWARDS: dict[str, Callable[[Array, Values], Array]] = {
    "range_saturation": lambda out, v: np.minimum(out, v[0]),
    "filtered_readings": _filtered,
    "coarse_steps": lambda out, v: np.round(out / v[0]) * v[0],
    "fold_back": lambda out, v: np.where(out > v[0], out - v[0], out),
    "nearest_reading": lambda out, v: np.maximum(out, v[0]),
}
"""Effects that act on the whole reading."""


def readings(b: RangeBench, table: Table, keys: list[Key], thetas: Array) -> Array:
    """Return readings, (variants, rows)."""
    effective = np.repeat(b.d[None], len(thetas), axis=0)
    gain = 1 + thetas[:, 1:2] * b.tolerance[1]
    offset = thetas[:, 0:1] * b.tolerance[0] + 0 * b.d[None]
    late = []
    for (name, material), parameters in columns(table, keys, thetas, NOMINAL):
        v = [column[:, None] for column in parameters]
        if name in OFFSETS:
            offset = offset + OFFSETS[name](b, v)
        elif name in MATERIAL_OFFSETS:
            offset = offset + (b.material == material) * MATERIAL_OFFSETS[name](b, v)
        elif name == "range_scale":
            gain = gain * v[0]
        elif name == "cover_crosstalk":
            effective = effective / (1 + v[0] * b.d[None] ** 2 / b.rho)
        else:
            late.append((AFTERWARDS[name], v))
    out = gain * effective + offset
    for act, v in late:
        out = act(out, v)
    return out
