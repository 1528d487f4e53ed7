"""Experiments with the QTR-8A of the robot across a straight tape, against closed forms and the paper's Fig. 5."""

from configs.schema.robot import RobotConfig
from diagnosis.validation.experiment import Experiment, ValidatedPart
from diagnosis.validation.line_sensor.channels import channels, converter
from diagnosis.validation.line_sensor.edge import edges
from diagnosis.validation.line_sensor.rig import Tape
from diagnosis.validation.line_sensor.threshold import threshold
from symolo.core.errors import InputError


def require_threshold(robot: RobotConfig) -> None:
    """Refuse a sensor whose threshold never distinguishes the tape from the floor.

    Raises:
        InputError: The threshold does not lie between the two.
    """
    tape = Tape()
    if not tape.reflectance < robot.line_sensor.threshold < tape.floor_reflectance:
        allowed = f"between the tape's {tape.reflectance} and the floor's {tape.floor_reflectance}"
        raise InputError("robot.line_sensor.threshold", got=robot.line_sensor.threshold, allowed=allowed)


LINE_SENSOR = ValidatedPart(
    "line-sensor",
    (
        Experiment("edge", "How wide the edge of the tape is to each channel, at two heights of the sensor.", edges),
        Experiment("channels", "Gains and offsets of the channels of many robots are spread as configured.", channels),
        Experiment("converter", "The converter has all of its levels, in equal steps.", converter),
        Experiment("threshold", "Which channels are on, and the line error, as in the paper's Fig. 5.", threshold),
    ),
    require_threshold,
)
