"""Effects of a motor bench with steps: those of the format, and causes that no table of the format has."""

import numpy as np

from benchmarks.diagnosis.other_robots.effects import Parameter, Table, factor, level, sized
from benchmarks.diagnosis.other_robots.motor import Motor


def named_table(m: Motor, top: float) -> Table:
    """Return the effects of the format with plausible ranges for this motor and its top voltage."""
    w = top / m.K
    stall = top / m.R
    idle = m.no_load_current()
    stribeck_speed = Parameter("stribeck_speed_rad_s", 0.04 * w, 0.3 * w, log=True)
    cycles = Parameter("cycles_per_turn", 1, max(1.5, min(24.0, 2 * np.pi * 30 / w)), log=True)
    return {
        "winding_resistance_scale": factor(0.5, 2.5),
        "torque_constant_scale": factor(0.6, 1.5),
        "viscous_friction_scale": factor(0.2, 6),
        "coulomb_friction_scale": factor(0.3, 4),
        "rotor_inertia_scale": factor(0.4, 3),
        "stribeck_friction": sized("extra_torque_N_m", 0.02 * m.Tc, 2 * m.Tc, stribeck_speed),
        "friction_asymmetry": sized("asymmetry", -0.7, 0.7),
        "bridge_voltage_drop": sized("drop_V", 0.001 * top, 0.25 * top),
        "supply_sag": sized("source_resistance_ohm", 0.005 * m.R, 1.5 * m.R),
        "input_delay": sized("delay_s", 0.0005, 0.06),
        "actuator_lag": sized("time_constant_s", 0.0005, 0.1),
        "current_limit": level("limit_A", max(0.2 * stall, 1.3 * idle), max(0.75 * stall, 1.6 * idle)),
        "gear_backlash": sized("gap_rad", 0.002, 0.5),
        "current_sensor_offset": sized("offset_A", -0.15 * stall, 0.15 * stall),
        "current_sensor_gain": factor(0.6, 1.6, "gain"),
        "speed_scale": factor(0.5, 2),
        "speed_filter_lag": sized("time_constant_s", 0.0005, 0.1),
        "speed_time_offset": sized("delay_s", 0.0005, 0.06),
        "torque_ripple": sized("amplitude_N_m", 0.02 * m.Tc, 0.95 * m.Tc, cycles, Parameter("phase_rad", 0, 6.28)),
    }


def outside_table(m: Motor, top: float) -> Table:
    """Return causes that no table of the format has."""
    w = top / m.K
    stall = top / m.R
    idle = m.no_load_current()
    tau = m.J * m.R / m.K**2
    reduced = m.J * 0.25
    slow, fast = 2 * np.pi * np.array([6.0, 20.0])
    damping = Parameter("damping", 0.02 * reduced * slow, 0.3 * reduced * slow)
    return {
        "inductance": sized("inductance", 0.02 * m.R * tau, 0.6 * m.R * tau),
        "cable_winds_up": sized("torque_per_rad", 0.003 * m.Tc, 0.3 * m.Tc),
        "slew_rate": level("volts_per_s", 2 * top, 25 * top),
        "bridge_trips": level(
            "current", max(0.5 * stall, 1.3 * idle), max(0.85 * stall, 1.6 * idle), Parameter("off_s", 0.01, 0.08)
        ),
        "encoder_disc_off_centre": sized("amplitude", 0.004, 0.25, Parameter("phase", 0, 6.28)),
        "minimum_pulse": level("voltage", 0.1 * top, 0.4 * top),
        "winding_heating": sized("rise", 0.02, 0.8),
        "magnet_heating": sized("loss", 0.005, 0.25),
        "flexible_shaft": level("stiffness", reduced * slow**2, reduced * fast**2, damping),
        "speed_clock_drifts": sized("rate", 0.0005, 0.05),
        "current_filtered": sized("time_constant", 0.001, 0.1),
        "friction_grows": sized("growth", 0.05, 3),
        "speed_clamped": level("level", 0.4 * w, 0.75 * w),
        "current_clamped": level("level", 0.25 * stall, 0.6 * stall),
        "speed_coarse": level("step", 0.06 * w, 0.2 * w),
        "current_picks_up_speed": sized("share", 0.005, 0.3),
    }
