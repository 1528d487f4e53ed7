"""A case of kind drive_log."""

from typing import Any

import numpy as np

from benchmarks.diagnosis.other_robots.draws import significant
from benchmarks.diagnosis.other_robots.drives.log import Log
from benchmarks.diagnosis.other_robots.drives.robot import Robot
from benchmarks.diagnosis.other_robots.drives.search import Search
from benchmarks.diagnosis.other_robots.drives.setting import DriveSetting
from benchmarks.diagnosis.other_robots.files import Case, tolerance_entry, truth_entry
from benchmarks.diagnosis.other_robots.hidden import Entries

HEADER = [
    "trial",
    "split",
    "session_time_s",
    "t_s",
    "v_cmd_m_s",
    "w_cmd_rad_s",
    "u_left_V",
    "u_right_V",
    "enc_left_ticks",
    "enc_right_ticks",
    "tof_front_m",
    "tof_left_m",
    "tof_right_m",
    "x_m",
    "y_m",
    "theta_rad",
]


def _nominal(bot: Robot, wheel_noise: float) -> dict[str, Any]:
    """Return the content of nominal.yaml."""
    mounts = {name: {"x_m": x, "y_m": y, "yaw_rad": yaw} for name, (x, y, yaw) in bot.ranges.mounts.items()}
    return {
        "kind": "drive_log",
        "motor": bot.motor.entries,
        "robot": {
            "wheel_radius_m": tolerance_entry(bot.radius, bot.loose["r"]),
            "wheel_separation_m": tolerance_entry(bot.track, bot.loose["b"]),
            "encoder_ticks_per_revolution": bot.encoder.ticks,
        },
        "tof": {
            "range_offset_m": {"value": 0, "tolerance": bot.loose["tof"]},
            "max_range_m": bot.ranges.reach,
            "mount": mounts,
        },
        "world": {"room_x_m": bot.room[0], "room_y_m": bot.room[1]},
        "noise": {
            "wheel_speed_rad_s": wheel_noise,
            "pose_xy_m": bot.encoder.pose_xy,
            "pose_theta_rad": bot.encoder.pose_theta,
            "travel_m_per_sqrt_m": bot.travel,
            "tof_polynomial_mm": bot.ranges.polynomial,
            "tof_polynomial_origin_m": bot.ranges.origin,
        },
    }


def _cell(value: float, digits: int) -> str:
    """Return a cell of data.csv, empty where the value is missing."""
    return f"{value:.{digits}f}" if np.isfinite(value) else ""


def _rows(log: Log, fit: list[int], *, logged: bool) -> list[list[str]]:
    """Return the rows of data.csv."""
    rows = []
    for q in range(len(log.starts)):
        for k in range(log.starts[q], log.ends[q]):
            volts = [_cell(log.u[c, k], 3) for c in range(2)] if logged and k < log.ends[q] - 1 else ["", ""]
            rows.append(
                [
                    str(q + 1),
                    "fit" if q in fit else "holdout",
                    f"{log.session[k]:.2f}",
                    f"{log.t[k]:.2f}",
                    *[_cell(command, 3) for command in log.commands[:, k]],
                    *volts,
                    *[f"{ticks:.0f}" for ticks in log.ticks[:, k]],
                    *[_cell(d, 3) for d in log.ranges[:, k]],
                    *[_cell(value, 4) for value in log.pose[k]],
                ]
            )
    return rows


def _setting(setting: DriveSetting) -> dict[str, Any]:
    """Return what truth.json holds of the robot and its trials."""
    bot = setting.bot
    return {
        "wheel_diameter_m": 2 * bot.radius,
        "track_m": bot.track,
        "ticks": bot.encoder.ticks,
        "room_m": bot.room,
        "reach_m": bot.ranges.reach,
        "speed_m_s": bot.speed,
        "supply_V": bot.motor.supply,
        "paths": [plan.kind for plan in setting.draws.plans],
        "rows": setting.draws.rows,
        "voltages_logged": setting.logged,
        "deviations": setting.deviations.tolist(),
        "tolerances": {**bot.motor.relative, **bot.loose},
    }


def make(rng: np.random.Generator, category: str) -> Case | None:
    """Return a case, or None when no visible effect was drawn for its robot."""
    setting, entries = DriveSetting(rng), Entries()
    driven = Search(setting, category).hide(rng, entries)
    if driven is None:
        return None
    bot = setting.bot
    stated = significant(setting.wheel_sd / bot.factors["wheel"], 3)
    disturbances = {"noise_factor": bot.factors, "lag1": setting.rho, **driven.disturbances}
    rows = _rows(driven.log, setting.fit, logged=setting.logged)
    truth = truth_entry("drive_log", category, entries, disturbances, _setting(setting))
    return Case(_nominal(bot, stated), HEADER, rows, truth)
