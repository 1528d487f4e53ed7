"""Noise and unit checks that both kinds of motor case share."""

import numpy as np
from numpy.typing import NDArray

from diagnosis.importers.cases.case import scale_note
from diagnosis.importers.cases.motor_checks import goes_against, number_checks, sign_check, speed_checks
from diagnosis.importers.cases.trials import KnownNoise
from diagnosis.importers.cases.voltage_rows import voltage_row_checks
from diagnosis.measured.case_files.nominal import NominalSteady, NominalStep, StepNoise
from diagnosis.measured.measurement import CHECK, CHECK_UNIT, Measurement
from symolo.core.arrays import Array
from symolo.core.tables.table import CsvTable

CLEAR_OF_STALL = 3.0
"""Voltage in breakaway voltages from which friction reduces the speed only a little."""


def motor_noise(nominal: NominalSteady | NominalStep, table: CsvTable, name: str) -> KnownNoise | None:
    """Return the noise that nominal.yaml states for current or speed; None for the voltage."""
    if name == "u_cmd_V":
        return None
    noise = nominal.noise
    correlation = noise.lag1_correlation if isinstance(noise, StepNoise) else 0.0
    return KnownNoise.constant(noise.current_A if name == "current_A" else noise.omega_rad_s, table, correlation)


def motor_notes(nominal: NominalSteady | NominalStep, measurement: Measurement) -> list[str]:
    """Return a note for each number, sign and unit that is probably wrong."""
    u, speed, current = (
        np.concatenate([c.values for c in measurement.across(name)]) for name in ("u_cmd_V", "omega_rad_s", "current_A")
    )
    notes: list[str] = []
    for name, values, does in (("omega_rad_s", speed, "turns"), ("current_A", current, "takes current")):
        unsigned = list(sign_check(u, values, name))
        notes += unsigned
        if not unsigned and goes_against(u, values):
            notes.append(f"{CHECK} {name}: the motor {does} against its voltage; give {name} or u_cmd_V factor: -1")
    units = _scale_notes(nominal, np.abs(u), np.abs(speed), np.abs(current))
    notes += units or speed_checks(nominal.motor, np.abs(u), np.abs(speed), "u_cmd_V")
    if isinstance(nominal, NominalStep) and not notes:
        notes += voltage_row_checks(measurement)
    has_wrong_unit = any(note.startswith(CHECK_UNIT) for note in notes)
    return [*notes, *(() if has_wrong_unit else number_checks(nominal.motor, notes))]


def _scale_notes(nominal: NominalSteady | NominalStep, u: Array, speed: Array, current: Array) -> list[str]:
    """Return a note for each channel that looks as if it were in another unit, from the sizes of its values.

    The speed is compared with the no-load speed u / K, by a ratio that three of four rows do not exceed, since a motor
    that has just been switched on is slower. The typical current is compared with the stall current u / R.
    """
    motor = nominal.motor
    resistance, constant = motor.winding_resistance_ohm.value, motor.torque_constant_N_m_A.value
    driven = u > CLEAR_OF_STALL * resistance * motor.coulomb_friction_N_m.value / constant
    speed_ratio, current_ratio = (
        _ratio(speed * constant, u, driven, 0.75),
        _ratio(current * resistance, u, driven, 0.5),
    )
    gear = f"; or it is the speed of the motor's shaft, before a gear with a ratio of about {speed_ratio:.2g}"
    return [
        *(
            f"{note}{gear if speed_ratio > 1.0 else ''}"
            for note in scale_note(speed_ratio, "omega_rad_s", "rad/s", "the no-load speed at its voltage")
        ),
        *scale_note(current_ratio, "current_A", "A", "the stall current at its voltage"),
    ]


def _ratio(values: Array, reference: Array, rows: NDArray[np.bool_], quantile: float) -> float:
    """Return a quantile of the ratios in the chosen rows that have both values; NaN if there are none."""
    ratios = values[rows] / reference[rows]
    known = ratios[np.isfinite(ratios)]
    return float(np.quantile(known, quantile)) if len(known) else float("nan")
