"""Voltages that change between the rows of a log, and how the speeds of the wheels respond to them.

A case holds each voltage from its row to the next. A controller that is faster than the log changes the voltage several
times in between, so that a wheel follows the voltage of the next row before that row is logged. How much of the change
acts early is not known, and differs from row to row.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from configs.schema.robot import RobotConfig
from physics.drivetrain.motor import MotorModel
from symolo.core.arrays import Array
from symolo.core.tables.time_series import TimeSeries

PARTS = 2
"""Parts of a row in which a voltage that changes gradually is taken as constant."""
SHAPES = np.array([[0.0, 0.0], [0.25, 0.75], [1.0, 1.0]])
"""Share of the change to the next row that acts in each part of a row: none of it, a gradual change over the whole row,
and all of it from the beginning on."""

MIN_LAG = 1e-6
"""Smallest time constant of a motor in rows; a motor without inertia follows its voltage at once."""


@dataclass(frozen=True)
class EarlyVoltages:
    """Responses of one quantity to voltages that act before they are logged."""

    changes_of: Callable[[RobotConfig], Array] = field(compare=False, repr=False)
    """Function that returns the changes (2, n) of the predictions by a robot: if each voltage changes gradually to that
    of the next row, and if it changes at the beginning of the row instead of gradually."""
    scatter: Array
    """(n,), root of the sum of the squares of the responses to each change alone, if it acts a whole row early."""

    def for_stated_robot(self, stated: Callable[[RobotConfig], RobotConfig]) -> "EarlyVoltages":
        """Return the responses of a case that states other numbers of the robot, by the function that puts them in."""
        return EarlyVoltages(partial(_changes_of_stated, self.changes_of, stated), self.scatter)


def _changes_of_stated(
    changes_of: Callable[[RobotConfig], Array], stated: Callable[[RobotConfig], RobotConfig], robot: RobotConfig
) -> Array:
    return changes_of(stated(robot))


def shaped(voltage_V: Array, shape: Array) -> Array:
    """Return the voltages (PARTS T, ...) in all parts of the rows.

    Args:
        voltage_V: (T + 1, ...), voltages of the rows and of the row after the last one.
        shape: (PARTS,), one of SHAPES.
    """
    steps = np.diff(voltage_V, axis=0)
    parts = [voltage_V[:-1] + share * steps for share in shape.tolist()]
    return np.stack(parts, axis=1).reshape(-1, *voltage_V.shape[1:])


def held_earlier(series: TimeSeries, shape: Array) -> TimeSeries:
    """Return a value that is held between its changes, with changes that act before their times.

    Args:
        series: The value, at the times of its changes.
        shape: (PARTS,), one of SHAPES, over the step of the log before a change.
    """
    # A little less than the step, so that a change does not begin before the one before it has ended.
    part_s, held = (1.0 - 1e-6) * steps_s(series) / PARTS, np.asarray(series.values, dtype=np.float64)
    begins_s = np.stack([series.t_s[1:] - k * part_s for k in range(PARTS, -1, -1)], axis=1)
    values = np.stack([held[:-1] + share * np.diff(held) for share in (*shape.tolist(), 1.0)], axis=1)
    return TimeSeries(
        series.name,
        series.unit,
        np.concatenate([series.t_s[:1], begins_s.ravel()]),
        np.concatenate([held[:1], values.ravel()]),
    )


def steps_s(series: TimeSeries) -> Array:
    """Return the time (n - 1,) from the row before each change of a value to that change.

    The rows themselves are not known. A value may be held for several of them, and they may be irregular, so that the
    usual distance is the first quartile of those of the changes.
    """
    gaps_s = np.diff(series.t_s)
    return np.minimum(gaps_s, np.quantile(gaps_s, 0.25)) if len(gaps_s) else gaps_s


def independent_responses(motor: MotorModel, inertia_kg_m2: float, steps_V: Array, row_s: float) -> Array:
    """Return the root of the sum of the squares of the responses of each row's mean speed to every step, (T, ...).

    It is that of a motor without dry friction, whose speed is the voltage after a first-order lag.

    Args:
        motor: The motor.
        inertia_kg_m2: Inertia at the wheel, with that of the robot.
        steps_V: (T, ...), voltages that act in one row each, independently of each other.
        row_s: Duration of a row.
    """
    damping = motor.damping_N_m_s_rad
    gain = motor.torque_constant_N_m_A / motor.resistance_ohm / damping
    lag = max(inertia_kg_m2 / damping / row_s, MIN_LAG)
    decay = np.exp(-1.0 / lag)
    at_once = (gain * (1.0 - lag * (1.0 - decay)) * steps_V) ** 2
    later = (gain * lag * (1.0 - decay) ** 2 * steps_V) ** 2
    squares, before = np.empty_like(at_once), np.zeros_like(at_once[0])
    for k in range(len(squares)):
        squares[k] = at_once[k] + before
        before = decay**2 * before + later[k]
    return np.sqrt(squares)
