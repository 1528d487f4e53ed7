"""The nominal robot of a measured case: a shipped robot with the nominal parameters of the case."""

from collections.abc import Mapping
from math import degrees
from types import MappingProxyType

from configs.effects.robot_effects import RobotEffects
from configs.schema.base import Section
from configs.schema.robot import RobotConfig, TofMount
from diagnosis.measured.nominal import (
    BenchTof,
    KnownWheels,
    Mount,
    Nominal,
    NominalDrive,
    NominalGearedMotor,
    NominalMotor,
    NominalMovingMotor,
    NominalRobot,
    NominalTof,
)
from sensors.effects.range_offset import RangeOffset
from sensors.effects.range_scale import RangeScale

PLAIN_RANGE: Mapping[str, float] = MappingProxyType(
    {"error_scale": 0.0, "noise_scale": 1.0, "rays": 1, "field_of_view_deg": 1e-3}
)
"""A single ray along the axis, without the error of Eq. 24."""


def nominal_robot(nominal: Nominal, carrier: RobotConfig) -> RobotConfig:
    """Return `carrier` without its effects and with the parameters that the case defines.

    A range sensor is a single ray with the offset and scale of the case, without the cone and the error of `carrier`.
    """
    robot = carrier.model_copy(update={"effects": RobotEffects()})
    match nominal:
        case NominalTof():
            return _with_bench_tof(robot, nominal.tof)
        case NominalDrive():
            return _with_motor(_with_drive(robot, nominal), nominal.motor)
        case KnownWheels():
            return _with_wheels(robot, nominal.robot)
        case _:
            return _with_motor(robot, nominal.motor)


def _with_motor(robot: RobotConfig, motor: NominalMotor) -> RobotConfig:
    numbers = {
        "winding_resistance_ohm": motor.winding_resistance_ohm.value,
        "torque_constant_N_m_A": motor.torque_constant_N_m_A.value,
        "viscous_friction_N_m_s_rad": motor.viscous_friction_N_m_s_rad.value,
        "coulomb_friction_N_m": motor.coulomb_friction_N_m.value,
    }
    if isinstance(motor, NominalMovingMotor):
        numbers["rotor_inertia_kg_m2"] = motor.rotor_inertia_kg_m2.value
    if isinstance(motor, NominalGearedMotor):
        numbers["motor_side_inertia_fraction"] = motor.motor_side_inertia_fraction
        numbers["motor_side_friction_fraction"] = motor.motor_side_friction_fraction
    supply = {"battery_voltage_V": motor.supply_voltage_V, "motor_voltage_limit_V": motor.supply_voltage_V}
    sections: dict[str, Section] = {
        "motor": robot.motor.model_copy(update=numbers),
        "power": robot.power.model_copy(update=supply),
    }
    return robot.model_copy(update=sections)


def _with_bench_tof(robot: RobotConfig, tof: BenchTof) -> RobotConfig:
    robot = _with_range(robot, tof.range_offset_m.value, tof.range_scale.value)
    numbers = {
        **PLAIN_RANGE,
        "quantisation_m": tof.resolution_m,
        "reference_temperature_C": tof.reference_temperature_C,
        "temperature_C": tof.reference_temperature_C,
    }
    return robot.model_copy(update={"tof": robot.tof.model_copy(update=numbers)})


def _with_drive(robot: RobotConfig, nominal: NominalDrive) -> RobotConfig:
    robot = _with_range(robot, nominal.tof.range_offset_m.value, 1.0)
    mounts = {name: _mounted(getattr(robot.tof.mounts, name), mount) for name, mount in nominal.tof.mount}
    ranges = {
        **PLAIN_RANGE,
        "mounts": robot.tof.mounts.model_copy(update=mounts),
        "max_range_m": nominal.tof.max_range_m,
    }
    robot = robot.model_copy(update={"tof": robot.tof.model_copy(update=ranges)})
    return _with_wheels(robot, nominal.robot)


def _with_wheels(robot: RobotConfig, wheels: NominalRobot) -> RobotConfig:
    drive = {"wheel_diameter_m": 2.0 * wheels.wheel_radius_m.value, "track_m": wheels.wheel_separation_m.value}
    counts = wheels.encoder_ticks_per_revolution
    encoder = {"counts_per_revolution": int(counts) if counts == int(counts) else counts}
    sections: dict[str, Section] = {
        "drive": robot.drive.model_copy(update=drive),
        "encoder": robot.encoder.model_copy(update=encoder),
    }
    return robot.model_copy(update=sections)


def _mounted(mount: TofMount, nominal: Mount) -> TofMount:
    numbers = {"x_m": nominal.x_m, "y_m": nominal.y_m, "yaw_deg": degrees(nominal.yaw_rad), "pitch_up_deg": 0.0}
    return mount.model_copy(update=numbers)


def _with_range(robot: RobotConfig, offset_m: float, scale: float) -> RobotConfig:
    if offset_m != 0.0:
        robot = robot.with_effect(RangeOffset(offset_m=offset_m))
    return robot if scale == 1.0 else robot.with_effect(RangeScale(scale=scale))
