"""The robot's body as simple shapes in R: it has shadows and mirror images, and its camera may see it."""

import math
from collections.abc import Iterator

import numpy as np

from blender_scenes.materials.fittings import bare_metal, moulded
from blender_scenes.scene.description import Mesh
from blender_scenes.scene.meshes import block, mesh_of_triangles, wheel
from blender_scenes.scene.shading import Surface
from configs.schema.robot import Chassis, Drive, RobotBody, RobotConfig, TofMounts
from symolo.arena.mesh import unpacked

CAMERA_BODY = "robot_camera"
"""Name of the camera's body, which the camera never sees."""
_THINNEST_M = 0.002
_DRAWN_LENGTH_M = 0.18
"""Length of the robot for which the sizes of motors, battery, boards and posts are; others have them in proportion."""


def robot_surfaces(robot: RobotConfig) -> tuple[Surface, ...]:
    body_surfaces = (moulded("robot_body", robot.body.color, 0.5),) if robot.body else ()
    return (
        *body_surfaces,
        moulded("robot_plate", (0.03, 0.03, 0.035), 0.4),
        moulded("robot_rubber", (0.02, 0.02, 0.02), 0.8),
        moulded("robot_board", (0.02, 0.08, 0.03), 0.4),
        moulded("robot_battery", (0.05, 0.10, 0.35), 0.5),
        bare_metal("robot_steel", (0.6, 0.58, 0.55), 0.3),
    )


def robot_body(robot: RobotConfig) -> tuple[Mesh, ...]:
    """Return base plate, drive, battery, sensor boards, mast and camera, at their configured places."""
    chassis = _chassis(robot.chassis, robot.drive) if robot.body is None else (_body_of(robot.body),)
    return (*chassis, *_wheels(robot.drive), *_sensors(robot))


def _body_of(body: RobotBody) -> Mesh:
    return mesh_of_triangles(
        "robot_body", unpacked(body.mesh.packed), np.eye(3), (body.x_m, 0.0, body.z_m), "robot_body"
    )


def _chassis(chassis: Chassis, drive: Drive) -> Iterator[Mesh]:
    top = chassis.base_height_m
    between_wheels = max(0.02, min(chassis.width_m, drive.track_m - drive.wheel_width_m - 0.006))
    yield block("robot_plate", (0.0, 0.0, top - 0.002), (chassis.length_m, between_wheels, 0.004), "robot_plate")
    motors_z = 0.5 * drive.wheel_diameter_m
    size = chassis.length_m / _DRAWN_LENGTH_M
    yield block("robot_motors", (0.0, 0.0, motors_z), (0.025 * size, between_wheels, 0.022 * size), "robot_steel")
    battery = (-0.25 * chassis.length_m, 0.0, top + 0.011 * size)
    yield block("robot_battery", battery, (0.4 * chassis.length_m, 0.04 * size, 0.022 * size), "robot_battery")


def _wheels(drive: Drive) -> Iterator[Mesh]:
    radius = 0.5 * drive.wheel_diameter_m
    for name, side in (("left", 0.5), ("right", -0.5)):
        center = (0.0, side * drive.track_m, radius)
        yield wheel(f"robot_tyre_{name}", center, radius, drive.wheel_width_m, "robot_rubber")
        yield wheel(f"robot_hub_{name}", center, 0.7 * radius, drive.wheel_width_m + 0.001, "robot_battery")
    caster = (drive.caster_x_m, 0.0, drive.caster_radius_m)
    yield wheel("robot_caster", caster, drive.caster_radius_m, 0.012, "robot_steel")


def _sensors(robot: RobotConfig) -> Iterator[Mesh]:
    line, camera, top = robot.line_sensor, robot.camera, robot.chassis.base_height_m
    row = (line.channels - 1) * line.pitch_m + 0.008
    yield block("robot_line_sensor", (line.x_m, 0.0, line.height_m + 0.002), (0.02, row, 0.004), "robot_board")
    yield _post("robot_bracket", line.x_m - 0.008, 0.0, (line.height_m, top - 0.002))  # up into the plate
    camera_z, yaw = top + camera.height_above_base_m, math.radians(camera.yaw_left_deg)
    (mast_x, mast_y), (body_x, body_y) = (
        (camera.x_m - behind * math.cos(yaw), camera.y_m - behind * math.sin(yaw)) for behind in (0.012, 0.005)
    )
    yield _post("robot_mast", mast_x, mast_y, (top, camera_z))
    yield block(CAMERA_BODY, (body_x, body_y, camera_z), (0.012, 0.03, 0.026), "robot_board")
    for name in TofMounts.model_fields:
        mount = getattr(robot.tof.mounts, name)
        at = (mount.x_m - 0.003, mount.y_m, mount.z_m)
        yield block(f"robot_tof_{name}", at, (0.004, 0.018, 0.012), "robot_board")
        yield _post(f"robot_tof_post_{name}", mount.x_m - 0.007, mount.y_m, (top, mount.z_m))


def _post(name: str, x_m: float, y_m: float, heights_m: tuple[float, float]) -> Mesh:
    """Return a post between two heights, in any order."""
    size = max(_THINNEST_M, abs(heights_m[1] - heights_m[0]))
    return block(name, (x_m, y_m, 0.5 * sum(heights_m)), (0.004, 0.02, size), "robot_plate")
