"""More effects that are in no table, for the wide families: jumps, a periodic error, an edge on the floor."""

import numpy as np

from .beyond import BEYOND, POSE, RANGES, SESSION, SPEED, Sampler
from .case import Bench, Outside


def zero_jump(rng: np.random.Generator, bench: Bench) -> Outside:
    """Of the ammeter, once."""
    sigma = bench.nominal["noise"]["current_A"]
    parameters = {
        "offset_A": rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 12.0) * sigma,
        "begins_s": _moment(rng, bench),
    }
    return Outside("zero_jump", parameters, ("current_A",), SESSION)


def speed_cycle(rng: np.random.Generator, bench: Bench) -> Outside:
    """Error of the counter that comes again every few rad/s."""
    del bench
    parameters = {
        "amplitude_rad_s": rng.uniform(0.08, 0.4),
        "period_rad_s": rng.uniform(1.5, 5.0),
        "phase_rad": rng.uniform(0.0, 2.0 * np.pi),
    }
    return Outside("speed_cycle", parameters, ("omega_rad_s",), SPEED)


def mode_switch(rng: np.random.Generator, bench: Bench) -> Outside:
    """Another offset from one distance on."""
    del bench
    parameters = {"offset_m": rng.choice([-1.0, 1.0]) * rng.uniform(0.004, 0.015), "from_m": rng.uniform(0.3, 0.75)}
    return Outside("mode_switch", parameters, ("reading_m",), ("distance_m",))


def range_jump(rng: np.random.Generator, bench: Bench) -> Outside:
    """Of the front sensor, once."""
    parameters = {
        "offset_m": rng.choice([-1.0, 1.0]) * rng.uniform(0.006, 0.03),
        "begins_s": _moment(rng, bench),
    }
    return Outside("range_jump", parameters, RANGES, SESSION)


def edge_on_the_floor(rng: np.random.Generator, bench: Bench) -> Outside:
    """A place where the left wheel gets less far."""
    room = bench.nominal["world"]
    parameters = {
        "share": rng.uniform(0.03, 0.2),
        "x_m": rng.uniform(0.35, 0.65) * room["room_x_m"],
        "y_m": rng.uniform(0.4, 0.6) * room["room_y_m"],
        "radius_m": rng.uniform(0.1, 0.25),
    }
    return Outside("edge_on_the_floor", parameters, POSE, ("position", "x_m", "y_m"))


def _moment(rng: np.random.Generator, bench: Bench) -> float:
    """Session time in the middle of the data."""
    time = bench.inputs["session_time_s"] if "session_time_s" in bench.inputs else bench.inputs["t_s"]
    return float(time[int(rng.uniform(0.3, 0.7) * len(time))])


def _wider(kind: str, *more: Sampler) -> dict[str, Sampler]:
    return BEYOND[kind] | {each.__name__: each for each in more}


WIDE_BEYOND: dict[str, dict[str, Sampler]] = {
    "motor_steady": _wider("motor_steady", zero_jump, speed_cycle),
    "motor_step": _wider("motor_step", zero_jump),
    "tof_bench": _wider("tof_bench", mode_switch),
    "drive_log": _wider("drive_log", range_jump, edge_on_the_floor),
}
