"""The rigid bodies of the robot and their joints, for the engine and for model files.

The frame of the base is R moved down to the floor: x forward, y left, origin below the middle of the axle. The wheels
touch the floor in the middle of their treads, so that the track between the contact points is exactly that of the
configuration.
"""

from dataclasses import dataclass

from configs.schema.robot import RobotConfig
from physics.drivetrain.motor import MotorModel
from physics.robot.model import RobotModel

BASE, RIGHT_WHEEL, LEFT_WHEEL, CASTER = "base_link", "right_wheel", "left_wheel", "caster"
CASTER_MASS_KG = 1e-3
"""Mass of the ball; the rest is part of the chassis."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class BoxShape:
    """A box with its middle at the origin of its frame."""

    size_m: Vector
    """Edges along x, y and z."""


@dataclass(frozen=True)
class SphereShape:
    """A sphere with its middle at the origin of its frame."""

    radius_m: float


@dataclass(frozen=True)
class RobotLink:
    """A rigid body; its frame has the axes of R."""

    name: str
    origin: Vector
    """(3,) [m], origin of its frame in R."""
    mass_kg: float
    center_of_mass: Vector
    """(3,) [m], in its frame."""
    inertia_kg_m2: Vector
    """(3,), principal moments about the axes of its frame through the centre of mass, without rotor."""
    shape: BoxShape | SphereShape
    """Shape for collisions."""
    shape_center: Vector
    friction: float | None
    """Coulomb friction coefficient of its surface; None for the chassis, whose contacts end a run."""
    motor: MotorModel | None = None
    """Motor that turns it about y; None if it is fixed to the base."""


def robot_links(robot: RobotConfig) -> tuple[RobotLink, ...]:
    """Return the base, then right wheel, left wheel and caster, which are joined to it."""
    model = RobotModel.from_config(robot)
    geometry, motors = model.geometry, model.motors
    half_track = 0.5 * geometry.track_m
    return (
        _base(robot),
        _wheel(RIGHT_WHEEL, robot, -half_track, geometry.right_radius_m, motors.right),
        _wheel(LEFT_WHEEL, robot, half_track, geometry.left_radius_m, motors.left),
        _caster(robot),
    )


def _base(robot: RobotConfig) -> RobotLink:
    chassis = robot.chassis
    size = (chassis.length_m, chassis.width_m, chassis.base_height_m - chassis.clearance_m)
    xx, yy, zz = (size[1] ** 2 + size[2] ** 2, size[0] ** 2 + size[2] ** 2, size[0] ** 2 + size[1] ** 2)
    twelfth = chassis.mass_kg / 12.0
    return RobotLink(
        BASE,
        origin=(0.0, 0.0, 0.0),
        mass_kg=chassis.mass_kg,
        center_of_mass=(chassis.center_of_mass_x_m, 0.0, chassis.center_of_mass_z_m),
        inertia_kg_m2=(twelfth * xx, twelfth * yy, twelfth * zz),
        shape=BoxShape(size),
        shape_center=(0.0, 0.0, chassis.clearance_m + 0.5 * size[2]),
        friction=None,
    )


def _wheel(name: str, robot: RobotConfig, y_m: float, radius: float, motor: MotorModel) -> RobotLink:
    """Return a disc that touches the floor as a sphere of the same radius: one contact, in the middle of the tread."""
    drive = robot.drive
    mass = drive.wheel_mass_kg
    across = mass * (3.0 * radius**2 + drive.wheel_width_m**2) / 12.0
    spin = 0.5 * mass * radius**2
    return RobotLink(
        name,
        origin=(0.0, y_m, radius),
        mass_kg=mass,
        center_of_mass=(0.0, 0.0, 0.0),
        inertia_kg_m2=(across, spin, across),
        shape=SphereShape(radius),
        shape_center=(0.0, 0.0, 0.0),
        friction=drive.wheel_friction,
        motor=motor,
    )


def _caster(robot: RobotConfig) -> RobotLink:
    drive = robot.drive
    inertia = 0.4 * CASTER_MASS_KG * drive.caster_radius_m**2
    return RobotLink(
        CASTER,
        origin=(drive.caster_x_m, 0.0, drive.caster_radius_m),
        mass_kg=CASTER_MASS_KG,
        center_of_mass=(0.0, 0.0, 0.0),
        inertia_kg_m2=(inertia, inertia, inertia),
        shape=SphereShape(drive.caster_radius_m),
        shape_center=(0.0, 0.0, 0.0),
        friction=drive.caster_friction,
    )
