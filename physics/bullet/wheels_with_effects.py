"""Effects that act on the wheels at every step of the engine, for robots that have such effects.

The engine computes the linear part, damping and stall torque. Effects add a torque, change the limit of the dry
friction, delay commands, lose counts and move the body over the floor; each adds exactly nothing at its null value.
"""

from collections import deque
from math import cos, sin

import numpy as np
import pybullet

from configs.effects.base import Slot
from physics.drivetrain.driveline import Driveline
from physics.drivetrain.wheel_slip import WheelSlip
from physics.robot.floor_place import FloorPlace
from physics.robot.model import RobotModel, applied
from symolo.core.arrays import Array

REST_RAD_S = 1e-4
"""Speed below which a wheel is at rest; the solver leaves 5e-9 rad/s."""


class WheelsWithEffects:
    """State of effects that act on both wheels of a robot in PyBullet, from step to step."""

    def __init__(self, model: RobotModel, physics_hz: int, rng: np.random.Generator) -> None:
        model.require_rigid_gears("PyBullet")
        self._driveline = Driveline.of_robot(model)
        self._period_s = 1.0 / physics_hz
        self._delay_steps = round(model.input_delay_s * physics_hz)
        self._counting = model.functions(Slot.COUNTING)
        self._rolling = model.functions(Slot.ROLLING)
        self._slip = WheelSlip(model, rng)
        self._creep = model.functions(Slot.CREEP)
        self._ground = model.functions(Slot.GROUND)
        self._travel = model.functions(Slot.TRAVEL)
        self._turning = model.functions(Slot.TURNING)
        self._place = FloorPlace(0.0, 0.0, 0.0)
        self._geometry = model.geometry
        self._coming: deque[tuple[int, Array]] = deque()
        self._command_V = self._held_V = self._voltage_V = np.zeros(2)
        self._trend = np.ones(2)
        self._heat: float | Array = 0.0
        self._winding = self._driveline.winding(0.0, self._heat)
        self._supply_V = self._driveline.full_supply_V
        self._angles: Array | None = None
        self._friction_N_m = self._wanted_friction_N_m = self._driveline.coulomb_N_m
        self.lost_rad = np.zeros(2)
        """Angles, right and left, that the encoders have not counted."""
        self.yaw_share = 1.0
        """Yaw rate of the body as a share of that of the wheels."""
        self._ahead_m_s = self._turning_rad_s = 0.0
        self._creep_m_s = np.zeros(2)

    def command(self, step: int, voltages_V: tuple[float, float]) -> None:
        self._coming.append((step + self._delay_steps, np.array(voltages_V)))

    @property
    def needs_place(self) -> bool:
        """Whether an effect may depend on the place of the robot."""
        return bool(self._driveline.needs_place or self._travel or self._turning)

    def torques_N_m(
        self, step: int, angles_rad: Array, speeds_rad_s: Array, place_m: tuple[float, float] = (0.0, 0.0)
    ) -> list[float]:
        """Return the driving torques, right and left [N m], for this step; call `friction_to_set` after it.

        Args:
            step: Number of the step.
            angles_rad: Angles of the wheels, right and left.
            speeds_rad_s: Their speeds.
            place_m: x and y of the middle of the axle in W; not used without `needs_place`.
        """
        while self._coming and self._coming[0][0] <= step:
            command_V = self._coming.popleft()[1]
            grown_V = np.abs(command_V) - np.abs(self._command_V)
            self._trend = np.where(grown_V == 0.0, self._trend, np.sign(grown_V))
            self._command_V = command_V
        self._count(angles_rad)
        driveline, time_s = self._driveline, step * self._period_s
        x_m, y_m = place_m
        self._place = FloorPlace(np.array([x_m]), np.array([y_m]), time_s)
        self._held_V, voltage_V = driveline.voltage_V(self._held_V, self._command_V, time_s, self._period_s)
        self._voltage_V, self._supply_V = voltage_V, driveline.supply_V(time_s)
        self._winding = driveline.winding(time_s, self._heat)
        self._heat = driveline.heat_after(self._heat, voltage_V, self._period_s)
        extra = driveline.extra_torque_N_m(voltage_V, speeds_rad_s, self._supply_V, self._winding)
        torque = driveline.stall_torque_N_m(voltage_V) + extra
        torque = driveline.shaft_torque_N_m(torque, angles_rad, speeds_rad_s * self._period_s)
        # The solver leaves a tiny speed on a wheel that sticks; its sign must not decide the direction of friction.
        at_rest = np.where(np.abs(speeds_rad_s) < REST_RAD_S, 0.0, speeds_rad_s)
        self._wanted_friction_N_m = driveline.friction_N_m(
            torque, at_rest, time_s, self._trend, (self._place.x_m, self._place.y_m)
        )
        return torque.tolist()

    def friction_to_set(self) -> list[float] | None:
        """Return the limits of the dry friction, right and left [N m], or None if they have not changed."""
        if np.array_equal(self._wanted_friction_N_m, self._friction_N_m):
            return None
        self._friction_N_m = self._wanted_friction_N_m
        return self._friction_N_m.tolist()

    def _count(self, angles_rad: Array) -> None:
        if self._counting and self._angles is not None:
            turned = angles_rad - self._angles
            self.lost_rad = self.lost_rad + (turned - applied(self._counting, turned, self._period_s))
        self._angles = angles_rad

    def currents_A(self, speeds_rad_s: Array) -> tuple[float, float]:
        current_A = self._driveline.current_A(self._voltage_V, speeds_rad_s, self._supply_V, self._winding)
        right, left = current_A.tolist()
        return right, left

    @property
    def slides(self) -> bool:
        """Whether the body moves otherwise than by the rolling of round wheels."""
        return bool(self._rolling or self._travel or self._slip or self._creep)

    def slid(self, yaw_rad: float) -> tuple[float, float]:
        """Return forward speed [m/s] and yaw rate [rad/s] of the body that its wheels in the engine do not have."""
        creep_m_s = self._creep_m_s[0] * cos(yaw_rad) + self._creep_m_s[1] * sin(yaw_rad)
        return self._ahead_m_s + float(creep_m_s), self._turning_rad_s

    def move_over_floor(self, client: int, body: int, to_axle: tuple[float, float, float], speeds_rad_s: Array) -> None:
        """Turn and move the body, about the middle of the axle, as the effects change its last step.

        Bullet's contacts hold a round wheel that rolls without any slip, so that a force cannot do this.
        """
        if not (self._ground or self._turning or self.slides):
            return
        round_right_m_s = self._geometry.right_radius_m * speeds_rad_s[0]
        round_left_m_s = self._geometry.left_radius_m * speeds_rad_s[1]
        right_m_s, left_m_s = round_right_m_s, round_left_m_s
        if self._rolling and self._angles is not None:
            turned = speeds_rad_s * self._period_s
            share = applied(self._rolling, np.ones(2), self._angles + 0.5 * turned, turned)
            right_m_s, left_m_s = share[0] * right_m_s, share[1] * left_m_s
        if self._travel:
            share = applied(self._travel, np.ones(2), self._place)
            right_m_s, left_m_s = share[0] * right_m_s, share[1] * left_m_s
        if self._slip:
            share = self._slip.travelled(self._period_s * np.array([right_m_s, left_m_s]))
            right_m_s, left_m_s = share[0] * right_m_s, share[1] * left_m_s
        yaw_rate = (right_m_s - left_m_s) / self._geometry.track_m
        self.yaw_share = float(applied(self._ground, 1.0, 0.5 * (right_m_s + left_m_s), yaw_rate))
        if self._turning:
            self.yaw_share *= float(applied(self._turning, np.ones(1), self._place)[0])
        more_rad_s = float(yaw_rate - (round_right_m_s - round_left_m_s) / self._geometry.track_m)
        self._ahead_m_s = float(0.5 * (right_m_s - round_right_m_s + left_m_s - round_left_m_s))
        self._turning_rad_s = self.yaw_share * more_rad_s
        sizes_m_s = (0.5 * (abs(right_m_s) + abs(left_m_s)), 0.5 * abs(right_m_s + left_m_s))
        self._creep_m_s = applied(self._creep, np.zeros(2), *(np.array([size]) for size in sizes_m_s))
        turn = (more_rad_s - (1.0 - self.yaw_share) * float(yaw_rate)) * self._period_s
        if turn != 0.0:
            _turn_about_axle(client, body, to_axle, turn)
        if self._ahead_m_s or self._creep_m_s.any():
            _shift(client, body, self._ahead_m_s * self._period_s, self._creep_m_s * self._period_s)


