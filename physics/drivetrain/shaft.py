"""Rotor and gearbox of a motor on a bench, as one mass or as two with play between them."""

from math import ceil
from typing import NamedTuple, Protocol

import numpy as np

from configs.effects.base import Slot
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.held_rows import HeldPart
from physics.drivetrain.rigid_wheels import RigidWheels
from physics.drivetrain.two_mass import Load, TwoMass
from physics.robot.model import RobotModel
from symolo.core.arrays import Array

MAX_STEP_S, MAX_STEP_SHARE = 5e-3, 0.25
"""Longest step with play, in seconds and in time constants of the motor side; the sides meet or part once at most.
At 5 ms speeds are within 0.006 rad/s of those at 0.02 ms, for a motor of 60 ms and a gap of 0.05 rad."""


class ShaftState(NamedTuple):
    """Speeds and angles of both sides of a gearbox."""

    sides: TwoMass
    angle_rad: Array
    """Angle of the motor side since the start; 0 if no effect depends on it."""

    @classmethod
    def at_rest(cls, shape: tuple[int, ...]) -> "ShaftState":
        """Return the state at the start of trials, in mid-gap."""
        rest = np.zeros(shape)
        return cls(TwoMass(rest, rest, rest), rest)


class Shaft(Protocol):
    """A gearbox with or without play."""

    def moved(self, part: HeldPart, state: ShaftState) -> ShaftState:
        """Return the state after a period."""
        ...


def shaft_of(model: RobotModel, driveline: Driveline) -> Shaft:
    """Return the shaft of a robot, with play if the robot has any."""
    return BacklashShaft(model, driveline) if model.has_play else RigidShaft(driveline)


class RigidShaft:
    """A gearbox without play: one mass."""

    def __init__(self, driveline: Driveline) -> None:
        self._wheels = RigidWheels(driveline, needs_turn=False)
        self._needs_angle = driveline.needs_angle

    def moved(self, part: HeldPart, state: ShaftState) -> ShaftState:
        speed, turned = self._wheels.moved(part, state.sides.motor_rad_s, state.angle_rad)
        angle = state.angle_rad + turned if self._needs_angle else state.angle_rad
        return ShaftState(TwoMass(speed, speed, state.sides.slack_rad), angle)


class BacklashShaft:
    """A gearbox with play: motor side and load side are two masses."""

    def __init__(self, model: RobotModel, driveline: Driveline) -> None:
        self._driveline = driveline
        self._config = model.config.motor
        self._play = model.functions(Slot.GEARBOX)
        inertia, viscous = self._config.motor_side_inertia_fraction, driveline.viscous_N_m_s_rad
        self._inertias = inertia * driveline.inertia_kg_m2, (1.0 - inertia) * driveline.inertia_kg_m2
        share = self._config.motor_side_friction_fraction
        # The back-EMF acts on the rotor alone, viscous friction on both sides.
        winding = driveline.damping_N_m_s_rad - viscous
        self._dampings = winding + share * viscous, (1.0 - share) * viscous
        self._max_step_s = min(
            MAX_STEP_S, MAX_STEP_SHARE * float(np.min(self._inertias[0] / driveline.damping_N_m_s_rad))
        )

    def moved(self, part: HeldPart, state: ShaftState) -> ShaftState:
        substeps = max(1, ceil(float(np.max(part.duration_s)) / self._max_step_s - 1e-9))
        duration_s = part.duration_s / substeps
        for k in range(substeps):
            state = self._step(part, state, part.begin_s + k * duration_s, duration_s)
        return state

    def _step(self, part: HeldPart, state: ShaftState, time_s: Array, duration_s: float | Array) -> ShaftState:
        driveline, sides = self._driveline, state.sides
        speed = sides.motor_rad_s
        torque = driveline.stall_torque_N_m(part.voltage_V)
        if driveline.adds_torque:
            winding = driveline.winding(time_s, part.heat)
            torque = torque + driveline.extra_torque_N_m(part.voltage_V, speed, part.supply_V, winding)
        torque = driveline.shaft_torque_N_m(torque, state.angle_rad, duration_s * speed)
        friction = driveline.friction_N_m(torque, speed, time_s, part.trend)
        share = self._config.motor_side_friction_fraction
        load_friction = (1.0 - share) * driveline.friction_N_m(torque, sides.load_rad_s, time_s, part.trend)
        motor_side = Load(torque, self._dampings[0], share * friction, self._inertias[0])
        load_side = Load(np.zeros_like(torque), self._dampings[1], load_friction, self._inertias[1])
        for play in self._play:
            sides = play(sides, motor_side, load_side, duration_s)
        turned = 0.5 * duration_s * (speed + sides.motor_rad_s) if driveline.needs_angle else 0.0
        return ShaftState(sides, state.angle_rad + turned)
