"""Effects of motors on a bench that the format does not list: those of steady states, and those of both benches."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick
from benchmarks.diagnosis.independent_cases.motors.motor_law import Law
from benchmarks.diagnosis.independent_cases.recipes import Array, Draft, Effect, Recipe

CHANNELS = ("current_A", "omega_rad_s")
BUMP_TEXT = "friction has a local bump (or dip) at one speed"
JUMP_TEXT = "changes by a factor at one moment of the session"


@dataclass(frozen=True)
class BenchDraft(Draft):
    """A draft with what the plausible sizes depend on."""

    when_s: float  # moment of a jump
    span_s: float  # duration of the session
    tc_N_m: float  # nominal Coulomb friction
    top_speed_rad_s: float

    def bump(self, low: float, highs: tuple[float, float], speeds: Sequence[float], widths: Sequence[float]) -> Recipe:
        """Return a recipe of a friction bump, or of a dip, whose largest size is highs[0] times Coulomb friction."""
        speed = self.top_speed_rad_s * self.rng.uniform(*speeds)
        width = self.top_speed_rad_s * self.rng.uniform(*widths)
        shape = {"speed_rad_s": speed, "width_rad_s": width}
        high = highs[0] if self.direction < 0 else highs[1]
        return self.grows(low, high, lambda size: {"torque_N_m": self.direction * size * self.tc_N_m, **shape})

    def parameter_change(self, high: float, channels: Sequence[str], clock: str, text: str, **more: float) -> Recipe:
        """Return a recipe of one parameter that changes; R shows in channels[0], others in channels[1]."""
        key = pick(self.rng, ["Tc", "R", "K"])
        recipe = self.signed(0.005, high, "change", {"parameter": key}, **more)
        return recipe.seen_in(channels[0 if key == "R" else 1], clock, f"{key} {text}")

    def gain_drift(self, high: float, clock: str, **more: float) -> Recipe:
        """Return a recipe of a gain that drifts."""
        channel = pick(self.rng, CHANNELS)
        recipe = self.signed(0.003, high, "change", {"channel": channel}, **more)
        return recipe.seen_in(channel, clock, "the gain of one sensor drifts linearly over the session")


@dataclass(frozen=True)
class SteadyDraft(BenchDraft):
    """A draft for the bench of steady states."""

    idle_A: float  # no-load current at the highest voltage


def _current_kink(d: SteadyDraft) -> Recipe:
    above = d.idle_A * d.rng.uniform(0.6, 1.0)
    recipe = d.grows(0.03, 1.5, lambda size: {"gain_change": max(d.direction * size, -0.95), "above_A": above})
    return recipe.seen_in("current_A", "current_A", "the current sensor has another gain above one current")


def _periodic_friction(d: SteadyDraft) -> Recipe:
    period, phase = float(d.span_s * d.rng.uniform(0.12, 0.4)), d.rng.uniform(-np.pi, np.pi)
    recipe = d.positive(0.02, 0.7, "change", period_s=period, phase_rad=phase)
    return recipe.seen_in("current_A", "t_s", "Coulomb friction swings periodically in time")


def _winding_memory(d: SteadyDraft) -> Recipe:
    recipe = d.positive(0.01, 1.5, "change", time_constant_s=float(d.span_s * log_uniform(d.rng, 0.04, 0.15)))
    return recipe.seen_in("omega_rad_s", "t_s", "the winding resistance follows the past voltage squared (heating)")


def _speed_counter_limit(d: SteadyDraft) -> Recipe:
    recipe = d.grows(0.01, 0.5, lambda size: {"above_rad_s": d.top_speed_rad_s * (1 - size)})
    return recipe.seen_in("omega_rad_s", "omega_rad_s", "the speed counter stops counting above one speed")


RECIPES: dict[str, Callable[[SteadyDraft], Recipe]] = {
    "friction_bump": lambda d: d.bump(0.03, (0.7, 2.0), (0.25, 0.8), (0.05, 0.12)).seen_in(
        "current_A", "omega_rad_s", BUMP_TEXT
    ),
    "parameter_jump": lambda d: d.parameter_change(0.6, CHANNELS[::-1], "t_s", JUMP_TEXT, time_s=d.when_s),
    "current_kink": _current_kink,
    "sweep_hysteresis": lambda d: d.signed(0.01, 0.6, "change").seen_in(
        "current_A", "sweep", "friction differs between rising and falling voltage"
    ),
    "current_dead_zone": lambda d: d.grows(0.05, 1.5, lambda size: {"below_A": size * d.idle_A}).seen_in(
        "current_A", "current_A", "currents below a threshold read zero"
    ),
    "gain_drift": lambda d: d.gain_drift(0.4, "t_s"),
    "winding_memory": _winding_memory,
    "periodic_friction": _periodic_friction,
    "speed_counter_limit": _speed_counter_limit,
}


def past_load(t_s: Array, load: Array, time_constant_s: float) -> Array:
    """Return the past load after a first-order low-pass filter; every row holds until the next one."""
    heat, level, last = np.empty(len(t_s)), 0.0, 0.0
    for i in range(len(t_s)):
        keep = np.exp(-(t_s[i] - (t_s[i - 1] if i else t_s[0])) / time_constant_s)
        level = keep * level + (1 - keep) * last
        heat[i] = level
        last = load[i]
    return heat


def change_law(law: Law, effect: Effect, t_s: Array, u_V: Array, top_voltage_V: float) -> None:
    """Change the law of the rows at times t_s and voltages u_V in place."""
    name, p = effect
    if name == "friction_bump":
        law.bump, law.bump_speed, law.bump_width = p["torque_N_m"], p["speed_rad_s"], p["width_rad_s"]
    elif name == "parameter_jump":
        law.multiply(p["parameter"], np.where(t_s >= p["time_s"], 1 + p["change"], 1.0))
    elif name == "sweep_hysteresis":
        before = np.concatenate([[0.0], np.abs(u_V)[:-1]])
        law.multiply("Tc", np.where(np.abs(u_V) < before, 1 + p["change"], 1.0))
    elif name == "winding_memory":
        load = np.array([(volts / top_voltage_V) ** 2 for volts in u_V])
        law.multiply("R", 1 + p["change"] * past_load(t_s, load, p["time_constant_s"]))
    elif name == "periodic_friction":
        law.multiply("Tc", 1 + p["change"] * np.sin(2 * np.pi * t_s / p["period_s"] + p["phase_rad"]))


def change_reading(amps: Array, speed: Array, effect: Effect, t_s: Array, span_s: float) -> tuple[Array, Array]:
    """Return the readings of current (A) and speed (rad/s) after an outside effect of a sensor."""
    name, p = effect
    if name == "current_kink":
        over = np.maximum(np.abs(amps) - p["above_A"], 0.0)
        amps = amps + np.sign(amps) * p["gain_change"] * over
    elif name == "current_dead_zone":
        amps = np.where(np.abs(amps) < p["below_A"], 0.0, amps)
    elif name == "gain_drift":
        gain = 1 + p["change"] * t_s / span_s
        amps, speed = (amps * gain, speed) if p["channel"] == "current_A" else (amps, speed * gain)
    elif name == "speed_counter_limit":
        speed = np.clip(speed, -p["above_rad_s"], p["above_rad_s"])
    return amps, speed
