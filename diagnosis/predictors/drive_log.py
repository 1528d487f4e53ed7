"""The stages of a drive: wheels, pose and ranges, as far as the log has their inputs."""

from collections.abc import Iterable

from configs.schema.robot import RobotConfig
from diagnosis.measured.case_files.case_format import POSE
from diagnosis.measured.case_files.nominal import NominalDrive
from diagnosis.measured.case_files.symolo_columns import RANGE_READINGS
from diagnosis.measured.measurement import Measurement
from diagnosis.predictors.base import Stage
from diagnosis.predictors.pose.by_counts import Pose
from diagnosis.predictors.ranges.in_arena import RangesInArena
from diagnosis.predictors.ranges.in_room import RangesInRoom
from diagnosis.predictors.wheels.speeds import Wheels

VOLTAGES = ("u_left_V", "u_right_V")
TICKS = ("enc_left_ticks", "enc_right_ticks")


def drive_log_stages(measurement: Measurement, nominal: RobotConfig) -> tuple[Stage, ...]:
    """Return wheels if there are voltages, pose if there are ticks, and ranges if there are poses and a known room or
    arena.

    A stage is left out if nominal.yaml has no section for it. The readings may be missing, as in unseen runs; then they
    are predicted and nothing is observed.
    """
    stages: list[Stage] = []
    case = measurement.nominal if isinstance(measurement.nominal, NominalDrive) else None
    if offers(measurement, VOLTAGES) and (case is None or case.motor is not None):
        stages.append(Wheels(measurement, nominal))
    if offers(measurement, TICKS):
        stages.append(Pose(measurement, nominal))
    if case is not None and case.tof is not None and case.world is not None and offers(measurement, POSE):
        stages.append(RangesInRoom(measurement, case, nominal))
    arenas = [trial.arena for trial in measurement.trials if trial.arena is not None]
    if len(arenas) == len(measurement.trials) and offers(measurement, (*POSE, *RANGE_READINGS)):
        stages.append(RangesInArena(measurement, arenas, None, nominal))
    return tuple(stage for stage in stages if all(len(observed.values) for observed in stage.observed))


def offers(measurement: Measurement, names: Iterable[str]) -> bool:
    offered = set(measurement.channel_names())
    return all(name in offered and any(c.is_offered for c in measurement.across(name)) for name in names)
