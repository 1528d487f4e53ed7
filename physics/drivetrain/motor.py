"""DC motor with gearbox at the wheel shaft (paper Eq. 15-21, inductance neglected), free of any engine.

Driving torque is linear in voltage and speed; Coulomb friction opposes motion, holds a wheel at rest up to its limit,
and never drives it. A constant voltage therefore has a closed form, which `step` follows through stops and starts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import copysign, expm1, log1p

from configs.schema.robot import Motor


@dataclass(frozen=True)
class MotorModel:
    """A motor with its gearbox, in quantities at the wheel shaft."""

    resistance_ohm: float
    torque_constant_N_m_A: float
    """Torque constant, which is also the back-EMF constant [V s/rad]."""
    viscous_N_m_s_rad: float
    coulomb_N_m: float
    inertia_kg_m2: float
    """Inertia of rotor and gearbox, reflected to the wheel shaft."""

    @classmethod
    def from_config(cls, config: Motor) -> "MotorModel":
        return cls(
            resistance_ohm=config.winding_resistance_ohm,
            torque_constant_N_m_A=config.torque_constant_N_m_A,
            viscous_N_m_s_rad=config.viscous_friction_N_m_s_rad,
            coulomb_N_m=config.coulomb_friction_N_m,
            inertia_kg_m2=config.rotor_inertia_kg_m2,
        )

    @property
    def damping_N_m_s_rad(self) -> float:
        """Loss of torque per unit of speed by back-EMF and viscous friction together."""
        return self.torque_constant_N_m_A**2 / self.resistance_ohm + self.viscous_N_m_s_rad

    def stall_torque_N_m(self, voltage_V: float) -> float:
        """Return the electrical torque on a wheel at rest."""
        return self.torque_constant_N_m_A * voltage_V / self.resistance_ohm

    def current_A(self, voltage_V: float, speed_rad_s: float) -> float:
        return (voltage_V - self.torque_constant_N_m_A * speed_rad_s) / self.resistance_ohm

    def steady_state(self, voltage_V: float) -> tuple[float, float]:
        """Return current [A] and speed [rad/s] without load: 0 below breakaway, Eq. 20 without derivative above."""
        stall = self.stall_torque_N_m(voltage_V)
        if abs(stall) <= self.coulomb_N_m:
            return self.current_A(voltage_V, 0.0), 0.0
        speed = (stall - copysign(self.coulomb_N_m, stall)) / self.damping_N_m_s_rad
        return self.current_A(voltage_V, speed), speed

    def step(
        self, voltage_V: float, speed_rad_s: float, duration_s: float, load_inertia_kg_m2: float = 0.0
    ) -> tuple[float, float]:
        """Return speed [rad/s] after `duration_s` at constant voltage, and turned angle [rad]; exact."""
        inertia = self.inertia_kg_m2 + load_inertia_kg_m2
        wheel = HeldWheel(self.damping_N_m_s_rad, self.coulomb_N_m, inertia, duration_s)
        return wheel.step(self.stall_torque_N_m(voltage_V), speed_rad_s)


class HeldWheel:
    """One wheel in exact steps of one duration at constant stall torque; `motor_arrays` does the same for arrays."""

    def __init__(self, damping_N_m_s_rad: float, friction_N_m: float, inertia_kg_m2: float, duration_s: float) -> None:
        self._damping = damping_N_m_s_rad
        self._friction = friction_N_m
        self._duration_s = duration_s
        self._time_constant_s = inertia_kg_m2 / damping_N_m_s_rad
        self._covered = self._covered_after(duration_s)

    def step(self, torque_N_m: float, speed_rad_s: float) -> tuple[float, float]:
        """Return speed [rad/s] after the step and turned angle [rad], through a stop and a start within it."""
        angle, left_s, covered = 0.0, self._duration_s, self._covered
        if speed_rad_s != 0.0:
            # The speed approaches `final` exponentially. If that has the sign of the speed, the wheel does not stop.
            final = (torque_N_m - copysign(self._friction, speed_rad_s)) / self._damping
            # Compare signs: the product with a tiny speed would underflow to zero, and friction would drive the wheel.
            if (final >= 0.0) if speed_rad_s > 0.0 else (final <= 0.0):
                return self._relaxed(speed_rad_s, final, left_s, covered)
            # Time at which the exponential passes 0; log1p keeps its digits for a wheel that is nearly at rest.
            stops_s = self._time_constant_s * log1p(-speed_rad_s / final)
            if stops_s > left_s:
                return self._relaxed(speed_rad_s, final, left_s, covered)
            angle = self._relaxed(speed_rad_s, final, stops_s, self._covered_after(stops_s))[1]
            left_s -= stops_s
            covered = self._covered_after(left_s)
        # From rest the wheel starts only against a friction that is smaller than the torque; else it sticks.
        if abs(torque_N_m) <= self._friction:
            return 0.0, angle
        final = (torque_N_m - copysign(self._friction, torque_N_m)) / self._damping
        speed, further = self._relaxed(0.0, final, left_s, covered)
        return speed, angle + further

    def _covered_after(self, duration_s: float) -> float:
        """Return the share of the difference to the final speed that is covered after a time."""
        return -expm1(-duration_s / self._time_constant_s)

    def _relaxed(self, start: float, final: float, duration_s: float, covered: float) -> tuple[float, float]:
        return start + (final - start) * covered, final * duration_s + (start - final) * self._time_constant_s * covered


@dataclass(frozen=True)
class Motors:
    """The motors of a robot, or the same one twice on a bench."""

    right: MotorModel
    left: MotorModel

    def each(self, change: Callable[[MotorModel], MotorModel]) -> "Motors":
        """Return both motors changed by a function."""
        return Motors(change(self.right), change(self.left))
