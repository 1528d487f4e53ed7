"""Estimates of unknown numbers from the log itself, which a diagnosis of the same log cannot doubt."""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.measured.pose_by_ticks import MIN_ROWS, PoseByTicks
from diagnosis.motor_identification import least_squares
from diagnosis.predictors.rows import good_values
from symolo.core.arrays import Array

SMALLEST, LARGEST = 1e-4, 1e6
"""Bounds of an estimate; anything else comes from values that no robot has."""
MOVING_RAD_S = 0.3
"""Speed above which friction is that of a moving motor."""


@dataclass(frozen=True)
class _Motion:
    """Rows of moving motors, (N,) each; the current is None if it was not logged."""

    voltage_V: Array
    speed_rad_s: Array
    acceleration_rad_s2: Array
    current_A: Array | None


def wheels_of(moved: PoseByTicks | None, known: dict[str, float]) -> dict[str, float]:
    """Return diameter, track or ticks, as far as they follow from counts, poses and the known ones of them."""
    if moved is None or not moved.is_explained:
        return {}
    result = {"track_m": moved.m_per_tick / moved.rad_per_tick}
    if "ticks_per_turn" in known:
        result["wheel_diameter_m"] = moved.m_per_tick * known["ticks_per_turn"] / np.pi
    elif "wheel_diameter_m" in known:
        result["ticks_per_turn"] = float(np.rint(np.pi * known["wheel_diameter_m"] / moved.m_per_tick))
    return {key: value for key, value in result.items() if key not in known and SMALLEST < value < LARGEST}


def motor_of(measurement: Measurement, known: dict[str, float], usual: dict[str, float]) -> dict[str, float]:
    """Return parameters of the motor by least squares, u = R i + K w and K i = B w + Tc sgn(w) + J w'.

    Args:
        measurement: A log of a motor, or of a drive with voltages and counts.
        known: Parameters that are known; `ticks_per_turn` for a drive.
        usual: Parameters of a usual motor, for those that the log does not show.
    """
    rows = _moving(measurement, known)
    result = {**usual, **known}
    if rows is not None:
        with suppress(np.linalg.LinAlgError):  # of voltages that never change
            result |= _fitted(rows, result, known, has_inertia=measurement.kind is not CaseKind.MOTOR_STEADY)
    return {
        key: value if SMALLEST < value / usual[key] < 1.0 / SMALLEST else usual[key]
        for key, value in result.items()
        if key not in known and key in usual
    }


def _fitted(rows: _Motion, result: dict[str, float], known: dict[str, float], *, has_inertia: bool) -> dict[str, float]:
    """Return the fitted parameters, and the known ones in their place; `result` has all of them before the fit."""
    w, sign, a = rows.speed_rad_s, np.sign(rows.speed_rad_s), rows.acceleration_rad_s2
    columns = [w, sign, a] if has_inertia else [w, sign]
    if rows.current_A is not None:
        ohm, constant = least_squares([rows.current_A, w], rows.voltage_V)
        fitted = {"winding_resistance_ohm": ohm, "torque_constant_N_m_A": constant} | known
        friction = least_squares(columns, fitted["torque_constant_N_m_A"] * rows.current_A)
    else:
        slope, *others = least_squares(columns, rows.voltage_V)
        ohm, viscous = result["winding_resistance_ohm"], result["viscous_friction_N_m_s_rad"]
        # u = (K + R B / K) w + (R / K) (Tc sgn(w) + J w'), with R and B of a usual motor
        constant = 0.5 * (slope + np.sqrt(max(slope**2 - 4.0 * ohm * viscous, 0.0)))
        fitted = {"torque_constant_N_m_A": float(constant)} | known
        friction = (viscous, *(other * fitted["torque_constant_N_m_A"] / ohm for other in others))
    names = ("viscous_friction_N_m_s_rad", "coulomb_friction_N_m", "rotor_inertia_kg_m2")
    return fitted | dict(zip(names, friction, strict=False)) | known


def _moving(measurement: Measurement, known: dict[str, float]) -> _Motion | None:
    if measurement.kind is CaseKind.DRIVE_LOG:
        per_tick = 2.0 * np.pi / known["ticks_per_turn"]
        parts = [_wheel_rows(measurement, side, per_tick) for side in ("left", "right")]
        u, w, a = (np.concatenate(columns) for columns in zip(*parts, strict=True))
        current = None
    else:
        u, w = good_values(measurement, "u_cmd_V"), good_values(measurement, "omega_rad_s")
        a = np.concatenate([_slope(trial["omega_rad_s"].values, trial.t_s) for trial in measurement.trials])
        current = good_values(measurement, "current_A") if measurement.has("current_A") else None
    usable = np.isfinite(u + w) & (np.abs(w) > MOVING_RAD_S)
    if measurement.kind is not CaseKind.MOTOR_STEADY:
        usable &= np.isfinite(a)
    if current is not None:
        usable &= np.isfinite(current)
    if np.count_nonzero(usable) < (MIN_ROWS if measurement.kind is not CaseKind.MOTOR_STEADY else 4):
        return None
    return _Motion(u[usable], w[usable], a[usable], None if current is None else current[usable])


def _wheel_rows(measurement: Measurement, side: str, per_tick: float) -> tuple[Array, Array, Array]:
    """Return voltage, speed and acceleration from each row to the next."""
    parts = []
    for trial in measurement.trials:
        ticks, voltage = trial[f"enc_{side}_ticks"].values, trial[f"u_{side}_V"].values
        speed = per_tick * np.diff(ticks) / np.diff(trial.t_s)
        parts.append((voltage[:-1], speed, _slope(speed, trial.t_s[:-1])))
    u, w, a = zip(*parts, strict=True)
    return np.concatenate(u), np.concatenate(w), np.concatenate(a)


def _slope(values: Array, t_s: Array) -> Array:
    return np.gradient(values, t_s) if len(values) > 1 else np.full(len(values), np.nan)


def speed_noise(ticks_per_turn: float, row_s: float) -> float:
    """Return the standard deviation of a wheel speed over one row: two counts are rounded, and torque is not steady."""
    rounding_rad_s = 2.0 * np.pi / ticks_per_turn / row_s / np.sqrt(6.0)
    return float(np.hypot(rounding_rad_s, 0.03))
