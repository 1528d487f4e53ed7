"""The two driven wheels of a drive log: laws per wheel, common supply, and the run at logged voltages."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.diagnosis.independent_cases.motors.motor_effects import apply_motor
from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes, Law, plain_law
from benchmarks.diagnosis.independent_cases.motors.step_integrator import mean_command
from benchmarks.diagnosis.independent_cases.motors.wheel_step import advance, moved
from benchmarks.diagnosis.independent_cases.recipes import Array, Effect, Variant

if TYPE_CHECKING:
    from benchmarks.diagnosis.independent_cases.drives.drive_log import DriveSetting

ROW_S, SUB = 0.05, 5
FINE_S = ROW_S / SUB
SIDES = ("left", "right")


def in_disc(x: Array, y: Array, disc: dict[str, float]) -> Array:
    """Return where a point (m) is in a disc of the floor."""
    return np.hypot(x - disc["x_m"], y - disc["y_m"]) < disc["radius_m"]


def _apply_outside(law: Law, effect: Effect, side: str, session_s: Array, path: Array | None) -> None:
    """Change the law of one wheel in place."""
    name, p = effect
    if name == "friction_patch" and path is not None:
        law.Tc = law.Tc * np.where(in_disc(path[:, 0], path[:, 1], p), 1 + p["change"], 1.0)
    elif name == "friction_jump":
        law.Tc = law.Tc * np.where(session_s >= p["time_s"], 1 + p["change"], 1.0)
    elif name == "wheel_cogging" and p["side"] == side:
        law.ripple, law.cycles, law.ripple_phase = p["amplitude_N_m"], p["cycles_per_turn"], p["phase_rad"]
    elif name == "command_dead_zone":
        law.dead = p["below_V"]


def wheel_laws(setting: "DriveSetting", variant: Variant, trial: int, path: Array | None) -> list[Law]:
    """Return the laws of both wheels in one trial; path (rows, 3) is where the robot is, None where unknown."""
    motor = setting.robot.motor
    drawn = {key: setting.individual[key] for key in motor.nominal}
    laws = []
    for sign, side in zip((0.5, -0.5), SIDES, strict=True):
        law = plain_law(variant.individual(drawn, motor.nominal), motor.supply_V)
        for effect in variant.effects:
            if effect.name == "torque_constant_mismatch":
                law.K = law.K * (1 + sign * effect.parameters["mismatch"])
            elif effect.name != "supply_sag":  # both wheels sag together
                apply_motor(law, effect)
        for effect in variant.outside:
            _apply_outside(law, effect, side, setting.session_s[trial], path)
        laws.append(law)
    return laws


def supply_terms(setting: "DriveSetting", variant: Variant, trial: int) -> tuple[float, float, Array]:
    """Return input delay (s), series resistance of the supply (ohm), and the battery's factor of every row."""
    listed = dict(variant.effects)
    delay = listed.get("input_delay", {"delay_s": 0.0})["delay_s"]
    source = listed.get("supply_sag", {"source_resistance_ohm": 0.0})["source_resistance_ohm"]
    battery = np.ones(setting.session_s.shape[1])
    if "battery_decline" in listed:
        battery = 1 - listed["battery_decline"]["fraction_per_minute"] * setting.session_s[trial] / 60
    return delay, source, battery


def _sagged(p: Lanes, source: Array, u: Array, w: Array) -> Array:
    """Return the voltages (V) of both wheels, left and right in turn, after the sag of their common supply.

    The supply gives the sum of abs(duty) * abs(current), and every voltage falls in proportion: u * factor. The
    factor solves a line once the signs of the currents are known; three rounds settle the signs.
    """
    factor = np.ones_like(u)
    duty = np.abs(u) / p.U
    for _ in range(3):
        direction = np.sign(u * factor - p.K * w)
        up = (duty * direction * p.K * w / p.R).reshape(-1, 2).sum(axis=1)
        down = (duty * direction * u / p.R).reshape(-1, 2).sum(axis=1)
        r = source.reshape(-1, 2)[:, 0] / p.U.reshape(-1, 2)[:, 0]
        factor = np.repeat(np.clip((1 + r * up) / np.maximum(1 + r * down, 0.1), 0.0, 1.2), 2)
    return u * factor


def substep(
    p: Lanes,
    volts: Array,
    w: Array,
    angle: Array,
    *,
    sources: Array | None = None,
    torque: Array | float = 0.0,
    h: float = FINE_S,
) -> tuple[Array, Array]:
    """Return speed (rad/s) and turned angle (rad) of all wheels after h seconds; sources are in ohm."""
    u = volts
    if sources is not None:
        first = advance(p, _sagged(p, sources, volts, w), w, angle, h=h, torque=torque)
        u = _sagged(p, sources, volts, 0.5 * (w + first))
    after, mean = moved(p, u, w, angle, h=h, torque=torque)
    return after, h * mean


def run(setting: "DriveSetting", variants: Sequence[Variant], trials: Sequence[int], u: Array, path: Array) -> Array:
    """Return mean wheel speeds (variants, trials, rows - 1, 2) in rad/s at logged voltages.

    u (all trials, rows - 1, 2) is in V, path (all trials, rows, 3) in m and rad.
    """
    rows = u.shape[1]
    pairs = [(variant, trial) for variant in variants for trial in trials]
    terms = [supply_terms(setting, variant, trial) for variant, trial in pairs for _ in SIDES]
    lanes = Lanes.stack([law for variant, trial in pairs for law in wheel_laws(setting, variant, trial, path[trial])])
    volts = np.concatenate([u[trial].T for _, trial in pairs])
    delays, sources = np.array([term[0] for term in terms]), np.array([term[1] for term in terms])
    batteries = np.stack([term[2] for term in terms])
    mean = mean_command(volts, delays / ROW_S, SUB)
    varies, sags = lanes.varies, bool(np.any(sources > 0))
    w, angle = np.zeros(len(terms)), np.zeros(len(terms))
    speeds = np.empty((len(terms), rows))
    p = lanes.column(0)
    for k in range(rows):
        if varies:
            p = lanes.column(k)
        start = angle
        for m in range(SUB):
            command = mean[:, k * SUB + m] * batteries[:, k]
            w, turned = substep(p, command, w, angle, sources=sources if sags else None)
            angle = angle + turned
        speeds[:, k] = (angle - start) / ROW_S
    return speeds.reshape(len(variants), len(trials), 2, rows).transpose(0, 1, 3, 2)
