"""The text of nominal.yaml for a new case, with a comment on the source of each number."""

import json
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import radians

import numpy as np

from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.measurement import CaseKind, Measurement
from diagnosis.measured.pose_by_ticks import PoseByTicks, pose_by_ticks
from diagnosis.measured.screening import noise_of
from diagnosis.measured.sweep_noise import noise_of_sweeps
from diagnosis.new_case.estimates import motor_of, speed_noise, wheels_of
from diagnosis.predictors.rows import good_values
from diagnosis.usual_tolerances import SHARES, TRACK_SHARE, WHEEL_SHARE
from logs.mapping import MAPPING
from logs.times import usual_step
from logs.units.heading import guessed_heading_unit
from symolo.core.errors import InputError

UNKNOWN_MOTOR, UNKNOWN_WHEELS = 0.5, 0.2
"""Tolerance of a number that nobody knows, as a share: so wide that no effect can be named in its place."""
USUAL_MOTOR: Mapping[str, float] = {
    "winding_resistance_ohm": 3.0,
    "torque_constant_N_m_A": 0.3,
    "viscous_friction_N_m_s_rad": 0.002,
    "coulomb_friction_N_m": 0.02,
    "rotor_inertia_kg_m2": 0.003,
}
"""Round numbers of the motors of the paper, at the wheel, with half of the robot's inertia."""
USUAL_DIAMETER_M, USUAL_TRACK_M = 0.065, 0.14
"""Wheels of the robot of the paper."""
REFLECTANCE: Mapping[str, float] = {"white": 0.85, "grey": 0.18, "gray": 0.18, "black": 0.05, "wood": 0.45}
"""Reflectances by a word of the material's name; 0.5 for any other."""
_UNKNOWN = "NOT KNOWN"
_ESTIMATED = f"{_UNKNOWN}: estimated from this log"
_ASSUMED = f"{_UNKNOWN}: a usual value"


@dataclass(frozen=True)
class _Value:
    """A number with tolerance and comment."""

    value: float
    tolerance: float
    comment: str

    def line(self, key: str) -> str:
        return f"  {key}: {{value: {self.value:.6g}, tolerance: {self.tolerance:.3g}}}  # {self.comment}"


def nominal_text(measurement: Measurement, known: Mapping[str, float]) -> str:
    """Return the text for a measurement without nominal parameters.

    Args:
        measurement: What was logged.
        known: Numbers that the user knows, by the keys of `numbers_of`.

    Raises:
        InputError: A number is missing that cannot be estimated.
    """
    lines = {
        CaseKind.MOTOR_STEADY: _motor_bench,
        CaseKind.MOTOR_STEP: _motor_bench,
        CaseKind.TOF_BENCH: _range_bench,
        CaseKind.DRIVE_LOG: _drive,
    }[measurement.kind](measurement, dict(known))
    lines = list(lines)
    head = [
        "# What a textbook simulation would use. A tolerance is the standard deviation between units, or your doubt.",
        "# docs/measured.md explains each field.",
    ]
    if any(_UNKNOWN in line for line in lines):
        head += [
            f"# Replace what is {_UNKNOWN}, and narrow its tolerance: as it is, the tolerance is so wide that no",
            "# effect can be named in its place.",
        ]
    return "\n".join([*head, f"kind: {measurement.kind}", *lines]) + "\n"


def _motor(measurement: Measurement, known: dict[str, float], names: Sequence[str], *, gear: bool) -> Iterator[str]:
    estimated = motor_of(measurement, known, dict(USUAL_MOTOR))
    yield "motor:  # at the wheel shaft"
    for name in names:
        if name in known:
            yield _Value(known[name], SHARES[name] * known[name], "given; usual tolerance between units").line(name)
        else:
            value = estimated[name]
            comment = _ASSUMED if value == USUAL_MOTOR[name] else _ESTIMATED
            yield _Value(value, UNKNOWN_MOTOR * value, comment).line(name)
    channels = ("u_left_V", "u_right_V") if measurement.kind is CaseKind.DRIVE_LOG else ("u_cmd_V",)
    highest = max(float(np.nanmax(np.abs(good_values(measurement, name)), initial=0.1)) for name in channels)
    supply, comment = highest, f"{_UNKNOWN}: the highest logged voltage"
    if "supply_voltage_V" in known:
        supply, comment = known["supply_voltage_V"], "given"
    yield f"  supply_voltage_V: {supply:.6g}  # {comment}"
    if gear:
        yield "  motor_side_inertia_fraction: 0.6  # a usual value; matters only with play in the gear"
        yield "  motor_side_friction_fraction: 0.5  # likewise"


