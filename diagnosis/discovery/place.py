"""The places where a law may act: slots of the simulator, with the covariates that their functions can see."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from configs.effects.base import Slot
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
    suffix: str
    """End of the name of a number with this unit."""
    expression: str
    """The quantity in the code of an effect."""
    values: Array
    """(n,), sorted values of the rows of the fit, none of them missing."""
    is_time: bool = False

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
    suffix: str
    size: float
    """A visible change, in the unit of the slot."""
    covariates: Mapping[str, SlotCovariate]
    imports: tuple[str, ...]
    setups: tuple[str, ...]
    is_odd: bool = False
    """Whether the law has the sign of the quantity, and its covariate is the size of it."""


_MOTION = "from physics.drivetrain.motion import ShaftMotion"
_VIEW = "from sensors.ranging.range_view import RangeView"
VISIBLE_SIGMAS = 3.0
"""Size of a visible change, in standard deviations of the noise."""


def places(kind: CaseKind, evidence: Evidence, torque_constant_N_m_A: float) -> tuple[LawPlace, ...]:
    """Return the places of a kind of case.

    Args:
        kind: Kind of the case.
        evidence: The observations.
        torque_constant_N_m_A: Torque constant of the nominal motor, by which a current is a torque.
    """
    if kind is CaseKind.TOF_BENCH:
        return (_range(evidence),)
    if kind is CaseKind.MOTOR_STEADY:
        return tuple(_of_motor(evidence, torque_constant_N_m_A))
    return ()


def _range(evidence: Evidence) -> LawPlace:
    read = _Read(evidence, "reading_m")
    covariates = (
        read.covariate("distance_m", "distance", "distance [m]", "m", "m", "view.distance_m"),
        read.covariate(
            "incidence_rad",
            "incidence",
            "angle of incidence [rad]",
            "rad",
            "rad",
            "np.abs(view.incidence_rad)",
            is_size=True,
        ),
        read.covariate("temperature_C", "temperature", "temperature [C]", "C", "C", "view.temperature_C"),
        read.covariate("ambient_lux", "light", "ambient light [lux]", "lux", "lux", "view.ambient_lux"),
        read.covariate("t_s", "time", "time since power-on [s]", "s", "s", "view.time_s", is_time=True),
    )
    return LawPlace(
        Slot.RANGE,
        prefix="range",
        noun="the range",
        first="reading_m",
        arguments="reading_m: Array, view: RangeView",
        unit="m",
        suffix="m",
        size=read.visible,
        covariates={each.name: each for each in covariates if each is not None and each.varies},
        imports=(_VIEW,),
        setups=("Setup.RANGE_BENCH",),
    )


def _of_motor(evidence: Evidence, torque_constant_N_m_A: float) -> list[LawPlace]:
    names = {observed.name for observed in evidence.observed if observed.usable.any()}
    made = []
    for channel, size in (("current_A", torque_constant_N_m_A), ("omega_rad_s", 0.0)):
        if channel not in names:
            continue
        read = _Read(evidence, channel)
        speed = read.covariate(
            "omega_rad_s", "speed", "speed [rad/s]", "rad/s", "rad_s", "np.abs(motion.speed_rad_s)", is_size=True
        )
        time = read.covariate("t_s", "time", "time since power-on [s]", "s", "s", "motion.time_s", is_time=True)
        if size > 0.0:
            made.append(
                LawPlace(
                    Slot.FRICTION,
                    prefix="friction",
                    noun="friction",
                    first="friction_N_m",
                    arguments="friction_N_m: Array, motion: ShaftMotion",
                    unit="N m",
                    suffix="N_m",
                    size=size * read.visible,
                    covariates={each.name: each for each in (speed, time) if each is not None and each.varies},
                    imports=(_MOTION,),
                    setups=("Setup.MOTOR_BENCH", "Setup.DRIVE"),
                )
            )
        is_current = channel == "current_A"
        reading = read.covariate(
            channel,
            "current" if is_current else "speed",
            "current [A]" if is_current else "speed [rad/s]",
            "A" if is_current else "rad/s",
            "A" if is_current else "rad_s",
            f"np.abs({channel})" if is_current else "np.abs(speed_rad_s)",
            is_size=True,
        )
        if reading is None or not reading.varies:
            continue
        made.append(
            LawPlace(
                Slot.CURRENT_READING if is_current else Slot.SPEED_READING,
                prefix="current_reading" if is_current else "speed_reading",
                noun="the reading of the current" if is_current else "the reading of the speed",
                first="current_A" if is_current else "speed_rad_s",
                arguments="current_A: Array" if is_current else "speed_rad_s: Array",
                unit=reading.unit,
                suffix=reading.suffix,
                size=read.visible,
                covariates={reading.name: reading},
                imports=(),
                setups=("Setup.MOTOR_BENCH", "Setup.DRIVE") if is_current else ("Setup.MOTOR_BENCH",),
                is_odd=True,
            )
        )
    return made


class _Read:
    """The covariates of one observed quantity."""

    def __init__(self, evidence: Evidence, name: str) -> None:
        number = next(k for k, observed in enumerate(evidence.observed) if observed.name == name)
        self._observed = evidence.observed[number]
        self._rows = evidence.fit[evidence.places[number]]
        sd = evidence.sd[evidence.places[number]][self._rows]
        self.visible = VISIBLE_SIGMAS * float(np.median(sd)) if len(sd) else 1.0
        """A visible change of the reading."""

    def covariate(  # noqa: PLR0917 - the words of one quantity
        self,
        name: str,
        word: str,
        words: str,
        unit: str,
        suffix: str,
        expression: str,
        *,
        is_size: bool = False,
        is_time: bool = False,
    ) -> SlotCovariate | None:
        """Return a covariate over the rows of the fit; None if the quantity has none of this name."""
        listed = next((each for each in self._observed.covariates if each.name == name), None)
        if listed is None:
            return None
        values = listed.values[self._rows & np.isfinite(listed.values)]
        return SlotCovariate(
            name, word, words, unit, suffix, expression, np.sort(np.abs(values) if is_size else values), is_time
        )
