"""Wheel torques from commanded voltages, with all effects on voltage, supply and friction.

Motors lie along the last axis of every array: right and left of a robot, or a single one on a bench. Numbers of several
robots are stacked along an axis before it. The current of the bare winding is linear in the speed, and integrators
treat that part exactly; effects add an extra torque, which is exactly zero where they change nothing.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from configs.effects.base import Slot
from physics.drivetrain.bridge import Bridge, Chopper
from physics.drivetrain.motion import ShaftMotion
from physics.drivetrain.motor import MotorModel
from physics.robot.model import RobotModel, applied
from symolo.core.arrays import Array

_GAUSS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)
NODES, WEIGHTS = (0.5 * (1.0 + _GAUSS)).tolist(), (0.5 * _GAUSS_WEIGHTS).tolist()
"""Nodes and weights of Gauss's rule on 0 to 1, for the mean of a lagging voltage."""
MIN_INERTIA_KG_M2 = 1e-12
MIN_WARM = 0.05
"""Smallest factor of heat on a resistance, whatever a law says beyond the voltages at which it was seen."""


class Winding(NamedTuple):
    """The windings of motors at one time; arrays of wheels."""

    resistance_ohm: Array
    torque_constant_N_m_A: Array


Place = tuple[float | Array, float | Array]
NO_PLACE: Place = (0.0, 0.0)
"""Place of a motor on a bench, and of a robot whose place is not known."""


