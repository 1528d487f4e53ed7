"""Voltages of a drive that change within rows: their means, and the file beside data.csv."""

import numpy as np
import pytest

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from diagnosis.measured.case_files.write_case import write_case
from diagnosis.measured.zero_order_hold import held_means
from symolo.core.errors import InputError

HEADER = "trial,t_s,u_left_V,u_right_V\n"
GOOD = HEADER + "1,0,0.2,0.5\n1,0.025,0.8,\n1,0.05,0.5,\n2,0,0.5,1\n2,0.025,,0\n"
"""Means of 0.5 V in each row, as in the hand-written drive."""


def test_the_mean_of_a_held_value_is_weighted_with_time():
    begins, values = np.array([0.1, 0.2, 0.3, 0.5]), np.array([1.0, np.nan, 4.0, 2.0])
    means = held_means(begins, values, np.array([0.1, 0.25, 0.0, 0.9]), np.array([0.4, 0.1, 0.2, 0.3]))
    np.testing.assert_allclose(means, [(0.2 * 1.0 + 0.2 * 4.0) / 0.4, 2.5, 1.0, 2.0])


def test_without_any_value_there_is_no_mean():
    assert np.isnan(held_means(np.array([0.0]), np.array([np.nan]), np.array([0.0]), 0.1)).all()


@pytest.fixture
def drive(case):
    def make(voltages):
        folder = case("drive_log")
        (folder / "voltages.csv").write_text(voltages)
        return folder

    return make


def test_each_voltage_is_held_until_its_next_value(drive):
    first, second = read_measurement(drive(GOOD), IMPORTERS).trials
    left, right = first.held_inputs
    assert (left.t_s.tolist(), left.values.tolist()) == ([0.0, 0.025, 0.05], [0.2, 0.8, 0.5])
    assert (right.t_s.tolist(), right.values.tolist()) == ([0.0], [0.5])
    assert second.held_inputs[1].values.tolist() == [1.0, 0.0]


def test_the_file_comes_back_from_what_was_written(drive, tmp_path):
    measurement = read_measurement(drive(GOOD), IMPORTERS)
    write_case(measurement, tmp_path / "again")
    assert (tmp_path / "again/voltages.csv").read_text().splitlines()[0] == HEADER.strip()
    again = read_measurement(tmp_path / "again", IMPORTERS)
    for before, after in zip(measurement.trials, again.trials, strict=True):
        for one, other in zip(before.held_inputs, after.held_inputs, strict=True):
            assert (one.t_s.tolist(), one.values.tolist()) == (other.t_s.tolist(), other.values.tolist())


def test_without_the_file_nothing_finer_is_known(case, tmp_path):
    measurement = read_measurement(case("drive_log"), IMPORTERS)
    assert all(trial.held_inputs == () for trial in measurement.trials)
    write_case(measurement, tmp_path / "again")
    assert not (tmp_path / "again/voltages.csv").exists()


@pytest.mark.parametrize(
    ("voltages", "message"),
    [
        (
            GOOD.replace("0.8", "1.8").replace("0.05,0.5", "0.05,0.6"),
            "trial 1 is not the voltage of data.csv: 0.3 V apart",
        ),
        (GOOD.replace("2,0.025", "3,0.025"), "column trial: got '3', allowed: the trials of data.csv"),
        (GOOD.replace("1,0.025", "1,0"), "column t_s: 0 repeats 0"),
        (HEADER + "1,0,0.5,0.5\n", "trial 2 has no u_left_V"),
        (GOOD.replace("u_left_V", "left"), "u_left_V"),
    ],
)
def test_voltages_that_do_not_belong_to_the_rows_are_refused(drive, voltages, message):
    with pytest.raises(InputError) as error:
        read_measurement(drive(voltages), IMPORTERS)
    assert message in str(error.value)
    assert "voltages.csv" in str(error.value)
