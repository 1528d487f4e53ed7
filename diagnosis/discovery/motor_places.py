"""The places of a motor, on a bench or in a drive: friction, windings, bridge and supply, and the instruments."""

from collections.abc import Iterator

from configs.effects.base import Slot
from configs.schema.robot import Motor
from diagnosis.discovery.place import MAX_FACTOR, TIMES, LawPlace, QuantityRead, SlotCovariate, varying
from diagnosis.inference.evidence.evidence import Evidence

_AT_WHEEL = "from physics.robot.floor_place import at_wheel"
_MOTION = "from physics.drivetrain.motion import ShaftMotion"
_BENCH, _BENCH_AND_DRIVE = ("Setup.MOTOR_BENCH",), ("Setup.MOTOR_BENCH", "Setup.DRIVE")
WHEELS = ("wheel_left_rad_s", "wheel_right_rad_s")
SIDES = {"left": WHEELS[0], "right": WHEELS[1]}


def motor_places(evidence: Evidence, motor: Motor, *, by_steps: bool) -> Iterator[LawPlace]:
    """Yield the places of a motor.

    Args:
        evidence: The observations.
        motor: The nominal motor, by which a current is a torque.
        by_steps: Whether the motor was measured against time, so that what its supply and its bridge give shows apart
            from what the windings do with it.
    """
    reads = {o.name: QuantityRead(evidence, o.name) for o in evidence.observed if o.usable.any()}
    for name, read in reads.items():
        is_current = name == "current_A"
        if is_current:
            yield _friction(read, motor.torque_constant_N_m_A * read.visible)
        yield from _reading(read, name, is_current=is_current)
        yield _gain(read, is_current=is_current)
        if by_steps:
            yield _error(read, is_current=is_current)
            if not is_current:
                yield _ripple(read)
    for name in ("omega_rad_s", "current_A"):
        if name in reads:
            if by_steps:
                yield from _voltage(reads[name], motor, by_speed=name == "omega_rad_s")
            yield from _winding(reads[name], motor, by_speed=name == "omega_rad_s")
            return


def wheel_places(evidence: Evidence, motor: Motor) -> Iterator[LawPlace]:
    """Yield the places of the motors of a drive, whose currents are not known."""
    sides = [observed.name for observed in evidence.observed if observed.name in WHEELS and observed.usable.any()]
    if not sides:
        return
    read = QuantityRead(evidence, *sides, drives=True)
    # A settled speed falls by R/K^2 for each torque.
    torque_N_m = motor.torque_constant_N_m_A**2 / motor.winding_resistance_ohm * read.visible
    friction = _friction(read, torque_N_m)
    yield friction
    yield from _voltage(read, motor, by_speed=True)
    yield from _winding(read, motor, by_speed=True)
    for side, name in SIDES.items():
        if name in sides:
            noun, share = f"friction at the {side} wheel", f'at_wheel("{side}", friction_N_m)'
            yield friction.at(side, share, noun, *TIMES, imports=(_MOTION, _AT_WHEEL))
            yield _shaft_torque(QuantityRead(evidence, name, drives=True), side, torque_N_m)


def _friction(read: QuantityRead, visible_N_m: float) -> LawPlace:
    speed = read.covariate("omega_rad_s", "speed", "speed [rad/s]", "rad/s", "np.abs(motion.speed_rad_s)", is_size=True)
    trend = read.covariate(
        "voltage_step_V",
        "trend",
        "change of the voltage's size since the row before [V]",
        "V",
        "motion.trend",
        is_past=True,
    )
    return LawPlace(
        Slot.FRICTION,
        prefix="friction",
        noun="friction",
        first="friction_N_m",
        arguments="friction_N_m: Array, motion: ShaftMotion",
        unit="N m",
        size=visible_N_m,
        covariates=varying((speed, read.time("motion.time_s"), trend, *read.place("motion"))),
        imports=(_MOTION,),
        setups=_BENCH_AND_DRIVE,
    )


def _shaft_torque(read: QuantityRead, side: str, visible_N_m: float) -> LawPlace:
    """Return the torque on one wheel over its angle."""
    middle = "(angle_rad + 0.5 * turned_rad)"
    angle = read.covariate("wheel_angle_rad", "angle", "angle of the wheel [rad]", "rad", middle, is_angle=True)
    return LawPlace(
        Slot.SHAFT_TORQUE,
        prefix="torque",
        noun=f"the torque on the {side} wheel",
        first="torque_N_m",
        arguments="torque_N_m: Array, angle_rad: Array, turned_rad: Array",
        unit="N m",
        size=visible_N_m,
        covariates=varying((angle,)),
        imports=(_AT_WHEEL,),
        setups=("Setup.DRIVE",),
        member=side,
        share=f'at_wheel("{side}", torque_N_m)',
        cycles=3,
        mean_over_turn=" * np.sinc({cycles} * turned_rad / (2.0 * np.pi))",
    )


def _reading(read: QuantityRead, name: str, *, is_current: bool) -> Iterator[LawPlace]:
    """Yield what an instrument reads over the true value."""
    first, unit = ("current_A", "A") if is_current else ("speed_rad_s", "rad/s")
    word, words = ("current", "current [A]") if is_current else ("speed", "speed [rad/s]")
    covariate = read.covariate(name, word, words, unit, f"np.abs({first})", is_size=True)
    if covariate is None or not covariate.varies:
        return
    yield LawPlace(
        Slot.CURRENT_READING if is_current else Slot.SPEED_READING,
        prefix=f"{word}_reading",
        noun=f"the reading of the {word}",
        first=first,
        arguments=f"{first}: Array",
        unit=unit,
        size=read.visible,
        covariates={name: covariate},
        imports=(),
        setups=_BENCH_AND_DRIVE if is_current else _BENCH,
        is_odd=True,
    )


