"""Wheels of a drive with known motors, as a stage of the diagnosis, from voltages and angles."""

import math

import numpy as np

from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors.wheels.speeds import Wheels
from symolo.core.tables.time_series import TimeSeries

R, K, B, TC, J, SUPPLY_V = 3.0, 0.3, 0.002, 0.02, 0.003, 7.4
DAMPING = K * K / R + B
RADIUS, BASE, TICKS, ROW_S = 0.03, 0.16, 2000, 0.05


def spread(value):
    return {"value": value, "tolerance": 0.01 * value}


NOMINAL = NominalDrive.model_validate(
    {
        "kind": "drive_log",
        "motor": {
            "winding_resistance_ohm": spread(R),
            "torque_constant_N_m_A": spread(K),
            "viscous_friction_N_m_s_rad": spread(B),
            "coulomb_friction_N_m": spread(TC),
            "rotor_inertia_kg_m2": spread(J),
            "supply_voltage_V": SUPPLY_V,
        },
        "robot": {
            "wheel_radius_m": spread(RADIUS),
            "wheel_separation_m": spread(BASE),
            "encoder_ticks_per_revolution": TICKS,
        },
        "noise": {
            "wheel_speed_rad_s": 0.045,
            "pose_xy_m": 0.001,
            "pose_theta_rad": 0.003,
            "travel_m_per_sqrt_m": 0.0006,
            "tof_polynomial_mm": [1.4, 4.88, 2.51, 1.15],
            "tof_polynomial_origin_m": 0.18,
        },
    }
)


def wheels(robot, voltage_V, angle_rad, t_s=None, **commands):
    """Stage of a log with the voltages and the angles (n, 2) of the left and the right wheel.

    Rows are even by default.
    """
    t_s = ROW_S * np.arange(len(voltage_V)) if t_s is None else t_s
    columns = {
        "u_left_V": voltage_V[:, 0],
        "u_right_V": voltage_V[:, 1],
        "enc_left_ticks": np.floor(TICKS / math.tau * angle_rad[:, 0]),
        "enc_right_ticks": np.floor(TICKS / math.tau * angle_rad[:, 1]),
    } | commands
    return Wheels(measured(t_s, columns), robot)


def measured(t_s, columns):
    """A log of one trial with these columns (n,)."""
    channels = tuple(Channel.logged(TimeSeries(k, "", t_s, v), Role.READING) for k, v in columns.items())
    log = Trial("1", t_s, np.zeros(len(t_s), dtype=bool), channels, begins_s=0.0)
    return Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), (log,), NOMINAL)
