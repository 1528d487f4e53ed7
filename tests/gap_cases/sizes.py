"""How large effects are drawn: from hardly more than the tolerance of a unit hides, to what nobody overlooks."""

from collections.abc import Callable, Mapping

import numpy as np

from .case import Bench, Effect
from .tof_bench import REFLECTANCE

Numbers = dict[str, float]
Sampler = Callable[[np.random.Generator, Bench], Numbers]
SENSORS = ("front", "left", "right")
SIDES = ("left", "right")


def _sized(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _factor(name: str, low: float, high: float) -> Sampler:
    """A factor that is e^low to e^high, or one over that."""

    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        del bench
        return {name: float(np.exp(rng.choice([-1.0, 1.0]) * _sized(rng, low, high)))}

    return sample


def _either(name: str, low: float, high: float) -> Sampler:
    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        del bench
        return {name: float(rng.choice([-1.0, 1.0]) * _sized(rng, low, high))}

    return sample


def _positive(name: str, low: float, high: float) -> Sampler:
    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        del bench
        return {name: _sized(rng, low, high)}

    return sample


def _both(*samplers: Sampler) -> Sampler:
    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        found: Numbers = {}
        for each in samplers:
            found |= each(rng, bench)
        return found

    return sample


def _times(name: str, parameter: str, low: float, high: float) -> Sampler:
    """Of a nominal parameter."""

    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        return {name: bench.spreads()[parameter][0] * _sized(rng, low, high)}

    return sample


def _of_all(name: str, value: float) -> Sampler:
    """A number that does not differ."""

    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        del rng, bench
        return {name: value}

    return sample


def _around(name: str) -> Sampler:
    """A direction or a phase, nowhere near half a turn, which has two names."""

    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        del bench
        return {name: float(rng.uniform(-3.0, 3.0))}

    return sample


def _of_session(name: str, low: float, high: float) -> Sampler:
    """Of how long the rows took."""

    def sample(rng: np.random.Generator, bench: Bench) -> Numbers:
        return {name: float(bench.inputs["t_s"][-1]) * _sized(rng, low, high)}

    return sample


def _crosstalk(rng: np.random.Generator, bench: Bench) -> Numbers:
    """Ten times as strong where no dark target shows it."""
    dark = min(REFLECTANCE[name] for name in set(bench.inputs["material"]))
    return {"strength_per_m2": _sized(rng, 0.002, 0.02) * (1.0 if dark < 0.1 else 10.0)}


STRIBECK = _both(
    _times("extra_torque_N_m", "coulomb_friction_N_m", 0.15, 0.9), _positive("stribeck_speed_rad_s", 0.8, 4.0)
)
COAST = _both(_positive("inductance_H", 2e-5, 1e-3), _positive("diode_V", 0.4, 2.0), _of_all("switching_Hz", 20_000.0))
"""Of the switching frequency and the inductance only the product shows, so that a report assumes the usual one."""
RIPPLE = _both(
    _times("amplitude_N_m", "coulomb_friction_N_m", 0.1, 1.0),
    _positive("cycles_per_turn", 0.7, 30.0),
    _around("phase_rad"),
)
MOTOR: dict[str, Sampler] = {
    "winding_resistance_scale": _factor("scale", 0.07, 0.25),
    "torque_constant_scale": _factor("scale", 0.05, 0.15),
    "viscous_friction_scale": _factor("scale", 0.33, 0.8),
    "coulomb_friction_scale": _factor("scale", 0.26, 0.7),
    "bridge_voltage_drop": _positive("drop_V", 0.05, 0.5),
    "supply_sag": _positive("source_resistance_ohm", 0.15, 1.5),
}
BENCH: dict[str, Sampler] = {
    **MOTOR,
    "stribeck_friction": STRIBECK,
    "friction_asymmetry": _either("asymmetry", 0.04, 0.3),
    "current_sensor_gain": _factor("gain", 0.04, 0.2),
    "speed_scale": _factor("scale", 0.03, 0.15),
}
SIZES: dict[str, dict[str, Sampler]] = {
    "motor_steady": {
        **BENCH,
        "supply_sag": _positive("source_resistance_ohm", 0.4, 4.0),
        "quadratic_drag": _positive("coefficient_N_m_s2_rad2", 3e-5, 4e-4),
        "friction_warmup": _both(_positive("amplitude", 0.08, 0.6), _of_session("time_constant_s", 0.06, 0.5)),
        "current_sensor_offset": _either("offset_A", 0.001, 0.02),
        "bridge_coast": COAST,
    },
    "motor_step": {
        **BENCH,
        "rotor_inertia_scale": _factor("scale", 0.13, 0.5),
        "input_delay": _positive("delay_s", 0.001, 0.02),
        "actuator_lag": _positive("time_constant_s", 0.002, 0.03),
        "current_limit": _positive("limit_A", 0.35, 1.2),
        "gear_backlash": _positive("gap_rad", 0.02, 0.3),
        "current_sensor_offset": _either("offset_A", 0.002, 0.05),
        "speed_filter_lag": _positive("time_constant_s", 0.002, 0.03),
        "speed_time_offset": _positive("delay_s", 0.001, 0.02),
        "bridge_coast": COAST,
        "torque_ripple": RIPPLE,
    },
    "tof_bench": {
        "range_offset": _either("offset_m", 0.004, 0.02),
        "range_scale": _factor("scale", 0.015, 0.06),
        "log_range_error": _either("coefficient_m", 0.003, 0.015),
        "temperature_drift": _either("coefficient_m_per_K", 1e-4, 1e-3),
        "material_bias": _either("offset_m", 0.003, 0.015),
        "material_slope": _either("coefficient", 0.01, 0.06),
        "incidence_bias": _either("coefficient", 0.01, 0.1),
        "tilt_asymmetry": _either("coefficient_m_per_rad", 0.005, 0.04),
        "cover_crosstalk": _crosstalk,
        "near_field_error": _both(_either("amplitude_m", 0.004, 0.025), _positive("decay_length_m", 0.02, 0.08)),
        "range_saturation": _positive("saturation_m", 0.6, 0.95),
        "warmup_drift": _both(_either("amplitude_m", 0.004, 0.02), _of_session("time_constant_s", 0.06, 0.5)),
        "range_wander": _both(_positive("sd_m", 0.0015, 0.006), _of_session("time_constant_s", 0.04, 0.15)),
        "noise_scale": _factor("scale", 0.3, 1.1),
        "ambient_noise": _positive("coefficient_per_klux", 0.3, 8.0),
    },
    "drive_log": {
        **MOTOR,
        "rotor_inertia_scale": _factor("scale", 0.13, 0.5),
        "torque_constant_mismatch": _either("mismatch", 0.004, 0.08),
        "battery_decline": _positive("fraction_per_minute", 0.005, 0.05),
        "input_delay": _positive("delay_s", 0.001, 0.05),
        "wheel_radius_scale": _factor("scale", 0.012, 0.05),
        "wheel_radius_asymmetry": _either("asymmetry", 0.004, 0.04),
        "wheelbase_scale": _factor("scale", 0.028, 0.1),
        "encoder_ticks_scale": _factor("scale", 0.012, 0.06),
        "encoder_missed_ticks": _both(_positive("fraction", 0.005, 0.2), _positive("threshold_rad_s", 3.0, 8.0)),
        "turn_slip": _positive("coefficient_s2_m", 0.05, 0.8),
        "marker_offset": _either("offset_m", 0.0015, 0.03),
        "pose_time_offset": _positive("delay_s", 0.002, 0.1),
        "tof_range_offset": _either("offset_m", 0.0025, 0.03),
        "tof_range_scale": _factor("scale", 0.004, 0.06),
        "tof_mount_yaw": _either("angle_rad", 0.004, 0.12),
        "tof_time_offset": _positive("delay_s", 0.003, 0.1),
        "marker_yaw": _either("angle_rad", 0.004, 0.08),
        "wheel_eccentricity": _both(_positive("amplitude", 0.006, 0.08), _around("phase_rad")),
        "floor_slope": _both(_positive("gradient", 0.003, 0.05), _around("direction_rad")),
        "pose_clock_drift": _either("rate", 1e-4, 5e-3),
    },
}
WIDE_NOISE_SCALE = _factor("scale", 0.92, 1.8)
"""Where the stated noise may be wrong by a factor of two, only what is beyond 2.5 is an effect."""
ROWS_FOR_WANDER = 100
SHAPES = 4
"""Sizes that are tried of an effect whose first number is not all there is to it."""
WORDS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "material_bias": ("material", tuple(REFLECTANCE)),
    "material_slope": ("material", tuple(REFLECTANCE)),
    "tilt_asymmetry": ("axis", ("forward", "sideways")),
    "encoder_missed_ticks": ("side", SIDES),
    "tof_range_offset": ("sensor", SENSORS),
    "tof_mount_yaw": ("sensor", SENSORS),
    "wheel_eccentricity": ("side", SIDES),
}
"""Discrete parameters: name and values."""
NEEDS_VOLTAGES = (*MOTOR, "rotor_inertia_scale", "torque_constant_mismatch", "battery_decline", "input_delay")
"""Effects on a drive that only show where the wheel voltages were logged."""


