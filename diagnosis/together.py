"""Several cases of one robot as one measurement: a bench, step logs and drives that share everything the robot has.

The samples of all cases form one vector, each with the noise of its own case. The robot is one: its nominal parameters,
which every case must state alike, and its effects. A case says nothing about a parameter that it does not see. What
belongs to a case stays with it: the errors of its session, and the inertia that its wheel turns, which is that of the
motor on a bench and includes the robot in a drive.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from configs.schema.base import Section
from configs.schema.robot import RobotConfig
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.channel import Mask
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource
from diagnosis.nominal_robot import nominal_robot
from diagnosis.nuisances import STEP, Nuisance, Number, change_by_tolerance, nuisances
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Observed, Predicted, Stage
from diagnosis.predictors.wheels.speeds import Wheels
from physics.effects.motor_and_gearbox.gear_backlash import GearBacklash
from symolo.core.arrays import Array
from symolo.core.errors import InputError

INERTIA = "rotor_inertia_kg_m2"
"""The only parameter that two cases of one robot may state differently."""
ORDER = (CaseKind.SYMOLO_CSV, CaseKind.TOF_BENCH, CaseKind.MOTOR_STEADY, CaseKind.MOTOR_STEP, CaseKind.DRIVE_LOG)
"""Kinds of cases by how much of a driving robot they state, the most last: the robot has the numbers of the last."""
DRIVES = (CaseKind.DRIVE_LOG, CaseKind.SYMOLO_CSV)
PLAY = GearBacklash.name
"""The only effect of a motor on a bench that no drive can have, since its wheel is one mass with the robot."""


def together(cases: Sequence[Measurement]) -> Measurement:
    """Return several cases of one robot as one measurement.

    Args:
        cases: At least two cases with different names.

    Raises:
        InputError: A case states no nominal parameters, or is of a kind that cannot be fitted together with others, or
            two cases state different ones.
    """
    for case in cases:
        if case.kind not in ORDER:
            allowed = ", ".join(ORDER)
            raise InputError("cannot be fitted together with others", where=case.where, got=case.kind, allowed=allowed)
        if case.nominal is None:
            cure = "name cases with a nominal.yaml; for runs of a dataset, name its folder, which is one case"
            raise InputError("has no nominal.yaml, so it cannot be fitted together", where=case.where, cure=cure)
    _check_alike(cases)
    # One session has no other to be compared with, and then an angle of the tracked body is an effect.
    drives = [case for case in cases if case.kind in DRIVES]
    has_sessions = len({(case.name, trial.session) for case in drives for trial in case.trials}) > 1
    trials = tuple(
        replace(
            trial,
            name=f"{case.name}/{trial.name}",
            channels=(),
            session=f"{case.name}/{trial.session}".rstrip("/") if has_sessions and case.kind in DRIVES else "",
        )
        for case in cases
        for trial in case.trials
    )
    source = MeasurementSource(
        "several cases of one robot", tuple(file for case in cases for file in case.source.files)
    )
    name = "+".join(case.name for case in cases)
    return Measurement(name, CaseKind.TOGETHER, source, trials, cases=tuple(cases))


def _check_alike(cases: Sequence[Measurement]) -> None:
    stated: dict[str, tuple[float, Measurement]] = {}
    for case in cases:
        for nuisance in _stated(case):
            value, other = stated.setdefault(nuisance.name, (nuisance.value, case))
            if value != nuisance.value and nuisance.name != INERTIA:
                what = f"{nuisance.name} is {nuisance.value:g}, but {value:g} in {other.name}"
                raise InputError(what, where=case.where, cure="write the same number, or diagnose them one by one")


def _stated(case: Measurement) -> tuple[Nuisance, ...]:
    return () if case.nominal is None else nuisances(case.nominal)


def joint_robot(measurement: Measurement, base_robot: RobotConfig) -> RobotConfig:
    """Return a robot with the nominal parameters of all cases of a measurement."""
    robot = base_robot
    for case in sorted(measurement.cases, key=lambda case: ORDER.index(case.kind)):
        if case.nominal is not None:
            before, robot = robot, nominal_robot(case.nominal, robot)
            for effect in before.effects:
                robot = robot if robot.effects.get(type(effect)) is not None else robot.with_effect(effect)
    return robot


def joint_nuisances(measurement: Measurement, robot: RobotConfig, evidence: Evidence) -> tuple[Nuisance, ...]:
    """Return the nuisances of the robot with their smallest tolerance in any case, and those of single cases.

    Args:
        measurement: Several cases as one measurement.
        robot: The robot of all cases.
        evidence: The samples of all cases, by the stages of `joint_stages`.
    """
    shared: dict[str, Nuisance] = {}
    local: list[Nuisance] = []
    first = 0
    for case in measurement.cases:
        rows = (evidence.trial >= first) & (evidence.trial < first + len(case.trials))
        first += len(case.trials)
        for nuisance in _stated(case):
            if nuisance.name == INERTIA and nuisance.value != robot.motor.rotor_inertia_kg_m2:
                local.append(_case_inertia(case, nuisance, robot, evidence, rows))
            elif nuisance.name not in shared or nuisance.tolerance < shared[nuisance.name].tolerance:
                shared[nuisance.name] = nuisance
    return (*shared.values(), *local)


def _case_inertia(
    case: Measurement, nuisance: Nuisance, robot: RobotConfig, evidence: Evidence, rows: Mask
) -> Nuisance:
    """Return a nuisance of the inertia of one case, which changes the samples of that case only."""
    both = []
    for sign in (1.0, -1.0):
        inertia = nuisance.value + sign * STEP * nuisance.tolerance
        stages = [
            stage.with_inertia(inertia) if isinstance(stage, CaseStage) and stage.case == case.name else stage
            for stage in evidence.stages
        ]
        both.append(Evidence(stages).as_measured().predicted([robot]).mean[0])
    more, less = both
    change = np.where(rows & np.isfinite(evidence.values), change_by_tolerance(more, less), 0.0)

    def same(other: RobotConfig, value: Number) -> RobotConfig:
        del value
        return other

    return Nuisance(f"{nuisance.name} of {case.name}", nuisance.value, nuisance.tolerance, nuisance.unit, same, change)


def joint_stages(measurement: Measurement, robot: RobotConfig) -> tuple[Stage, ...]:
    """Return the stages of all cases of a measurement, each with what its case states."""
    return tuple(_stages(measurement, robot))


def _stages(measurement: Measurement, robot: RobotConfig) -> Iterator[Stage]:
    first = 0
    for case in measurement.cases:
        case_robot = robot if case.nominal is None else nominal_robot(case.nominal, robot)
        stated = _differing(robot, case_robot)
        for stage in STAGES[case.kind](case, case_robot):
            yield CaseStage(stage, case.name, first, stated, has_play=case.kind not in DRIVES)
        first += len(case.trials)


def _differing(robot: RobotConfig, case_robot: RobotConfig) -> Mapping[str, Mapping[str, object]]:
    """Return the values of one robot that differ from those of another, by section; effects are left out."""
    differing: dict[str, dict[str, object]] = {}
    for name in type(robot).model_fields:
        section, other = getattr(case_robot, name), getattr(robot, name)
        if isinstance(section, Section) and section != other:
            differing[name] = {key: value for key, value in vars(section).items() if value != getattr(other, key)}
    return MappingProxyType(differing)


class CaseStage:
    """A stage of one of several cases: its quantities carry the name of the case, and its trials count on."""

    def __init__(
        self,
        stage: Stage,
        case: str,
        first_trial: int,
        stated: Mapping[str, Mapping[str, object]],
        *,
        has_play: bool,
    ) -> None:
        """Take the stage of a case.

        Args:
            stage: The stage.
            case: Name of the case.
            first_trial: Number of trials of the cases before it.
            stated: Values that the case states differently from the robot of all cases, by section.
            has_play: Whether the gear of the case may have play.
        """
        self.name, self.at_once = stage.name, stage.at_once
        self.case = case
        self._stage, self._first, self._stated, self._has_play = stage, first_trial, stated, has_play
        self.observed: tuple[Observed, ...] = tuple(
            replace(
                observed,
                name=f"{observed.name}[{case}]",
                trial=observed.trial + first_trial,
                early=observed.early and observed.early.for_stated_robot(self._as_stated),
            )
            for observed in stage.observed
        )

    def predict(self, robots: Sequence[RobotConfig]) -> tuple[Predicted, ...]:
        return self._stage.predict([self._as_stated(robot) for robot in robots])

    def coupling_rad_s(self, robot: RobotConfig, share: float) -> Array | None:
        """Return the change of the speeds of both wheels if the body couples them; None if it is known, or no drive."""
        if not isinstance(self._stage, Wheels):
            return None
        return self._stage.coupling_rad_s(self._as_stated(robot), share)

    def with_inertia(self, inertia_kg_m2: float) -> "CaseStage":
        """Return the stage of a case that states another inertia."""
        motor = {**self._stated.get("motor", {}), INERTIA: inertia_kg_m2}
        stated = {**self._stated, "motor": motor}
        return CaseStage(self._stage, self.case, self._first, stated, has_play=self._has_play)

    def _as_stated(self, robot: RobotConfig) -> RobotConfig:
        for section, values in self._stated.items():
            robot = robot.with_section(section, values)
        return robot if self._has_play else robot.model_copy(update={"effects": robot.effects.without(PLAY)})
