"""All effects of a robot by their canonical names: `robot.terms.<name>.<parameter>`.

The parameters are written as schema sections, since the schema is the lowest layer and a section already is a config
key, a randomisation axis and a refusal with bounds. `physics.effects` and `sensors.effects` give each section its slot,
its cause and its function; nothing of a parameter is repeated there.

A robot has at most one term of each name, and no key means no effect; `name: null` takes away one that was inherited.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, get_args

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer

from configs.schema.base import Section, absent
from configs.schema.effects import drive, motor, range_bench


class Terms(Section):
    """Motor and its bench, range sensor, drive. Order means nothing here; `physics.effects` has the one that acts."""

    winding_resistance_scale: motor.WindingResistanceScale | None = Field(default_factory=absent)
    torque_constant_scale: motor.TorqueConstantScale | None = Field(default_factory=absent)
    torque_constant_mismatch: drive.TorqueConstantMismatch | None = Field(default_factory=absent)
    viscous_friction_scale: motor.ViscousFrictionScale | None = Field(default_factory=absent)
    coulomb_friction_scale: motor.CoulombFrictionScale | None = Field(default_factory=absent)
    rotor_inertia_scale: motor.RotorInertiaScale | None = Field(default_factory=absent)
    stribeck_friction: motor.StribeckFriction | None = Field(default_factory=absent)
    quadratic_drag: motor.QuadraticDrag | None = Field(default_factory=absent)
    friction_asymmetry: motor.FrictionAsymmetry | None = Field(default_factory=absent)
    friction_warmup: motor.FrictionWarmup | None = Field(default_factory=absent)
    bridge_voltage_drop: motor.BridgeVoltageDrop | None = Field(default_factory=absent)
    supply_sag: motor.SupplySag | None = Field(default_factory=absent)
    battery_decline: drive.BatteryDecline | None = Field(default_factory=absent)
    input_delay: motor.InputDelay | None = Field(default_factory=absent)
    actuator_lag: motor.ActuatorLag | None = Field(default_factory=absent)
    current_limit: motor.CurrentLimit | None = Field(default_factory=absent)
    gear_backlash: motor.GearBacklash | None = Field(default_factory=absent)
    current_sensor_offset: motor.CurrentSensorOffset | None = Field(default_factory=absent)
    current_sensor_gain: motor.CurrentSensorGain | None = Field(default_factory=absent)
    speed_scale: motor.SpeedScale | None = Field(default_factory=absent)
    speed_filter_lag: motor.SpeedFilterLag | None = Field(default_factory=absent)
    speed_time_offset: motor.SpeedTimeOffset | None = Field(default_factory=absent)
    range_offset: range_bench.RangeOffset | None = Field(default_factory=absent)
    range_scale: range_bench.RangeScale | None = Field(default_factory=absent)
    log_range_error: range_bench.LogRangeError | None = Field(default_factory=absent)
    temperature_drift: range_bench.TemperatureDrift | None = Field(default_factory=absent)
    material_bias: range_bench.MaterialBias | None = Field(default_factory=absent)
    incidence_bias: range_bench.IncidenceBias | None = Field(default_factory=absent)
    cover_crosstalk: range_bench.CoverCrosstalk | None = Field(default_factory=absent)
    near_field_error: range_bench.NearFieldError | None = Field(default_factory=absent)
    range_saturation: range_bench.RangeSaturation | None = Field(default_factory=absent)
    warmup_drift: range_bench.WarmupDrift | None = Field(default_factory=absent)
    noise_scale: range_bench.NoiseScale | None = Field(default_factory=absent)
    ambient_noise: range_bench.AmbientNoise | None = Field(default_factory=absent)
    wheel_radius_scale: drive.WheelRadiusScale | None = Field(default_factory=absent)
    wheel_radius_asymmetry: drive.WheelRadiusAsymmetry | None = Field(default_factory=absent)
    wheelbase_scale: drive.WheelbaseScale | None = Field(default_factory=absent)
    encoder_ticks_scale: drive.EncoderTicksScale | None = Field(default_factory=absent)
    encoder_missed_ticks: drive.EncoderMissedTicks | None = Field(default_factory=absent)
    turn_slip: drive.TurnSlip | None = Field(default_factory=absent)
    marker_offset: drive.MarkerOffset | None = Field(default_factory=absent)
    pose_time_offset: drive.PoseTimeOffset | None = Field(default_factory=absent)
    tof_range_offset: drive.TofRangeOffset | None = Field(default_factory=absent)
    tof_range_scale: drive.TofRangeScale | None = Field(default_factory=absent)
    tof_mount_yaw: drive.TofMountYaw | None = Field(default_factory=absent)
    tof_time_offset: drive.TofTimeOffset | None = Field(default_factory=absent)

    @model_serializer(mode="wrap")
    def _present_alone(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {name: value for name, value in handler(self).items() if value is not None}

    def present(self) -> Iterator[tuple[str, Section]]:
        """Name and parameters of each term that the robot has."""
        for name in type(self).model_fields:
            values = getattr(self, name)
            if values is not None:
                yield name, values

    def with_term(self, values: Section) -> "Terms":
        """These and one more, in place of one of the same name."""
        return self.model_copy(update={TERM_NAMES[type(values)]: values})


def _sections() -> Iterator[tuple[type[Section], str]]:
    for name, field in Terms.model_fields.items():
        section, _ = get_args(field.annotation)
        yield section, name


TERM_NAMES: Mapping[type[Section], str] = MappingProxyType(dict(_sections()))
"""Canonical name of the effect that a section gives the parameters of."""
