"""Input of the network from a run: small grey images, and the ranges at the same rows."""

from dataclasses import dataclass

import numpy as np

from pipeline.baselines.base import NO_IMAGES
from pipeline.baselines.robot_knowledge import RobotKnowledge
from pipeline.baselines.runs import LoggedRun
from symolo.core.arrays import Array
from symolo.core.errors import InputError

HEIGHT, WIDTH = 48, 64
"""Height and width [px] of the images that the network sees."""
ASPECT_TOLERANCE = 0.02
RANGE_NUMBERS = 6
"""Numbers of the ranges: for each of the three whether it has a target, and the range."""


@dataclass(frozen=True)
class NetworkReadings:
    """Readings at the images of runs."""

    grey: Array
    """(M, 48, 64), grey images from 0 to 1."""
    ranges: Array
    """(M, 6), for front, left and right: 1 if there is a target; then the ranges as shares of the longest one."""

    @classmethod
    def from_knowledge(cls, knowledge: RobotKnowledge) -> "NetworkReadings":
        """Return the readings of a robot.

        Raises:
            InputError: There are no images.
        """
        if knowledge.images is None:
            raise InputError(NO_IMAGES)
        ranges_m = knowledge.ranges_m[knowledge.images.rows]
        target = ~np.isnan(ranges_m)
        share = np.where(target, ranges_m / knowledge.drawing.longest_range_m, 0.0)
        return cls(knowledge.images.grey((HEIGHT, WIDTH)), np.column_stack((target, share)))

    def __len__(self) -> int:
        return len(self.grey)


def check_shape(shape: tuple[int, ...], run: str) -> None:
    """Refuse images whose aspect ratio is not that of the images of the network.

    Raises:
        InputError: It is another one.
    """
    height, width = shape[:2]
    if abs(width / height * HEIGHT / WIDTH - 1.0) > ASPECT_TOLERANCE:
        size = f"images of {width} x {height} px"
        raise InputError("the network needs an aspect ratio of 4:3", where=run, got=size, allowed="such as 160 x 120")


def knowledge_of(run: LoggedRun) -> RobotKnowledge:
    """Return the knowledge of the robot of a run; the readings of a network do not depend on its start."""
    return run.knowledge(np.zeros(3), np.random.Generator(np.random.PCG64(0)))
