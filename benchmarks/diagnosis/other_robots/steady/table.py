"""Effects of a steady motor bench: those of the format, and causes that no table of the format has."""

from benchmarks.diagnosis.other_robots.effects import Parameter, Table, factor, level, sized
from benchmarks.diagnosis.other_robots.motor import Motor


def named_table(m: Motor, top: float, last: float) -> Table:
    """Return the effects of the format with plausible ranges for this motor, its top voltage and the last time."""
    w = top / m.K
    idle = m.no_load_current()
    stribeck_speed = Parameter("stribeck_speed_rad_s", 0.06 * w, 0.4 * w, log=True)
    time_constant = Parameter("time_constant_s", 0.08 * last, 0.5 * last, log=True)
    return {
        "winding_resistance_scale": factor(0.5, 2.5),
        "torque_constant_scale": factor(0.6, 1.5),
        "viscous_friction_scale": factor(0.2, 6),
        "coulomb_friction_scale": factor(0.3, 4),
        "stribeck_friction": sized("extra_torque_N_m", 0.05 * m.Tc, 1.5 * m.Tc, stribeck_speed),
        "quadratic_drag": sized("coefficient_N_m_s2_rad2", 0.002 * m.Tc / w**2, 4 * m.Tc / w**2),
        "friction_asymmetry": sized("asymmetry", -0.6, 0.6),
        "friction_warmup": sized("amplitude", 0.05, 2.0, time_constant),
        "bridge_voltage_drop": sized("drop_V", 0.002 * top, 0.3 * top),
        "supply_sag": sized("source_resistance_ohm", 0.01 * m.R, 1.5 * m.R),
        "current_sensor_offset": sized("offset_A", -0.8 * idle, 0.8 * idle),
        "current_sensor_gain": factor(0.6, 1.6, "gain"),
        "speed_scale": factor(0.5, 2.0),
    }


def outside_table(m: Motor, top: float, last: float, sweeps: int) -> Table:
    """Return causes that no table of the format has."""
    w = top / m.K
    idle = m.no_load_current()
    time_constant = Parameter("time_constant", 0.2 * last, last)
    table = {
        # the contact resistance of the brushes falls with the current: R + r / (1 + |I| / I0)
        "brush_contact": sized(
            "resistance", 0.05 * m.R, 4 * m.R, Parameter("current", 0.1 * idle, 1.0 * idle, log=True)
        ),
        # the magnets heat up: K falls over the session
        "magnet_heating": sized("loss", 0.005, 0.15, time_constant),
        # the winding heats up: R rises over the session
        "winding_heating": sized("rise", 0.02, 0.6, time_constant),
        # the mounting resonates at one speed and takes power there
        "resonance": sized(
            "torque",
            0.05 * m.Tc,
            2 * m.Tc,
            Parameter("speed", 0.25 * w, 0.7 * w),
            Parameter("width", 0.03 * w, 0.12 * w),
        ),
        # the counter of edges per window overflows above a speed and starts again at zero
        "counter_overflow": level("modulus", 0.45 * w, 0.85 * w),
        # the current amplifier saturates (before the noise is added)
        "current_reading_clamped": level("level", 0.5 * idle, 0.85 * idle),
        # the converter of the current has coarse steps
        "current_quantised": level("step", 0.1 * idle, 0.5 * idle),
        # pulses shorter than a minimum are lost
        "minimum_pulse": level("voltage", 0.15 * top, 0.4 * top),
        # from one moment on something rubs
        "rubs_from_a_moment": sized("torque", 0.05 * m.Tc, 2 * m.Tc, Parameter("moment", 0.3 * last, 0.65 * last)),
        # the bridge is not linear in the duty: u (1 + c (1 - |u| / top))
        "duty_curved": sized("curvature", -0.4, 0.4),
        # the voltage of the cell falls over the session
        "cell_runs_down": sized("loss", 0.02, 0.35),
        # the current reading has a part that grows with the square of the speed
        "current_picks_up_speed": sized("share", 0.05, 0.8),
    }
    if sweeps >= 2:
        # friction is higher while the voltage goes up than while it goes down
        table["friction_memory"] = sized("torque", 0.05 * m.Tc, 1.0 * m.Tc)
    return table
