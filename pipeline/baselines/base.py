"""What a localisation method is: from what a robot knows of a run to where it believes that it was, and how surely."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.baselines.robot_knowledge import RobotKnowledge, RunImages
from symolo.core.arrays import Array
from symolo.dataset.rows import Ints


@dataclass(frozen=True)
class Estimate:
    """The poses that a method tells of a run."""

    rows: Ints
    """(M,), the rows of data.csv at which it tells one."""
    pose: Array
    """(M, 3), x [m], y [m], yaw [rad] in W."""
    covariance: Array
    """(M, 3, 3), of the pose, in W."""

    def __post_init__(self) -> None:
        for array in (self.rows, self.pose, self.covariance):
            array.flags.writeable = False


@dataclass(frozen=True)
class TrainingRun:
    """Pictures of another run with their true poses, to learn from."""

    pictures: RunImages
    pose: Array
    """(M, 3), x [m], y [m], yaw [rad] in W at each picture."""


@dataclass(frozen=True)
class Method:
    name: str
    """What `--methods` takes."""
    title: str
    what: str
    """What it is told and what it makes of it, in a line for people."""
    estimate: Callable[[RobotKnowledge, Sequence[TrainingRun], np.random.Generator], Estimate]
    """Of a run; lessons are of the other runs of the release, in an order that says nothing."""
    learns: bool = False
    """Whether it takes lessons, and so pictures and another run."""
