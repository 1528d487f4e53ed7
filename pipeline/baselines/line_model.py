"""The probability that the channels of the line sensor see the tape, for many poses at once."""

import numpy as np
from numpy.typing import NDArray

from pipeline.baselines.robot_knowledge import MAP_SD_M, RobotKnowledge
from sensors.line.line_sensor import tape_share
from symolo.core.arrays import Array

WRONG = 0.02
"""Share of readings that no position explains: a joint of the tape, a stain, a reading near the threshold."""


class LineModel:
    """Likelihood of the readings of the line sensor at any pose, by the line of the map."""

    def __init__(self, knowledge: RobotKnowledge) -> None:
        self._row = knowledge.drawing.line
        self._line = knowledge.map.line
        self._blur_m = float(np.hypot(self._row.spot_sd_m, MAP_SD_M))

    def log_likelihood(self, poses: Array, on_line: NDArray[np.bool_]) -> Array:
        """Return the logarithm (P,) of the likelihood of the readings (8,) at the poses (P, 3)."""
        c, s = np.cos(poses[:, 2:]), np.sin(poses[:, 2:])
        x = poses[:, :1] + c * self._row.x_m - s * self._row.y_m
        y = poses[:, 1:2] + s * self._row.x_m + c * self._row.y_m
        share = tape_share(self._line, np.column_stack((x.ravel(), y.ravel())), self._blur_m).reshape(x.shape)
        likely = WRONG + (1.0 - 2.0 * WRONG) * np.where(on_line, share, 1.0 - share)
        return np.log(likely).sum(axis=1)
