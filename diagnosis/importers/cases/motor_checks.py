"""Notes on motors whose numbers, or whose logged voltages and speeds, are probably wrong."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from diagnosis.importers.cases.case import scale_note
from diagnosis.measured.case_files.nominal import NominalMotor
from diagnosis.measured.measurement import CHECK, CHECK_UNIT
from symolo.core.arrays import Array

MIN_DRIVEN_ROWS = 10
"""Rows with a voltage and a motion from which the one is judged by the other."""
AGAINST = 0.5
"""Correlation of two quantities, both from zero, beyond which one goes against the other."""
FASTER, SLOWER = 5.0, 0.05
"""Usual speed, as a share of that without load at the same voltage, beyond which number or unit is wrong: a motor is
only faster at a bridge that coasts, and friction seldom leaves so little."""
FEW = 0.02
"""Share of the rows that noise may take below zero in a reading without a sign."""
MOVING_RAD_S = 0.5
"""Speed from which a motor turns."""
LOWEST_SUPPLY_V, HIGHEST_SUPPLY_V = 0.5, 100.0
"""Range of the largest voltage of a bench of small motors."""
LOWEST_V = 0.1
"""Voltage at which no geared motor turns."""
SMALL_MOTORS: Mapping[str, tuple[float, float, str, str]] = {
    "winding_resistance_ohm": (0.02, 500.0, "ohm", "mohm"),
    "torque_constant_N_m_A": (1e-3, 20.0, "N m/A", "mN m/A"),
    "viscous_friction_N_m_s_rad": (0.0, 0.5, "N m s/rad", "mN m s/rad"),
    "coulomb_friction_N_m": (0.0, 5.0, "N m", "mN m"),
    "rotor_inertia_kg_m2": (1e-8, 1.0, "kg m2", "g m2"),
    "supply_voltage_V": (LOWEST_SUPPLY_V, HIGHEST_SUPPLY_V, "V", "mV"),
}
"""Range of each number at the wheel for robots up to some 50 kg, its unit, and a thousandth of that unit."""
LONGEST_S, MAX_DAMPING, MAX_FRICTION = 30.0, 10.0, 0.9
"""Numbers of a motor of any size: time constant of its speed, viscous friction as a multiple of the braking by its
back-EMF, and dry friction as a share of its stall torque."""


def number_checks(motor: NominalMotor, others: Sequence[str] = ()) -> Iterator[str]:
    """Yield a note for each number that no motor of a small robot has.

    Args:
        motor: The numbers.
        others: Other notes on the motor; a number that they name is left out.
    """
    for key, (low, high, unit, thousandth) in SMALL_MOTORS.items():
        number = getattr(motor, key, None)
        value = number if isinstance(number, float | None) else number.value
        if value is None or low <= value <= high or any(key in note for note in others):
            continue
        if value > high and _fits_a_large_motor(key, value, motor):
            continue
        would = "if it was estimated from the log, check the units of voltage, current and speed"
        if low <= 1e-3 * value <= high:
            would = f"if it is in {thousandth}, write {1e-3 * value:.4g}"
        yield f"{CHECK} {key}: {value:.4g} {unit}, where small robots have {low:g} to {high:g} {unit}; {would}"


def _fits_a_large_motor(key: str, value: float, motor: NominalMotor) -> bool:
    """Return whether a friction or inertia is usual in relation to the other numbers of the motor."""
    resistance, constant = motor.winding_resistance_ohm.value, motor.torque_constant_N_m_A.value
    braking = constant**2 / resistance
    largest = {
        "viscous_friction_N_m_s_rad": MAX_DAMPING * braking,
        "coulomb_friction_N_m": MAX_FRICTION * constant * motor.supply_voltage_V / resistance,
        "rotor_inertia_kg_m2": LONGEST_S * braking,
    }
    return value <= largest.get(key, 0.0)


def goes_against(one: Array, other: Array) -> bool:
    """Return whether two quantities (N,), both from zero, mostly have opposite signs; false for too few rows."""
    known = np.isfinite(one + other)
    one, other = one[known], other[known]
    if np.count_nonzero(one * other) < MIN_DRIVEN_ROWS:
        return False
    return float(one @ other) < -AGAINST * float(np.linalg.norm(one) * np.linalg.norm(other))


def sign_check(u_V: Array, values: Array, name: str) -> Iterator[str]:
    """Yield a note if a reading (N,) is positive at voltages (N,) of both signs, as of a sensor that has no sign."""
    known = np.isfinite(u_V + values)
    u_V, values = u_V[known], values[known]
    backward, forward = values[(u_V < 0.0) & (values != 0.0)], values[(u_V > 0.0) & (values != 0.0)]
    if min(len(backward), len(forward)) < MIN_DRIVEN_ROWS:
        return
    below = np.count_nonzero(values < 0.0)
    if below <= FEW * len(values) and min(np.median(backward), np.median(forward)) > 0.0:
        seldom = f"almost never below 0, in {below} of {len(values)} rows" if below else "never below 0"
        rows = f"{np.count_nonzero(u_V < 0.0)} of {len(u_V)} rows"
        yield (
            f"{CHECK} {name}: it is {seldom}, although the voltage is in {rows}, as from a sensor that measures no "
            "sign; log the sign too, or make the case from the rows with voltages of one sign"
        )


def speed_checks(motor: NominalMotor, u_V: Array, speed_rad_s: Array, voltage: str) -> Iterator[str]:
    """Yield a note if a motor turns much faster or slower than the voltage lets it turn without load.

    Args:
        motor: Nominal motor.
        u_V: (N,), voltages [V].
        speed_rad_s: (N,), speeds at the same time [rad/s].
        voltage: Name of the voltage for the note.
    """
    constant = motor.torque_constant_N_m_A.value
    turning = (u_V * speed_rad_s > 0.0) & (np.abs(speed_rad_s) > MOVING_RAD_S)
    if np.count_nonzero(turning) < MIN_DRIVEN_ROWS:
        return
    highest_V = float(np.max(np.abs(u_V[turning])))
    if highest_V < LOWEST_V:
        yield (
            f"{CHECK_UNIT} of {voltage}: the motor turns at {highest_V:.2g} V at most, as if the values were in V and "
            "were taken for mV: multiply by 1000"
        )
        return
    usual, fast = np.quantile(speed_rad_s[turning] * constant / u_V[turning], (0.5, 0.9)).tolist()
    if SLOWER < usual < FASTER:
        return
    # A thousand times a usual voltage is none, so that the constant is wrong.
    wrong_constant = LOWEST_SUPPLY_V <= highest_V <= HIGHEST_SUPPLY_V and 700.0 < fast < 1400.0
    if not wrong_constant and (unit := scale_note(1.0 / fast, voltage, "V", "the voltage of this speed without load")):
        yield from unit
        return
    thousandth = f"; if it is in mN m/A, write {1e-3 * constant:.4g}" if wrong_constant else ""
    fits = f"{'at most' if usual > 1.0 else 'about'} {constant / fast:.2g} N m/A"
    yield (
        f"{CHECK} torque_constant_N_m_A: the motor turns {usual:.2g} times as fast as one with {constant:.4g} N m/A "
        f"does without load at the same voltage; {fits} would fit{thousandth}; check the unit of this number, that "
        f"it is the one at the wheel, gear included, and the units of {voltage} and of the speed"
    )
