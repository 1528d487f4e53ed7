"""Effects that are in no table, and where a report may say that they live."""

from collections.abc import Callable

import numpy as np

from .case import Bench, Outside

Sampler = Callable[[np.random.Generator, Bench], Outside]
SPEED = ("omega_rad_s", "u_cmd_V")
SESSION = ("row", "t_s", "session_time_s", "sweep", "trial")
MOTOR = ("current_A", "omega_rad_s")


def brush_film_bump(rng: np.random.Generator, bench: Bench) -> Outside:
    """More friction at about one speed."""
    coulomb = bench.spreads()["coulomb_friction_N_m"][0]
    size = rng.uniform(0.25, 0.7) if bench.kind == "motor_step" else rng.uniform(0.12, 0.5)
    parameters = {
        "torque_N_m": coulomb * size,
        "speed_rad_s": rng.uniform(4.0, 10.0),
        "width_rad_s": rng.uniform(0.8, 2.0),
    }
    return Outside("brush_film_bump", parameters, MOTOR, SPEED)


def session_change(rng: np.random.Generator, bench: Bench) -> Outside:
    """Dry friction that jumps once, as of a screw that works loose."""
    fraction = rng.choice([-1.0, 1.0]) * rng.uniform(0.12, 0.4)
    inputs = bench.inputs
    time = inputs["session_time_s"] if "session_time_s" in inputs else inputs["t_s"]
    begins = float(time[int(rng.uniform(0.3, 0.7) * len(time))])
    channels = ("wheel_speed_rad_s",) if bench.kind == "drive_log" else MOTOR
    return Outside("session_change", {"fraction": fraction, "begins_s": begins}, channels, SESSION)


def current_range_switch(rng: np.random.Generator, bench: Bench) -> Outside:
    """Another gain of the ammeter above a current."""
    motor = bench.spreads()
    dry = motor["coulomb_friction_N_m"][0] / motor["torque_constant_N_m_A"][0]
    parameters = {
        "gain": 1.0 + rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.2),
        "above_A": dry * rng.uniform(1.3, 1.7),
    }
    return Outside("current_range_switch", parameters, ("current_A",), (*SPEED, "current_A"))


def torsional_ringing(rng: np.random.Generator, bench: Bench) -> Outside:
    del bench
    parameters = {
        "rad_s_per_V": rng.uniform(0.1, 0.5),
        "rad_s": 2.0 * np.pi * rng.uniform(15.0, 40.0),
        "decay_s": rng.uniform(0.03, 0.1),
    }
    return Outside("torsional_ringing", parameters, ("omega_rad_s",), ("time_since_step_s",))


def gear_error(rng: np.random.Generator, bench: Bench) -> Outside:
    """Speed that depends on where in a turn the wheel is."""
    del bench
    parameters = {
        "share": rng.uniform(0.01, 0.05),
        "per_turn": float(rng.choice([1.0, 2.0, 3.0, 5.0])),
        "phase_rad": rng.uniform(0.0, 2.0 * np.pi),
    }
    return Outside("gear_error", parameters, ("omega_rad_s",), ("angle_rad", "wheel_angle_rad"))


def encoder_glitches(rng: np.random.Generator, bench: Bench) -> Outside:
    del bench
    parameters = {
        "share_lost": rng.uniform(0.1, 0.5),
        "rows": float(rng.integers(6, 15)),
        "per_trial": float(rng.integers(3, 7)),
        "pattern": float(rng.integers(1_000_000)),
    }
    return Outside("encoder_glitches", parameters, ("omega_rad_s",), ("t_s", "trial", "session_time_s", "row"))


def cyclic_error(rng: np.random.Generator, bench: Bench) -> Outside:
    del bench
    parameters = {
        "amplitude_m": rng.uniform(0.003, 0.01),
        "wavelength_m": rng.uniform(0.08, 0.3),
        "phase_rad": rng.uniform(0.0, 2.0 * np.pi),
    }
    return Outside("cyclic_error", parameters, ("reading_m",), ("distance_m",))


def local_bump(rng: np.random.Generator, bench: Bench) -> Outside:
    """A second target in the cone at about one distance."""
    del bench
    parameters = {
        "amplitude_m": rng.choice([-1.0, 1.0]) * rng.uniform(0.006, 0.02),
        "distance_m": rng.uniform(0.25, 0.75),
        "width_m": rng.uniform(0.04, 0.1),
    }
    return Outside("local_bump", parameters, ("reading_m",), ("distance_m",))


def bumped(rng: np.random.Generator, bench: Bench) -> Outside:
    """The sensor was moved once."""
    time = bench.inputs["t_s"]
    begins = float(time[int(rng.uniform(0.3, 0.7) * len(time))])
    parameters = {"offset_m": rng.choice([-1.0, 1.0]) * rng.uniform(0.003, 0.015), "begins_s": begins}
    return Outside("bumped", parameters, ("reading_m",), ("t_s", "row"))


def memory(rng: np.random.Generator, bench: Bench) -> Outside:
    """A share of the last target's distance."""
    del bench
    return Outside("memory", {"share": rng.uniform(0.006, 0.04)}, ("reading_m",), ("previous_distance_m",))


def slippery_patch(rng: np.random.Generator, bench: Bench) -> Outside:
    """Wheels that get less far on some of the floor."""
    room = bench.nominal["world"]
    parameters = {
        "share": rng.uniform(0.03, 0.25),
        "x_m": rng.uniform(0.35, 0.65) * room["room_x_m"],
        "y_m": rng.uniform(0.4, 0.6) * room["room_y_m"],
        "radius_m": rng.uniform(0.12, 0.25),
    }
    return Outside("slippery_patch", parameters, POSE, ("position", "x_m", "y_m"))


def moved_wall(rng: np.random.Generator, bench: Bench) -> Outside:
    """The far one in x."""
    del bench
    parameters = {"moved_m": rng.choice([-1.0, 1.0]) * rng.uniform(0.004, 0.04)}
    return Outside("moved_wall", parameters, RANGES, ("wall", "position", "x_m", "y_m", "theta_rad"))


def glass_wall(rng: np.random.Generator, bench: Bench) -> Outside:
    """One through which a sensor looks too far."""
    del bench
    parameters = {"share": rng.uniform(0.015, 0.1), "wall": float(rng.integers(4))}
    return Outside("glass_wall", parameters, RANGES, ("wall", "position", "x_m", "y_m", "theta_rad"))


POSE = ("pose_increment", "x_m", "y_m", "theta_rad")
RANGES = ("tof_m", "tof_front_m", "tof_left_m", "tof_right_m")
BEYOND: dict[str, dict[str, Sampler]] = {
    "motor_steady": {each.__name__: each for each in (brush_film_bump, session_change, current_range_switch)},
    "motor_step": {
        each.__name__: each
        for each in (brush_film_bump, session_change, torsional_ringing, gear_error, encoder_glitches)
    },
    "tof_bench": {each.__name__: each for each in (cyclic_error, local_bump, bumped, memory)},
    "drive_log": {each.__name__: each for each in (slippery_patch, moved_wall, glass_wall)},
}
