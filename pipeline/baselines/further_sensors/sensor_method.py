"""Methods that need one sensor of `robot.sensors`."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from pipeline.baselines.base import Method, TrainingRun
from pipeline.baselines.further_sensors.readings import FurtherReadings
from pipeline.baselines.robot_knowledge import RobotKnowledge
from symolo.core.errors import InputError
from symolo.evaluation.estimate import Estimate

Log = TypeVar("Log")


def sensor_method(
    name: str,
    title: str,
    what: str,
    *,
    log_of: Callable[[FurtherReadings], Log | None],
    missing: str,
    estimate: Callable[[RobotKnowledge, Log], Estimate],
) -> Method:
    """Return a method that estimates the poses of a run by the log of a sensor.

    Args:
        name: Name for `--methods`.
        title: Name in figures.
        what: Line about the readings that the method uses, and how.
        log_of: Function that returns the log of the sensor, or None without the sensor.
        missing: Message for a dataset without the sensor.
        estimate: Function that returns the estimate by the log.
    """

    def estimated(
        knowledge: RobotKnowledge, _training_runs: Sequence[TrainingRun], _rng: np.random.Generator
    ) -> Estimate:
        log = log_of(knowledge.further)
        if log is None:
            raise InputError(missing)
        return estimate(knowledge, log)

    def lacks(further: FurtherReadings) -> str:
        return missing if log_of(further) is None else ""

    return Method(name, title, what, estimated, lacks=lacks)
