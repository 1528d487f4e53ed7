"""A time stamp that alone is out of order is a fault of the log, and no trial begins or ends there."""

import numpy as np
import pytest

from diagnosis.new_case.proposal import propose
from diagnosis.new_case.rows import measurement_of
from logs.log_file import read_log
from logs.times import stray_rows
from tests.diagnosis.new_case.drives import csv_text, drive_rows


def measured(tmp_path, columns):
    path = tmp_path / "run.csv"
    path.write_text(csv_text(columns))
    log = read_log(path)
    return measurement_of(log, propose(log).mapping, "m")


@pytest.mark.parametrize(("row", "time_ms", "where"), [(3, -60, "row 5"), (3, 9950, "row 5"), (198, 30, "row 200")])
def test_a_stray_time_is_left_out_with_its_row_and_the_trial_goes_on(row, time_ms, where, tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"][row] = time_ms
    measurement = measured(tmp_path, columns)
    (trial,) = measurement.trials
    assert trial.t_s[-1] - trial.t_s[0] == pytest.approx(0.05 * 199)
    (note,) = [note for note in measurement.notes if "out of order" in note]
    assert note == f"left out, because its time alone is out of order: {where}"


def test_new_trials_are_noted_with_the_row_of_the_first_and_the_length_of_the_shortest(tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"][150:] -= 7500
    (note,) = [note for note in measured(tmp_path, columns).notes if "goes back" in note]
    start = "the time goes back 1 time (first in row 152); a new trial begins at each of these rows"
    assert note == f"{start}, and the shortest has 50 rows"


@pytest.mark.parametrize(
    ("t_s", "stray"),
    [
        ([0, 1, 2, 3, 4, 5], []),
        ([0, 1, -9, 3, 4, 5], [2]),
        ([0, 1, 99, 3, 4, 5], [2]),
        ([0, 1, 3, 2, 4, 5], [3]),
        ([0, 1, 2, 0, 1, 2], []),
        ([0, 1, 2, 0, 5, 6], []),
        ([0, 1, 2, 2, 3, 4], []),
        ([5, 0, 1, 2, 3, 4], []),
        ([0, 1, 2, 3, 4, 0], []),
        ([0, 5], []),
        ([0], []),
    ],
)
def test_a_row_is_stray_if_the_times_before_and_after_it_belong_together(t_s, stray):
    assert np.flatnonzero(stray_rows(np.array(t_s, dtype=float))).tolist() == stray
