"""Effects of a drive: those of the format, and causes that no table of the format has."""

from benchmarks.diagnosis.other_robots.drives.robot import SENSORS, Robot
from benchmarks.diagnosis.other_robots.effects import Effect, Parameter, Table, factor, level, sized

SIDES = ("left", "right")
WHEELS, POSES, RANGES = "w", "p", "t"
STAGES = {
    "winding_resistance_scale": "w",
    "torque_constant_scale": "w",
    "viscous_friction_scale": "w",
    "coulomb_friction_scale": "w",
    "rotor_inertia_scale": "w",
    "torque_constant_mismatch": "w",
    "bridge_voltage_drop": "w",
    "supply_sag": "w",
    "battery_decline": "w",
    "input_delay": "w",
    "wheel_radius_scale": "p",
    "wheel_radius_asymmetry": "p",
    "wheelbase_scale": "p",
    "encoder_ticks_scale": "wp",
    "encoder_missed_ticks": "wp",
    "turn_slip": "p",
    "marker_offset": "pt",
    "pose_time_offset": "pt",
    "tof_range_offset": "t",
    "tof_range_scale": "t",
    "tof_mount_yaw": "t",
    "tof_time_offset": "t",
    "marker_yaw": "pt",
    "pose_clock_drift": "pt",
    "wheel_eccentricity": "p",
    "floor_slope": "p",
    "loaded_by_turning": "w",
    "minimum_pulse": "w",
    "winding_heating": "w",
    "carpet_patch": "w",
    "cable_pulls": "w",
    "tyre_warms": "p",
    "camera_distortion": "pt",
    "camera_stretched": "pt",
    "wall_askew": "t",
    "box_in_room": "t",
    "ranges_filtered": "t",
    "slip_when_accelerating": "p",
    "caster_kick": "p",
    "camera_slow": "pt",
    "range_at_grazing": "t",
    "sideways_on_patch": "p",
}
"""Where an effect shows: in wheel speeds (w), pose increments (p) or ranges (t)."""


def named_table(bot: Robot, session: float) -> Table:
    """Return the effects of the format with plausible ranges for this robot and the length of its session."""
    m, w, v = bot.motor, bot.speed / bot.radius, bot.speed
    top = m.K * w
    turn = v * v / bot.track
    sides, sensors = ("side", SIDES), ("sensor", SENSORS)
    missed = (Parameter("fraction", 0.004, 0.4), Parameter("threshold_rad_s", 0.2 * w, 0.75 * w))
    eccentricity = (Parameter("amplitude", 0.003, 0.12), Parameter("phase_rad", 0, 6.28))
    return {
        "winding_resistance_scale": factor(0.5, 2.5),
        "torque_constant_scale": factor(0.6, 1.5),
        "viscous_friction_scale": factor(0.2, 6),
        "coulomb_friction_scale": factor(0.3, 3.5),
        "rotor_inertia_scale": factor(0.4, 3),
        "torque_constant_mismatch": sized("mismatch", -0.4, 0.4),
        "bridge_voltage_drop": sized("drop_V", 0.003 * top, 0.3 * top),
        "supply_sag": sized("source_resistance_ohm", 0.01 * m.R, 2 * m.R),
        "battery_decline": sized("fraction_per_minute", 0.002, min(0.15, 18 / session)),
        "input_delay": sized("delay_s", 0.002, 0.2),
        "wheel_radius_scale": factor(0.8, 1.25),
        "wheelbase_scale": factor(0.8, 1.3),
        "encoder_ticks_scale": factor(0.6, 1.6),
        "wheel_radius_asymmetry": sized("asymmetry", -0.15, 0.15),
        "encoder_missed_ticks": Effect(missed, discrete=sides),
        "turn_slip": sized("coefficient_s2_m", 0.01 / turn, 1.5 / turn),
        "marker_offset": sized("offset_m", -0.4 * bot.track, 0.4 * bot.track),
        "pose_time_offset": sized("delay_s", 0.004, 0.3),
        "tof_range_offset": Effect((Parameter("offset_m", -0.1, 0.1),), discrete=sensors),
        "tof_range_scale": factor(0.8, 1.25),
        "tof_mount_yaw": Effect((Parameter("angle_rad", -0.3, 0.3),), discrete=sensors),
        "tof_time_offset": sized("delay_s", 0.004, 0.3),
        "marker_yaw": sized("angle_rad", -0.4, 0.4),
        "pose_clock_drift": sized("rate", 0.0002, 0.012),
        "wheel_eccentricity": Effect(eccentricity, discrete=sides),
        "floor_slope": sized("gradient", 0.002, 0.15, Parameter("direction_rad", 0, 6.28)),
    }


def outside_table(bot: Robot, session: float) -> Table:
    """Return causes that no table of the format has."""
    m, w = bot.motor, bot.speed / bot.radius
    top = m.K * w
    big, small = max(bot.room), min(bot.room)
    spot = (Parameter("x", 0.3, 0.7), Parameter("y", 0.3, 0.7))
    anywhere = (Parameter("x", 0, 1), Parameter("y", 0, 1))
    radius = Parameter("radius", 0.15 * small, 0.3 * small)
    acceleration = w / 0.1
    return {
        "carpet_patch": sized("torque", 0.05 * m.Tc, 2 * m.Tc, *spot, radius),
        "cable_pulls": sized("torque", 0.05 * m.Tc, 1.0 * m.Tc, *anywhere),
        "loaded_by_turning": sized("per_rad_s", 0.02 / w, 4 / w),
        "minimum_pulse": sized("voltage", 0.02 * top, 0.45 * top),
        "winding_heating": sized("rise_per_s", 0.05 / session, 1 / session),
        "tyre_warms": sized("growth_per_s", 0.004 / session, 0.12 / session),
        "camera_distortion": sized("per_m2", -0.4 / big**2, 0.4 / big**2),
        "camera_stretched": sized("share", -0.15, 0.15),
        "wall_askew": sized("slope", -0.15, 0.15),
        "box_in_room": sized("size", 0.08 * small, 0.35 * small, Parameter("corner", 0, 3.99)),
        "ranges_filtered": sized("share", 0.05, 0.9),
        "slip_when_accelerating": sized("per_rad_s2", 0.01 / acceleration, 0.6 / acceleration),
        "caster_kick": sized("angle", 0.01, 0.2),
        "camera_slow": level("rows", 2, 8),
        "range_at_grazing": sized("coefficient", -0.3, 0.3),
        "sideways_on_patch": sized("slope", 0.01, 0.25, Parameter("direction", 0, 6.28), *spot),
    }
