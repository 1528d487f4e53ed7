"""Settings of a scenario whose numbers are allowed, but probably in another unit than that of their fields."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import radians

from configs.schema.scenario import RunSpec
from pipeline.run_warnings.suspicion import Suspicion, settings_of
from pipeline.run_warnings.unusual_sizes import unusual_sizes


@dataclass(frozen=True)
class UsualRange:
    """Range of the numbers that occur in fields of one kind, and the unit of those beyond it; 0 is usual, too."""

    field: str
    """Pattern of the paths of the fields."""
    low: float
    high: float
    meaning: str
    """What a number beyond the range would mean, after "means"."""
    unit: str
    per: float
    """Factor from the other unit to that of the field."""


_SENSOR = r"robot\.(encoder|tof|line_sensor|sensors\.\w+)"
_GYROSCOPE = r"robot\.sensors\.\w+\.gyroscope"
_ACCELEROMETER = r"robot\.sensors\.\w+\.accelerometer"
_DEG = radians(1.0)
_MILLI_G = 9.80665e-3
USUAL = (
    UsualRange(rf"{_SENSOR}\.dropout_probability", 0.0, 0.5, "most readings are lost", "per cent", 0.01),
    UsualRange(rf"{_SENSOR}\.quantisation_m", 0.0, 0.02, "the readings have coarse steps", "mm", 0.001),
    # Data sheet of the MPU-6050: at most 20 deg/s, and 0.005 deg/s/sqrt(Hz).
    UsualRange(
        rf"{_GYROSCOPE}\.bias_sd_rad_s", 0.0, 0.15, "the gyroscope shows many degrees per second at rest", "deg/s", _DEG
    ),
    UsualRange(
        rf"{_GYROSCOPE}\.bias_instability_rad_s", 0.0, 0.01, "the bias of the gyroscope wanders fast", "deg/s", _DEG
    ),
    UsualRange(
        rf"{_GYROSCOPE}\.noise_density_rad_s_rtHz", 0.0, 0.002, "the gyroscope is very noisy", "deg/s/sqrt(Hz)", _DEG
    ),
    UsualRange(
        rf"{_GYROSCOPE}\.range_rad_s", 0.0, 100.0, "the gyroscope measures many turns per second", "deg/s", _DEG
    ),
    # Data sheet of the MPU-6050: 80 mg at rest, 0.4 mg/sqrt(Hz), and axes that are perpendicular within 2 %.
    UsualRange(
        rf"{_ACCELEROMETER}\.bias_sd_m_s2", 0.0, 2.0, "the accelerometer shows a part of gravity", "mg", _MILLI_G
    ),
    UsualRange(rf"{_ACCELEROMETER}\.bias_instability_m_s2", 0.0, 0.1, "the bias wanders fast", "mg", _MILLI_G),
    UsualRange(
        rf"{_ACCELEROMETER}\.noise_density_m_s2_rtHz",
        0.0,
        0.05,
        "the accelerometer is very noisy",
        "mg/sqrt(Hz)",
        _MILLI_G,
    ),
    UsualRange(
        r"robot\.sensors\.\w+\.(gyroscope|accelerometer)\.misalignment_sd_rad",
        0.0,
        0.1,
        "the axes are many degrees from perpendicular",
        "degrees",
        _DEG,
    ),
    UsualRange(
        r"robot\.(encoder|tof|line_sensor)\.delay_s", 0.0, 0.3, "the robot reacts to readings that are old", "ms", 0.001
    ),
    UsualRange(r"stop\.time_limit_s", 0.0, 1800.0, "a run may take more than half an hour", "ms", 0.001),
    UsualRange(
        r"render\.jpeg_quality", 2.0, 100.0, "the images have the lowest quality of 1 to 100", "parts of one", 100.0
    ),
    UsualRange(r"look\.(\w+\.)+hue_deg", 1.0, 360.0, "the hue is red, which is 0", "turns", 360.0),
)
"""Usual numbers by field. They are far from those of the shipped files, and of what is sold for small robots."""
MAX_LINE_SENSOR_M = 0.0095
"""Largest distance from the floor that the data sheet of the QTR line sensors recommends."""
MAX_MAST = 5.0
"""Largest height of a camera above the body, relative to the body's length or width, that is usual."""
MIN_CAMERA_HZ = 0.5
LONG_S = 100.0
"""Time of a waypoint up to which a run that ends before it is probably a short trial."""
MAX_INERTIA = 50.0
"""Largest inertia of a rotor, relative to that of the robot's mass at the wheels' radius."""


