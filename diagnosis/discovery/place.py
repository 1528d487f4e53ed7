"""The places where a law may act: slots of the simulator, with the covariates that their functions can see."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import Motor
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.measurement import CaseKind
from symolo.core.arrays import Array

MIN_SPREAD = 1e-6
"""Range of a covariate, relative to its size, up to which it is constant."""


@dataclass(frozen=True)
class SlotCovariate:
    """A quantity that the functions of a slot can see, over the rows of the fit."""

    name: str
    """Name among the covariates of the stage."""
    word: str
    """Name in that of an effect."""
    words: str
    """Name in a sentence."""
    unit: str
    expression: str
    """The quantity in the code of an effect."""
    values: Array
    """(n,), sorted values of the rows of the fit, none of them missing."""
    is_past: bool = False
    """Whether only forms that depend on its past may have it, since the code sees what is kept of it."""

    @property
    def low(self) -> float:
        return float(self.values[0])

    @property
    def high(self) -> float:
        return float(self.values[-1])

    @property
    def varies(self) -> bool:
        return len(self.values) > 0 and self.high - self.low > MIN_SPREAD * max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class LawPlace:
    """A slot, with what the code of an effect in it looks like."""

    slot: Slot
    prefix: str
    """Beginning of the names of its laws."""
    noun: str
    """What a law changes, in a sentence."""
    first: str
    """First argument of `apply`, which the law changes."""
    arguments: str
    unit: str
    size: float
    """A visible change, in the unit of the slot."""
    covariates: Mapping[str, SlotCovariate]
    imports: tuple[str, ...]
    setups: tuple[str, ...]
    is_odd: bool = False
    """Whether the law has the sign of the quantity, and its covariate is the size of it."""
    is_factor: bool = False
    """Whether the law is the change of a factor on the quantity."""


_MOTION = "from physics.drivetrain.motion import ShaftMotion"
_BENCH, _BENCH_AND_DRIVE = ("Setup.MOTOR_BENCH",), ("Setup.MOTOR_BENCH", "Setup.DRIVE")
_VIEW = "from sensors.ranging.range_view import RangeView"
VISIBLE_SIGMAS = 3.0
"""Size of a visible change, in standard deviations of the noise."""
MAX_FACTOR = 0.5
"""Largest change of a factor at which a fit starts."""


def places(kind: CaseKind, evidence: Evidence, motor: Motor) -> tuple[LawPlace, ...]:
    """Return the places of a kind of case.

    Args:
        kind: Kind of the case.
        evidence: The observations.
        motor: The nominal motor, by which a current is a torque.
    """
    if kind is CaseKind.TOF_BENCH:
        return (_range(evidence),)
    if kind is CaseKind.RANGE_SCAN:
        return (_rays(evidence),)
    if kind is CaseKind.MOTOR_STEADY:
        return tuple(_of_motor(evidence, motor))
    return ()


def _range(evidence: Evidence) -> LawPlace:
    read = _Read(evidence, "reading_m")
    covariates = (
        read.covariate("distance_m", "distance", "distance [m]", "m", "view.distance_m"),
        read.covariate(
            "incidence_rad", "incidence", "angle of incidence [rad]", "rad", "np.abs(view.incidence_rad)", is_size=True
        ),
        read.covariate("temperature_C", "temperature", "temperature [C]", "C", "view.temperature_C"),
        read.covariate("ambient_lux", "light", "ambient light [lux]", "lux", "view.ambient_lux"),
        read.time("view.time_s"),
        read.covariate(
            "distance_step_m",
            "step",
            "change of the distance since the reading before [m]",
            "m",
            "(view.distance_m - view.previous_distance_m)",
            is_past=True,
        ),
    )
    return LawPlace(
        Slot.RANGE,
        prefix="range",
        noun="the range",
        first="reading_m",
        arguments="reading_m: Array, view: RangeView",
        unit="m",
        size=read.visible,
        covariates=_varying(covariates),
        imports=(_VIEW,),
        setups=("Setup.RANGE_BENCH",),
    )


def _rays(evidence: Evidence) -> LawPlace:
    """Return the weight of a ray, of which a scan shows how the reading changes from the middle of the object on."""
    read = _Read(evidence, "reading_m")
    words = "distance from the middle of the object [m]"
    distance = read.covariate("from_middle_m", "distance", words, "m", "distance_m", is_past=True)
    return LawPlace(
        Slot.RAY_WEIGHT,
        prefix="ray_weight",
        noun="the weight of a ray",
        first="weight",
        arguments="weight: Array, distance_m: Array",
        unit="1",
        size=1.0,
        covariates=_varying((distance,)),
        imports=(),
        setups=("Setup.RANGE_SCAN",),
    )


def _of_motor(evidence: Evidence, motor: Motor) -> Iterator[LawPlace]:
    reads = {o.name: _Read(evidence, o.name) for o in evidence.observed if o.usable.any()}
    for name, read in reads.items():
        is_current = name == "current_A"
        if is_current:
            yield _friction(read, motor)
        yield from _reading(read, name, is_current=is_current)
        yield _gain(read, is_current=is_current)
    for name in ("omega_rad_s", "current_A"):
        if name in reads:
            yield from _winding(reads[name], motor, by_speed=name == "omega_rad_s")
            return


def _friction(read: "_Read", motor: Motor) -> LawPlace:
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
        size=motor.torque_constant_N_m_A * read.visible,
        covariates=_varying((speed, read.time("motion.time_s"), trend)),
        imports=(_MOTION,),
        setups=_BENCH_AND_DRIVE,
    )


def _reading(read: "_Read", name: str, *, is_current: bool) -> Iterator[LawPlace]:
    """Yield what an instrument reads over the true value."""
    first, unit = ("current_A", "A") if is_current else ("speed_rad_s", "rad/s")
    word, words = ("current", "current [A]") if is_current else ("speed", "speed [rad/s]")
    own = read.covariate(name, word, words, unit, f"np.abs({first})", is_size=True)
    if own is None or not own.varies:
        return
    yield LawPlace(
        Slot.CURRENT_READING if is_current else Slot.SPEED_READING,
        prefix=f"{word}_reading",
        noun=f"the reading of the {word}",
        first=first,
        arguments=f"{first}: Array",
        unit=unit,
        size=read.visible,
        covariates={name: own},
        imports=(),
        setups=_BENCH_AND_DRIVE if is_current else _BENCH,
        is_odd=True,
    )


def _gain(read: "_Read", *, is_current: bool) -> LawPlace:
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
        covariates=_varying((read.time("time_s"),)),
        imports=(),
        setups=_BENCH_AND_DRIVE if is_current else _BENCH,
        is_factor=True,
    )


def _winding(read: "_Read", motor: Motor, *, by_speed: bool) -> Iterator[LawPlace]:
    """Yield resistance and torque constant over time, and the heat of the winding."""
    of_constant = min(read.visible / read.typical, MAX_FACTOR)
    # A resistance takes R I / K from the speed, in which friction keeps the current nearly constant.
    dry_A = motor.coulomb_friction_N_m / motor.torque_constant_N_m_A
    lost_rad_s = motor.winding_resistance_ohm * dry_A / motor.torque_constant_N_m_A
    of_resistance = min(read.visible / max(lost_rad_s, 1e-9), MAX_FACTOR) if by_speed else of_constant
    for slot, noun, first, size in (
        (Slot.RESISTANCE, "the winding resistance", "resistance_ohm", of_resistance),
        (Slot.TORQUE_CONSTANT, "the torque constant", "torque_constant_N_m_A", of_constant),
    ):
        yield LawPlace(
            slot,
            prefix=slot.value.replace(" ", "_"),
            noun=noun,
            first=first,
            arguments=f"{first}: Array, time_s: float | Array",
            unit="1",
            size=size,
            covariates=_varying((read.time("time_s"),)),
            imports=(),
            setups=_BENCH_AND_DRIVE,
            is_factor=True,
        )
    voltage = read.covariate("u_cmd_V", "voltage", "voltage [V]", "V", "voltage_V", is_size=True, is_past=True)
    yield LawPlace(
        Slot.WINDING_HEAT,
        prefix="resistance",
        noun="the winding resistance",
        first="share",
        arguments="share: float | Array, voltage_V: Array, duration_s: float | Array",
        unit="1",
        size=of_resistance,
        covariates=_varying((voltage, read.time("duration_s", is_past=True))),
        imports=(),
        setups=_BENCH_AND_DRIVE,
    )


def _varying(covariates: Sequence[SlotCovariate | None]) -> dict[str, SlotCovariate]:
    return {each.name: each for each in covariates if each is not None and each.varies}


class _Read:
    """The covariates of one observed quantity."""

    def __init__(self, evidence: Evidence, name: str) -> None:
        number = next(k for k, observed in enumerate(evidence.observed) if observed.name == name)
        self._observed = evidence.observed[number]
        self._rows = evidence.fit[evidence.places[number]]
        sd = evidence.sd[evidence.places[number]][self._rows]
        self.visible = VISIBLE_SIGMAS * float(np.median(sd)) if len(sd) else 1.0
        """A visible change of the reading."""
        sizes = np.abs(self._observed.values[self._rows])
        sizes = sizes[np.isfinite(sizes) & (sizes > 0.0)]
        self.typical = float(np.median(sizes)) if len(sizes) else 1.0
        """Median size of a reading that is not 0."""

    def time(self, expression: str, *, is_past: bool = False) -> SlotCovariate | None:
        """Return the time since power-on."""
        words = "time since power-on [s]"
        return self.covariate("t_s", "time", words, "s", expression, is_past=is_past)

    def covariate(
        self,
        name: str,
        word: str,
        words: str,
        unit: str,
        expression: str,
        *,
        is_size: bool = False,
        is_past: bool = False,
    ) -> SlotCovariate | None:
        """Return a covariate over the rows of the fit; None if the quantity has none of this name."""
        listed = next((each for each in self._observed.covariates if each.name == name), None)
        if listed is None:
            return None
        values = listed.values[self._rows & np.isfinite(listed.values)]
        sizes = np.sort(np.abs(values) if is_size else values)
        return SlotCovariate(name, word, words, unit, expression, sizes, is_past)