def names(bench: Bench) -> list[str]:
    """Of the effects that can show in such data at all."""
    found = list(SIZES[bench.kind])
    if bench.kind == "drive_log" and not np.isfinite(bench.inputs["logs_voltage"]).all():
        found = [name for name in found if name not in NEEDS_VOLTAGES]
    if bench.kind == "tof_bench" and (bench.inputs["incidence_rad"] >= 0.0).all():
        found.remove("tilt_asymmetry")
    if bench.kind == "tof_bench" and len(bench.inputs["row"]) < ROWS_FOR_WANDER:
        found.remove("range_wander")
    return found


def sample(
    name: str, bench: Bench, rng: np.random.Generator, word: str | None = None, *, is_wide: bool = False
) -> Effect:
    """One effect of that name, of a size by chance; the word too, where it has one."""
    sampler = WIDE_NOISE_SCALE if is_wide and name == "noise_scale" else SIZES[bench.kind][name]
    parameters = sampler(rng, bench)
    if name not in WORDS:
        return Effect(name, parameters)
    key, words = WORDS[name]
    if key == "material" and word is None:
        words = tuple(sorted(set(bench.inputs["material"])))
    return Effect(name, {key: word or str(rng.choice(words)), **parameters})


def rivals(bench: Bench) -> list[Effect]:
    """Every effect of the kind with every word: of one size, or of several where it has a shape too."""
    found = []
    for name in names(bench):
        for word in WORDS[name][1] if name in WORDS else (None,):
            rng = np.random.default_rng(7)
            draws = 1 if len(SIZES[bench.kind][name](rng, bench)) == 1 else SHAPES
            found += [sample(name, bench, rng, word) for _ in range(draws)]
    return found


def is_two_sided(name: str, bench: Bench) -> bool:
    """Whether the effect comes with both signs."""
    rng = np.random.default_rng(1)
    drawn = [next(iter(SIZES[bench.kind][name](rng, bench).items())) for _ in range(20)]
    above = [value > (1.0 if key in {"scale", "gain"} else 0.0) for key, value in drawn]
    return any(above) and not all(above)
