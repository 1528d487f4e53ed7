"""The robot's own body as simple shapes in R; it throws shadows and is mirrored but is never seen by its camera."""

from blender_scenes.description import Mesh
from blender_scenes.geometry import block, wheel
from blender_scenes.materials.fittings import bare_metal, moulded
from blender_scenes.shading import Surface
from configs.schema.robot import RobotConfig


def robot_surfaces() -> tuple[Surface, ...]:
    return (
        moulded("robot_plate", (0.03, 0.03, 0.035), 0.4),
        moulded("robot_rubber", (0.02, 0.02, 0.02), 0.8),
        moulded("robot_board", (0.02, 0.08, 0.03), 0.4),
        moulded("robot_battery", (0.05, 0.10, 0.35), 0.5),
        bare_metal("robot_steel", (0.6, 0.58, 0.55), 0.3),
    )


def robot_body(robot: RobotConfig) -> tuple[Mesh, ...]:
    """Base plate, wheels, caster, battery, sensor boards, mast and camera, at the places of the configuration."""
    chassis, drive, camera = robot.chassis, robot.drive, robot.camera
    radius, plate_z = 0.5 * drive.wheel_diameter_m, chassis.base_height_m
    camera_z = plate_z + camera.height_above_base_m
    inner_width = max(0.02, min(chassis.width_m, drive.track_m - drive.wheel_width_m - 0.006))
    meshes = [
        _block("plate", (0, 0, plate_z - 0.002), (chassis.length_m, inner_width, 0.004), "robot_plate"),
        _block("motors", (0, 0, radius), (0.025, inner_width, 0.022), "robot_steel"),
        _block("battery", (-0.25 * chassis.length_m, 0, plate_z + 0.012), (0.075, 0.04, 0.022), "robot_battery"),
        _block(
            "mast",
            (camera.x_m - 0.012, camera.y_m, 0.5 * (plate_z + camera_z)),
            (0.006, 0.02, camera_z - plate_z),
            "robot_plate",
        ),
        _block("camera", (camera.x_m - 0.005, camera.y_m, camera_z), (0.012, 0.03, 0.026), "robot_board"),
    ]
    for name, side in (("left", 0.5), ("right", -0.5)):
        center = (0.0, side * drive.track_m, radius)
        meshes.append(_wheel(f"wheel_{name}", center, radius, drive.wheel_width_m, "robot_rubber"))
        hub = (0.0, side * drive.track_m, radius)
        meshes.append(_wheel(f"hub_{name}", hub, 0.7 * radius, drive.wheel_width_m + 0.001, "robot_battery"))
    caster = (drive.caster_x_m, 0.0, drive.caster_radius_m)
    meshes.append(_wheel("caster", caster, drive.caster_radius_m, 0.012, "robot_steel"))
    line = robot.line_sensor
    row = (line.channels - 1) * line.pitch_m + 0.008
    meshes.append(_block("line_sensor", (line.x_m, 0, line.height_m + 0.003), (0.02, row, 0.004), "robot_board"))
    bracket = (line.x_m - 0.008, 0, 0.5 * (line.height_m + plate_z))
    meshes.append(_block("bracket", bracket, (0.003, 0.03, plate_z - line.height_m), "robot_plate"))
    for name in ("front", "left", "right"):
        mount = getattr(robot.tof.mounts, name)
        meshes.append(
            _block(f"tof_{name}", (mount.x_m - 0.003, mount.y_m, mount.z_m), (0.004, 0.018, 0.012), "robot_board")
        )
    return tuple(meshes)


def _block(name: str, center: tuple[float, float, float], size: tuple[float, float, float], surface: str) -> Mesh:
    return block(f"robot_{name}", center, size, surface, seen_by_camera=False)


def _wheel(name: str, center: tuple[float, float, float], radius: float, length: float, surface: str) -> Mesh:
    return wheel(f"robot_{name}", center, radius, length, surface, seen_by_camera=False)
