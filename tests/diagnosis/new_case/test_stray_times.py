"""A time stamp that alone is out of order is a fault of the log, and no trial begins or ends there."""

import numpy as np
import pytest

from diagnosis.new_case.proposal import propose
from diagnosis.new_case.rows import measurement_of
from logs.log_file import read_log
from logs.times import stray_rows
from symolo.core.errors import InputError
from tests.diagnosis.new_case.drives import csv_text, drive_rows


def measured(tmp_path, columns):
    path = tmp_path / "run.csv"
    path.write_text(csv_text(columns))
    log = read_log(path)
    return measurement_of(log, propose(log).mapping, "m")


STRAY = [(3, -60, "row 5"), (3, 9950, "row 5"), (198, 30, "row 200")]


@pytest.mark.parametrize(("row", "time_ms", "where"), STRAY)
def test_a_stray_time_is_left_out_with_its_row_and_the_trial_goes_on(row, time_ms, where, tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"][row] = time_ms
    measurement = measured(tmp_path, columns)
    (trial,) = measurement.trials
    assert trial.t_s[-1] - trial.t_s[0] == pytest.approx(0.05 * 199)
    (note,) = [note for note in measurement.notes if "out of order" in note]
    assert note == f"left out, because its time alone is out of order: {where}"


@pytest.mark.parametrize(("row", "time_ms", "where", "rows"), [(0, 9950, "row 2", 199), (199, -5, "row 201", 199)])
def test_a_stray_time_in_the_first_or_the_last_row_begins_no_trial(row, time_ms, where, rows, tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"][row] = time_ms
    measurement = measured(tmp_path, columns)
    (trial,) = measurement.trials
    assert len(trial.t_s) == rows
    assert f"left out, because its time alone is out of order: {where}" in measurement.notes


@pytest.mark.parametrize(("row", "time_ms", "where"), STRAY)
def test_a_stray_time_in_a_trial_that_a_column_names_is_left_out(row, time_ms, where, tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["trial"] = np.repeat([1, 2], 100)
    columns["time_ms"][row] = time_ms
    measurement = measured(tmp_path, columns)
    assert len(measurement.trials) == 2
    assert f"left out, because its time alone is out of order: {where}" in measurement.notes


def test_a_clock_that_steps_back_and_stays_there_begins_a_new_trial(tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"][100:] -= 60
    measurement = measured(tmp_path, columns)
    assert len(measurement.trials) == 2
    assert not [note for note in measurement.notes if "out of order" in note]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.1, 0.25, 0.4])
def test_stray_times_of_a_clock_that_scatters_are_left_out(share, seed, tmp_path):
    """Each stamp is off by up to a share of the step, so that no two rows are exchanged."""
    columns = drive_rows(0.05 * np.arange(200))
    rng = np.random.Generator(np.random.PCG64(seed))
    columns["time_ms"] = np.rint(50.0 * (np.arange(200) + rng.uniform(-share, share, 200))).astype(int)
    columns["time_ms"][[30, 90, 150]] = 0, 9990, 20
    measurement = measured(tmp_path, columns)
    assert len(measurement.trials) == 1
    assert "left out, because its time alone is out of order: row 32 and 2 others" in measurement.notes


def test_a_clock_that_scatters_and_begins_again_has_two_trials(tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    rng = np.random.Generator(np.random.PCG64(1))
    columns["time_ms"] = np.rint(50.0 * (np.arange(200) % 100 + rng.uniform(-0.4, 0.4, 200))).astype(int)
    assert len(measured(tmp_path, columns).trials) == 2


@pytest.mark.parametrize("cell", ["", "nan", "later"])
def test_a_row_without_a_time_is_to_be_removed_whatever_its_cell_holds(cell, tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"] = [cell if row in {7, 9} else time_ms for row, time_ms in enumerate(columns["time_ms"])]
    with pytest.raises(InputError) as raised:
        measured(tmp_path, columns)
    assert f"row 9: column time_ms: got {cell!r}, allowed: a number, since it is a time" in str(raised.value)
    assert "remove each row whose time is not known; rows without a time: 2" in str(raised.value)
    assert "empty cell" not in str(raised.value)


def test_a_log_in_which_many_times_are_out_of_order_is_refused(tmp_path):
    columns = drive_rows(0.05 * np.arange(200))
    columns["time_ms"][10:60:10] = -5
    with pytest.raises(InputError, match=r"run.csv: row 12: the times of 5 of 200 rows are out of order") as error:
        measured(tmp_path, columns)
    assert "at most 2 %" in str(error.value)
    columns["time_ms"][50] = 2500
    assert len(measured(tmp_path, columns).trials) == 1


def test_up_to_three_rows_are_left_out_of_a_short_log_too(tmp_path):
    columns = drive_rows(0.05 * np.arange(100))
    columns["time_ms"][10:40:10] = -5
    assert sum(len(trial.t_s) for trial in measured(tmp_path, columns).trials) == 97


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
        ([5, 0, 1, 2, 3, 4], [0]),
        ([0, 1, 2, 3, 4, 0], [5]),
        ([5, 0, 1, 2, 9, 4], [0, 4]),
        ([5, 4, 3, 2, 1, 0], []),
        ([0, 1, 2, 1.8, 2.8, 3.8], []),
        ([0, 1, 2, 0.6, 1.6, 2.6], []),
        ([5, 0], []),
        ([0, 5], []),
        ([0], []),
    ],
)
def test_a_row_is_stray_if_the_times_before_and_after_it_belong_together(t_s, stray):
    assert np.flatnonzero(stray_rows(np.array(t_s, dtype=float))).tolist() == stray
