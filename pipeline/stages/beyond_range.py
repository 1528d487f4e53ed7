"""Warnings of a run in which an effect of the robot acts outside the range where it was observed."""

from collections.abc import Iterator

import numpy as np

from configs.schema.effect_range import EffectRange
from configs.schema.robot import RobotConfig
from symolo.core.arrays import Array
from symolo.core.time_series import Recording

MARGIN = 0.1
"""Distance beyond the range, as a share of its width, that does not count."""
MIN_SHARE = 0.01
"""Least share of the run outside the range that is worth a warning."""
MEAN_S = 0.5
"""Time over which the speeds of the robot are averaged, as in the diagnosis, which sees them as changes of the pose."""


def range_warnings(robot: RobotConfig, recording: Recording) -> tuple[str, ...]:
    """Return a warning for each range that a run leaves, for the effects that the robot has."""
    present = {effect.name for effect in robot.effects}
    return tuple(text for each in robot.effect_ranges if each.effect in present for text in _left(each, recording))


def _left(seen: EffectRange, recording: Recording) -> Iterator[str]:
    values = _values(seen.quantity, recording)
    margin = MARGIN * (seen.high - seen.low)
    values = values[np.isfinite(values)]
    low, high = seen.low, seen.high
    if seen.quantity != "tof_m":
        # Every run begins and ends at rest. An effect was not seen there only because it is small there.
        low, high = min(low, 0.0), max(high, 0.0)
    outside = values[(values < low - margin) | (values > high + margin)]
    if len(outside) <= MIN_SHARE * len(values):
        return
    share = 100.0 * len(outside) / len(values)
    yield (
        f"the effect {seen.effect} was observed for {seen.quantity} from {seen.low:.3g} to {seen.high:.3g}, and"
        f" {share:.0f} % of this run is outside, between {outside.min():.3g} and {outside.max():.3g}: there the effect"
        " is extrapolated"
    )


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