def _motor_bench(measurement: Measurement, known: dict[str, float]) -> Iterator[str]:
    is_step = measurement.kind is CaseKind.MOTOR_STEP
    names = list(USUAL_MOTOR) if is_step else [name for name in USUAL_MOTOR if name != "rotor_inertia_kg_m2"]
    yield from _motor(measurement, known, names, gear=is_step)
    if is_step:
        steps = np.concatenate([np.diff(trial.t_s) for trial in measurement.trials])
        yield f"sample_rate_Hz: {1.0 / usual_step(steps):.6g}"
    yield "noise:  # standard deviations; a factor of two off does no harm"
    for name, low, usual_sd, high in (("current_A", 1e-3, 5e-3, 0.1), ("omega_rad_s", 0.02, 0.06, 1.0)):
        sd = _noise(measurement, name)
        comment = "a usual value, since there are too few rows" if sd is None else "estimated from this log"
        yield f"  {name}: {np.clip(sd or usual_sd, low, high):.3g}  # {comment}"
    if is_step:
        yield "  lag1_correlation: 0.0"


def _noise(measurement: Measurement, name: str) -> float | None:
    """Return the standard deviation of a channel's noise; None if it cannot be estimated."""
    if measurement.kind is CaseKind.MOTOR_STEADY:
        noises = [noise_of_sweeps(measurement, name)]
    else:
        noises = [noise_of(channel) for channel in measurement.across(name)]
    sds = [noise.sd for noise in noises if noise is not None and noise.sd > 0.0]
    return float(np.median(sds)) if sds else None


def _range_bench(measurement: Measurement, _known: dict[str, float]) -> Iterator[str]:
    (trial,) = measurement.trials
    yield "tof:"
    yield _Value(0.0, 0.002, "a calibrated sensor; usual tolerance between units").line("range_offset_m")
    yield _Value(1.0, 0.01, "likewise").line("range_scale")
    yield "  reference_temperature_C: 25  # temperature of the calibration"
    yield "  resolution_m: 0.001"
    yield "  reflectance:"
    for material in sorted(set(trial.label("material").values)) or ["any"]:
        share = next((share for word, share in REFLECTANCE.items() if word in material.lower()), 0.5)
        yield f"    {json.dumps(material or 'any', ensure_ascii=False)}: {share:g}  # a usual value"
    yield from ("noise:", *_range_noise(""))


def _range_noise(prefix: str) -> Iterator[str]:
    yield f"  {prefix}polynomial_mm: [1.4, 4.88, 2.51, 1.15]  # VL53L0X, Eq. 23 of the paper"
    yield f"  {prefix}polynomial_origin_m: 0.18"


def _drive(measurement: Measurement, known: dict[str, float]) -> Iterator[str]:
    has_ticks = measurement.has("enc_left_ticks", "enc_right_ticks")
    usual_wheels = {"wheel_diameter_m": USUAL_DIAMETER_M, "track_m": USUAL_TRACK_M}
    if not has_ticks:
        known = {"ticks_per_turn": 1000.0, **usual_wheels} | known
    stated = set(known)
    if not stated & {"ticks_per_turn", "wheel_diameter_m"}:
        known["wheel_diameter_m"] = USUAL_DIAMETER_M
    moved = pose_by_ticks(measurement)
    estimated = wheels_of(moved, known)
    known |= estimated
    if "ticks_per_turn" not in known:
        raise _missing_ticks(measurement, moved)
    known = usual_wheels | known
    if has_ticks and measurement.has("u_left_V", "u_right_V"):
        motor = {key: value for key, value in known.items() if key in {*stated, "ticks_per_turn"}}
        yield from _motor(measurement, motor, list(USUAL_MOTOR), gear=False)
    yield "robot:"
    for key, name, scale, share in (
        ("wheel_diameter_m", "wheel_radius_m", 0.5, WHEEL_SHARE),
        ("track_m", "wheel_separation_m", 1.0, TRACK_SHARE),
    ):
        value = scale * known[key]
        is_given = key in stated and (key != "wheel_diameter_m" or "ticks_per_turn" in stated)
        comment = "given; usual tolerance" if is_given else _origin(key, stated, estimated, has_ticks=has_ticks)
        yield _Value(value, (share if is_given else UNKNOWN_WHEELS) * value, comment).line(name)
    key = "ticks_per_turn"
    comment = "given" if key in stated else _origin(key, stated, estimated, has_ticks=has_ticks)
    yield f"  encoder_ticks_per_revolution: {known['ticks_per_turn']:g}  # {comment}"
    yield from _ranges(measurement, known)
    yield "noise:  # standard deviations; a factor of two off does no harm"
    row_s = usual_step(np.concatenate([np.diff(trial.t_s) for trial in measurement.trials]))
    speed_rad_s = speed_noise(known["ticks_per_turn"], row_s)
    yield f"  wheel_speed_rad_s: {speed_rad_s:.3g}  # rounding to ticks, and disturbances"
    if moved is None or not moved.is_explained:
        yield "  pose_xy_m: 0.001  # a usual value"
        yield "  pose_theta_rad: 0.003  # a usual value"
    else:
        yield f"  pose_xy_m: {max(moved.pose_xy_m, 1e-4):.3g}  # estimated from this log"
        yield f"  pose_theta_rad: {max(moved.pose_theta_rad, 1e-4):.3g}  # estimated from this log"
    yield "  travel_m_per_sqrt_m: 0.001  # slip: a millimetre per metre"
    yield from _range_noise("tof_")


