"""The robot's body in a PyBullet client: links from its URDF, contacts, rotor inertia, stick-slip friction."""

from math import cos, sin

import numpy as np
import pybullet

from configs.schema.robot import RobotConfig
from physics.bullet.world import BOXES, CHASSIS, FLOOR, TREADS
from physics.drivetrain.motor import MotorModel
from physics.robot.links import CASTER, LEFT_WHEEL, RIGHT_WHEEL
from physics.robot.model import RobotModel
from physics.robot.urdf import robot_urdf
from symolo.arena.mesh import unpacked
from symolo.core.files.scratch_folders import scratch_folder
from symolo.core.geometry.poses import PlanarPose

_BODY_FILE = "body.obj"
MAX_JOINT_SPEED_RAD_S = 1000.0
"""Limit of joint speeds; Bullet's default of 100 rad/s is too low."""


def add_robot(client: int, robot: RobotConfig, start: PlanarPose, step_s: float) -> tuple[int, list[int]]:
    """Put the robot on the floor at x [m], y [m], yaw [rad]; return its body id and wheel joints, right and left.

    Args:
        client: The PyBullet client.
        robot: The robot.
        start: Pose of the robot.
        step_s: Duration of a physics step.
    """
    body = _load(client, robot, start)
    pybullet.changeDynamics(
        body,
        -1,
        linearDamping=0.0,
        angularDamping=0.0,
        restitution=0.0,
        maxJointVelocity=MAX_JOINT_SPEED_RAD_S,
        physicsClientId=client,
    )
    pybullet.setCollisionFilterGroupMask(body, -1, CHASSIS, BOXES, physicsClientId=client)
    links = _links(client, body)
    wheels = [links[RIGHT_WHEEL], links[LEFT_WHEEL]]
    motors = RobotModel.from_config(robot).motors
    for wheel, motor in zip(wheels, (motors.right, motors.left), strict=True):
        _tread(client, body, wheel, robot.drive.wheel_friction)
        _motor(client, body, wheel, motor, step_s)
    _tread(client, body, links[CASTER], robot.drive.caster_friction)
    return body, wheels


def _load(client: int, robot: RobotConfig, start: PlanarPose) -> int:
    x, y, yaw = start
    with scratch_folder() as folder:
        path = folder / "robot.urdf"
        shape = _body_text(robot)
        path.write_text(robot_urdf(robot, _BODY_FILE if shape else ""), encoding="utf-8")
        if shape:
            (folder / _BODY_FILE).write_text(shape, encoding="utf-8")
        body = pybullet.loadURDF(
            str(path),
            basePosition=[x, y, 0.0],
            baseOrientation=[0.0, 0.0, sin(0.5 * yaw), cos(0.5 * yaw)],
            # Without the flag PyBullet makes up inertias from the collision shapes.
            flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
            physicsClientId=client,
        )
    return int(body)


def _body_text(robot: RobotConfig) -> str:
    """Return the body as an OBJ file, of which the engine takes the convex hull; empty for a body that is a box."""
    if robot.body is None:
        return ""
    mesh = unpacked(robot.body.mesh.packed)
    origin = np.array([robot.body.x_m, 0.0, robot.body.z_m])
    vertices = (mesh.vertices + origin).tolist()
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices]
    lines += [f"f {i + 1} {j + 1} {k + 1}" for i, j, k in mesh.triangles.tolist()]
    return "\n".join(lines) + "\n"


def _links(client: int, body: int) -> dict[str, int]:
    joints = range(pybullet.getNumJoints(body, physicsClientId=client))
    return {pybullet.getJointInfo(body, joint, physicsClientId=client)[12].decode(): joint for joint in joints}


def _tread(client: int, body: int, link: int, friction: float) -> None:
    pybullet.changeDynamics(body, link, lateralFriction=friction, restitution=0.0, physicsClientId=client)
    pybullet.setCollisionFilterGroupMask(body, link, TREADS, FLOOR, physicsClientId=client)


def _motor(client: int, body: int, wheel: int, motor: MotorModel, step_s: float) -> None:
    # URDF cannot express a reflected rotor, and no rigid body has so much inertia about one axis alone.
    across, spin, _ = pybullet.getDynamicsInfo(body, wheel, physicsClientId=client)[2]
    # The engine computes the damping from the speed before a step. A wheel whose time constant is below half a step
    # would therefore overshoot more at each step. With this inertia it settles in one step, at the same speed.
    settles_in_a_step = step_s * motor.damping_N_m_s_rad
    inertia = [across, max(spin + motor.inertia_kg_m2, settles_in_a_step), across]
    pybullet.changeDynamics(body, wheel, localInertiaDiagonal=inertia, physicsClientId=client)
    # A velocity motor with set point 0 and limited force is Coulomb friction: the solver brakes with at most that
    # torque and holds the wheel at rest below it.
    pybullet.setJointMotorControl2(
        body,
        wheel,
        pybullet.VELOCITY_CONTROL,
        targetVelocity=0.0,
        force=motor.coulomb_N_m,
        physicsClientId=client,
    )
