"""Stuck rows of the paper's Table 1, whose figures follow from its own by hand, and of no table."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.importers.paper import IMPORTER
from diagnosis.inference.evidence.stuck_rows import stuck_rows

K, R, B, TC = 0.31057, 2.8535, 0.002701, 0.01742
"""Of the literal recipe of Eq. 21 and 22 on all rows."""


def without_speeds(measurement):
    """All rows as fast as the straight line of the nominal motor."""
    (trial,) = measurement.trials
    volts = trial["u_cmd_V"].values
    speed = np.maximum(volts - R * TC / K, 0.0) / (K + R * B / K)
    channels = tuple(
        replace(c, series=replace(c.series, values=speed)) if c.name == "omega_rad_s" else c for c in trial.channels
    )
    return replace(measurement, trials=(replace(trial, channels=channels),))


def test_the_row_of_a_quarter_volt_is_stuck(robot):
    (row,) = stuck_rows(IMPORTER.read(Path("table-1")), robot)
    assert (row.row, row.voltage_V, row.moves_at_V) == (2, 0.25, 0.5)
    assert row.resistance_ohm == pytest.approx(0.25 / 0.072723)
    assert row.holds_N_m == pytest.approx(K * 0.072723, rel=1e-3)
    assert row.moves_N_m == pytest.approx(2.0 * K * 0.072723, rel=1e-3)
    assert row.nominal_speed_rad_s == pytest.approx((0.25 - R * TC / K) / (K + R * B / K), rel=1e-3)


def test_a_motor_that_moves_where_it_should_has_no_stuck_row(robot):
    assert stuck_rows(without_speeds(IMPORTER.read(Path("table-1"))), robot) == ()