def _missing_ticks(measurement: Measurement, moved: PoseByTicks | None) -> InputError:
    """Return the error for ticks that were not given, with the reason why the log does not show them."""
    cure = "give it with --set ticks_per_turn=NUMBER: pulses of the encoder, times edges, times gear ratio"
    reason = "without poses it cannot be estimated"
    if measurement.has("x_m", "y_m", "theta_rad"):
        reason = "it cannot be estimated, since the robot hardly moves where poses and counts were logged"
    if moved is not None:
        if _is_in_degrees(measurement):
            why = "the headings follow the path in degrees and not in rad"
            cure = f"write unit: degrees for theta_rad in a {MAPPING} (docs/case_from_log.md); or {cure}"
        else:
            why = next(moved.contradictions(), "the poses do not follow the counts")
        reason = f"it cannot be estimated, since {why}"
    return InputError(f"ticks_per_turn is missing, and {reason}", where=measurement.where, cure=cure)


def _is_in_degrees(measurement: Measurement) -> bool:
    """Return whether the headings follow the path only if they are taken for degrees."""
    for trial in measurement.trials:
        place_m = np.column_stack([trial[name].values for name in ("x_m", "y_m")])
        if guessed_heading_unit(trial.t_s, place_m, trial["theta_rad"].values)[0]:
            return True
    return False


def _origin(key: str, known: Container[str], estimated: Container[str], *, has_ticks: bool) -> str:
    """Return the comment for a number of the wheels that may be wrong."""
    if not has_ticks:
        return "not used: no counts"
    if key in known:
        return "given, but the ticks were estimated with it"
    return _ESTIMATED if key in estimated else _ASSUMED


def _ranges(measurement: Measurement, known: Mapping[str, float]) -> Iterator[str]:
    sides = compared_sides(measurement, known)
    if not sides:
        return
    yield "tof:"
    yield _Value(0.0, 0.002, "a calibrated sensor; usual tolerance between units").line("range_offset_m")
    yield f"  max_range_m: {known.get('max_range_m', 1.2):g}  # beyond it, readings are not used"
    yield "  mount:  # in the frame of the axle: x ahead, y to the left, yaw counter-clockwise from straight ahead"
    for side in sides:
        x, y, yaw = (known[f"{side}_{end}"] for end in ("x_m", "y_m", "yaw_deg"))
        yield f"    {side}: {{x_m: {x:g}, y_m: {y:g}, yaw_rad: {radians(yaw):.6g}}}  # given"
    yield "world:  # an empty room with 0 <= x <= room_x_m and 0 <= y <= room_y_m"
    yield f"  room_x_m: {known['room_x_m']:g}  # given"
    yield f"  room_y_m: {known['room_y_m']:g}  # given"


def compared_sides(measurement: Measurement, known: Mapping[str, float]) -> list[str]:
    """Return the range sensors whose readings can be predicted: logged, with pose, mount and room."""
    if not measurement.has("x_m", "y_m", "theta_rad") or not {"room_x_m", "room_y_m"} <= set(known):
        return []
    return [
        side
        for side in RANGE_SIDES
        if measurement.has(f"tof_{side}_m") and {f"{side}_x_m", f"{side}_y_m", f"{side}_yaw_deg"} <= set(known)
    ]
