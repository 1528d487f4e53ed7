"""The robot as URDF text, written from its configuration; the same text for the same numbers.

The base link's frame is R put down on the floor: x forward, y left, origin under the middle of the axle. The wheels
touch the floor in the middle of their treads, so that the track between the contact points is exactly the configured
one. The reflected rotor inertia is not in it: URDF has no word for it.
"""

from configs.schema.robot import RobotConfig
from physics.motor import MotorModel
from physics.robot_model import RobotModel

RIGHT_WHEEL, LEFT_WHEEL, CASTER = "right_wheel", "left_wheel", "caster"
CASTER_MASS_KG = 1e-3
"""Of the ball alone; the chassis carries the rest."""


def robot_urdf(robot: RobotConfig) -> str:
    """URDF 1.0. The joints' damping is back-EMF and viscous friction; Coulomb friction is the engine's to add."""
    drive = robot.drive
    model = RobotModel.from_config(robot)
    geometry, motors = model.geometry, model.motors
    right, left, half_track = geometry.right_radius_m, geometry.left_radius_m, 0.5 * geometry.track_m
    lines = [
        '<?xml version="1.0"?>',
        f'<robot name="{robot.name}">',
        *_base(robot),
        *_wheel(RIGHT_WHEEL, robot, right),
        *_joint(RIGHT_WHEEL, "continuous", (0.0, -half_track, right), motors.right),
        *_wheel(LEFT_WHEEL, robot, left),
        *_joint(LEFT_WHEEL, "continuous", (0.0, half_track, left), motors.left),
        *_caster(drive.caster_radius_m),
        *_joint(CASTER, "fixed", (drive.caster_x_m, 0.0, drive.caster_radius_m)),
        "</robot>",
    ]
    return "\n".join(lines) + "\n"


def _base(robot: RobotConfig) -> list[str]:
    chassis = robot.chassis
    size = (chassis.length_m, chassis.width_m, chassis.base_height_m - chassis.clearance_m)
    xx, yy, zz = (size[1] ** 2 + size[2] ** 2, size[0] ** 2 + size[2] ** 2, size[0] ** 2 + size[1] ** 2)
    twelfth = chassis.mass_kg / 12.0
    inertia = (twelfth * xx, twelfth * yy, twelfth * zz)
    center = (0.0, 0.0, chassis.clearance_m + 0.5 * size[2])
    return [
        '  <link name="base">',
        _inertial(chassis.mass_kg, inertia, (chassis.center_of_mass_x_m, 0.0, chassis.center_of_mass_z_m)),
        f'    <collision><origin xyz="{_text(center)}"/><geometry><box size="{_text(size)}"/></geometry></collision>',
        "  </link>",
    ]


def _wheel(name: str, robot: RobotConfig, radius: float) -> list[str]:
    """A disc that meets the floor as a sphere of the same radius: one contact, in the middle of the tread."""
    drive = robot.drive
    mass = drive.wheel_mass_kg
    across = mass * (3.0 * radius**2 + drive.wheel_width_m**2) / 12.0
    spin = 0.5 * mass * radius**2
    return [
        f'  <link name="{name}">',
        _inertial(mass, (across, spin, across)),
        f'    <collision><geometry><sphere radius="{radius!r}"/></geometry></collision>',
        "  </link>",
    ]


def _caster(radius_m: float) -> list[str]:
    inertia = 0.4 * CASTER_MASS_KG * radius_m**2
    return [
        f'  <link name="{CASTER}">',
        _inertial(CASTER_MASS_KG, (inertia, inertia, inertia)),
        f'    <collision><geometry><sphere radius="{radius_m!r}"/></geometry></collision>',
        "  </link>",
    ]


def _joint(child: str, kind: str, origin: tuple[float, float, float], motor: MotorModel | None = None) -> list[str]:
    dynamics = [f'    <dynamics damping="{motor.damping_N_m_s_rad!r}" friction="0"/>'] if motor else []
    return [
        f'  <joint name="{child}_joint" type="{kind}">',
        f'    <parent link="base"/><child link="{child}"/><origin xyz="{_text(origin)}"/><axis xyz="0 1 0"/>',
        *dynamics,
        "  </joint>",
    ]


def _inertial(
    mass_kg: float, diagonal: tuple[float, float, float], origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> str:
    ixx, iyy, izz = diagonal
    return (
        f'    <inertial><origin xyz="{_text(origin)}"/><mass value="{mass_kg!r}"/>'
        f'<inertia ixx="{ixx!r}" iyy="{iyy!r}" izz="{izz!r}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def _text(vector: tuple[float, float, float]) -> str:
    return " ".join(repr(value) for value in vector)
