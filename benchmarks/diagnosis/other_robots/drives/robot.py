"""Robots of very different size in empty rooms, with true and stated noise."""

from dataclasses import dataclass

import numpy as np

from benchmarks.diagnosis.other_robots.compiled import WHEEL_DT_S
from benchmarks.diagnosis.other_robots.draws import Array, log_uniform, noise_factor, pick, significant
from benchmarks.diagnosis.other_robots.motor import Motor, draw_motor
from benchmarks.diagnosis.other_robots.range_noise import polynomial_mm, stated_noise

SENSORS = ("front", "left", "right")
NOMINAL = 8
"""Parameters with a tolerance: motor R, K, B, Tc, J; wheel radius; wheel separation; offset of the ranges."""
FACTORS = ("wheel", "pose", "travel", "tof")


@dataclass
class Encoder:
    """Ticks of the wheels and noise of the camera, which hides the rounding to ticks."""

    ticks: int
    pose_xy: float
    pose_theta: float


@dataclass
class Ranges:
    """Range sensors: reach, mounts (x, y, yaw) and the polynomial of their noise."""

    reach: float
    mounts: dict[str, tuple[float, float, float]]
    polynomial: list[float]
    origin: float

    def noise(self, d: Array | float) -> Array:
        """Return the stated noise of a range, in metres."""
        return stated_noise(self.polynomial, self.origin, d)


@dataclass
class Robot:
    """Nominal robot, its room, its noise (true and stated)."""

    motor: Motor
    radius: float
    track: float
    speed: float
    room: tuple[float, float]
    encoder: Encoder
    ranges: Ranges
    loose: dict[str, float]
    """Tolerances: relative ones of the radius (r) and the track (b), and of the range offset in metres (tof)."""
    travel: float
    wheel_sd: float
    """Noise of the wheel speeds that the outside torque is drawn for."""
    factors: dict[str, float]
    """True over stated noise."""

    @property
    def tick_length(self) -> float:
        """Distance that a wheel rolls in one tick."""
        return 2 * np.pi * self.radius / self.encoder.ticks

    @property
    def pose_xy(self) -> float:
        """True noise of a camera position."""
        return self.factors["pose"] * self.encoder.pose_xy

    @property
    def pose_theta(self) -> float:
        """True noise of a camera heading."""
        return self.factors["pose"] * self.encoder.pose_theta


def _draw_size(rng: np.random.Generator) -> tuple[float, float]:
    """Return wheel radius and track, from a matchbox with 20 mm wheels to a cart with 200 mm wheels."""
    while True:
        radius = significant(log_uniform(rng, 0.010, 0.100))
        track = significant(log_uniform(rng, 0.07, 0.5))
        if 2.2 * radius < track < 14 * radius:
            return radius, track


def _draw_encoder(rng: np.random.Generator, radius: float, track: float, speed: float) -> Encoder:
    """Return an encoder whose rounding is the smaller part of the noise of a window, which the format leaves out."""
    while True:
        ticks = round(log_uniform(rng, 48, 8000))
        pose_xy = significant(log_uniform(rng, 0.0004, 0.006), 2)
        pose_theta = significant(log_uniform(rng, 0.001, 0.02), 2)
        edge = 2 * np.pi * radius / ticks
        along = edge / np.sqrt(12) < 0.8 * np.sqrt(2) * pose_xy
        around = edge / np.sqrt(3) / track < 0.8 * np.sqrt(2) * pose_theta
        if along and around and 2 * np.pi / ticks / WHEEL_DT_S / np.sqrt(6) < 0.12 * speed / radius:
            return Encoder(ticks, pose_xy, pose_theta)


def _draw_mounts(rng: np.random.Generator, track: float) -> dict[str, tuple[float, float, float]]:
    """Return x, y and yaw of the three range sensors."""
    any_yaw = rng.uniform(0.4, 1.6)
    yaw = round(float(pick(rng, [np.pi / 4, np.pi / 2, np.pi / 3, any_yaw])), 8)
    skew = rng.uniform(-0.1, 0.1) if rng.random() < 0.3 else 0.0
    x, y = round(rng.uniform(0.0, 0.6) * track, 3), round(rng.uniform(0.15, 0.5) * track, 3)
    front = (round(rng.uniform(0.2, 0.6) * track, 3), round(skew * track, 3), 0.0)
    return {"front": front, "left": (x, y, yaw), "right": (x, -y, -yaw)}


def draw_robot(rng: np.random.Generator) -> Robot:
    """Return a robot in its room."""
    radius, track = _draw_size(rng)
    speed = log_uniform(rng, 0.12, 0.9) * float(np.clip((track / 0.2) ** 0.4, 0.6, 1.4))
    motor = draw_motor(rng, inertia=True, top_speed=significant(speed / radius * rng.uniform(1.5, 3)))
    encoder = _draw_encoder(rng, radius, track, speed)
    smallest = max(1.0, 4.5 * track)
    room = (round(log_uniform(rng, smallest, 6), 2), round(log_uniform(rng, smallest, 6), 2))
    reach = significant(float(np.clip(max(room) * log_uniform(rng, 0.3, 1.1), 0.4, 4.0)), 2)
    mounts = _draw_mounts(rng, track)
    loose = {
        "r": log_uniform(rng, 0.0008, 0.012),
        "b": log_uniform(rng, 0.002, 0.02),
        "tof": significant(log_uniform(rng, 0.0003, 0.006), 2),
    }
    top = reach * 1000 * log_uniform(rng, 0.004, 0.02)
    first = min(log_uniform(rng, 0.6, 4), 0.7 * top)
    origin = significant(rng.uniform(0, 0.25), 2)
    polynomial = polynomial_mm(first, top, max(reach - origin, 0.1), rng.dirichlet([1, 1, 1]))
    return Robot(
        motor,
        radius,
        track,
        speed,
        room,
        encoder,
        Ranges(reach, mounts, polynomial, origin),
        loose,
        travel=significant(log_uniform(rng, 0.0002, 0.002), 2),
        wheel_sd=log_uniform(rng, 0.002, 0.015) * speed / radius,
        factors={name: noise_factor(rng) for name in FACTORS},
    )
