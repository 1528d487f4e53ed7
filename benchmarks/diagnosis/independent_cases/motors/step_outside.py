"""Effects of step trials that the format does not list."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick
from benchmarks.diagnosis.independent_cases.motors import steady_outside
from benchmarks.diagnosis.independent_cases.motors.excitation import DT_S
from benchmarks.diagnosis.independent_cases.motors.motor_law import Law
from benchmarks.diagnosis.independent_cases.motors.steady_outside import BUMP_TEXT, CHANNELS, JUMP_TEXT, BenchDraft
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Recipe


@dataclass(frozen=True)
class StepDraft(BenchDraft):
    """A draft for the bench of step trials."""

    phase_rad: float
    top_voltage_V: float
    idle_A: float  # no-load current at the highest voltage
    stated_sd: Mapping[str, float]  # noise of current [A] and speed [rad/s]


def _two_mass_ringing(d: StepDraft) -> Recipe:
    damping = log_uniform(d.rng, 0.02, 0.12)
    recipe = d.grows(1.0, 7.0, lambda size: {"frequency_Hz": 40 / size, "damping_ratio": damping}, clamped=True)
    return recipe.seen_in("omega_rad_s", "time_since_step_s", "motor and load swing against each other on a spring")


def _hum(d: StepDraft) -> Recipe:
    channel = pick(d.rng, CHANNELS)
    shape, sd = {"frequency_Hz": log_uniform(d.rng, 0.7, 12), "phase_rad": d.phase_rad}, d.stated_sd[channel]
    recipe = d.grows(0.1, 6.0, lambda size: {"channel": channel, "amplitude": size * sd, **shape})
    return recipe.seen_in(channel, "session_time_s", "a sinusoid in session time is added to one channel")


RECIPES: dict[str, Callable[[StepDraft], Recipe]] = {
    "two_mass_ringing": _two_mass_ringing,
    "parameter_jump": lambda d: d.parameter_change(0.7, CHANNELS, "session_time_s", JUMP_TEXT, time_s=d.when_s),
    "parameter_drift": lambda d: d.parameter_change(
        0.8, CHANNELS, "session_time_s", "drifts linearly over the session", span_s=d.span_s
    ),
    "friction_bump": lambda d: d.bump(0.05, (0.8, 2.5), (0.2, 0.6), (0.04, 0.1)).seen_in(
        "omega_rad_s", "omega_rad_s", BUMP_TEXT
    ),
    "encoder_eccentricity": lambda d: d.positive(0.002, 0.2, "amplitude", phase_rad=d.phase_rad).seen_in(
        "omega_rad_s", "wheel_angle_rad", "the measured speed swings once a turn of the wheel"
    ),
    "driver_hysteresis": lambda d: d.signed(0.003, 0.3, "change").seen_in(
        "current_A", "u_cmd_V", "the bridge gives more after a rise than after a fall of abs(u)"
    ),
    "voltage_dead_zone": lambda d: d.grows(0.02, 0.6, lambda size: {"below_V": size * d.top_voltage_V}).seen_in(
        "current_A", "u_cmd_V", "commands below a threshold give no voltage, others all of it"
    ),
    "gain_drift": lambda d: d.gain_drift(0.5, "session_time_s", span_s=d.span_s),
    "hum": _hum,
}


def _tacho_compression(d: StepDraft) -> Recipe:
    recipe = d.grows(0.05, 1.5, lambda size: {"end_rad_s": d.top_speed_rad_s / size})
    return recipe.seen_in("omega_rad_s", "omega_rad_s", "the speed sensor saturates gradually, as a tanh")


def _periodic_friction(d: StepDraft) -> Recipe:
    period = float(d.span_s * d.rng.uniform(0.12, 0.4))
    recipe = d.positive(0.02, 0.7, "change", period_s=period, phase_rad=d.phase_rad)
    return recipe.seen_in("omega_rad_s", "session_time_s", "Coulomb friction swings periodically in time")


def _winding_memory(d: StepDraft) -> Recipe:
    recipe = d.positive(0.01, 1.5, "change", time_constant_s=float(d.span_s * log_uniform(d.rng, 0.04, 0.15)))
    return recipe.seen_in("current_A", "session_time_s", "the winding resistance follows the past voltage squared")


def _current_kink(d: StepDraft) -> Recipe:
    above = d.idle_A * d.rng.uniform(1.0, 3.0)
    recipe = d.grows(0.03, 1.5, lambda size: {"gain_change": max(d.direction * size, -0.95), "above_A": above})
    return recipe.seen_in("current_A", "current_A", "the current sensor has another gain above one current")


FURTHER: dict[str, Callable[[StepDraft], Recipe]] = {
    "supply_drift": lambda d: d.signed(0.003, 0.4, "change", span_s=d.span_s).seen_in(
        "omega_rad_s", "session_time_s", "the voltage of the supply drifts linearly over the session"
    ),
    "driver_limit": lambda d: d.grows(0.02, 0.7, lambda size: {"above_V": d.top_voltage_V * (1 - size)}).seen_in(
        "current_A", "u_cmd_V", "the driver gives no voltage beyond one value"
    ),
    "periodic_friction": _periodic_friction,
    "winding_memory": _winding_memory,
    "current_kink": _current_kink,
    "speed_counter_limit": lambda d: d.grows(
        0.01, 0.6, lambda size: {"above_rad_s": d.top_speed_rad_s * (1 - size)}
    ).seen_in("omega_rad_s", "omega_rad_s", "the speed counter stops counting above one speed"),
    "tacho_compression": _tacho_compression,
}
"""Effects that only the evaluation of discovery draws, so that the cases of known seeds stay as they are."""


def change_law(law: Law, effect: Effect, session_s: Array, trial: int, u_V: Array) -> None:
    """Change the law of one trial in place.

    session_s are the session times of its samples, and u_V (trials, samples) the voltages of all trials.
    """
    name, p = effect
    if name == "parameter_jump":
        law.multiply(p["parameter"], np.where(session_s > p["time_s"], 1 + p["change"], 1.0))
    elif name == "parameter_drift":
        law.multiply(p["parameter"], 1 + p["change"] * session_s / p["span_s"])
    elif name == "friction_bump":
        law.bump, law.bump_speed, law.bump_width = p["torque_N_m"], p["speed_rad_s"], p["width_rad_s"]
    elif name == "voltage_dead_zone":
        law.dead = p["below_V"]
    elif name == "winding_memory":
        # The winding stays warm from one trial to the next.
        load = (u_V[: trial + 1].ravel() / np.abs(u_V).max()) ** 2
        heat = steady_outside.past_load(np.arange(len(load)) * DT_S, load, p["time_constant_s"])
        law.multiply("R", 1 + p["change"] * heat[-len(session_s) :])
    elif name == "periodic_friction":
        law.multiply("Tc", 1 + p["change"] * np.sin(2 * np.pi * session_s / p["period_s"] + p["phase_rad"]))


def change_command(u: Array, effect: Effect, session_s: Array) -> Array:
    """Return the voltage (V) of one trial that the bridge really gives."""
    if effect.name == "supply_drift":
        return u * (1 + effect.parameters["change"] * session_s / effect.parameters["span_s"])
    if effect.name == "driver_limit":
        return np.clip(u, -effect.parameters["above_V"], effect.parameters["above_V"])
    if effect.name != "driver_hysteresis":
        return u
    trend, last, real = 1.0, 0.0, np.empty(len(u))
    for k, value in enumerate(np.abs(u)):
        if value != last:
            trend = 1.0 if value > last else -1.0
        last = value
        real[k] = u[k] * (1 + effect.parameters["change"] * trend)
    return real


def change_reading(amps: Array, speed: Array, effect: Effect, angle: Array, session_s: Array) -> tuple[Array, Array]:
    """Return readings (A, rad/s) of one trial after an outside effect of a sensor at wheel angles (rad)."""
    name, p = effect
    factor, wave = np.ones(len(speed)), np.zeros(len(speed))
    if name == "encoder_eccentricity":
        return amps, speed * (1 + p["amplitude"] * np.cos(angle + p["phase_rad"]))
    if name == "tacho_compression":
        return amps, p["end_rad_s"] * np.tanh(speed / p["end_rad_s"])
    if name in {"current_kink", "speed_counter_limit"}:
        return steady_outside.change_reading(amps, speed, effect, session_s, 0.0)
    if name == "gain_drift":
        factor = 1 + p["change"] * session_s / p["span_s"]
    elif name == "hum":
        wave = p["amplitude"] * np.sin(2 * np.pi * p["frequency_Hz"] * session_s + p["phase_rad"])
    else:
        return amps, speed
    if p["channel"] == "current_A":
        return amps * factor + wave, speed
    return amps, speed * factor + wave
