"""Steady states of a motor, row by row."""

from collections.abc import Mapping, Sequence

import numpy as np

from .case import Array, Bench, Columns, Frame, World
from .disturbances import AS_STATED, Day
from .motor_law import Motors, column, steady_states
from .noise import share, white, with_dropouts, with_outliers

SUPPLY_V = 7.4
ROW_S = 3.0
BREAKAWAY = 2.2
"""Times the nominal breakaway voltage up to which a row says nothing about how fast the motor is."""


def draw(rng: np.random.Generator, rows: str) -> Bench:
    up = np.linspace(0.0, 5.0, 21)
    sweeps = [up] if rows == "few" else [up, up[::-1], -up, -up[::-1]] * (2 if rows == "usual" else 1)
    voltage = np.concatenate(sweeps)
    n = len(voltage)
    if rows == "few":
        holdout = np.arange(n) % 4 == int(rng.integers(4))
    else:
        holdout = np.isin(np.arange(n) // 21, rng.choice(len(sweeps), len(sweeps) // 4, replace=False))
    inputs = {
        "row": np.arange(1, n + 1),
        "sweep": np.arange(n) // 21 + 1,
        "split": np.where(holdout, "holdout", "fit"),
        "t_s": ROW_S * np.arange(n),
        "u_cmd_V": voltage,
    }
    unseen = np.linspace(0.4, 4.9, 15)
    unseen = rng.permutation(unseen if rows == "few" else np.concatenate([unseen, -unseen]))
    later = {"row": np.arange(1, len(unseen) + 1), "t_s": ROW_S * (n + np.arange(len(unseen))), "u_cmd_V": unseen}
    nominal = {
        "kind": "motor_steady",
        "motor": motor(rng),
        "noise": {"current_A": 0.001, "omega_rad_s": 0.04},
    }
    return Bench(nominal, inputs, {"blind_inputs.csv": later})


def motor(rng: np.random.Generator) -> dict:
    """Nominal values as of small geared motors, with the tolerances of the format's examples."""
    ranges = {
        "winding_resistance_ohm": (2.4, 3.7, 0.01),
        "torque_constant_N_m_A": (0.25, 0.36, 0.007),
        "viscous_friction_N_m_s_rad": (0.0015, 0.0032, 0.05),
        "coulomb_friction_N_m": (0.018, 0.026, 0.04),
    }
    drawn = {}
    for name, (low, high, tolerance) in ranges.items():
        value = float(f"{rng.uniform(low, high):.4g}")
        drawn[name] = {"value": value, "tolerance": float(f"{tolerance * value:.6g}")}
    return {**drawn, "supply_voltage_V": SUPPLY_V}


def mean(bench: Bench, inputs: Columns, worlds: Sequence[World]) -> tuple[Array, Array]:
    """Current and speed as the instruments would say them without noise, (V, rows) each."""
    motors = Motors.from_worlds(worlds, bench.nominal["motor"]["supply_voltage_V"])
    current, speed = steady_states(motors, inputs["u_cmd_V"], inputs["t_s"])
    return instruments(worlds, current, speed, inputs["t_s"])


def instruments(worlds: Sequence[World], current: Array, speed: Array, session_s: Array) -> tuple[Array, Array]:
    """What current sensor and encoder make of (V, ...) true values at (...) times."""

    def effect(name: str, parameter: str, absent: float) -> Array:
        values = column([w.value(name, parameter, absent) for w in worlds])
        return values.reshape(-1, *[1] * (current.ndim - 1))

    beyond = column([w.beyond("current_range_switch", "gain", 1.0) for w in worlds])
    above = column([w.beyond("current_range_switch", "above_A", np.inf) for w in worlds])
    beyond, above = (each.reshape(-1, *[1] * (current.ndim - 1)) for each in (beyond, above))
    current = np.where(np.abs(current) > above, beyond * current, current)
    if any(w.beyond("zero_jump", "offset_A") for w in worlds):
        jump = [w.beyond("zero_jump", "offset_A") * (session_s >= w.beyond("zero_jump", "begins_s")) for w in worlds]
        current = current + np.array(jump)
    if any(w.beyond("speed_cycle", "amplitude_rad_s") for w in worlds):
        cycle = [_cycle(w, each) for w, each in zip(worlds, speed, strict=True)]
        speed = np.where(speed == 0.0, 0.0, speed + np.array(cycle))
    current = effect("current_sensor_gain", "gain", 1.0) * current + effect("current_sensor_offset", "offset_A", 0.0)
    return current, effect("speed_scale", "scale", 1.0) * speed


def _cycle(world: World, speed: Array) -> Array:
    """Error of a speed that is periodic in the speed."""
    turns = speed / world.beyond("speed_cycle", "period_rad_s", 1.0)
    swing = np.sin(2.0 * np.pi * turns + world.beyond("speed_cycle", "phase_rad"))
    return world.beyond("speed_cycle", "amplitude_rad_s") * swing


def observe(
    bench: Bench, world: World, rng: np.random.Generator, day: Day = AS_STATED
) -> tuple[Columns, Mapping[str, Columns]]:
    """Columns of data.csv, and the inputs of unseen runs; the noise of the bench is the true one."""
    noise, struck = bench.nominal["noise"], day.struck(len(bench.inputs["row"]))
    lost, odd = share(rng, 0.03), share(rng, 0.02)
    current, speed = (each[0] for each in mean(bench, bench.inputs, [world]))
    stuck = speed == 0.0
    zero = day.zero("current_A", bench.inputs["sweep"], bench.inputs["t_s"])
    current = current + noise["current_A"] * (white(rng, current.shape, day.degrees) + zero)
    speed = np.where(stuck, 0.0, speed + noise["omega_rad_s"] * white(rng, speed.shape, day.degrees))
    columns = dict(bench.inputs)
    for name, good in (("current_A", current), ("omega_rad_s", speed)):
        columns[name] = with_dropouts(rng, with_outliers(rng, good, noise[name], odd, struck.get(name)), lost)
    return columns, bench.blind


def frame(bench: Bench, columns: Columns) -> Frame:
    n = len(columns["row"])
    values = {name: value for name, (value, _) in bench.spreads().items()}
    breakaway = values["coulomb_friction_N_m"] * values["winding_resistance_ohm"] / values["torque_constant_N_m_A"]
    sure = (np.abs(columns["u_cmd_V"]) > BREAKAWAY * breakaway) | (columns["u_cmd_V"] == 0.0)
    sigma = [np.full(n, bench.nominal["noise"][name]) for name in ("current_A", "omega_rad_s")]
    return Frame(
        measured=np.concatenate([columns["current_A"], columns["omega_rad_s"]]),
        sigma=np.concatenate(sigma),
        holdout=np.tile(columns["split"] == "holdout", 2),
        stage=np.zeros(2 * n, dtype=np.int64),
        run=np.repeat([0, 1], n),
        correlation=np.zeros(2 * n),
        usable=np.tile(sure, 2),
    )


def predict(bench: Bench, columns: Columns, worlds: Sequence[World]) -> Array:
    return np.concatenate(mean(bench, columns, worlds), axis=1)
