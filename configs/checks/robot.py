"""Contradictions between the measures, motors, sensors and effects of a robot."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from configs.robot_sensors import SensorSettings
from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from configs.validation.faults import ConfigFault
from symolo.core.yaml.tree import FieldPath


def robot_faults(robot: RobotConfig, *, in_simulation: bool) -> Iterator[ConfigFault]:
    """Yield what is wrong with a robot in any arena.

    Args:
        robot: The robot.
        in_simulation: Whether PyBullet drives it, which cannot do all that a bench can measure.
    """
    yield from _body_faults(robot)
    yield from _camera_faults(robot)
    yield from _range_faults(robot)
    yield from _stall_faults(robot)
    yield from _effect_faults(robot, in_simulation=in_simulation)
    yield from _sensor_faults(robot)
    corner: FieldPath = ("robot", "controller", "corner")
    yield from _order_faults(robot.controller.corner, corner, "front_below_m", "front_clear_m")


def _order_faults(section: Section, path: FieldPath, lower: str, upper: str) -> Iterator[ConfigFault]:
    """Yield a fault if one field of a section is not below another."""
    low, high = getattr(section, lower), getattr(section, upper)
    if low >= high:
        allowed = f"less than {upper}, which is {high}"
        yield ConfigFault((*path, lower), got=low, allowed=allowed, against=(*path, upper))


def _effect_faults(robot: RobotConfig, *, in_simulation: bool) -> Iterator[ConfigFault]:
    for effect in robot.effects:
        yield from _below(("robot", "effects", effect.name), effect.faults(in_simulation=in_simulation))


def _sensor_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    for name, settings in robot.sensors:
        if isinstance(settings, SensorSettings):
            yield from _below(("robot", "sensors", name), settings.faults())


def _below(place: FieldPath, faults: Iterable[ConfigFault]) -> Iterator[ConfigFault]:
    """Yield faults whose paths start at a place with their whole paths."""
    for fault in faults:
        against = (*place, *fault.against) if fault.against else ()
        yield replace(fault, path=(*place, *fault.path), against=against)


def _range_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    tof = robot.tof
    path: FieldPath = ("robot", "tof")
    yield from _order_faults(tof, path, "min_range_m", "max_range_m")
    if tof.min_range_m < tof.no_target_m < tof.max_range_m:
        # Blame the limit that is nearer, as a ratio: whoever changed one of the three most likely changed that one.
        nearer = "max_range_m" if tof.min_range_m * tof.max_range_m <= tof.no_target_m**2 else "min_range_m"
        ends = f"up to {tof.min_range_m} (min_range_m) or from {tof.max_range_m} (max_range_m)"
        yield ConfigFault(
            (*path, "no_target_m"),
            got=tof.no_target_m,
            allowed=f"values outside the valid range, {ends}",
            against=(*path, nearer),
        )


def _stall_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    motor = robot.motor
    voltage = min(robot.power.battery_voltage_V, robot.power.motor_voltage_limit_V)
    stall_N_m = motor.torque_constant_N_m_A * voltage / motor.winding_resistance_ohm
    if stall_N_m <= motor.coulomb_friction_N_m:
        path: FieldPath = ("robot", "motor")
        problem = "the motor cannot overcome its friction"
        allowed = (
            f"less than {stall_N_m:.3g}, its torque at {voltage} V and {motor.winding_resistance_ohm} ohm with"
            f" {motor.torque_constant_N_m_A} N m/A"
        )
        against = (*path, "winding_resistance_ohm")
        voltages = (("robot", "power", "battery_voltage_V"), ("robot", "power", "motor_voltage_limit_V"))
        also = ((*path, "torque_constant_N_m_A"), *voltages)
        yield ConfigFault(
            (*path, "coulomb_friction_N_m"), problem, motor.coulomb_friction_N_m, allowed, against=against, also=also
        )


def _body_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    chassis, drive = robot.chassis, robot.drive
    chassis_path: FieldPath = ("robot", "chassis")
    drive_path: FieldPath = ("robot", "drive")
    max_track_m = chassis.width_m - drive.wheel_width_m
    if drive.track_m > max_track_m + 1e-9:
        allowed = f"at most {max_track_m:.6g}, chassis.width_m less drive.wheel_width_m, which covers the wheels"
        yield ConfigFault(
            (*drive_path, "track_m"),
            got=drive.track_m,
            allowed=allowed,
            against=(*chassis_path, "width_m"),
            also=((*drive_path, "wheel_width_m"),),
        )
    if not chassis.clearance_m < drive.wheel_diameter_m <= chassis.length_m:
        allowed = f"more than chassis.clearance_m ({chassis.clearance_m}), up to chassis.length_m ({chassis.length_m})"
        nearer = "clearance_m" if drive.wheel_diameter_m <= chassis.clearance_m else "length_m"
        against = (*chassis_path, nearer)
        yield ConfigFault(
            (*drive_path, "wheel_diameter_m"), got=drive.wheel_diameter_m, allowed=allowed, against=against
        )
    yield from _order_faults(chassis, chassis_path, "clearance_m", "base_height_m")
    if abs(drive.caster_x_m) > chassis.length_m / 2:
        allowed = f"at most {chassis.length_m / 2:.6g}, half of chassis.length_m, before or behind the axle"
        against = (*chassis_path, "length_m")
        yield ConfigFault((*drive_path, "caster_x_m"), got=drive.caster_x_m, allowed=allowed, against=against)
    low, high = sorted((0.0, drive.caster_x_m))
    if not low <= chassis.center_of_mass_x_m <= high or low == high:
        allowed = f"between the axle at 0 and the caster at {drive.caster_x_m}, or the robot tips over"
        got, against = chassis.center_of_mass_x_m, (*drive_path, "caster_x_m")
        yield ConfigFault((*chassis_path, "center_of_mass_x_m"), got=got, allowed=allowed, against=against)


def _camera_faults(robot: RobotConfig) -> Iterator[ConfigFault]:
    height_m, base_m = robot.camera.height_above_base_m, robot.chassis.base_height_m
    if base_m + height_m <= 0.0:
        field, problem = ("robot", "camera", "height_above_base_m"), "the lens is not above the floor"
        allowed = f"more than {-base_m}, since the base plate's top is {base_m} m above the floor"
        yield ConfigFault(field, problem, height_m, allowed, against=("robot", "chassis", "base_height_m"))
