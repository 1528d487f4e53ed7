"""Times of day and dates in a log, as seconds since the first one."""

from datetime import datetime

import pytest

from logs.clock_times import seconds_of
from logs.log_file import read_log
from logs.trajectories.base import ReadSettings
from logs.trajectories.table import READER, propose_trajectory
from symolo.core.errors import InputError


@pytest.mark.parametrize(
    ("first", "second", "seconds"),
    [
        ("2026-05-04T10:00:59.123+02:00", "2026-05-04T10:01:00.173+02:00", 1.05),
        ("2026-05-04T10:00:59Z", "2026-05-04T11:30:59+01:30", 0.0),
        ("2026-05-04T10:00:59-00:30", "2026-05-04T10:30:59.5Z", 0.5),
        ("2026/02/28 23:59:59.9", "2026/03/01 00:00:00", 0.1),
        ("04.05.2026 10:00:59,05", "5.5.2026 10:00:59,1", 86400.05),
        ("10:00:59.123", "10:00:59.173", 0.05),
        ("23:59:59.98", "0:00:00.03", 0.05),
        ("2026-05-04 10:00:59.123456789", "2026-05-04 10:00:59.123456790", 1e-9),
    ],
)
def test_times_are_seconds_since_the_first_one(first, second, seconds):
    texts = seconds_of([first, "", second])
    assert texts is not None
    assert [float(text) if text else None for text in texts] == [0.0, None, seconds]


def test_times_with_a_date_are_those_of_the_standard_library():
    cells = ["2024-02-29T23:59:58.250+05:30", "2024-03-01T02:00:01.5+05:30", "2025-01-01T00:00:00+00:00"]
    dates = [datetime.fromisoformat(cell) for cell in cells]
    assert [float(text) for text in seconds_of(cells) or ()] == [(date - dates[0]).total_seconds() for date in dates]


@pytest.mark.parametrize(
    "cell", ["1.5", "10:00", "2026-13-01T10:00:00", "2026-05-04", "a", "05/04/2026 10:00:00", "10:61:00"]
)
def test_other_cells_are_no_times(cell):
    """Of 05/04/2026, nobody knows the month."""
    assert seconds_of(["10:00:00", cell]) is None


def test_a_column_of_dates_is_a_time_in_seconds(tmp_path):
    path = tmp_path / "run.csv"
    rows = [f"2026-05-04T10:00:{second:02d},{0.1 * second},1,0" for second in range(10)]
    path.write_text("\n".join(["timestamp,x_m,y_m,theta_rad", *rows]) + "\n")
    log = read_log(path)
    assert log.times("timestamp").tolist() == [float(second) for second in range(10)]
    assert "run.csv: column timestamp has times of day, and is read as seconds since its first one" in log.notes
    proposal = propose_trajectory(log)
    assert not proposal.mapping.columns["t_s"].unit
    assert not [warning for warning in proposal.warnings if "timestamp" in warning]


def test_times_of_another_form_are_refused_with_the_forms_that_are_read(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time,x\n05/04/2026 10:00:00,1\n05/04/2026 10:00:01,2\n")
    with pytest.raises(InputError, match=r"row 2: column time: .*such as 2026-05-04T10:00:59.123; write .*: 2 rows"):
        read_log(path).times("time")


@pytest.mark.parametrize(
    ("names", "cells", "column"),
    [
        ("time,millis", ("10:00:00", "0", "10:00:00", "50"), "millis"),
        ("time,t_ms", ("10:00:00", "0", "10:00:00", "50"), "t_ms"),
        ("epoch,time", ("1", "0", "1", "0.05"), "time"),
        ("unix_time,uptime_ms", ("1770000000", "0", "1770000000", "50"), "uptime_ms"),
        ("time,battery", ("10:00:00.00", "7", "10:00:00.05", "7"), "time"),
        ("unix_time,battery", ("1770000000.00", "7", "1770000000.05", "7"), "unix_time"),
    ],
)
def test_the_clock_of_the_controller_comes_before_a_time_of_day(names, cells, column, tmp_path):
    """A time of day often has whole seconds only, so that most rows would have the time of the row above."""
    path = tmp_path / "run.csv"
    path.write_text(f"{names},x_m,y_m,theta_rad\n{cells[0]},{cells[1]},0,0,0\n{cells[2]},{cells[3]},0.1,0,0\n")
    assert propose_trajectory(read_log(path)).mapping.columns["t_s"].column == column


def test_a_time_of_day_that_is_no_time_of_the_trajectory_is_a_column_in_seconds(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("t_s,wall,x_m,y_m,theta_rad\n0,10:00:00.5,0,0,0\n1,10:00:01.5,0.1,0,0\n")
    (trajectory,) = READER.read(path, ReadSettings())
    (table,) = trajectory.tables
    unit, values = table.columns["wall"]
    assert unit == "s"
    assert values.tolist() == [0.0, 1.0]
