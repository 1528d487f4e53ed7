"""The stages of a drive: wheels, pose and ranges, each where the log has what it needs."""

from configs.schema.robot import RobotConfig
from diagnosis.measured.measurement import Measurement
from diagnosis.measured.nominal import NominalDrive
from diagnosis.predictors.base import Stage
from diagnosis.predictors.pose import Pose
from diagnosis.predictors.ranges import Ranges
from diagnosis.predictors.wheels import Wheels

VOLTAGES = ("u_left_V", "u_right_V")
TICKS = ("enc_left_ticks", "enc_right_ticks")
POSE = ("x_m", "y_m", "theta_rad")


def drive_log_stages(measurement: Measurement, nominal: RobotConfig) -> tuple[Stage, ...]:
    """Wheels with voltages, pose with ticks, ranges with poses and a known room.

    What a stage is held against may miss, as in unseen runs; it is then predicted and nothing is observed.
    """
    found: list[Stage] = []
    if _offers(measurement, VOLTAGES):
        found.append(Wheels(measurement, nominal))
    if _offers(measurement, TICKS):
        found.append(Pose(measurement, nominal))
    if isinstance(measurement.nominal, NominalDrive) and _offers(measurement, POSE):
        found.append(Ranges(measurement, measurement.nominal, nominal))
    return tuple(stage for stage in found if all(len(of.values) for of in stage.observed))


def _offers(measurement: Measurement, names: tuple[str, ...]) -> bool:
    offered = set(measurement.channel_names())
    return all(name in offered and any(c.is_offered for c in measurement.across(name)) for name in names)
