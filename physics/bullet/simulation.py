"""One robot in one arena, stepped by PyBullet, with the wheel-speed loop at a lower rate.

Back-EMF and viscous friction are linear in speed and are joint damping in the robot's URDF, so that a step needs only
the stall torque of the present voltages. Coulomb friction is the joint's velocity motor at zero speed with limited
force, which sticks truly. Both together are the paper's Eq. 18 and 20.

The rotor is part of the wheel's inertia, reflected through the gear. In the engine its acceleration would push the body
back with the geared torque and lift the wheels at a hard start, while the real rotor, behind the gear, hardly pushes at
all. The simulation therefore returns that torque to the body.
"""

from collections.abc import Sequence
from math import atan2, floor, pi

import numpy as np
import pybullet
from typing_extensions import Self

from configs.schema.robot import RobotConfig
from configs.schema.scenario import Rates
from physics.arena.rays import RayHits, RayScene
from physics.bullet.body import add_robot
from physics.bullet.moving_boxes import MovingBoxes
from physics.bullet.wheels_with_effects import WheelsWithEffects, needs_every_step
from physics.bullet.world import add_arena, connect
from physics.drivetrain.wheel_loop import WheelSpeedLoop, voltage_limit_V
from physics.robot.body_motion import BodyMotion, velocity_of_turn
from physics.robot.model import RobotModel
from symolo.arena.geometry import Arena
from symolo.core.arrays import Array
from symolo.core.geometry.poses import PlanarPose
from symolo.core.random_streams import stream

LIFT_M = 0.1
REACTION_PERIOD_S = 0.002
REACTION_SMOOTHING = 0.5
"""Period and smoothing of the torque that is returned to the body: it is known with a delay, and without smoothing a
heavy rotor would shake a light body."""


