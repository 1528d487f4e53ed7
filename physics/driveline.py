"""From the commanded voltages to the torques at the wheels, with everything that voltage, supply and friction may do.

Motors lie along the last axis of every array: right and left of a robot, or one alone on a bench. The winding's own
current is linear in the speed, and whoever integrates treats that part exactly; what terms add to it comes as an extra
torque, which is zero to the bit where they have no effect.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from physics.bridge import Bridge
from physics.motion import Motion
from physics.motor import MotorModel
from physics.robot_model import RobotModel, through
from physics.terms.base import Slot

Array = NDArray[np.float64]


class Driveline:
    """The motors of a robot with its terms; pure, the voltage that a lag holds is the caller's to keep."""

    def __init__(self, model: RobotModel, motors: Sequence[MotorModel]) -> None:
        self.resistance_ohm = np.array([motor.resistance_ohm for motor in motors])
        self.torque_constant_N_m_A = np.array([motor.torque_constant_N_m_A for motor in motors])
        self.viscous_N_m_s_rad = np.array([motor.viscous_N_m_s_rad for motor in motors])
        self.coulomb_N_m = np.array([motor.coulomb_N_m for motor in motors])
        self.inertia_kg_m2 = np.array([motor.inertia_kg_m2 for motor in motors])
        self.damping_N_m_s_rad = np.array([motor.damping_N_m_s_rad for motor in motors])
        self.supply_V = model.config.power.battery_voltage_V
        self._actuator = model.effects(Slot.ACTUATOR)
        self._battery = model.effects(Slot.BATTERY)
        self._bridge = model.effects(Slot.BRIDGE)
        self._supply = model.effects(Slot.SUPPLY)
        self._limit = model.effects(Slot.CURRENT_LIMIT)
        self._friction = model.effects(Slot.FRICTION)

    @classmethod
    def of_robot(cls, model: RobotModel) -> "Driveline":
        """Both motors, right and left."""
        return cls(model, (model.motors.right, model.motors.left))

    @classmethod
    def of_bench(cls, model: RobotModel) -> "Driveline":
        """One motor alone."""
        return cls(model, (model.motors.right,))

    @property
    def lags(self) -> bool:
        """Whether the voltage depends on what it was before."""
        return bool(self._actuator)

    @property
    def is_bare(self) -> bool:
        """Whether torque and friction are those of the bare motors, at any speed and time."""
        return not (self._bridge or self._supply or self._limit or self._friction)

    def voltage_V(
        self, held_V: Array, command_V: Array, time_s: float | Array, duration_s: float
    ) -> tuple[Array, Array]:
        """What a lag holds after `duration_s`, and the voltage at the motors."""
        for lag in self._actuator:
            held_V = lag(held_V, command_V, duration_s)
        held_V = held_V if self._actuator else command_V
        return held_V, through(self._battery, held_V, time_s)

    def current_A(self, voltage_V: Array, speed_rad_s: Array) -> Array:
        """Through the windings, at the voltage that the bridge would give from a full supply."""
        emf_V = voltage_V - self.torque_constant_N_m_A * speed_rad_s
        bridge = Bridge(self.supply_V, voltage_V / self.supply_V, self.resistance_ohm, self._driving_V)
        current_A = bridge.current_A(emf_V)
        for sag in self._supply:
            current_A = sag(emf_V, bridge)
        return through(self._limit, current_A)

    def _driving_V(self, emf_V: Array) -> Array:
        return through(self._bridge, emf_V)

    def extra_torque_N_m(self, voltage_V: Array, speed_rad_s: Array) -> Array:
        """By terms, on top of that of the bare winding at this voltage and speed."""
        if not (self._bridge or self._supply or self._limit):
            return np.zeros_like(speed_rad_s)
        bare_A = (voltage_V - self.torque_constant_N_m_A * speed_rad_s) / self.resistance_ohm
        return self.torque_constant_N_m_A * (self.current_A(voltage_V, speed_rad_s) - bare_A)

    def stall_torque_N_m(self, voltage_V: Array) -> Array:
        """Of the bare windings at rest."""
        return self.torque_constant_N_m_A * voltage_V / self.resistance_ohm

    def friction_N_m(self, torque_N_m: Array, speed_rad_s: Array, time_s: float | Array) -> Array:
        """Dry friction against the motion, or against the torque on a wheel at rest, up to which it holds.

        Of the motors alone, to be broadcast, where no term makes it differ in time.
        """
        if not self._friction:
            return self.coulomb_N_m
        direction = np.sign(np.where(speed_rad_s == 0.0, torque_N_m, speed_rad_s))
        motion = Motion(direction, speed_rad_s, time_s)
        return through(self._friction, np.broadcast_to(self.coulomb_N_m, speed_rad_s.shape), motion)
