"""The arguments with which each slot calls `apply` of its effects; `Slot` describes them."""

import inspect
from collections.abc import Mapping
from types import MappingProxyType

from configs.effects.base import Effect, Slot

ARGUMENTS: Mapping[Slot, str] = MappingProxyType(
    {
        Slot.MOTORS: "motors",
        Slot.COMMAND_DELAY: "delay_s",
        Slot.ACTUATOR: "present_V, command_V, duration_s",
        Slot.BATTERY: "voltage_V, time_s",
        Slot.CONDUCTION: "emf_V, chopper",
        Slot.BRIDGE: "emf_V",
        Slot.SUPPLY: "emf_V, bridge",
        Slot.RESISTANCE: "resistance_ohm, time_s",
        Slot.TORQUE_CONSTANT: "constant_N_m_A, time_s",
        Slot.WINDING_HEAT: "share, voltage_V, duration_s",
        Slot.CURRENT_LIMIT: "current_A",
        Slot.FRICTION: "friction_N_m, motion",
        Slot.SHAFT_TORQUE: "torque_N_m, angle_rad, turned_rad",
        Slot.GEARBOX: "state, motor, load, duration_s",
        Slot.GEOMETRY: "geometry",
        Slot.ROLLING: "share, angle_rad, turned_rad",
        Slot.TRAVEL: "share, place",
        Slot.SLIP: "share, travel_m, deviates",
        Slot.CREEP: "creep_m, rolled_m, middle_m",
        Slot.GROUND: "share, speed_m_s, yaw_rate_rad_s",
        Slot.TURNING: "share, place",
        Slot.ENCODER: "counts_per_revolution",
        Slot.COUNTING: "turned_rad, duration_s",
        Slot.CURRENT_READING: "current_A",
        Slot.SPEED_READING: "speed_rad_s",
        Slot.CURRENT_GAIN: "gain, time_s",
        Slot.SPEED_GAIN: "gain, time_s",
        Slot.SPEED_RIPPLE: "gain, angle_rad",
        Slot.CURRENT_ERROR: "error_A, time_s",
        Slot.SPEED_ERROR: "error_rad_s, time_s",
        Slot.SPEED_FILTER: "filtered_rad_s, before_rad_s, speed_rad_s, duration_s",
        Slot.SPEED_DELAY: "delay_s",
        Slot.POSE_POINT: "pose",
        Slot.POSE_HEADING: "error_rad, yaw_rad, time_s",
        Slot.POSE_DELAY: "delay_s, time_s",
        Slot.RANGE_MOUNT: "yaw_rad",
        Slot.RAY_WEIGHT: "weight, distance_m",
        Slot.RANGE_GATHERING: "duration_s",
        Slot.RANGE: "reading_m, view",
        Slot.RANGE_WANDER: "error_m, duration_s, deviates",
        Slot.RANGE_NOISE: "sd_m, view",
        Slot.RANGE_LIMIT: "reading_m",
        Slot.RANGE_DELAY: "delay_s",
        Slot.LINE_PLACE: "place_m",
        Slot.LINE_HEIGHT: "ratio",
        Slot.LINE_READING: "reading",
        Slot.LINE_LIMIT: "reading",
    }
)


def takes_arguments(effect: type[Effect]) -> bool:
    """Return whether `apply` can be called with the arguments of its slot."""
    instance = () if isinstance(inspect.getattr_static(effect, "apply"), (staticmethod, classmethod)) else (effect,)
    try:
        inspect.signature(effect.apply).bind(*instance, *ARGUMENTS[effect.slot].split(", "))
    except TypeError:
        return False
    return True