def _gain(read: QuantityRead, *, is_current: bool) -> LawPlace:
    """Return the gain of an instrument over time."""
    word = "current" if is_current else "speed"
    return LawPlace(
        Slot.CURRENT_GAIN if is_current else Slot.SPEED_GAIN,
        prefix=f"{word}_gain",
        noun=f"the gain of the {word} sensor",
        first="gain",
        arguments="gain: Array, time_s: Array",
        unit="1",
        size=min(read.visible / read.typical, MAX_FACTOR),
        covariates=varying((read.time("time_s"),)),
        imports=(),
        setups=_BENCH_AND_DRIVE if is_current else _BENCH,
        is_factor=True,
    )


def _error(read: QuantityRead, *, is_current: bool) -> LawPlace:
    """Return what an instrument adds to its reading over time."""
    word, unit, first = ("current", "A", "error_A") if is_current else ("speed", "rad/s", "error_rad_s")
    return LawPlace(
        Slot.CURRENT_ERROR if is_current else Slot.SPEED_ERROR,
        prefix=f"{word}_error",
        noun=f"the error of the {word} sensor",
        first=first,
        arguments=f"{first}: float | Array, time_s: Array",
        unit=unit,
        size=read.visible,
        covariates=varying((read.time("time_s"),)),
        imports=(),
        setups=_BENCH_AND_DRIVE if is_current else _BENCH,
    )


def _ripple(read: QuantityRead) -> LawPlace:
    """Return the ratio of the speed sensor over the angle of the shaft."""
    angle = read.covariate("angle_rad", "angle", "angle of the shaft [rad]", "rad", "angle_rad", is_angle=True)
    return LawPlace(
        Slot.SPEED_RIPPLE,
        prefix="speed_ripple",
        noun="the reading of the speed",
        first="ratio",
        arguments="ratio: Array, angle_rad: Array",
        unit="1",
        size=min(read.visible / read.typical, MAX_FACTOR),
        covariates=varying((angle,)),
        imports=(),
        setups=_BENCH,
        is_factor=True,
    )


def _voltage(read: QuantityRead, motor: Motor, *, by_speed: bool) -> Iterator[LawPlace]:
    """Yield what reaches the motor of each voltage, and the supply over time."""
    arguments = "voltage_V: Array, time_s: float | Array"
    volts = read.visible * (motor.torque_constant_N_m_A if by_speed else motor.winding_resistance_ohm)
    size = _voltage_covariate(read, "np.abs(voltage_V)")
    yield LawPlace(
        Slot.BATTERY,
        prefix="voltage",
        noun="the voltage at the motor",
        first="voltage_V",
        arguments=arguments,
        unit="V",
        size=volts,
        covariates=varying((size,)),
        imports=(),
        setups=_BENCH_AND_DRIVE,
        is_odd=True,
    )
    yield LawPlace(
        Slot.BATTERY,
        prefix="supply",
        noun="the supply voltage",
        first="voltage_V",
        arguments=arguments,
        unit="1",
        size=min(read.visible / read.typical, MAX_FACTOR),
        covariates=varying((read.time("time_s"),)),
        imports=(),
        setups=_BENCH_AND_DRIVE,
        is_factor=True,
    )


def _winding(read: QuantityRead, motor: Motor, *, by_speed: bool) -> Iterator[LawPlace]:
    """Yield resistance and torque constant over time, and the heat of the winding."""
    constant_size = min(read.visible / read.typical, MAX_FACTOR)
    # A resistance takes R I / K from the speed, in which friction keeps the current nearly constant.
    dry_A = motor.coulomb_friction_N_m / motor.torque_constant_N_m_A
    lost_rad_s = motor.winding_resistance_ohm * dry_A / motor.torque_constant_N_m_A
    resistance_size = min(read.visible / max(lost_rad_s, 1e-9), MAX_FACTOR) if by_speed else constant_size
    for slot, noun, first, size in (
        (Slot.RESISTANCE, "the winding resistance", "resistance_ohm", resistance_size),
        (Slot.TORQUE_CONSTANT, "the torque constant", "torque_constant_N_m_A", constant_size),
    ):
        yield LawPlace(
            slot,
            prefix=slot.value.replace(" ", "_"),
            noun=noun,
            first=first,
            arguments=f"{first}: Array, time_s: float | Array",
            unit="1",
            size=size,
            covariates=varying((read.time("time_s"),)),
            imports=(),
            setups=_BENCH_AND_DRIVE,
            is_factor=True,
        )
    voltage = _voltage_covariate(read, "voltage_V", is_past=True)
    time = read.covariate("t_s", "time", "time since power-on [s]", "s", "duration_s", is_past=True)
    yield LawPlace(
        Slot.WINDING_HEAT,
        prefix="resistance",
        noun="the winding resistance",
        first="share",
        arguments="share: float | Array, voltage_V: Array, duration_s: float | Array",
        unit="1",
        size=resistance_size,
        covariates=varying((voltage, time)),
        imports=(),
        setups=_BENCH_AND_DRIVE,
    )


def _voltage_covariate(read: QuantityRead, expression: str, *, is_past: bool = False) -> SlotCovariate | None:
    """Return the size of the commanded voltage, which has one name on a bench and another one in a drive."""
    both = (
        read.covariate(name, "voltage", "voltage [V]", "V", expression, is_size=True, is_past=is_past)
        for name in ("u_cmd_V", "u_V")
    )
    return next((each for each in both if each is not None), None)
