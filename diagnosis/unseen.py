"""Predictions of a robot in runs with known inputs and unknown readings, in the columns of a measurement."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_format import POSE
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import NominalDrive
from diagnosis.predictors import STAGES
from diagnosis.predictors.pose import Pose
from diagnosis.predictors.ranges_in_room import RangesInRoom
from diagnosis.predictors.rows import good_values
from diagnosis.predictors.wheels import Wheels
from symolo.core.arrays import Array

Columns = Mapping[str, Array]
DIGITS = 7
"""Digits of a number in a file."""


def unseen_runs(measurement: Measurement, robot: RobotConfig, unseen: Mapping[str, Measurement]) -> dict[str, Columns]:
    """Return predictions by the stages of the simulator, each from the inputs of its file.

    Args:
        measurement: The case, with its nominal parameters; the unseen runs have the same noise and world.
        robot: The robot.
        unseen: Runs by file name, as `read_blind` returns them.

    Returns:
        By file name `CASE.csv`, or `CASE_wheels.csv`, `CASE_pose.csv`, `CASE_tof.csv` for a drive: columns (n,) for the
        n rows of the inputs; NaN where they determine nothing.
    """
    predictions: dict[str, Columns] = {}
    for name, inputs in unseen.items():
        part = name.removeprefix("blind_").removesuffix("inputs.csv").rstrip("_")
        whole = replace(inputs, nominal=measurement.nominal)
        predictions[f"{measurement.name}{'_' * bool(part)}{part}.csv"] = _predicted(part, whole, robot)
    return predictions


def csv_text(columns: Columns) -> str:
    """Return a header and a line for each row; cells without a prediction are empty."""
    rows = zip(*columns.values(), strict=True)
    lines = (",".join(f"{value:.{DIGITS}g}" if np.isfinite(value) else "" for value in row) for row in rows)
    return "\n".join([",".join(columns), *lines]) + "\n"


def _predicted(part: str, inputs: Measurement, robot: RobotConfig) -> Columns:
    match part:
        case "":
            (stage,) = STAGES[inputs.kind](inputs, robot)
        case "wheels":
            stage = Wheels(inputs, robot)
        case "tof" if isinstance(inputs.nominal, NominalDrive):
            stage = RangesInRoom(inputs, inputs.nominal, robot)
        case "pose":
            # The stage predicts increments between measured poses; an unseen run has only the first pose of each trial.
            starts = np.stack([good_values(inputs, name) for name in POSE], axis=-1)
            first = np.cumsum([0, *(len(trial.t_s) for trial in inputs.trials[:-1])])
            path = Pose(inputs, robot).path(robot, starts[first])
            return dict(zip(POSE, path.T, strict=True))
        case _:
            raise ValueError(f"no stage predicts {part} of {inputs.kind}")
    predicted = stage.predict([robot])
    return {observed.name: p.mean[0] for observed, p in zip(stage.observed, predicted, strict=True)}
