"""The listed effects of a motor: what each changes in its law, and how its size is drawn."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import draw_sign, log_uniform, pick
from benchmarks.diagnosis.independent_cases.motors.motor import Motor
from benchmarks.diagnosis.independent_cases.motors.motor_law import Law
from benchmarks.diagnosis.independent_cases.recipes import Array, Draft, Effect, Recipe

SCALED = {
    "winding_resistance_scale": "R",
    "torque_constant_scale": "K",
    "viscous_friction_scale": "B",
    "coulomb_friction_scale": "Tc",
    "rotor_inertia_scale": "J",
}
ASSIGNED = {
    "stribeck_friction": {"extra": "extra_torque_N_m", "extra_speed": "stribeck_speed_rad_s"},
    "quadratic_drag": {"drag": "coefficient_N_m_s2_rad2"},
    "friction_asymmetry": {"asymmetry": "asymmetry"},
    "bridge_voltage_drop": {"drop": "drop_V"},
    "supply_sag": {"source": "source_resistance_ohm"},
    "bridge_coast": {"L": "inductance_H", "diode": "diode_V", "switching": "switching_Hz"},
    "current_limit": {"limit": "limit_A"},
    "torque_ripple": {"ripple": "amplitude_N_m", "cycles": "cycles_per_turn", "ripple_phase": "phase_rad"},
}


def apply_motor(law: Law, effect: Effect, t_s: Array | float = 0.0) -> None:
    """Change the law in place; t_s is the time since the motor was first switched on.

    Effects of sensors, delays and gear play leave the law as it is.
    """
    name, p = effect
    if name in SCALED:
        law.multiply(SCALED[name], p["scale"])
    for key, parameter in ASSIGNED.get(name, {}).items():
        setattr(law, key, p[parameter])
    if name == "bridge_coast":
        law.coast = 1.0
    elif name == "friction_warmup":
        law.multiply("Tc", 1 + p["amplitude"] * np.exp(-t_s / p["time_constant_s"]))


@dataclass(frozen=True)
class MotorDraft(Draft):
    """A draft with what the plausible sizes depend on."""

    motor: Motor
    top_voltage_V: float
    duration_s: float
    top_speed_rad_s: float
    motors: int  # on the supply

    @property
    def tc(self) -> float:
        """Nominal Coulomb friction [N m]."""
        return self.motor.value("Tc")

    @property
    def stall_A(self) -> float:
        """Stall current [A] at the highest voltage of the data."""
        return self.top_voltage_V / self.motor.value("R")


def _supply_sag(d: MotorDraft) -> Recipe:
    """Draw 0.05 to 2 ohm beside a winding of 3.2 ohm, in proportion beside others.

    3.2 ohm is the middle of the windings that are drawn. Stalled motors lower the supply by 30 % at most.
    """
    resistance = d.motor.value("R")
    scale = resistance / 3.2
    high = min(2 * scale, 0.3 / 0.7 * resistance / d.motors)
    return d.grows(0.05 * scale, high, lambda size: {"source_resistance_ohm": size}, clamped=True)


def _bridge_coast(d: MotorDraft) -> Recipe:
    """Draw an electrical time constant of 0.05 to 2 ms and a switching period of 1 to 20 of them."""
    tau = log_uniform(d.rng, 5e-5, 2e-3)
    return d.fixed(
        inductance_H=d.motor.value("R") * tau,
        diode_V=d.rng.uniform(0.4, 1.6),
        switching_Hz=log_uniform(d.rng, 0.05, 1.0) / tau,
    )


def _stribeck_friction(d: MotorDraft) -> Recipe:
    speed = d.top_speed_rad_s * log_uniform(d.rng, 0.02, 0.15)
    return d.positive(0.03 * d.tc, 2.5 * d.tc, "extra_torque_N_m", stribeck_speed_rad_s=speed)


def _friction_warmup(d: MotorDraft) -> Recipe:
    return d.positive(0.03, 2.0, "amplitude", time_constant_s=d.duration_s * log_uniform(d.rng, 0.08, 0.6))


def _quadratic_drag(d: MotorDraft) -> Recipe:
    square = d.top_speed_rad_s**2
    return d.positive(0.02 * d.tc / square, 5 * d.tc / square, "coefficient_N_m_s2_rad2")


def _battery_decline(d: MotorDraft) -> Recipe:
    return d.positive(0.002 * 60 / d.duration_s, 0.4 * 60 / d.duration_s, "fraction_per_minute")


def _torque_ripple(d: MotorDraft) -> Recipe:
    """Draw a ripple that has at least four samples of 5 ms a cycle at the highest speed."""
    max_cycles = max(1, int(0.25 * 2 * math.pi / (0.005 * d.top_speed_rad_s)))
    cycles = float(pick(d.rng, [c for c in (1, 2, 3, 4, 6, 8, 12, 24) if c <= max_cycles] or [1]))
    phase = d.rng.uniform(-math.pi, math.pi)
    return d.positive(0.02 * d.tc, 0.9 * d.tc, "amplitude_N_m", cycles_per_turn=cycles, phase_rad=phase)


RECIPES: dict[str, tuple[str, str, Callable[[MotorDraft], Recipe]]] = {
    "winding_resistance_scale": ("resistance", "steady step drive", lambda d: d.scaled(0.02, 0.9)),
    "torque_constant_scale": ("constant", "steady step drive", lambda d: d.scaled(0.01, 0.5)),
    "viscous_friction_scale": ("viscous", "steady step drive", lambda d: d.scaled(0.04, 1.4)),
    "coulomb_friction_scale": ("coulomb", "steady step drive", lambda d: d.scaled(0.03, 1.1)),
    "rotor_inertia_scale": ("inertia", "step drive", lambda d: d.scaled(0.02, 1.1)),
    "stribeck_friction": ("low_speed", "steady step", _stribeck_friction),
    "quadratic_drag": ("viscous", "steady", _quadratic_drag),
    "friction_asymmetry": ("coulomb", "steady step", lambda d: d.signed(0.02, 0.6, "asymmetry")),
    "friction_warmup": ("time", "steady", _friction_warmup),
    "bridge_voltage_drop": (
        "bridge",
        "steady step drive",
        lambda d: d.positive(0.003 * d.top_voltage_V, 0.3 * d.top_voltage_V, "drop_V"),
    ),
    "supply_sag": ("bridge", "steady step drive", _supply_sag),
    "bridge_coast": ("bridge", "steady step drive", _bridge_coast),
    "input_delay": ("command", "step drive", lambda d: d.positive(5e-4, 0.03, "delay_s")),
    "actuator_lag": ("command", "step", lambda d: d.positive(5e-4, 0.05, "time_constant_s")),
    "current_limit": (
        "limit",
        "step",
        lambda d: d.grows(0.02, 0.9, lambda size: {"limit_A": 2 * d.stall_A * (1 - size)}),
    ),
    "gear_backlash": ("gear", "step", lambda d: d.positive(1e-3, 0.5, "gap_rad")),
    "torque_ripple": ("gear", "step", _torque_ripple),
    "current_sensor_offset": (
        "current_sensor",
        "steady step",
        lambda d: d.signed(2e-4 * d.stall_A, 0.3 * d.stall_A, "offset_A"),
    ),
    "current_sensor_gain": ("current_sensor", "steady step", lambda d: d.scaled(0.005, 0.5, "gain")),
    "speed_scale": ("speed_sensor", "steady step", lambda d: d.scaled(0.003, 0.4)),
    "speed_filter_lag": ("speed_sensor", "step", lambda d: d.positive(5e-4, 0.08, "time_constant_s")),
    "speed_time_offset": ("speed_sensor", "step", lambda d: d.positive(5e-4, 0.05, "delay_s")),
    "torque_constant_mismatch": ("constant", "drive", lambda d: d.signed(0.004, 0.4, "mismatch")),
    "battery_decline": ("time", "drive", _battery_decline),
}
"""Place, kinds of cases and recipe of every listed effect."""
PLACES = {name: place for name, (place, _, _) in RECIPES.items()}


def places_of(kind: str) -> dict[str, str]:
    """Return the effects that a kind of cases draws (`steady`, `step` or `drive`) with their places."""
    return {name: place for name, (place, kinds, _) in RECIPES.items() if kind in kinds.split()}


def motor_recipe(
    name: str,
    rng: np.random.Generator,
    motor: Motor,
    *,
    top_voltage_V: float,
    duration_s: float,
    top_speed_rad_s: float,
    motors: int = 1,
) -> Recipe:
    """Draw the recipe of a listed effect; voltage, duration and speed are those of the data."""
    place, _, recipe = RECIPES[name]
    direction = draw_sign(rng)
    return recipe(MotorDraft(name, place, rng, direction, motor, top_voltage_V, duration_s, top_speed_rad_s, motors))
