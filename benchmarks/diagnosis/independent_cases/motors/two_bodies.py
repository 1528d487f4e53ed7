"""Gears whose motor side and load side are not rigidly joined: play with inelastic contact, or a spring.

The motor side has its shares of the inertia and of all friction; the encoder is on it.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from benchmarks.diagnosis.independent_cases.motors.motor_law import Lanes
from benchmarks.diagnosis.independent_cases.motors.wheel_step import advance
from benchmarks.diagnosis.independent_cases.recipes import Array

FRICTION = ("B", "Tc", "extra", "drag", "bump")


class Joint(ABC):
    """What connects the two sides of a gear."""

    def __init__(self, lanes: int, inertia_share: float, friction_share: float) -> None:
        self.inertia_share, self.friction_share = inertia_share, friction_share
        self.load_speed = np.zeros(lanes)

    def share(self, p: Lanes) -> None:
        """Divide the motor between its sides; the load side has no drive and no torque with the angle."""
        friction = self.friction_share
        self.motor = p.times(J=self.inertia_share, **dict.fromkeys(FRICTION, friction))
        rest = dict.fromkeys(FRICTION, 1 - friction)
        self.load = p.times(J=1 - self.inertia_share, K=1e-9, ripple=0.0, **rest)

    @abstractmethod
    def step(self, whole: Lanes, u: Array, w: Array, angle: Array, h: float) -> Array:
        """Return the motor-side speed (rad/s) after h seconds at voltage u (V)."""


class Play(Joint):
    """Free play between the sides, `gap` [rad] in all; a trial starts at rest in mid-gap."""

    def __init__(self, gap: Sequence[float], inertia_share: float, friction_share: float) -> None:
        super().__init__(len(gap), inertia_share, friction_share)
        self.half = np.asarray(gap, float) / 2
        self.between = np.zeros_like(self.half)
        self.contact = np.zeros_like(self.half)

    def step(self, whole: Lanes, u: Array, w: Array, angle: Array, h: float) -> Array:
        """Return the motor-side speed (rad/s): free within the gap, with the momentum of both sides after a contact."""
        free = advance(self.motor, u, w, angle, h=h)
        load_free = advance(self.load, 0.0 * u, self.load_speed, angle, h=h)
        joined = advance(whole, u, w, angle, h=h)
        touching = self.contact != 0
        parting = touching & (self.contact * (free - load_free) < -1e-12)
        together = touching & ~parting
        moved = self.between + 0.5 * h * ((w + free) - (self.load_speed + load_free))
        hits = ~together & (np.abs(moved) >= self.half) & ((free - load_free) * np.sign(moved) > 0)
        share = self.motor.J / whole.J
        merged = share * free + (1 - share) * load_free
        speed = np.where(together, joined, np.where(hits, merged, free))
        self.load_speed = np.where(together, joined, np.where(hits, merged, load_free))
        self.contact = np.where(together, self.contact, np.where(hits, np.sign(moved), 0.0))
        self.between = np.where(together, self.between, np.clip(moved, -self.half, self.half))
        return speed


class Spring(Joint):
    """A spring and a damper between the sides, which ring at a frequency [Hz] with a damping ratio.

    inertia is that of the whole motor [kg m2]; the reduced inertia of both sides sets the stiffness.
    """

    def __init__(
        self, frequency_Hz: Array, damping_ratio: Array, inertia: Array, inertia_share: float, friction_share: float
    ) -> None:
        super().__init__(len(frequency_Hz), inertia_share, friction_share)
        reduced = inertia * inertia_share * (1 - inertia_share)
        omega = 2 * np.pi * frequency_Hz
        self.stiffness = reduced * omega**2
        self.damper = 2 * damping_ratio * omega * reduced
        self.twist = np.zeros_like(omega)

    def step(self, whole: Lanes, u: Array, w: Array, angle: Array, h: float) -> Array:
        """Return the motor-side speed (rad/s) by a semi-implicit step of the twist."""
        del whole
        torque = self.stiffness * self.twist + self.damper * (w - self.load_speed)
        speed = advance(self.motor, u, w, angle, h=h, torque=-torque)
        self.load_speed = advance(self.load, 0.0 * u, self.load_speed, angle, h=h, torque=torque)
        self.twist = self.twist + h * (speed - self.load_speed)
        return speed
