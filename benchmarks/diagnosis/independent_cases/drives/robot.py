"""Differential robots, their range sensors and the room they drive in, as they are drawn."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import log_uniform, pick, significant
from benchmarks.diagnosis.independent_cases.motors.motor import Motor, draw_motor, value_with_tolerance
from benchmarks.diagnosis.independent_cases.ranges.errors import draw_polynomial
from benchmarks.diagnosis.independent_cases.recipes import Toleranced

SENSORS = ("front", "left", "right")
TICKS = [360, 512, 720, 960, 1440, 1920, 2048, 2797, 3840, 6000]
Mount = tuple[float, float, float]  # x forward [m], y left [m], yaw [rad] in the axle frame


@dataclass(frozen=True)
class Robot:
    """Nominal robot in an empty room."""

    motor: Motor
    nominal: dict[str, Toleranced]  # `radius` of the wheels, `track` between them, and `range_offset`, all in m
    ticks: int  # of the encoder per revolution
    mounts: dict[str, Mount]
    room: list[float]  # size [m] along x and y
    max_range_m: float
    polynomial_mm: list[float]
    origin_m: float
    top_speed_m_s: float
    turn_rate_rad_s: float

    @property
    def radius_m(self) -> float:
        """Nominal wheel radius."""
        return self.nominal["radius"][0]

    @property
    def track_m(self) -> float:
        """Nominal wheel separation."""
        return self.nominal["track"][0]

    @property
    def wheel_speed_rad_s(self) -> float:
        """Wheel speed at the highest speed."""
        return self.top_speed_m_s / self.radius_m

    @property
    def all_nominal(self) -> dict[str, Toleranced]:
        """Nominal parameters of motors and body."""
        return {**self.motor.nominal, **self.nominal}

    def sections(self) -> dict[str, Any]:
        """Return the sections of nominal.yaml but kind and noise."""
        return {
            "motor": self.motor.section(list(self.motor.nominal)),
            "robot": {
                "wheel_radius_m": value_with_tolerance(self.nominal["radius"]),
                "wheel_separation_m": value_with_tolerance(self.nominal["track"]),
                "encoder_ticks_per_revolution": self.ticks,
            },
            "tof": {
                "range_offset_m": value_with_tolerance(self.nominal["range_offset"]),
                "max_range_m": self.max_range_m,
                "mount": {
                    sensor: dict(zip(("x_m", "y_m", "yaw_rad"), self.mounts[sensor], strict=True)) for sensor in SENSORS
                },
            },
            "world": {"room_x_m": self.room[0], "room_y_m": self.room[1]},
        }


def _with_tolerance(rng: np.random.Generator, value: float, share: float) -> Toleranced:
    """Return a rounded value with a tolerance of about that share."""
    value = significant(value)
    return value, significant(value * share * rng.uniform(0.6, 1.6), 5)


def _draw_room(rng: np.random.Generator, track: float) -> list[float]:
    """Draw a room of 1 to 6 m that the robot can turn in."""
    small = max(1.0, 6 * track)
    size_x = round(log_uniform(rng, small, 6.0 if small < 4 else 1.5 * small), 2)
    size_y = round(min(6.0, max(1.0, size_x * rng.uniform(0.6, 1.6))), 2)
    return [max(size, round(5 * track, 2)) for size in (size_x, size_y)]


def draw_robot(rng: np.random.Generator) -> Robot:
    """Draw wheels of 20 to 120 mm, a track of 60 to 400 mm, motors to match, three range sensors and a room."""
    track = log_uniform(rng, 0.06, 0.40)
    diameter = min(0.12, max(0.02, track * rng.uniform(0.2, 0.6)))
    radius = diameter / 2
    top_speed = log_uniform(rng, 0.12, 0.7) * min(1.0, (track / 0.1) ** 0.5)
    motor = draw_motor(rng, full_speed_rad_s=top_speed / radius * rng.uniform(1.5, 3.0))
    # A tick is at most 1.2 mm of travel.
    ticks = max(int(pick(rng, TICKS)), math.ceil(diameter * math.pi / 1.2e-3))
    nominal = {
        "radius": _with_tolerance(rng, radius, 0.0015),
        "track": _with_tolerance(rng, track, 0.004),
        "range_offset": (0.0, significant(log_uniform(rng, 3e-4, 1.5e-3), 2)),
    }
    yaw = round(pick(rng, [math.pi / 4, math.pi / 4, math.pi / 3, math.pi / 2]), 8)
    x, y = round(0.3 * track, 3), round(0.35 * track, 3)
    polynomial, origin = draw_polynomial(rng)
    room = _draw_room(rng, track)
    reach = [r for r in (1.2, 2.0, 4.0) if r >= 0.45 * min(room)] or [4.0]
    return Robot(
        motor=motor,
        nominal=nominal,
        ticks=ticks,
        mounts={"front": (round(0.4 * track, 3), 0.0, 0.0), "left": (x, y, yaw), "right": (x, -y, -yaw)},
        room=room,
        max_range_m=float(pick(rng, reach)),
        polynomial_mm=polynomial,
        origin_m=origin,
        top_speed_m_s=top_speed,
        turn_rate_rad_s=min(3.5, 0.9 * 2 * top_speed / track) * rng.uniform(0.5, 1.0),
    )
