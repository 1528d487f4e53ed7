"""The stages of a SyMoLo data.csv: speeds against poses, ranges and line readings, as far as the log has them."""

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.nominal import NominalLog
from diagnosis.measured.case_files.symolo_columns import POSES, SPEEDS
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Stage
from diagnosis.predictors.drive_log import offers
from diagnosis.predictors.line_readings import LineReadings
from diagnosis.predictors.pose.by_speeds import PoseByBodySpeeds, PoseByWheelSpeeds
from diagnosis.predictors.ranges.in_arena import RangesInArena


def symolo_csv_stages(measurement: Measurement, nominal: RobotConfig) -> tuple[Stage, ...]:
    """Return the stages that the log has the inputs and readings for."""
    case = measurement.nominal
    if not isinstance(case, NominalLog) or not offers(measurement, POSES):
        return ()
    by_speeds = PoseByWheelSpeeds if case.twist == "odometry" else PoseByBodySpeeds
    stages: list[Stage] = [by_speeds(measurement, nominal)] if offers(measurement, SPEEDS) else []
    arenas = [case.arena] * len(measurement.trials)
    stages.append(RangesInArena(measurement, arenas, case.noise, nominal))
    stages.append(LineReadings(measurement, case, nominal))
    return tuple(stage for stage in stages if any(observed.usable.any() for observed in stage.observed))
