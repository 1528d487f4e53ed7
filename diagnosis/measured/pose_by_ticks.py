"""How the pose of a drive moves with the ticks of its encoders, and signs that both do not belong together."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.measured.measurement import Measurement, Trial
from diagnosis.measured.noise import trimmed_variance
from diagnosis.motor_identification import least_squares
from logs.times import usual_step
from symolo.core.arrays import Array

MIN_ROWS = 20
"""Number of rows from which an equation is fitted."""
MIN_SHARE = 0.5
"""Share that the ticks explain of the motion of a robot, below which poses and ticks do not belong together."""
SPAN_S = 0.5
"""Time over which the motion is judged: over a single row, the noise of a tracker may be larger."""
TINY = 1e-30
SLOW = 0.25
"""Motion of the wheels, as a share of a fast one, up to which they count as standing."""
USUAL = 0.75
"""Quantile of the sizes of a column that counts as a usual value."""
MIN_STEP_M, MIN_TURN_RAD = 0.01, 0.05
"""Root mean square of distances and turns over SPAN_S from which they are motion rather than noise."""


@dataclass(frozen=True)
class PoseByTicks:
    """How the pose moves with the ticks, by least squares over all rows."""

    m_per_tick: float
    """Distance forward for a change of the mean of both ticks by one."""
    rad_per_tick: float
    """Turn for a change of the difference of the ticks, right minus left, by one."""
    pose_xy_m: float
    """Standard deviation of the noise of x_m and y_m in one row [m]."""
    pose_theta_rad: float
    """Standard deviation of the noise of theta_rad in one row [rad]."""
    span_m_per_tick: float
    """Metres per tick over SPAN_S: less exact on curves, and right for a tracker that holds its poses."""
    span_rad_per_tick: float
    """Radians per tick over SPAN_S."""
    forward_share: float
    """Share of the squares of the distances over SPAN_S that the ticks explain."""
    turn_share: float
    """Share of the squares of the turns over SPAN_S that the ticks explain."""
    turn_share_of_mean: float
    """Share of the squares of the turns over SPAN_S that the mean of the ticks explains, with its sign. It is that of
    their difference if one of the counts has the wrong sign."""
    is_forward_clear: bool
    """Whether pose and wheels drive rather than turn on the spot, so that `forward_share` says something."""
    is_turn_clear: bool
    """Whether the pose turns more than its noise, so that `turn_share` says something."""

    @property
    def is_explained(self) -> bool:
        """Whether the ticks explain both distances and turns, so that a robot's dimensions follow from them."""
        return min(self.forward_share, self.turn_share) >= MIN_SHARE and min(self.m_per_tick, self.rad_per_tick) > 0.0

    @property
    def has_wrong_sign(self) -> bool:
        """Whether the pose turns with the sum of the counts, so that one of them has the wrong sign."""
        return self.is_turn_clear and self.turn_share < MIN_SHARE <= abs(self.turn_share_of_mean)

    def contradictions(self) -> Iterator[str]:
        """Yield a sentence for the sign, if there is one, that poses and ticks do not belong together."""
        if self.has_wrong_sign:
            side, other = ("left", "right") if self.turn_share_of_mean > 0.0 else ("right", "left")
            yield (
                f"enc_{side}_ticks has the wrong sign: theta_rad turns with the sum of the counts and not with their "
                f"difference; give enc_{side}_ticks factor: -1, or enc_{other}_ticks if the pose then moves backwards"
            )
        elif self.is_turn_clear and self.turn_share < MIN_SHARE:
            yield "theta_rad does not follow the wheels: check the columns of left and right, heading and time"
        elif self.is_turn_clear and self.rad_per_tick < 0.0:
            yield (
                "theta_rad turns against the wheels: exchange left and right, or give theta_rad (and y_m, if y points "
                "to the right) factor: -1"
            )
        elif self.is_forward_clear and self.forward_share < MIN_SHARE:
            yield (
                "x_m and y_m do not move where theta_rad points: its zero must be along +x, which an offset "
                "in the mapping corrects, and it must count from x to y"
            )
        elif self.is_forward_clear and self.m_per_tick < 0.0:
            yield "the pose moves backwards while the ticks grow: give both columns of ticks factor: -1"


