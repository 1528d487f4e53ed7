"""Whether speed and current of a motor can be in their units, by what its nominal parameters make of the voltage."""

import numpy as np

from diagnosis.importers.case import scale_note
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import KnownWheels, Nominal, NominalTof
from symolo.core.arrays import Array

CLEAR_OF_STALL = 3.0
"""Voltage in breakaway voltages, from which on friction takes little off the speed."""


def motor_scale_notes(nominal: Nominal, measurement: Measurement) -> list[str]:
    """A note for each channel whose middle is a unit's factor away from u / K or above u / R."""
    if isinstance(nominal, (NominalTof, KnownWheels)):
        return []
    motor = nominal.motor
    resistance, constant = motor.winding_resistance_ohm.value, motor.torque_constant_N_m_A.value
    u, speed, current = (
        np.abs(np.concatenate([c.values for c in measurement.across(name)]))
        for name in ("u_cmd_V", "omega_rad_s", "current_A")
    )
    driven = u > CLEAR_OF_STALL * resistance * motor.coulomb_friction_N_m.value / constant
    return [
        *scale_note(_middle(speed * constant, u, driven), "omega_rad_s", "rad/s", "the no-load speed at its voltage"),
        *scale_note(_middle(current * resistance, u, driven), "current_A", "A", "the stall current at its voltage"),
    ]


def _middle(values: Array, beside: Array, where: np.ndarray) -> float:
    """Median of the ratio where both are given; NaN where they never are."""
    ratio = values[where] / beside[where]
    given = ratio[np.isfinite(ratio)]
    return float(np.median(given)) if len(given) else float("nan")
