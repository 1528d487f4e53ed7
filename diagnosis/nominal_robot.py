"""The nominal robot of a measured case: a shipped robot with the nominal parameters of the case."""

from collections.abc import Mapping
from math import degrees
from types import MappingProxyType

from configs.effects.robot_effects import RobotEffects
from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import (
    BenchTof,
    KnownWheels,
    Nominal,
    NominalDrive,
    NominalGearedMotor,
    NominalLog,
    NominalMotor,
    NominalRobot,
    NominalTof,
    PositiveSpread,
    Spread,
)
from sensors.effects.range_sensor.range_offset import RangeOffset
from sensors.effects.range_sensor.range_scale import RangeScale

PLAIN_RANGE: Mapping[str, float] = MappingProxyType(
    {"error_scale": 0.0, "noise_scale": 1.0, "rays": 1, "field_of_view_deg": 1e-3}
)
"""A single ray along the axis, without the error of Eq. 24."""


def nominal_robot(nominal: Nominal, base_robot: RobotConfig) -> RobotConfig:
    """Return `base_robot` without its effects and with the parameters that the case defines.

    A log that names its robot defines all of it. In other cases, a range sensor is a single ray with the offset and
    scale of the case, without the cone and the error of `base_robot`.
    """
    robot = base_robot.model_copy(update={"effects": RobotEffects()})
    match nominal:
        case NominalLog():
            return nominal.robot
        case NominalTof():
            return _with_bench_tof(robot, nominal.tof)
        case NominalDrive():
            robot = _with_drive(robot, nominal)
            return robot if nominal.motor is None else _with_motor(robot, nominal.motor)
        case KnownWheels():
            return _with_wheels(robot, nominal.robot)
        case _:
            return _with_motor(robot, nominal.motor)


def _with_motor(robot: RobotConfig, motor: NominalMotor) -> RobotConfig:
    numbers = {name: field.value for name, field in motor if isinstance(field, (PositiveSpread, Spread))}
    if isinstance(motor, NominalGearedMotor):
        numbers["motor_side_inertia_fraction"] = motor.motor_side_inertia_fraction
        numbers["motor_side_friction_fraction"] = motor.motor_side_friction_fraction
    supply = {"battery_voltage_V": motor.supply_voltage_V, "motor_voltage_limit_V": motor.supply_voltage_V}
    return robot.with_section("motor", numbers).with_section("power", supply)


def _with_bench_tof(robot: RobotConfig, tof: BenchTof) -> RobotConfig:
    numbers = {
        **PLAIN_RANGE,
        "quantisation_m": tof.resolution_m,
        "reference_temperature_C": tof.reference_temperature_C,
        "temperature_C": tof.reference_temperature_C,
    }
    return _with_range(robot, tof.range_offset_m.value, tof.range_scale.value).with_section("tof", numbers)


def _with_drive(robot: RobotConfig, nominal: NominalDrive) -> RobotConfig:
    if nominal.tof is None:
        return _with_wheels(robot, nominal.robot)
    mounts = {
        name: getattr(robot.tof.mounts, name).model_copy(
            update={"x_m": mount.x_m, "y_m": mount.y_m, "yaw_deg": degrees(mount.yaw_rad), "pitch_up_deg": 0.0}
        )
        for name, mount in nominal.tof.mount
        if mount is not None
    }
    ranges = {
        **PLAIN_RANGE,
        "mounts": robot.tof.mounts.model_copy(update=mounts),
        "max_range_m": nominal.tof.max_range_m,
    }
    robot = _with_range(robot, nominal.tof.range_offset_m.value, 1.0).with_section("tof", ranges)
    return _with_wheels(robot, nominal.robot)


def _with_wheels(robot: RobotConfig, wheels: NominalRobot) -> RobotConfig:
    drive = {"wheel_diameter_m": 2.0 * wheels.wheel_radius_m.value, "track_m": wheels.wheel_separation_m.value}
    counts = wheels.encoder_ticks_per_revolution
    encoder = {"counts_per_revolution": int(counts) if counts == int(counts) else counts}
    return robot.with_section("drive", drive).with_section("encoder", encoder)


def _with_range(robot: RobotConfig, offset_m: float, scale: float) -> RobotConfig:
    if offset_m != 0.0:
        robot = robot.with_effect(RangeOffset(offset_m=offset_m))
    return robot if scale == 1.0 else robot.with_effect(RangeScale(scale=scale))
