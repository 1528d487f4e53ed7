"""The few numbers of a robot or bench that no log contains, and what each of them allows the diagnosis to name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from configs.validation.other_units import other_unit
from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.measurement import CaseKind, Measurement
from symolo.core.errors import FaultList, InputError, nearest


@dataclass(frozen=True)
class KnownNumber:
    """A number that the user may know."""

    key: str
    """Name for `--set`, which ends with the unit."""
    title: str
    """Words for a question and a comment."""
    allows: str
    """Effects that the diagnosis can name only if the number is known."""
    low: float = 0.0
    high: float = 1e6


_MOTOR = (
    KnownNumber("supply_voltage_V", "voltage of battery or supply", "supply_sag"),
    KnownNumber("winding_resistance_ohm", "resistance of the motor's winding", "winding_resistance_scale"),
    KnownNumber(
        "torque_constant_N_m_A", "torque constant at the wheel, gear included", "torque_constant_scale, speed_scale"
    ),
    KnownNumber("viscous_friction_N_m_s_rad", "friction torque per speed at the wheel", "viscous_friction_scale"),
    KnownNumber("coulomb_friction_N_m", "constant friction torque at the wheel", "coulomb_friction_scale"),
)
_INERTIA = KnownNumber(
    "rotor_inertia_kg_m2", "inertia at the wheel of motor and half of the robot", "rotor_inertia_scale"
)
_TICKS = KnownNumber("ticks_per_turn", "encoder ticks per turn of a wheel, gear included", "encoder_ticks_scale")
_WHEELS = (
    KnownNumber("wheel_diameter_m", "diameter of the wheels", "wheel_radius_scale", high=0.5),
    KnownNumber("track_m", "distance between the two wheels", "wheelbase_scale, turn_slip", high=1.0),
)
_ROOM = (
    KnownNumber("room_x_m", "length of the empty rectangular room along x", "all effects of ranges"),
    KnownNumber("room_y_m", "length of that room along y", "all effects of ranges"),
    *(
        KnownNumber(
            f"room_corner_{axis}_m",
            f"smallest {axis} within that room, in the frame of the log",
            "nothing more; 0 by default",
            -1e3,
            1e3,
        )
        for axis in ("x", "y")
    ),
)
_MAX_RANGE = KnownNumber("max_range_m", "longest range of the sensors", "nothing more; 1.2 is usual", high=10.0)


def _mount(side: str) -> tuple[KnownNumber, ...]:
    allows = f"effects of the ranges tof_{side}_m"
    return (
        KnownNumber(f"{side}_x_m", f"place of the {side} sensor ahead of the axle", allows, -0.5, 0.5),
        KnownNumber(f"{side}_y_m", f"place of the {side} sensor to the left of the middle", allows, -0.5, 0.5),
        KnownNumber(
            f"{side}_yaw_deg", f"direction of the {side} sensor to the left of straight ahead", allows, -180.0, 180.0
        ),
    )


def numbers_of(measurement: Measurement) -> tuple[KnownNumber, ...]:
    """Return the numbers that matter for what was logged."""
    match measurement.kind:
        case CaseKind.MOTOR_STEADY:
            return _MOTOR
        case CaseKind.MOTOR_STEP:
            return (*_MOTOR, _INERTIA)
        case CaseKind.DRIVE_LOG:
            return tuple(_drive_numbers(measurement))
        case _:
            return ()


def _drive_numbers(measurement: Measurement) -> Sequence[KnownNumber]:
    numbers: list[KnownNumber] = []
    has_pose = measurement.has("x_m", "y_m", "theta_rad")
    if measurement.has("enc_left_ticks", "enc_right_ticks"):
        numbers += [_TICKS, *(_WHEELS if has_pose else ())]
        if measurement.has("u_left_V", "u_right_V"):
            numbers += [*_MOTOR, _INERTIA]
    sides = [side for side in RANGE_SIDES if measurement.has(f"tof_{side}_m")]
    if has_pose and sides:
        numbers += [*_ROOM, _MAX_RANGE, *(number for side in sides for number in _mount(side))]
    return numbers


NUMBERS = (
    _TICKS,
    *_WHEELS,
    *_MOTOR,
    _INERTIA,
    *_ROOM,
    _MAX_RANGE,
    *(number for side in RANGE_SIDES for number in _mount(side)),
)
"""All numbers that may matter for some log."""


def parsed(settings: Sequence[str]) -> dict[str, float]:
    """Return the numbers of settings such as `track_m=0.14`, by key.

    Raises:
        InputError: A setting is no such number; all faults are reported.
    """
    by_key = {number.key: number for number in NUMBERS}
    faults, values = FaultList(), {}
    for setting in settings:
        with faults.noted():
            key, equals, text = (part.strip() for part in setting.partition("="))
            if not equals or key not in by_key:
                close = nearest(key, by_key)
                raise InputError("--set", got=setting, allowed=f"KEY=VALUE with {', '.join(by_key)}", nearest=close)
            values[key] = value_of(text, by_key[key])
    faults.check()
    return values


def value_of(text: str, number: KnownNumber) -> float:
    """Return a number as a user wrote it.

    Raises:
        InputError: It is none, or not within the bounds.
    """
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    is_inside = number.low <= value <= number.high and not (number.low == 0.0 == value)
    if not is_inside:
        low = "above 0" if number.low == 0.0 else f"{number.low:g}"
        hint = other_unit(number.key, value, number.low, number.high) if isfinite(value) else ""
        raise InputError(number.key, got=text, allowed=f"a number, {low} to {number.high:g}", cure=hint)
    return value


def missing(numbers: Sequence[KnownNumber], known: Mapping[str, float]) -> list[KnownNumber]:
    """Return the numbers that are not known, in their order."""
    return [number for number in numbers if number.key not in known]
