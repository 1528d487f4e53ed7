"""The places of a kind of case where a law may act, with those of range sensors."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from configs.effects.base import Slot
from configs.schema.robot import Motor
from diagnosis.discovery.motor_places import motor_places, wheel_places
from diagnosis.discovery.place import STEP, TIMES, LawPlace, QuantityRead, varying
from diagnosis.discovery.pose_places import pose_places
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.case_files.case_format import RANGE_SIDES
from diagnosis.measured.measurement import CaseKind

RANGE_CHANNEL = "tof_m"
OF_ONE_SENSOR = ("distance_m", STEP, *TIMES)
"""Covariates of a law of one range sensor."""
FACING: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "wall_facing_plus_x": ("+x", 0.0),
        "wall_facing_minus_x": ("-x", np.pi),
        "wall_facing_plus_y": ("+y", 0.5 * np.pi),
        "wall_facing_minus_y": ("-y", -0.5 * np.pi),
    }
)
"""The walls of a rectangular room: the direction of the normal in words and in rad."""
_VIEW = "from sensors.ranging.range_view import RangeView"


def places(kind: CaseKind, evidence: Evidence, motor: Motor) -> tuple[LawPlace, ...]:
    """Return the places of a kind of case.

    Args:
        kind: Kind of the case.
        evidence: The observations.
        motor: The nominal motor, by which a current is a torque.
    """
    if kind is CaseKind.TOF_BENCH:
        return (_range(QuantityRead(evidence, "reading_m"), ("Setup.RANGE_BENCH",)),)
    if kind is CaseKind.RANGE_SCAN:
        return (_rays(evidence),)
    if kind in {CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP}:
        return tuple(motor_places(evidence, motor, by_steps=kind is CaseKind.MOTOR_STEP))
    if kind is CaseKind.DRIVE_LOG:
        return tuple(_drive_places(evidence, motor))
    return ()


def _drive_places(evidence: Evidence, motor: Motor) -> Iterator[LawPlace]:
    """Yield the places of motors, wheels and range sensors: those of all alike, and of each alone."""
    yield from wheel_places(evidence, motor)
    yield from pose_places(evidence)
    ranges = [o.name for o in evidence.observed if o.channel == RANGE_CHANNEL and o.usable.any()]
    if not ranges:
        return
    every = _range(QuantityRead(evidence, *ranges, drives=True), ("Setup.DRIVE",))
    # A memory of all sensors is a delay, which is a listed effect.
    yield replace(every, covariates={name: each for name, each in every.covariates.items() if name != STEP})
    for sensor in RANGE_SIDES:
        if f"tof_{sensor}_m" in ranges:
            place = _range(QuantityRead(evidence, f"tof_{sensor}_m", drives=True), ("Setup.DRIVE",))
            noun = f"the range of the {sensor} sensor"
            yield place.at(sensor, f'view.of_sensor("{sensor}")', noun, *OF_ONE_SENSOR)
    for wall, (words, direction_rad) in FACING.items():
        noun = f"the range to walls that face {words}"
        yield replace(every.at(wall, f"view.facing({direction_rad:.6g})", noun), may_be_constant=True)


def _range(read: QuantityRead, setups: tuple[str, ...]) -> LawPlace:
    covariates = (
        read.covariate("distance_m", "distance", "distance [m]", "m", "view.distance_m"),
        read.covariate(
            "incidence_rad", "incidence", "angle of incidence [rad]", "rad", "np.abs(view.incidence_rad)", is_size=True
        ),
        read.covariate("temperature_C", "temperature", "temperature [C]", "C", "view.temperature_C"),
        read.covariate("ambient_lux", "light", "ambient light [lux]", "lux", "view.ambient_lux"),
        read.time("view.time_s"),
        read.covariate(
            STEP,
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
        covariates=varying(covariates),
        imports=(_VIEW,),
        setups=setups,
    )


def _rays(evidence: Evidence) -> LawPlace:
    """Return the weight of a ray, of which a scan shows how the reading changes from the middle of the object on."""
    read = QuantityRead(evidence, "reading_m")
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
        covariates=varying((distance,)),
        imports=(),
        setups=("Setup.RANGE_SCAN",),
    )
