"""DC motor with gearbox at the wheel shaft (paper Eq. 15-21, inductance neglected), free of any engine.

Driving torque is linear in voltage and speed; Coulomb friction opposes motion, holds a wheel at rest up to its limit,
and never drives it. A constant voltage therefore has a closed form, which `step` follows through stops and starts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import copysign, exp, log

from configs.schema.robot import Motor


@dataclass(frozen=True)
class MotorModel:
    resistance_ohm: float
    torque_constant_N_m_A: float
    """Also the back-EMF constant [V s/rad]."""
    viscous_N_m_s_rad: float
    coulomb_N_m: float
    inertia_kg_m2: float
    """Of rotor and gearbox, seen at the wheel shaft."""

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
        """What back-EMF and viscous friction together take off the torque per unit of speed."""
        return self.torque_constant_N_m_A**2 / self.resistance_ohm + self.viscous_N_m_s_rad

    def stall_torque_N_m(self, voltage_V: float) -> float:
        """Electrical torque of a wheel at rest."""
        return self.torque_constant_N_m_A * voltage_V / self.resistance_ohm

    def current_A(self, voltage_V: float, speed_rad_s: float) -> float:
        return (voltage_V - self.torque_constant_N_m_A * speed_rad_s) / self.resistance_ohm

    def steady_state(self, voltage_V: float) -> tuple[float, float]:
        """Current [A] and speed [rad/s] off load: stuck below breakaway, Eq. 20 without its derivative above."""
        stall = self.stall_torque_N_m(voltage_V)
        if abs(stall) <= self.coulomb_N_m:
            return self.current_A(voltage_V, 0.0), 0.0
        speed = (stall - copysign(self.coulomb_N_m, stall)) / self.damping_N_m_s_rad
        return self.current_A(voltage_V, speed), speed

    def step(
        self, voltage_V: float, speed_rad_s: float, duration_s: float, load_inertia_kg_m2: float = 0.0
    ) -> tuple[float, float]:
        """Speed [rad/s] after `duration_s` at constant voltage, and the angle [rad] turned meanwhile; exact."""
        stall = self.stall_torque_N_m(voltage_V)
        time_constant = (self.inertia_kg_m2 + load_inertia_kg_m2) / self.damping_N_m_s_rad
        speed, angle, left = speed_rad_s, 0.0, duration_s
        if speed != 0.0:
            final = (stall - copysign(self.coulomb_N_m, speed)) / self.damping_N_m_s_rad
            stops = time_constant * log(1.0 - speed / final) if final * speed < 0.0 else float("inf")
            if stops > left:
                return _relax(speed, final, left, time_constant)
            angle = _relax(speed, final, stops, time_constant)[1]
            speed, left = 0.0, left - stops
        if abs(stall) <= self.coulomb_N_m:
            return 0.0, angle
        final = (stall - copysign(self.coulomb_N_m, stall)) / self.damping_N_m_s_rad
        speed, further = _relax(speed, final, left, time_constant)
        return speed, angle + further


@dataclass(frozen=True)
class Motors:
    """The motors of a robot, or twice the same one on a bench."""

    right: MotorModel
    left: MotorModel

    def each(self, change: Callable[[MotorModel], MotorModel]) -> "Motors":
        return Motors(change(self.right), change(self.left))


def _relax(start: float, final: float, duration_s: float, time_constant_s: float) -> tuple[float, float]:
    """Speed and angle of an exponential approach from `start` to `final`."""
    decay = exp(-duration_s / time_constant_s)
    return final + (start - final) * decay, final * duration_s + (start - final) * time_constant_s * (1.0 - decay)
