"""What a stage is: one link of the signal chain, simulated from what was *measured* at its input.

A wrong motor then does not spoil the poses, errors do not add up along a drive, and where measurement and prediction
part tells where the fault is. The stages run the simulator's own models, so that what a diagnosis finds is a fault of
the robot and not of a second model.
"""

from collections.abc import Callable

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement, Trial
from physics.trajectory import TimeSeries

Prediction = tuple[TimeSeries, ...]
"""Of one trial: a series for each reading that the stage predicts, of its name and times; NaN where an input misses."""

Stage = Callable[[Measurement, RobotConfig], tuple[Prediction, ...]]
"""Predictions of every trial, by a robot with its terms."""


def predicted(trial: Trial, name: str, unit: str, values: np.ndarray) -> TimeSeries:
    """A series at the rows of a trial."""
    return TimeSeries(name, unit, trial.t_s.copy(), values.astype(np.float64))