def pose_by_ticks(measurement: Measurement) -> PoseByTicks | None:
    """Return how the pose moves with the ticks; None if one of them is not logged, or nothing moves."""
    if not measurement.has("enc_left_ticks", "enc_right_ticks", "x_m", "y_m", "theta_rad"):
        return None
    steps = _known([_motion(trial, 1) for trial in measurement.trials if len(trial.t_s) > 1])
    forward_m, turn_rad, ticks, more_right, _ = steps.T
    if len(steps) < MIN_ROWS or not ticks.any() or not more_right.any():
        return None
    (m_per_tick,), (rad_per_tick,) = least_squares([ticks], forward_m), least_squares([more_right], turn_rad)
    if m_per_tick == 0.0 or rad_per_tick == 0.0:
        return None
    # Two poses make a step, and outliers of the tracker shall not count.
    left = (forward_m - m_per_tick * ticks, turn_rad - rad_per_tick * more_right)
    sds = [float(np.sqrt(trimmed_variance(each) / 2.0)) for each in left]
    spans = _without_outliers(
        _known([_motion(trial, _rows_of_span(trial)) for trial in measurement.trials if len(trial.t_s) > 1])
    )
    forward, turned, by_ticks, by_difference, distance = spans.T
    turned_rad, distance_m = (float(np.sqrt(np.mean(each**2))) for each in (turned, distance))
    return PoseByTicks(
        m_per_tick,
        rad_per_tick,
        *sds,
        span_m_per_tick=float(forward @ by_ticks / max(by_ticks @ by_ticks, TINY)),
        span_rad_per_tick=float(turned @ by_difference / max(by_difference @ by_difference, TINY)),
        forward_share=float((forward @ by_ticks) ** 2 / max((by_ticks @ by_ticks) * (distance @ distance), TINY)),
        turn_share=float(
            (turned @ by_difference) ** 2 / max((by_difference @ by_difference) * (turned @ turned), TINY)
        ),
        turn_share_of_mean=float(
            (turned @ by_ticks) * abs(turned @ by_ticks) / max((by_ticks @ by_ticks) * (turned @ turned), TINY)
        ),
        is_forward_clear=distance_m > MIN_STEP_M
        and float(by_ticks @ by_ticks) > 0.25 * float(by_difference @ by_difference),
        is_turn_clear=turned_rad > MIN_TURN_RAD,
    )


def _rows_of_span(trial: Trial) -> int:
    rows = round(SPAN_S / usual_step(np.diff(trial.t_s)))
    return min(max(rows, 1), len(trial.t_s) - 1)


def _known(motions: list[Array]) -> Array:
    rows = np.concatenate(motions) if motions else np.zeros((0, 5))
    return rows[np.isfinite(rows).all(axis=1)]


def _without_outliers(spans: Array) -> Array:
    """Return the motions during which the wheels turn, with the large values of each column cut to a usual one.

    Few outliers of a tracker would otherwise make up most of the squares of the distances.
    """
    size = np.abs(spans[:, 2]) + 0.5 * np.abs(spans[:, 3])
    turning = spans[size > SLOW * np.quantile(size, 0.95)] if len(spans) else spans
    if not len(turning):
        return np.zeros((1, 5))
    usual = np.quantile(np.abs(turning), USUAL, axis=0)
    return np.clip(turning, -usual, usual)


def _motion(trial: Trial, rows: int) -> Array:
    """Return distance forward [m], turn [rad], mean ticks, right minus left ticks, and distance [m] over this number of
    rows, (N - rows, 5).
    """
    names = ("x_m", "y_m", "theta_rad", "enc_left_ticks", "enc_right_ticks")
    columns = np.stack([trial[name].values for name in names])
    x, y, turn, left, right = columns[:, rows:] - columns[:, :-rows]
    middle = 0.5 * (columns[2, rows:] + columns[2, :-rows])
    forward = x * np.cos(middle) + y * np.sin(middle)
    return np.stack([forward, turn, 0.5 * (left + right), right - left, np.hypot(x, y)], axis=1)