def unusual_settings(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the settings that are probably in another unit, unless they were drawn."""
    for field, value in settings_of(spec):
        for usual in USUAL:
            if value and not usual.low <= value <= usual.high and re.fullmatch(usual.field, field):
                yield _beyond(field, value, usual.meaning, f"it is in {usual.unit}", value * usual.per)
    yield from _rare_images(spec)
    yield from _late_waypoints(spec)
    yield from _voltage_beyond_the_battery(spec)
    yield from _unusual_body(spec)
    yield from _unusual_heights(spec)
    yield from _large_effects(spec)
    yield from unusual_sizes(spec)


def _beyond(field: str, value: float, meaning: str, condition: str, instead: float) -> Suspicion:
    name = field.rpartition(".")[2]
    return Suspicion(
        f"{field} unusual", f"{field} {value:g} means that {meaning}; if {condition}, write {name}: {instead:.3g}"
    )


def _rare_images(spec: RunSpec) -> Iterator[Suspicion]:
    rate = spec.rates.camera_hz
    if 0.0 < rate < MIN_CAMERA_HZ:
        meaning = f"there is one image in {1.0 / rate:.3g} s"
        yield _beyond("rates.camera_hz", rate, meaning, "it is the time between two images", 1.0 / rate)


def _late_waypoints(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the last waypoint of each moving obstacle if the run ends before it."""
    limit_s = spec.stop.time_limit_s
    for index, obstacle in enumerate(spec.arena.obstacles):
        if obstacle.motion is None:
            continue
        waypoints = obstacle.motion.waypoints
        field, t_s = f"arena.obstacles.{index}.motion.waypoints.{len(waypoints) - 1}.t_s", waypoints[-1].t_s
        if t_s > max(limit_s, LONG_S) and field not in spec.drawn:
            meaning = f"{obstacle.name} does not reach it before the run ends at {limit_s:g} s"
            yield _beyond(field, t_s, meaning, "it is in ms", 0.001 * t_s)


def _voltage_beyond_the_battery(spec: RunSpec) -> Iterator[Suspicion]:
    power, field = spec.robot.power, "robot.power.motor_voltage_limit_V"
    drawn = spec.drawn.keys() & {field, "robot.power.battery_voltage_V"}
    if power.motor_voltage_limit_V > power.battery_voltage_V and not drawn:
        battery_V = power.battery_voltage_V
        yield Suspicion(
            f"{field} unusual",
            f"{field} {power.motor_voltage_limit_V:g} is more than the battery has: the motors get up to"
            f" {battery_V:g} V (robot.power.battery_voltage_V)",
        )


def _unusual_body(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield a distance of the wheels that is half of what the body has room for, and a rotor that is far too heavy."""
    chassis, drive, motor = spec.robot.chassis, spec.robot.drive, spec.robot.motor
    track_m, width_m = drive.track_m, chassis.width_m
    if 2.0 * track_m + drive.wheel_width_m <= width_m and "robot.drive.track_m" not in spec.drawn:
        meaning = f"the wheels take less than half of the body, whose width is {width_m:g} m with its wheels"
        yield _beyond(
            "robot.drive.track_m", track_m, meaning, "it is the distance of a wheel from the middle", 2.0 * track_m
        )
    robot_kg_m2 = chassis.mass_kg * (0.5 * drive.wheel_diameter_m) ** 2
    inertia = motor.rotor_inertia_kg_m2
    if inertia > MAX_INERTIA * robot_kg_m2 and "robot.motor.rotor_inertia_kg_m2" not in spec.drawn:
        meaning = f"a rotor resists as if the robot were {1.0 + inertia / robot_kg_m2:.0f} times as heavy"
        yield _beyond("robot.motor.rotor_inertia_kg_m2", inertia, meaning, "it is in kg cm2", 1e-4 * inertia)


def _unusual_heights(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield a line sensor that is too far from the floor, and a camera that is far above the body."""
    field, height_m = "robot.line_sensor.height_m", spec.robot.line_sensor.height_m
    if height_m > MAX_LINE_SENSOR_M and field not in spec.drawn:
        meaning = f"the line sensor is farther from the floor than the {1e3 * MAX_LINE_SENSOR_M:g} mm of its data sheet"
        yield Suspicion(f"{field} unusual", f"{field} {height_m:g} means that {meaning}")
    field, height_m = "robot.camera.height_above_base_m", spec.robot.camera.height_above_base_m
    size_m = max(spec.robot.chassis.length_m, spec.robot.chassis.width_m)
    if height_m > MAX_MAST * size_m and field not in spec.drawn:
        meaning = f"the camera is {height_m:g} m above a body of {size_m:g} m"
        yield Suspicion(f"{field} unusual", f"{field} {height_m:g} means that {meaning}")


def _large_effects(spec: RunSpec) -> Iterator[Suspicion]:
    """Yield the sizes of effects that do not occur in small robots."""
    for effect in spec.robot.effects:
        for name, plausible in effect.plausible_sizes().items():
            field, value = f"robot.effects.{effect.name}.{name}", float(getattr(effect, name))
            if field in spec.drawn or plausible.low <= value <= plausible.high:
                continue
            text = f"{field} {value:g} is beyond {plausible.low:g} to {plausible.high:g}: {plausible.why}"
            if plausible.low <= 0.01 * value <= plausible.high:
                text += f"; if it is in per cent, write {name}: {0.01 * value:g}"
            yield Suspicion(f"{field} unusual", text)
