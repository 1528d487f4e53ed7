"""Warnings of a run in which the robot leaves the range where its effects were observed, or where it was measured."""

from collections.abc import Iterator, Sequence

import numpy as np

from configs.posterior.schema import MeasuredRange
from configs.schema.effect_range import EffectRange
from configs.schema.robot import RobotConfig
from symolo.core.arrays import Array
from symolo.core.tables.time_series import Recording

MARGIN = 0.1
"""Distance beyond the range, as a share of its width, that does not count."""
MIN_SHARE = 0.01
"""Least share of the run outside the range that is worth a warning."""
MEAN_S = 0.5
"""Time over which the speeds of the robot are averaged, as in the diagnosis, which sees them as changes of the pose."""


def range_warnings(robot: RobotConfig, recording: Recording, measured: Sequence[MeasuredRange] = ()) -> tuple[str, ...]:
    """Return a warning for each range that a run leaves.

    Args:
        robot: The robot, with the ranges of those effects that were observed.
        recording: The run.
        measured: Ranges over which a diagnosis has measured the robot.
    """
    present = {effect.name for effect in robot.effects}
    effects = [each for each in robot.effect_ranges if each.effect in present]
    return tuple(_warnings(measured, effects, recording))


def _warnings(measured: Sequence[MeasuredRange], effects: Sequence[EffectRange], recording: Recording) -> Iterator[str]:
    for each in measured:
        if each.quantity is not None and (left := _left(each.quantity, each.low, each.high, recording)):
            yield f"the robot was measured for {left}: there its numbers are extrapolated"
    for each in effects:
        if left := _left(each.quantity, each.low, each.high, recording):
            yield f"the effect {each.effect} was observed for {left}: there the effect is extrapolated"


def _left(quantity: str, low: float, high: float, recording: Recording) -> str:
    """Return a range and how far a run leaves it; empty if it does not."""
    values = _values(quantity, recording)
    margin = MARGIN * (high - low)
    values = values[np.isfinite(values)]
    text = f"{quantity} from {low:.3g} to {high:.3g}"
    low, high = within(quantity, low, high)
    outside = values[(values < low - margin) | (values > high + margin)]
    if len(outside) <= MIN_SHARE * len(values):
        return ""
    share = 100.0 * len(outside) / len(values)
    return f"{text}, and {share:.0f} % of this run is outside, between {outside.min():.3g} and {outside.max():.3g}"


def within(quantity: str, low: float, high: float) -> tuple[float, float]:
    """Return a range with the rest in it: every run begins and ends at rest, and hardly anything can be seen there."""
    return (low, high) if quantity == "tof_m" else (min(low, 0.0), max(high, 0.0))


def _values(quantity: str, recording: Recording) -> Array:
    """Return a quantity at every control tick and, if there are several, of every wheel or sensor."""
    if quantity in {"v_m_s", "w_rad_s"}:
        speed = recording.trajectory.twist[:, ("v_m_s", "w_rad_s").index(quantity)]
        rows = min(len(speed), max(1, round(MEAN_S / np.median(np.diff(recording.trajectory.t_s, append=np.inf)))))
        return np.convolve(speed, np.full(rows, 1.0 / rows), mode="valid")
    values = np.asarray(recording[quantity].values, dtype=np.float64)
    if quantity == "tof_m":
        values = np.where(np.asarray(recording["tof_status"].values) == 0, values, np.nan)
    return values.ravel()
