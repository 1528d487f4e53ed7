"""Speeds of bare motors in successive rows: one exact step for each row, in which only the speed is computed."""

from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import HeldVoltages
from physics.drivetrain.motor_arrays import HeldDrive, covered_share
from symolo.core.arrays import Array, stacked_rows


def bare_speeds(driveline: Driveline, held: HeldVoltages, speed_rad_s: Array) -> Array:
    """Return the speeds at the end of each row, (T, N, wheels) or (T, M, N, wheels).

    `rigid_wheels` has the same for motors with any effects. Here, all that the speeds do not change is computed once.

    Args:
        driveline: Motors without effects on torque and friction.
        held: Their voltages in T rows that last equally long.
        speed_rad_s: (N, wheels), speeds before the first row.
    """
    damping, friction, inertia = driveline.damping_N_m_s_rad, driveline.coulomb_N_m, driveline.inertia_kg_m2
    durations = (held.durations.whole_s, held.durations.before_s, held.durations.after_s)
    whole, before, after = ((duration_s, covered_share(duration_s, inertia / damping)) for duration_s in durations)
    torques, old, new = (
        [driveline.stall_torque_N_m(voltage_V) for voltage_V in rows_V]
        for rows_V in (held.mean_V, held.old_V, held.new_V)
    )
    speeds = []
    for torque, place in zip(torques, held.cut.tolist(), strict=True):
        periods = ((torque, whole),) if place < 0 else ((old[place], before), (new[place], after))
        for torque_N_m, (duration_s, covered) in periods:
            drive = HeldDrive(torque_N_m, damping, friction, inertia)
            speed_rad_s = drive.speed_after(speed_rad_s, duration_s, covered)
        speeds.append(speed_rad_s)
    return stacked_rows(speeds, speed_rad_s.shape)
