"""Time that each row lasts, of wheels with a smooth speed that are counted at known times."""

import numpy as np
import pytest

from diagnosis.measured.channel import Channel, Role
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors.grid import Grid
from diagnosis.predictors.rows import rows_after
from diagnosis.predictors.wheels.row_lengths import row_lengths_s
from symolo.core.tables.time_series import TimeSeries

PERIOD_S = 0.05
ROWS = 600
JITTER_S = 0.001


def turned_rad(t_s):
    """Angle of a wheel whose speed is 10 rad/s with slow changes by 5 rad/s."""
    return 10.0 * t_s - 5.0 / 0.7 * np.cos(0.7 * t_s)


def row_times_s(jitter_s):
    jitter = np.random.Generator(np.random.PCG64(11)).normal(0.0, jitter_s, ROWS)
    return PERIOD_S * np.arange(ROWS) + jitter - jitter[0]


def lengths_s(logged_s, counted_s, counts_per_turn, outliers=()):
    """Return the lengths by a log with these times whose wheels were counted at other ones, and its logged steps."""
    left, right = (np.rint(counts_per_turn / (2.0 * np.pi) * sign * turned_rad(counted_s)) for sign in (1.0, -1.0))
    left[list(outliers)] += 1000.0
    columns = {"enc_left_ticks": left, "enc_right_ticks": right}
    channels = tuple(Channel.logged(TimeSeries(k, "", logged_s, v), Role.READING) for k, v in columns.items())
    trial = Trial("1", logged_s, np.zeros(ROWS, dtype=bool), channels, begins_s=0.0)
    log = Measurement("m", CaseKind.DRIVE_LOG, MeasurementSource("here", ()), (trial,), None)
    return row_lengths_s(log, Grid.from_measurement(log, 1.0 / PERIOD_S), *rows_after(log, 1)), np.diff(logged_s)


@pytest.mark.parametrize("outliers", [(), range(40, 600, 50)])
def test_rows_that_are_uneven_last_as_their_times_say(outliers):
    times = row_times_s(JITTER_S)
    lengths, steps = lengths_s(times, times, 2000, outliers)
    np.testing.assert_allclose(lengths, steps, rtol=1e-12)


@pytest.mark.parametrize("outliers", [(), range(40, 600, 50)])
def test_even_rows_that_are_stamped_late_last_whole_periods(outliers):
    lengths, _ = lengths_s(row_times_s(JITTER_S), PERIOD_S * np.arange(ROWS), 2000, outliers)
    np.testing.assert_allclose(lengths, PERIOD_S, rtol=1e-12)


def test_with_too_few_counts_to_decide_rows_last_whole_periods():
    """A row has three or four counts, so that rounding hides a thousandth of a second."""
    times = row_times_s(JITTER_S)
    lengths, _ = lengths_s(times, times, 40)
    np.testing.assert_allclose(lengths, PERIOD_S, rtol=1e-12)


def test_rounded_times_are_no_reason_to_take_them():
    times = np.round(row_times_s(0.0) + 1e-5 * np.tile([0.0, 1.0], ROWS // 2), 6)
    lengths, _ = lengths_s(times, times, 2000)
    np.testing.assert_allclose(lengths, PERIOD_S, rtol=1e-12)
