"""What a user should know before the diagnosis of a drive with voltages, which may take minutes."""

from pathlib import Path

from diagnosis.measured.case_files.case_format import WHEEL_VOLTAGES
from diagnosis.measured.measurement import CaseKind, Measurement
from logs.mapping import MAPPING


def long_drive_note(case: Path, measurement: Measurement) -> str:
    """Return how long a drive with voltages of the motors takes, and what is faster; empty for other cases.

    Args:
        case: Folder of the case.
        measurement: Its data.
    """
    if measurement.kind is not CaseKind.DRIVE_LOG or not measurement.has(*WHEEL_VOLTAGES):
        return ""
    text = "the drive has voltages of both motors: seconds if no motor differs, and often minutes if something differs"
    if (case / MAPPING).is_file() and measurement.has("enc_left_ticks", "enc_right_ticks", "x_m", "y_m", "theta_rad"):
        names = " and ".join(WHEEL_VOLTAGES)
        text += f"; a case whose {MAPPING} lacks {names} answers only wheels and floor, in seconds"
    return text
