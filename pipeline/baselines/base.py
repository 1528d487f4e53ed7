"""The interface of localisation methods: from the knowledge of a robot they estimate poses with covariances."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.baselines.further_sensors.readings import FurtherReadings
from pipeline.baselines.robot_knowledge import RobotKnowledge, RunImages
from symolo.core.arrays import Array
from symolo.dataset.tables.rows import Ints

NO_IMAGES = "there are no images: release the scenario, with rates.camera_hz above 0"
"""Why a method that reads images cannot be used."""


@dataclass(frozen=True)
class Estimate:
    """The poses that a method estimates in a run."""

    rows: Ints
    """(M,), rows of data.csv with an estimate."""
    pose: Array
    """(M, 3), x [m], y [m], yaw [rad] in W."""
    covariance: Array
    """(M, 3, 3), covariance of the pose in W."""

    def __post_init__(self) -> None:
        for array in (self.rows, self.pose, self.covariance):
            array.flags.writeable = False


@dataclass(frozen=True)
class TrainingRun:
    """Images of another run with their true poses, from which a method learns."""

    images: RunImages
    pose: Array
    """(M, 3), x [m], y [m], yaw [rad] in W at each image."""


def _nothing(_further: FurtherReadings) -> str:
    return ""


@dataclass(frozen=True)
class Method:
    name: str
    """Name for `--methods`."""
    title: str
    """Name in figures."""
    what: str
    """Line about the readings that the method uses, and how."""
    estimate: Callable[[RobotKnowledge, Sequence[TrainingRun], np.random.Generator], Estimate]
    """Estimates the poses of a run; training runs are the other runs of the release, in random order."""
    learns: bool = False
    """Whether it needs training runs, and so images and another run."""
    lacks: Callable[[FurtherReadings], str] = _nothing
    """Returns why a method cannot be used with these readings of `robot.sensors`; empty where it can."""