class Driveline:
    """The motors of a robot with its effects. All methods are pure: the caller keeps the state of a lag."""

    def __init__(self, model: RobotModel, motors: Sequence[MotorModel]) -> None:
        self.resistance_ohm = _along_wheels([motor.resistance_ohm for motor in motors])
        self.torque_constant_N_m_A = _along_wheels([motor.torque_constant_N_m_A for motor in motors])
        self.viscous_N_m_s_rad = _along_wheels([motor.viscous_N_m_s_rad for motor in motors])
        self.coulomb_N_m = _along_wheels([motor.coulomb_N_m for motor in motors])
        self.inertia_kg_m2 = _along_wheels([motor.inertia_kg_m2 for motor in motors])
        self.damping_N_m_s_rad = _along_wheels([motor.damping_N_m_s_rad for motor in motors])
        self.full_supply_V: float | Array = model.config.power.battery_voltage_V
        """Voltage of the supply without load, before a battery runs down."""
        self._actuator = model.functions(Slot.ACTUATOR)
        self._battery = model.functions(Slot.BATTERY)
        self._conduction = model.functions(Slot.CONDUCTION)
        self._bridge = model.functions(Slot.BRIDGE)
        self._supply = model.functions(Slot.SUPPLY)
        self._resistance = model.functions(Slot.RESISTANCE)
        self._constant = model.functions(Slot.TORQUE_CONSTANT)
        self._heating = model.functions(Slot.WINDING_HEAT)
        self._limit = model.functions(Slot.CURRENT_LIMIT)
        self._friction = model.functions(Slot.FRICTION)
        self._bare_winding = Winding(self.resistance_ohm, self.torque_constant_N_m_A)
        self._shaft_torque = model.functions(Slot.SHAFT_TORQUE)

    @classmethod
    def of_robot(cls, model: RobotModel) -> "Driveline":
        """Return the driveline of both motors, right and left."""
        return cls(model, (model.motors.right, model.motors.left))

    @classmethod
    def for_bench(cls, model: RobotModel) -> "Driveline":
        """Return the driveline of the right motor alone, as on a bench."""
        return cls(model, (model.motors.right,))

    @cached_property
    def lags(self) -> bool:
        """Whether the voltage depends on its own past."""
        return bool(self._actuator)

    @cached_property
    def adds_torque(self) -> bool:
        """Whether effects can change the torque of the bare windings."""
        in_circuit = self._conduction or self._bridge or self._supply or self._limit
        return bool(in_circuit or self._resistance or self._constant or self._heating)

    @cached_property
    def heats(self) -> bool:
        """Whether the resistance depends on the past voltage."""
        return bool(self._heating)

    @cached_property
    def may_coast(self) -> bool:
        """Whether the bridge may drive a motor faster than the mean voltage would."""
        return bool(self._conduction)

    @cached_property
    def needs_angle(self) -> bool:
        """Whether the torque depends on the angle of the shaft."""
        return bool(self._shaft_torque)

    @cached_property
    def needs_place(self) -> bool:
        """Whether friction may depend on the place on the floor."""
        return bool(self._friction)

    @cached_property
    def is_bare(self) -> bool:
        """Whether torque and friction are those of the bare motors, at any angle, speed and time."""
        return not (self.adds_torque or self._friction or self._shaft_torque)

    def voltage_V(
        self, held_V: Array, command_V: Array, time_s: float | Array, duration_s: float
    ) -> tuple[Array, Array]:
        """Return the state of a lag after `duration_s`, and the voltage at the motors."""
        held_V = self.held_V(held_V, command_V, duration_s)
        return held_V, self.battery_voltage_V(held_V, time_s)

    def held_V(self, held_V: Array, command_V: Array, duration_s: float | Array) -> Array:
        """Return the state of a lag after `duration_s`; the command if nothing lags."""
        for lag in self._actuator:
            held_V = lag(held_V, command_V, duration_s)
        return held_V if self._actuator else command_V

    def battery_voltage_V(self, voltage_V: Array, time_s: float | Array) -> Array:
        """Return the part of a voltage that reaches the motors from a battery that runs down."""
        return applied(self._battery, voltage_V, time_s)

    def supply_V(self, time_s: float | Array) -> float | Array:
        """Return the voltage of the supply without load, of a battery that runs down."""
        return applied(self._battery, self.full_supply_V, time_s)

    def lagged_V(self, held_V: Array, command_V: Array, duration_s: float | Array) -> tuple[Array, Array]:
        """Return the state of a lag after `duration_s`, and the constant voltage that brings a bare motor to the same
        speed; both before the battery.
        """
        if not self._actuator:
            return command_V, command_V
        # A bare motor weighs the voltage at a time by exp(-decay * time left), so that its speed at the end is that of
        # a weighted mean. A lag may have any form, so the mean is a quadrature.
        (lag,) = self._actuator
        decay_1_s = self.damping_N_m_s_rad / np.maximum(self.inertia_kg_m2, MIN_INERTIA_KG_M2)
        weighed, weights = np.zeros(()), np.zeros(())
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            left = weight * np.exp(-decay_1_s * (NODES[-1] - node) * duration_s)
            weighed = weighed + left * (lag(held_V, command_V, node * duration_s) - command_V)
            weights = weights + left
        return lag(held_V, command_V, duration_s), command_V + weighed / weights

    def winding(self, time_s: float | Array, heat: float | Array) -> Winding:
        """Return the windings at a time.

        Args:
            time_s: Time since the motors were first switched on.
            heat: Share by which heat has raised the resistance (`heat_after`).
        """
        if not (self._resistance or self._constant or self._heating):
            return self._bare_winding
        resistance = applied(self._resistance, self.resistance_ohm, time_s)
        resistance = resistance * np.maximum(1.0 + heat, MIN_WARM) if self._heating else resistance
        return Winding(resistance, applied(self._constant, self.torque_constant_N_m_A, time_s))

    def heat_after(self, heat: float | Array, voltage_V: Array, duration_s: float | Array) -> float | Array:
        """Return the share by which heat has raised the resistance after a period at constant voltage."""
        return applied(self._heating, heat, voltage_V, duration_s)

    def current_A(self, voltage_V: Array, speed_rad_s: Array, supply_V: float | Array, winding: Winding) -> Array:
        """Return the winding currents.

        Args:
            voltage_V: Mean voltages that the bridge would give from a supply without load, duty * supply.
            speed_rad_s: Speeds.
            supply_V: Voltage of that supply at this time.
            winding: The windings at this time.
        """
        back_emf_V = winding.torque_constant_N_m_A * speed_rad_s
        return self._current_A(voltage_V, back_emf_V, voltage_V - back_emf_V, supply_V, winding)

    def _current_A(
        self, voltage_V: Array, back_emf_V: Array, emf_V: Array, supply_V: float | Array, winding: Winding
    ) -> Array:
        """Return the same with K w and u - K w."""
        if not (self._conduction or self._supply):
            return applied(self._limit, applied(self._bridge, emf_V) / winding.resistance_ohm)
        # An empty battery switches nothing.
        duty = np.divide(voltage_V, supply_V, out=np.zeros(emf_V.shape), where=np.asarray(supply_V) > 0.0)
        chopper = Chopper(supply_V, duty, winding.resistance_ohm, back_emf_V)

        def driving_V(emf_V: Array) -> Array:
            return applied(self._bridge, applied(self._conduction, emf_V, chopper))

        bridge = Bridge(supply_V, duty, winding.resistance_ohm, driving_V)
        current_A = self._supply[0](emf_V, bridge) if self._supply else bridge.current_A(emf_V)
        return applied(self._limit, current_A)

    def extra_torque_N_m(
        self, voltage_V: Array, speed_rad_s: Array, supply_V: float | Array, winding: Winding
    ) -> Array:
        """Return the torque that effects add to that of the bare winding; arguments are those of `current_A`."""
        if not self.adds_torque:
            return np.zeros_like(speed_rad_s)
        back_emf_V = self.torque_constant_N_m_A * speed_rad_s
        emf_V = voltage_V - back_emf_V
        bare_A = emf_V / self.resistance_ohm
        if winding is self._bare_winding:
            current_A = self._current_A(voltage_V, back_emf_V, emf_V, supply_V, winding)
        else:
            current_A = self.current_A(voltage_V, speed_rad_s, supply_V, winding)
        extra = self.torque_constant_N_m_A * (current_A - bare_A)
        if not self._constant:
            return extra
        return extra + (winding.torque_constant_N_m_A - self.torque_constant_N_m_A) * current_A

    def stall_torque_N_m(self, voltage_V: Array) -> Array:
        """Return the torque of the bare windings at rest."""
        return self.torque_constant_N_m_A * voltage_V / self.resistance_ohm

    def shaft_torque_N_m(self, torque_N_m: Array, angle_rad: Array, turned_rad: Array) -> Array:
        """Return the mean torque on the shafts without friction, over turns that begin at their angles.

        Args:
            torque_N_m: Torque of the windings.
            angle_rad: Angles since the start.
            turned_rad: Turns.
        """
        return applied(self._shaft_torque, torque_N_m, angle_rad, turned_rad)

    def friction_N_m(
        self,
        torque_N_m: Array,
        speed_rad_s: Array,
        time_s: float | Array,
        trend: float | Array,
        place_m: Place = NO_PLACE,
    ) -> Array:
        """Return the dry friction against the motion; at rest the largest torque that it can hold.

        Without an effect on friction this is the motors' constant, to be broadcast.

        Args:
            torque_N_m: Torque without friction.
            speed_rad_s: Speeds.
            time_s: Time since the motors were first switched on.
            trend: Whether the size of the commanded voltage last grew (`voltage_trend`).
            place_m: x and y of the robot in W.
        """
        if not self._friction:
            return self.coulomb_N_m
        turns = np.count_nonzero(speed_rad_s) == speed_rad_s.size
        direction = np.sign(speed_rad_s if turns else np.where(speed_rad_s == 0.0, torque_N_m, speed_rad_s))
        motion = ShaftMotion(direction, speed_rad_s, time_s, trend, *place_m)
        return applied(self._friction, self.coulomb_N_m, motion)


def _along_wheels(values: Sequence[float | Array]) -> Array:
    """Return one number per motor along a last axis; those of many robots are (M, ..., 1) or (M, ..., wheels) each."""
    each_shape = np.broadcast_shapes((1,), *(np.shape(value) for value in values))
    numbers = (np.broadcast_to(value, each_shape) for value in values)
    return np.stack([number[..., min(k, each_shape[-1] - 1)] for k, number in enumerate(numbers)], axis=-1)