def _shift(client: int, body: int, ahead_m: float, creep_m: Array) -> None:
    """Move a body ahead along its heading, and by x, y [m] in W."""
    position, quaternion = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    velocity, spin = pybullet.getBaseVelocity(body, physicsClientId=client)
    r = pybullet.getMatrixFromQuaternion(quaternion)
    moved = [position[0] + r[0] * ahead_m + creep_m[0], position[1] + r[3] * ahead_m + creep_m[1], position[2]]
    pybullet.resetBasePositionAndOrientation(body, moved, quaternion, physicsClientId=client)
    pybullet.resetBaseVelocity(body, velocity, spin, physicsClientId=client)


def _turn_about_axle(client: int, body: int, to_axle: tuple[float, float, float], turn_rad: float) -> None:
    position, quaternion = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
    velocity, spin = pybullet.getBaseVelocity(body, physicsClientId=client)
    r = pybullet.getMatrixFromQuaternion(quaternion)
    a, _, h = to_axle
    # From the middle of the axle to the centre of mass, level.
    x, y = -(r[0] * a + r[2] * h), -(r[3] * a + r[5] * h)
    c, s = cos(turn_rad), sin(turn_rad)
    moved = [position[0] + (c - 1.0) * x - s * y, position[1] + s * x + (c - 1.0) * y, position[2]]
    half = [0.0, 0.0, sin(0.5 * turn_rad), cos(0.5 * turn_rad)]
    _, turned = pybullet.multiplyTransforms([0, 0, 0], half, [0, 0, 0], quaternion)
    pybullet.resetBasePositionAndOrientation(body, moved, turned, physicsClientId=client)
    swung = [c * velocity[0] - s * velocity[1], s * velocity[0] + c * velocity[1], velocity[2]]
    pybullet.resetBaseVelocity(body, swung, spin, physicsClientId=client)


def needs_every_step(model: RobotModel) -> bool:
    """Return whether an effect of this robot acts at every step, beyond numbers that the engine receives once."""
    slots = (Slot.ACTUATOR, Slot.BATTERY, Slot.CONDUCTION, Slot.BRIDGE, Slot.SUPPLY, Slot.CURRENT_LIMIT)
    slots += (Slot.RESISTANCE, Slot.TORQUE_CONSTANT, Slot.WINDING_HEAT)
    slots += (Slot.FRICTION, Slot.SHAFT_TORQUE, Slot.COMMAND_DELAY, Slot.COUNTING)
    # The gearbox cannot act at all; it is listed so that its play is refused.
    slots += (Slot.ROLLING, Slot.TRAVEL, Slot.SLIP, Slot.CREEP, Slot.GROUND, Slot.TURNING, Slot.GEARBOX)
    return any(model.functions(slot) for slot in slots)
