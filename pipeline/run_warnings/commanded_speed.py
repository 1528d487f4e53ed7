"""Commands of a controller of the user that are probably in another unit."""

from collections.abc import Iterator

import numpy as np

from configs.schema.scenario import RunSpec
from physics.drivetrain.motor import MotorModel
from physics.drivetrain.wheel_loop import voltage_limit_V
from symolo.core.tables.time_series import Recording

FAR_BEYOND = 10.0
"""Ratio of the commanded speed and that of the motors without load, from which the unit is probably another one. A
controller that wants full speed may command a few times as much."""
UNITS = {"cm/s": 0.01, "mm/s": 0.001}
"""Metres per second of each unit that may be meant, the most frequent first."""


def commanded_in_other_units(spec: RunSpec, recording: Recording) -> Iterator[str]:
    """Yield the suspicion that the controller of a run commands in another unit, such as cm/s.

    Voltages count with the speed that they lead to without load.
    """
    if spec.controller is None:
        return
    forward_m_s = np.abs(recording["command"].values[:, 0])
    forward_m_s = forward_m_s[forward_m_s > 0.0]
    motor = MotorModel.from_config(spec.robot.motor)
    reached_m_s = 0.5 * spec.robot.drive.wheel_diameter_m * motor.steady_state(voltage_limit_V(spec.robot.power))[1]
    usual_m_s = float(np.median(forward_m_s)) if len(forward_m_s) else 0.0
    if usual_m_s < FAR_BEYOND * reached_m_s:
        return
    unit, m_s = next(((unit, m_s) for unit, m_s in UNITS.items() if usual_m_s * m_s <= reached_m_s), ("", 1.0))
    meant = f"; {usual_m_s:.3g} {unit} would be {usual_m_s * m_s:.3g} m/s" if unit else ""
    yield (
        f"the controller {spec.controller.name} commands {usual_m_s:.3g} m/s (median), and the motors reach "
        f"{reached_m_s:.2g} m/s without load: its commands are probably in another unit than m/s, rad/s or V{meant}"
    )
