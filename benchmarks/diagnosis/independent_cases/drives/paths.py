"""Commands of one trial, forward speed (m/s) and yaw rate (rad/s) at 20 Hz, for usual manoeuvres."""

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.diagnosis.independent_cases.draws import draw_sign, pick
from benchmarks.diagnosis.independent_cases.drives.robot import Robot
from benchmarks.diagnosis.independent_cases.recipes import Array

DT_S = 0.05
Leg = tuple[float, float, float]  # speed [m/s], yaw rate [rad/s], duration [s]
Legs = Iterator[Leg]


def _square(_: np.random.Generator, __: Robot, space: float, v: float, w: float, turn: float) -> Legs:
    while True:
        yield v, 0, max(0.3, space * 1.1 / v)
        yield 0, turn * w, np.pi / 2 / w


def _circle(rng: np.random.Generator, robot: Robot, space: float, v: float, _: float, turn: float) -> Legs:
    while True:
        radius = max(space * rng.uniform(0.3, 0.7), v / (1.2 * robot.turn_rate_rad_s))
        leg = v, turn * v / radius, rng.uniform(1, 2) * 2 * np.pi * radius / v
        v, turn = robot.top_speed_m_s * rng.uniform(0.4, 1.0), draw_sign(rng)
        yield leg


def _spin(rng: np.random.Generator, robot: Robot, _: float, v: float, __: float, ___: float) -> Legs:
    while True:
        yield 0, draw_sign(rng) * robot.turn_rate_rad_s * rng.uniform(0.3, 1.0), rng.uniform(1.5, 5)
        yield rng.uniform(-0.3, 0.6) * v, 0, rng.uniform(0.4, 1.2)


def _eight(_: np.random.Generator, robot: Robot, space: float, v: float, __: float, turn: float) -> Legs:
    while True:
        radius = max(0.4 * space, v / (1.2 * robot.turn_rate_rad_s))
        yield v, turn * v / radius, 2 * np.pi * radius / v
        turn = -turn


def _shuttle(rng: np.random.Generator, _: Robot, space: float, v: float, w: float, turn: float) -> Legs:
    while True:
        yield v, 0, max(0.3, space * rng.uniform(0.6, 1.3) / v)
        yield 0, turn * w, np.pi / w


def _random(rng: np.random.Generator, robot: Robot, _: float, __: float, w: float, ___: float) -> Legs:
    top, rate = robot.top_speed_m_s, robot.turn_rate_rad_s
    while True:
        kind = pick(rng, ["drive", "drive", "drive", "spin", "stop", "back"])
        if kind == "drive":
            yield top * rng.uniform(0.2, 1.0), rate * rng.normal(0, 0.35), rng.uniform(0.5, 3)
        elif kind == "spin":
            yield 0, draw_sign(rng) * w, rng.uniform(0.5, 2)
        elif kind == "stop":
            yield 0, 0, rng.uniform(0.3, 1.0)
        else:
            yield -top * rng.uniform(0.2, 0.5), rate * rng.normal(0, 0.2), rng.uniform(0.5, 1.5)


STYLES: dict[str, tuple[int, Callable[[np.random.Generator, Robot, float, float, float, float], Legs]]] = {
    "square": (2, _square),
    "circle": (1, _circle),
    "spin": (2, _spin),
    "eight": (1, _eight),
    "random": (1, _random),
    "shuttle": (2, _shuttle),
}
"""Legs of one round, and the legs."""


def commands(rng: np.random.Generator, rows: int, style: str, robot: Robot) -> Array:
    """Draw the commands (rows, 2) of one trial; every manoeuvre fits about in the middle of the room."""
    space = 0.5 * min(robot.room) - robot.track_m
    v, w = robot.top_speed_m_s * rng.uniform(0.5, 1.0), robot.turn_rate_rad_s * rng.uniform(0.5, 1.0)
    round_legs, manoeuvre = STYLES[style]
    legs = manoeuvre(rng, robot, space, v, w, draw_sign(rng))
    parts: list[Array] = []
    while sum(len(part) for part in parts) < rows:
        for _ in range(round_legs):
            speed, rate, seconds = next(legs)
            parts.append(np.tile([speed, rate], (max(1, round(seconds / DT_S)), 1)))
    return np.concatenate(parts)[:rows]
