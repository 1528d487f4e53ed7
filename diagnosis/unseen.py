"""Predictions of robots in runs with known inputs and unknown readings, in the columns of a measurement."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors import STAGES
from diagnosis.predictors.base import Observed, Stage
from diagnosis.predictors.pose.by_counts import Pose
from diagnosis.predictors.ranges.in_room import RangesInRoom
from diagnosis.predictors.rows import good_values, joined
from diagnosis.predictors.wheels.speeds import Wheels
from symolo.core.arrays import Array

Columns = Mapping[str, Array]
DIGITS = 7
"""Digits of a number in a file."""


@dataclass(frozen=True)
class UnseenInputs:
    """The inputs of unseen runs of one file, with the stage that predicts their readings."""

    file: str
    """Name of the file of predictions."""
    stage: Stage
    t_s: Array
    """(n,), time of each row since the start of its trial."""
    starts: Array | None = None
    """(N, 3), poses at the start of each trial, from which the whole path is predicted; None for other readings."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the K columns."""
        return POSE if self.starts is not None else tuple(observed.name for observed in self.stage.observed)

    @property
    def observed(self) -> tuple[Observed, ...]:
        """Quantities of the stage, whose covariates tell under which conditions it predicts."""
        return self.stage.observed

    def means(self, robots: Sequence[RobotConfig]) -> Array:
        """Return the predictions (K, M, n) by M robots for n rows; NaN where the inputs determine nothing."""
        if self.starts is None or not isinstance(self.stage, Pose):
            return np.stack([predicted.mean for predicted in self.stage.predict(robots)])
        return np.stack([self.stage.path(robot, self.starts).T for robot in robots], axis=1)


def unseen_inputs(
    measurement: Measurement, robot: RobotConfig, unseen: Mapping[str, Measurement]
) -> tuple[UnseenInputs, ...]:
    """Return the inputs of unseen runs with their stages.

    Args:
        measurement: The case, with its nominal parameters; the unseen runs have the same noise and world.
        robot: The robot with which the stages are bound.
        unseen: Runs by file name, as `read_blind` returns them.

    Returns:
        Inputs with the file names `CASE.csv`, or `CASE_wheels.csv`, `CASE_pose.csv`, `CASE_tof.csv` for a drive.
    """
    inputs = []
    for name, runs in unseen.items():
        part = name.removeprefix("blind_").removesuffix("inputs.csv").rstrip("_")
        whole = replace(runs, nominal=measurement.nominal)
        file = f"{measurement.name}{'_' * bool(part)}{part}.csv"
        starts = _starts(whole) if part == "pose" else None
        times = joined(trial.t_s for trial in whole.trials)
        inputs.append(UnseenInputs(file, _stage(part, whole, robot), times, starts))
    return tuple(inputs)


def csv_text(columns: Columns) -> str:
    """Return a header and a line for each row; cells without a prediction are empty."""
    rows = zip(*columns.values(), strict=True)
    lines = (",".join(f"{value:.{DIGITS}g}" if np.isfinite(value) else "" for value in row) for row in rows)
    return "\n".join([",".join(columns), *lines]) + "\n"


def _stage(part: str, inputs: Measurement, robot: RobotConfig) -> Stage:
    match part:
        case "":
            (stage,) = STAGES[inputs.kind](inputs, robot)
            return stage
        case "wheels":
            return Wheels(inputs, robot)
        case "tof" if isinstance(inputs.nominal, NominalDrive):
            return RangesInRoom(inputs, inputs.nominal, robot)
        case "pose":
            return Pose(inputs, robot)
        case _:
            raise ValueError(f"no stage predicts {part} of {inputs.kind}")


def _starts(inputs: Measurement) -> Array:
    """Return the first pose of each trial (N, 3): the stage predicts changes, and such a run has no other pose."""
    starts = np.stack([good_values(inputs, name) for name in POSE], axis=-1)
    first = np.cumsum([0, *(len(trial.t_s) for trial in inputs.trials[:-1])])
    return starts[first]
