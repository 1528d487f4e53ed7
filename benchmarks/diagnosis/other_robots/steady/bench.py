"""The balance of torques of a steady motor, solved for its speed by bisection."""

import numpy as np

from benchmarks.diagnosis.other_robots.draws import Array
from benchmarks.diagnosis.other_robots.effects import Key, Table, columns
from benchmarks.diagnosis.other_robots.motor import Motor

NOMINAL = 4
"""Parameters with a tolerance: R, K, B, Tc."""
BISECTIONS = 38
SCAN = 40
"""Speeds at which the first balance is looked for, where friction has a maximum."""


class Values:
    """Parameters of the effects of some variants by effect and name, as columns."""

    def __init__(self, table: Table, keys: list[Key], thetas: Array) -> None:
        self.columns: dict[str, Array] = {}
        for (name, _), values in columns(table, keys, thetas, NOMINAL):
            for p, value in zip(table[name].parameters, values, strict=True):
                self.columns[f"{name}.{p.name}"] = value[:, None]

    def __call__(self, label: str, absent: float = 0.0) -> Array | float:
        """Return "effect.parameter", or its value in the absence of the effect."""
        return self.columns.get(label, absent)


class Circuit:
    """Voltage and electrical parameters of some variants in each row."""

    def __init__(self, bench: "SteadyBench", get: Values, individual: dict[str, Array]) -> None:
        size, t = np.abs(bench.u)[None], bench.t[None]
        u = size * (1 + get("duty_curved.curvature") * (1 - size / bench.top))
        u = u * (1 - get("cell_runs_down.loss") * t / (float(bench.t.max()) or 1.0))
        self.u = np.where(u < get("minimum_pulse.voltage"), 0.0, u)
        heat = 1 - np.exp(-t / get("winding_heating.time_constant", 1.0))
        r = individual["R"] * get("winding_resistance_scale.scale", 1.0) * (1 + get("winding_heating.rise") * heat)
        heat = 1 - np.exp(-t / get("magnet_heating.time_constant", 1.0))
        k = individual["K"] * get("torque_constant_scale.scale", 1.0) * (1 - get("magnet_heating.loss") * heat)
        self.k = k + 0 * t
        self.r = r + get("supply_sag.source_resistance_ohm") * (self.u / bench.motor.supply) ** 2 + 0 * t
        self.drop = get("bridge_voltage_drop.drop_V")
        self.brush, self.brush_current = get("brush_contact.resistance"), get("brush_contact.current", 1.0)

    def current(self, w: Array) -> Array:
        """Return the current at a speed."""
        e = np.maximum(self.u - self.k * w - self.drop, 0)
        if np.ndim(self.brush):
            linear = self.r + self.brush - e / self.brush_current
            return (np.sqrt(linear**2 + 4 * self.r / self.brush_current * e) - linear) / (
                2 * self.r / self.brush_current
            )
        return e / self.r


class Friction:
    """Friction torque of some variants in each row."""

    def __init__(self, bench: "SteadyBench", get: Values, individual: dict[str, Array]) -> None:
        t = bench.t[None]
        tc = individual["Tc"] * get("coulomb_friction_scale.scale", 1.0)
        tc = tc * (1 + get("friction_warmup.amplitude") * np.exp(-t / get("friction_warmup.time_constant_s", 1.0)))
        tc = tc * (1 - get("friction_asymmetry.asymmetry") * np.sign(bench.u)[None])
        tc = tc + get("rubs_from_a_moment.torque") * (t > get("rubs_from_a_moment.moment", 1e9))
        self.dry = tc + get("friction_memory.torque") * bench.rising[None]
        self.viscous = individual["B"] * get("viscous_friction_scale.scale", 1.0)
        self.get = get

    def torque(self, w: Array) -> Array:
        """Return the torque at a speed."""
        get = self.get
        stribeck = w / get("stribeck_friction.stribeck_speed_rad_s", 1.0)
        from_resonance = (w - get("resonance.speed")) / get("resonance.width", 1.0)
        f = self.dry + self.viscous * w + get("quadratic_drag.coefficient_N_m_s2_rad2") * w * w
        f = f + get("stribeck_friction.extra_torque_N_m") * np.exp(-(stribeck**2))
        return f + get("resonance.torque") * np.exp(-(from_resonance**2))


def balance(circuit: Circuit, friction: Friction, *, several: bool) -> Array:
    """Return the lowest speed at which the torques balance; `several` means that there may be more than one."""

    def net(w: Array) -> Array:
        return circuit.k * circuit.current(w) - friction.torque(w)

    moves = (net(np.zeros_like(circuit.k)) > 0) & (circuit.u > 0)
    ceiling = circuit.u / circuit.k + 1e-9
    low, high, before = np.zeros_like(circuit.k), ceiling.copy(), np.zeros_like(circuit.k)
    bracketed = np.zeros(low.shape, bool)
    for part in np.linspace(0, 1, SCAN + 1)[1:] if several else []:
        w = part * ceiling
        first = (net(w) <= 0) & ~bracketed
        low, high = np.where(first, before, low), np.where(first, w, high)
        bracketed |= first
        before = w
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        positive = net(middle) > 0
        low, high = np.where(positive, middle, low), np.where(positive, high, middle)
    return np.where(moves, 0.5 * (low + high), 0.0)


class SteadyBench:
    """The voltages of one bench, and the model of its readings."""

    def __init__(self, motor: Motor, u: Array, t: Array) -> None:
        self.motor, self.u, self.t = motor, u, t
        self.top = float(np.abs(u).max())
        self.idle = motor.no_load_current()
        previous = np.concatenate([[0.0], np.abs(u)[:-1]])
        self.rising = (np.abs(u) >= previous).astype(float)

    def readings(self, table: Table, keys: list[Key], thetas: Array) -> tuple[Array, Array]:
        """Return current and speed readings without noise, (variants, rows) each."""
        get = Values(table, keys, thetas)
        individual = self.motor.individual(thetas[:, :NOMINAL])
        circuit, friction = Circuit(self, get, individual), Friction(self, get, individual)
        w = balance(circuit, friction, several=any(name in {"stribeck_friction", "resonance"} for name, _ in keys))
        i = np.where(circuit.u > 0, np.sign(self.u)[None] * circuit.current(w), 0.0)
        return self.current_reading(get, i, w), self.speed_reading(get, np.sign(self.u)[None] * w)

    def current_reading(self, get: Values, i: Array, w: Array) -> Array:
        """Return what the current sensor reads at a current and a speed."""
        i = get("current_sensor_gain.gain", 1.0) * i + get("current_sensor_offset.offset_A")
        i = i + get("current_picks_up_speed.share") * self.idle * np.abs(w * self.motor.K / self.top) ** 2
        limit = get("current_reading_clamped.level", 1e9)
        i = np.clip(i, -limit, limit)
        step = get("current_quantised.step")
        return np.round(i / step) * step if np.ndim(step) else i

    @staticmethod
    def speed_reading(get: Values, w: Array) -> Array:
        """Return what the encoder reads at a speed."""
        w = w * get("speed_scale.scale", 1.0)
        modulus = get("counter_overflow.modulus")
        return np.sign(w) * np.mod(np.abs(w), modulus) if np.ndim(modulus) else w