class BulletSimulation:
    """A PyBullet client, of which one process may have several. Close it, or use it as a context manager."""

    def __init__(
        self,
        robot: RobotConfig,
        arena: Arena,
        start: PlanarPose,
        rates: Rates,
        rng: np.random.Generator | None = None,
    ) -> None:
        """Build the world.

        Args:
            robot: The robot.
            arena: The arena.
            start: Pose of the robot at time 0.
            rates: Rates of physics and wheel loop.
            rng: Random numbers for slip of the wheels; a fixed stream if none is given.
        """
        self._rates = rates
        self._steps = 0
        model = RobotModel.from_config(robot)
        self._motors = model.motors
        rng = stream(0, "wheels") if rng is None else rng
        self._effects = WheelsWithEffects(model, rates.physics_hz, rng) if needs_every_step(model) else None
        self._limit_V = voltage_limit_V(robot.power)
        self._rad_to_counts = model.counts_per_revolution / (2.0 * pi)
        self._loops = tuple(
            WheelSpeedLoop(robot.wheel_loop, robot.encoder, robot.power, rates.wheel_loop_hz) for _ in range(2)
        )
        self._set_points: tuple[float, float] | None = (0.0, 0.0)
        self._voltages = (0.0, 0.0)
        self._volt_steps = np.zeros(2)
        """Sum of the voltages over the steps since the last mean, up to `_counted_until`."""
        self._mean_since = self._counted_until = 0
        self._torques = [0.0, 0.0]
        self._look_every = max(1, round(REACTION_PERIOD_S * rates.physics_hz))
        looks_hz = rates.physics_hz / self._look_every
        self._reaction_gain = REACTION_SMOOTHING * model.motors.right.inertia_kg_m2 * looks_hz
        self._reaction = [0.0, 0.0, 0.0]
        self._speed_sum = 0.0
        # The vector from the chassis' centre of mass, whose pose PyBullet reports, to the middle of the axle.
        chassis = robot.chassis
        self._axle_height_m = 0.5 * (model.geometry.right_radius_m + model.geometry.left_radius_m)
        self._to_axle = (-chassis.center_of_mass_x_m, 0.0, self._axle_height_m - chassis.center_of_mass_z_m)
        self._box_names = tuple(box.name for box in arena.boxes)
        self._touched: set[int] = set()
        self._pose_step = self._joints_step = -1
        self._rays = RayScene(arena)
        self._client = connect(rates.physics_hz)
        self._surface_of_body = add_arena(self._client, arena)
        self._movers = MovingBoxes.from_arena(self._client, arena, self._surface_of_body, rates.physics_hz)
        self._robot, self._wheels = add_robot(self._client, robot, start, 1.0 / rates.physics_hz)
        self._yaw = start[2]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def close(self) -> None:
        pybullet.disconnect(self._client)

    @property
    def steps(self) -> int:
        """Physics steps since the start."""
        return self._steps

    @property
    def time_s(self) -> float:
        return self._steps / self._rates.physics_hz

    def set_wheel_speeds(self, right_rad_s: float, left_rad_s: float) -> None:
        """Set the set points of the wheel loop, from its next update on."""
        if self._set_points is None:
            for loop, counts in zip(self._loops, self.encoder_counts(), strict=True):
                loop.restart(counts)
        self._set_points = (right_rad_s, left_rad_s)

    def set_voltages(self, right_V: float, left_V: float) -> None:
        """Apply voltages within the driver's limit without the wheel loop, until wheel speeds are set again."""
        self._set_points = None
        self._drive(right_V, left_V)

    def lift(self) -> None:
        """Hold the body LIFT_M above its place, so that the wheels turn in the air."""
        position, turn = pybullet.getBasePositionAndOrientation(self._robot, physicsClientId=self._client)
        above = [position[0], position[1], position[2] + LIFT_M]
        pybullet.resetBasePositionAndOrientation(self._robot, above, turn, physicsClientId=self._client)
        pybullet.createConstraint(
            self._robot, -1, -1, -1, pybullet.JOINT_FIXED, [0, 0, 0], [0, 0, 0], above, physicsClientId=self._client
        )

    def advance(self, steps: int) -> None:
        """Take a number of physics steps."""
        per_update = self._rates.physics_hz // self._rates.wheel_loop_hz
        end = self._steps + steps
        while self._steps < end:
            since_update = self._steps % per_update
            if since_update == 0:
                self._update()
            count = min(per_update - since_update, end - self._steps)
            if self._movers is not None:
                self._movers.place(self._steps)
                count = 1
            if self._effects is None:
                self._step(count)
            else:
                self._step_with(self._effects, count)
            self._steps += count

    def _step(self, count: int) -> None:
        """Take steps without effects: the innermost loop, about 3 us in addition to the engine's 20 us per step."""
        client, robot, wheels, torques = self._client, self._robot, self._wheels, self._torques
        read, step = pybullet.getJointStates, pybullet.stepSimulation
        drive, mode = pybullet.setJointMotorControlArray, pybullet.TORQUE_CONTROL
        push, frame = pybullet.applyExternalTorque, pybullet.LINK_FRAME
        gain, speed, reaction, look_every = self._reaction_gain, self._speed_sum, self._reaction, self._look_every
        for number in range(self._steps, self._steps + count):
            if number % look_every == 0:
                # If the wheel loop has just run, the states have been read already.
                right, left = self._wheel_states() if number == self._steps else read(robot, wheels, client)
                # Torque of the rotors on the wheels about y, J dw/dt of both, smoothed exponentially.
                reaction[1] += gain * (right[1] + left[1] - speed) - REACTION_SMOOTHING * reaction[1]
                speed = right[1] + left[1]
            push(robot, -1, reaction, frame, client)
            drive(robot, wheels, mode, forces=torques, physicsClientId=client)
            step(client)
        self._speed_sum = speed

    def _step_with(self, effects: WheelsWithEffects, count: int) -> None:
        """Take steps of a robot with effects that act at every step."""
        client, robot, wheels, reaction = self._client, self._robot, self._wheels, self._reaction
        for number in range(self._steps, self._steps + count):
            right, left = pybullet.getJointStates(robot, wheels, client)
            speeds = np.array((right[1], left[1]))
            if number % self._look_every == 0:
                speed = right[1] + left[1]
                reaction[1] += self._reaction_gain * (speed - self._speed_sum) - REACTION_SMOOTHING * reaction[1]
                self._speed_sum = speed
            place_m = self._place_m() if effects.needs_place else (0.0, 0.0)
            torques = effects.torques_N_m(number, np.array((right[0], left[0])), speeds, place_m)
            friction = effects.friction_to_set()
            if friction is not None:
                pybullet.setJointMotorControlArray(
                    robot,
                    wheels,
                    pybullet.VELOCITY_CONTROL,
                    targetVelocities=(0.0, 0.0),
                    forces=friction,
                    physicsClientId=client,
                )
            pybullet.applyExternalTorque(robot, -1, reaction, pybullet.LINK_FRAME, client)
            pybullet.setJointMotorControlArray(
                robot, wheels, pybullet.TORQUE_CONTROL, forces=torques, physicsClientId=client
            )
            pybullet.stepSimulation(client)
            effects.move_over_floor(client, robot, self._to_axle, speeds)

    def _update(self) -> None:
        """Update the loop, the contacts and the unwrapped yaw, once per wheel-loop period."""
        self._watch()
        if self._set_points is not None:
            right, left = self.encoder_counts()
            right_loop, left_loop = self._loops
            self._drive(right_loop.update(right, self._set_points[0]), left_loop.update(left, self._set_points[1]))

    def _drive(self, right_V: float, left_V: float) -> None:
        limit = self._limit_V
        right_V, left_V = min(max(right_V, -limit), limit), min(max(left_V, -limit), limit)
        self._count_voltages()
        self._voltages = (right_V, left_V)
        if self._effects is not None:
            self._effects.command(self._steps, self._voltages)
        motors = self._motors
        self._torques[:] = (motors.right.stall_torque_N_m(right_V), motors.left.stall_torque_N_m(left_V))

    def _watch(self) -> None:
        contacts = pybullet.getContactPoints(bodyA=self._robot, linkIndexA=-1, physicsClientId=self._client)
        # Bullet lists near pairs too; a contact has a distance of zero or less.
        self._touched.update(self._surface_of_body[contact[2]] - 1 for contact in contacts if contact[8] <= 0.0)
        self.pose()

    def pose(self) -> PlanarPose:
        """Return X_WR: x [m], y [m], yaw [rad, unwrapped] of the middle of the axle."""
        if self._pose_step != self._steps:
            self._pose_step, self._pose = self._steps, self._look()
        return self._pose

    def _look(self) -> tuple[float, float, float]:
        position, turn = pybullet.getBasePositionAndOrientation(self._robot, physicsClientId=self._client)
        r = pybullet.getMatrixFromQuaternion(turn)
        step = (atan2(r[3], r[0]) - self._yaw + pi) % (2.0 * pi) - pi
        self._yaw += step
        return *self._axle_at(position, r), self._yaw

    def _place_m(self) -> tuple[float, float]:
        """Return the place of the middle of the axle, without following its yaw."""
        position, turn = pybullet.getBasePositionAndOrientation(self._robot, physicsClientId=self._client)
        return self._axle_at(position, pybullet.getMatrixFromQuaternion(turn))

    def _axle_at(self, position: Sequence[float], r: Sequence[float]) -> tuple[float, float]:
        a, b, c = self._to_axle
        return position[0] + r[0] * a + r[1] * b + r[2] * c, position[1] + r[3] * a + r[4] * b + r[5] * c

    def twist(self) -> tuple[float, float]:
        """Return the forward speed [m/s] of the middle of the axle and the yaw rate [rad/s]."""
        velocity, spin = pybullet.getBaseVelocity(self._robot, physicsClientId=self._client)
        _, turn = pybullet.getBasePositionAndOrientation(self._robot, physicsClientId=self._client)
        r = pybullet.getMatrixFromQuaternion(turn)
        forward = velocity[0] * r[0] + velocity[1] * r[3] + velocity[2] * r[6]
        pitch_rate = spin[0] * r[1] + spin[1] * r[4] + spin[2] * r[7]
        yaw_share = 1.0 if self._effects is None else self._effects.yaw_share
        speed_m_s, yaw_rate_rad_s = forward + pitch_rate * self._to_axle[2], yaw_share * spin[2]
        if self._effects is None or not self._effects.slides:
            return speed_m_s, yaw_rate_rad_s
        slid_m_s, slid_rad_s = self._effects.slid(atan2(r[3], r[0]))
        return speed_m_s + slid_m_s, yaw_rate_rad_s + slid_rad_s

    def motion(self) -> BodyMotion:
        """Return the motion of the body in space, with what effects add to it."""
        position, turn = pybullet.getBasePositionAndOrientation(self._robot, physicsClientId=self._client)
        velocity, spin = pybullet.getBaseVelocity(self._robot, physicsClientId=self._client)
        R_WR = np.array(pybullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        to_axle, w_WR = R_WR @ self._to_axle, np.array(spin)
        v_WA = velocity + velocity_of_turn(w_WR, to_axle)
        if self._effects is not None:
            slid_m_s, slid_rad_s = self._effects.slid(atan2(R_WR[1, 0], R_WR[0, 0]))
            w_WR[2] = self._effects.yaw_share * w_WR[2] + slid_rad_s
            v_WA = v_WA + slid_m_s * R_WR[:, 0]
        to_floor = R_WR @ (0.0, 0.0, -self._axle_height_m)
        return BodyMotion(R_WR, position + to_axle + to_floor, v_WA + velocity_of_turn(w_WR, to_floor), w_WR)

    def _wheel_states(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the engine's joint states of both wheels: angle [rad], speed [rad/s] and more."""
        if self._joints_step != self._steps:
            self._joints_step = self._steps
            self._joints = pybullet.getJointStates(self._robot, self._wheels, self._client)
        return self._joints

    def wheel_angles(self) -> tuple[float, float]:
        """Return the angles [rad] of the wheels since the start, right and left, less what the encoders lost."""
        right, left = (state[0] for state in self._wheel_states())
        if self._effects is None:
            return right, left
        return right - float(self._effects.lost_rad[0]), left - float(self._effects.lost_rad[1])

    def encoder_counts(self) -> tuple[int, int]:
        """Return quadrature counts, right and left, since the start, which lies midway between two edges."""
        right, left = self.wheel_angles()
        return floor(right * self._rad_to_counts + 0.5), floor(left * self._rad_to_counts + 0.5)

    def wheel_speeds(self) -> tuple[float, float]:
        """Return the true wheel speeds, right and left [rad/s]."""
        right, left = self._wheel_states()
        return right[1], left[1]

    def voltages(self) -> tuple[float, float]:
        """Return the voltages commanded to the driver, right and left [V]; effects may change them at the motors."""
        return self._voltages

    def take_mean_voltages(self) -> tuple[float, float]:
        """Return the mean commanded voltages since the last call, right and left [V]."""
        self._count_voltages()
        steps = self._steps - self._mean_since
        right_V, left_V = (self._volt_steps / steps).tolist() if steps else self._voltages
        self._volt_steps[:] = 0.0
        self._mean_since = self._steps
        return right_V, left_V

    def _count_voltages(self) -> None:
        self._volt_steps += (self._steps - self._counted_until) * np.array(self._voltages)
        self._counted_until = self._steps

    def currents(self) -> tuple[float, float]:
        """Return the winding currents, right and left [A]."""
        right, left = self.wheel_speeds()
        if self._effects is not None:
            return self._effects.currents_A(np.array((right, left)))
        motors = self._motors
        return motors.right.current_A(self._voltages[0], right), motors.left.current_A(self._voltages[1], left)

    def cast(self, origins: Array, ends: Array, time_s: float | None = None) -> RayHits:
        """Cast rays from `origins` to `ends`, (N, 3) each, in W; they pass through the robot.

        Args:
            origins: Beginnings of the rays.
            ends: Ends of the rays.
            time_s: Time at which moving obstacles are placed; by default now.
        """
        return self._rays.cast(origins, ends, self.time_s if time_s is None else time_s)

    def touching(self) -> tuple[str, ...]:
        """Return the names of walls and obstacles touched now or at a wheel-loop update since the last call."""
        self._watch()
        names = tuple(self._box_names[index] for index in sorted(self._touched))
        self._touched.clear()
        return names
