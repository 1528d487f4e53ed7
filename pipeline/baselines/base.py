"""The interface of localisation methods: from the knowledge of a robot they estimate poses with covariances."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.baselines.further_sensors.readings import FurtherReadings
from pipeline.baselines.robot_knowledge import RobotKnowledge, RunImages
from symolo.core.arrays import Array
from symolo.evaluation.estimate import Estimate

NO_IMAGES = "there are no images: release the scenario, with rates.camera_hz above 0"
"""Why a method that reads images cannot be used."""


@dataclass(frozen=True)
class TrainingRun:
    """Images of another run with their true poses, from which a method learns."""

    images: RunImages
    pose: Array
    """(M, 3), x [m], y [m], yaw [rad] in W at each image."""


def _nothing(_further: FurtherReadings) -> str:
    return ""


@dataclass(frozen=True)
class Estimator:
    """The source of estimates that the table compares."""

    name: str
    """Name in the table, and of a method for `--methods`."""
    title: str
    """Name in figures."""
    what: str
    """Line about the readings that a method uses, and how; or the file of the estimates."""


@dataclass(frozen=True)
class Method(Estimator):
    """A method that is included."""

    estimate: Callable[[RobotKnowledge, Sequence[TrainingRun], np.random.Generator], Estimate]
    """Estimates the poses of a run; training runs are the other runs of the release, in random order."""
    learns: bool = False
    """Whether it needs training runs, and so images and another run."""
    lacks: Callable[[FurtherReadings], str] = _nothing
    """Returns why a method cannot be used with these readings of `robot.sensors`; empty where it can."""
