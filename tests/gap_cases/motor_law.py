"""The motor of the format with every effect that bears on it, for many worlds at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .case import Array, World


@dataclass(frozen=True)
class Motors:
    """Each (V, 1): one row per world. Names as in the format; `source_ohm` is the resistance of the supply."""

    resistance: Array
    constant: Array
    viscous: Array
    coulomb: Array
    inertia: Array
    extra: Array
    extra_speed: Array
    drag: Array
    asymmetry: Array
    warm: Array
    warm_s: Array
    drop: Array
    source_ohm: Array
    inductance: Array
    diode: Array
    switching: Array
    limit: Array
    ripple: Array
    ripple_cycles: Array
    ripple_phase: Array
    bump: Array
    bump_speed: Array
    bump_width: Array
    change: Array
    change_s: Array
    supply_V: float

    @classmethod
    def from_worlds(cls, worlds: Sequence[World], supply_V: float) -> "Motors":
        def own(name: str, effect: str) -> Array:
            return column([w.own.get(name, np.nan) * w.value(effect, "scale", 1.0) for w in worlds])

        def effect(name: str, parameter: str, absent: float = 0.0) -> Array:
            return column([w.value(name, parameter, absent) for w in worlds])

        def beyond(name: str, parameter: str, absent: float = 0.0) -> Array:
            return column([w.beyond(name, parameter, absent) for w in worlds])

        return cls(
            resistance=own("winding_resistance_ohm", "winding_resistance_scale"),
            constant=own("torque_constant_N_m_A", "torque_constant_scale"),
            viscous=own("viscous_friction_N_m_s_rad", "viscous_friction_scale"),
            coulomb=own("coulomb_friction_N_m", "coulomb_friction_scale"),
            inertia=own("rotor_inertia_kg_m2", "rotor_inertia_scale"),
            extra=effect("stribeck_friction", "extra_torque_N_m"),
            extra_speed=effect("stribeck_friction", "stribeck_speed_rad_s", 1.0),
            drag=effect("quadratic_drag", "coefficient_N_m_s2_rad2"),
            asymmetry=effect("friction_asymmetry", "asymmetry"),
            warm=effect("friction_warmup", "amplitude"),
            warm_s=effect("friction_warmup", "time_constant_s", 1.0),
            drop=effect("bridge_voltage_drop", "drop_V"),
            source_ohm=effect("supply_sag", "source_resistance_ohm"),
            inductance=effect("bridge_coast", "inductance_H"),
            diode=effect("bridge_coast", "diode_V"),
            switching=effect("bridge_coast", "switching_Hz", 1.0),
            limit=effect("current_limit", "limit_A", np.inf),
            ripple=effect("torque_ripple", "amplitude_N_m"),
            ripple_cycles=effect("torque_ripple", "cycles_per_turn", 1.0),
            ripple_phase=effect("torque_ripple", "phase_rad"),
            bump=beyond("brush_film_bump", "torque_N_m"),
            bump_speed=beyond("brush_film_bump", "speed_rad_s"),
            bump_width=beyond("brush_film_bump", "width_rad_s", 1.0),
            change=beyond("session_change", "fraction"),
            change_s=beyond("session_change", "begins_s", np.inf),
            supply_V=supply_V,
        )

    def pick(self, chosen: Sequence[int]) -> "Motors":
        """Those worlds only."""
        arrays = {name: each[list(chosen)] for name, each in vars(self).items() if isinstance(each, np.ndarray)}
        return Motors(**arrays, supply_V=self.supply_V)

    # Steps are many and arrays small: what no world has costs nothing.

    @cached_property
    def _has_drop(self) -> bool:
        return bool(self.drop.any())

    @cached_property
    def _has_source(self) -> bool:
        return bool(self.source_ohm.any())

    @cached_property
    def coasts(self) -> bool:
        return bool(self.inductance.any())

    @cached_property
    def _has_limit(self) -> bool:
        return bool(np.isfinite(self.limit).any())

    @cached_property
    def _has_drag(self) -> bool:
        return bool(self.drag.any())

    @cached_property
    def ripples(self) -> bool:
        return bool(self.ripple.any())

    @cached_property
    def _is_unusual(self) -> bool:
        return any(bool(each.any()) for each in (self.warm, self.change, self.extra, self.bump))

    def current_A(self, voltage_V: Array, speed_rad_s: Array) -> Array:
        """I = sgn(e) max(|e| - drop, 0) / (R + r duty^2) with e = u - K w, and no more than the limit."""
        driving = voltage_V - self.constant * speed_rad_s
        if self.coasts:
            chopped = self.resistance * self._chopped_A(voltage_V, speed_rad_s)
            driving = np.where(self.inductance > 0.0, chopped, driving)
        if self._has_drop:
            driving = np.sign(driving) * np.maximum(np.abs(driving) - self.drop, 0.0)
        resistance = self.resistance
        if self._has_source:
            resistance = resistance + self.source_ohm * (voltage_V / self.supply_V) ** 2
        current = driving / resistance
        return np.clip(current, -self.limit, self.limit) if self._has_limit else current

    def _chopped_A(self, voltage_V: Array, speed_rad_s: Array) -> Array:
        """Mean over a switching period: a rise with the supply on, then a fall through the diodes, to zero or not.

        Both are exponentials, integrated as they stand; times in periods.
        """
        duty, emf = np.abs(voltage_V) / self.supply_V, self.constant * speed_rad_s
        tau = np.maximum(self.inductance * self.switching / self.resistance, 1e-6)
        rises_to = (np.sign(voltage_V) * self.supply_V - emf) / self.resistance
        falls_to = (-np.sign(rises_to) * (self.supply_V + self.diode) - emf) / self.resistance
        left = np.exp(-duty / tau)
        peak = rises_to * (1.0 - left)
        opposed = np.sign(rises_to) * falls_to < 0.0
        until = tau * np.log(np.where(opposed, (peak - falls_to) / np.where(opposed, -falls_to, 1.0), 1.0))
        until = np.where(opposed, until, np.inf)
        within = np.minimum(until, 1.0 - duty)
        rise = rises_to * duty - rises_to * tau * (1.0 - left)
        fall = falls_to * within + (peak - falls_to) * tau * (1.0 - np.exp(-within / tau))
        return np.where(until < 1.0 - duty, rise + fall, rises_to * duty + falls_to * (1.0 - duty))

    def friction_N_m(self, direction: Array, speed_rad_s: Array, session_s: Array) -> Array:
        """Dry friction against a motion in that direction (+1 or -1) at that speed; at speed 0, breakaway torque."""
        friction = self.coulomb * (1.0 - self.asymmetry * direction)
        if not self._is_unusual:
            return friction
        if self.warm.any():
            friction = friction * (1.0 + self.warm * np.exp(-session_s / self.warm_s))
        if self.change.any():
            friction = friction * (1.0 + self.change * (session_s >= self.change_s))
        if self.extra.any():
            friction = friction + self.extra * np.exp(-((speed_rad_s / self.extra_speed) ** 2))
        if self.bump.any():
            beside = (np.abs(speed_rad_s) - self.bump_speed) / self.bump_width
            friction = friction + self.bump * np.exp(-(beside**2))
        return friction

    def ripple_N_m(self, angle_rad: Array) -> Array | float:
        """Torque against forward motion at an angle of the wheel."""
        return self.ripple * np.cos(self.ripple_cycles * angle_rad + self.ripple_phase) if self.ripples else 0.0

    def surplus_N_m(
        self,
        voltage_V: Array,
        direction: Array,
        speed_rad_s: Array,
        session_s: Array,
        ripple_N_m: Array | float = 0.0,
    ) -> Array:
        """Accelerating torque in the direction of motion; `speed_rad_s` is signed."""
        drive = self.constant * self.current_A(voltage_V, speed_rad_s) - ripple_N_m
        resisting = self.viscous * speed_rad_s
        if self._has_drag:
            resisting = resisting + self.drag * speed_rad_s * np.abs(speed_rad_s)
        return direction * (drive - resisting) - self.friction_N_m(direction, speed_rad_s, session_s)


def column(values: Sequence[float]) -> Array:
    return np.array(values, dtype=np.float64)[:, None]


def steady_states(motors: Motors, voltage_V: Array, session_s: Array) -> tuple[Array, Array]:
    """Current [A] and speed [rad/s], (V, N) each: the first speed from rest upwards at which nothing accelerates."""
    direction = np.where(voltage_V < 0.0, -1.0, 1.0)
    # A bridge that coasts gives the full supply for part of the time.
    top = np.where((motors.inductance > 0.0) & (voltage_V != 0.0), motors.supply_V, np.abs(voltage_V)) / motors.constant
    low = np.zeros_like(top)
    running = motors.surplus_N_m(voltage_V, direction, low, session_s) > 0.0
    high, is_found = top.copy(), ~running
    grid = np.linspace(0.0, 1.0, 401) ** 2
    for fraction in grid[1:]:
        speed = fraction * top
        slows = motors.surplus_N_m(voltage_V, direction, direction * speed, session_s) <= 0.0
        new = slows & ~is_found
        high = np.where(new, speed, high)
        is_found |= slows
        low = np.where(is_found, low, speed)
    for _ in range(50):
        middle = 0.5 * (low + high)
        faster = motors.surplus_N_m(voltage_V, direction, direction * middle, session_s) > 0.0
        low, high = np.where(faster, middle, low), np.where(faster, high, middle)
    speed = np.where(running, direction * 0.5 * (low + high), 0.0)
    return motors.current_A(voltage_V, speed), speed
