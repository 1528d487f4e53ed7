"""Short trials of a log whose voltages are held over another row, of which one row is left out."""

import numpy as np
import pytest

from diagnosis.new_case.rows import measurement_of
from logs.log_file import read_log
from logs.mapping import LogMapping
from symolo.core.errors import InputError

STEP = ("motor_step", "after_row", "trial,t_s,u_cmd_V,omega_rad_s,current_A")
DRIVE = ("drive_log", "before_row", "trial,t_s,u_left_V,u_right_V,enc_left_ticks,enc_right_ticks")


@pytest.fixture
def trials(tmp_path):
    """Read a log with some trials by their numbers of rows, 50 ms apart, in which all numbers of a row are equal."""

    def read(kind, held, names, *rows):
        columns = {name: {"column": name} for name in names.split(",")}
        columns |= {name: {"column": name, "held": held} for name in columns if name.startswith("u_")}
        numbers = [k for count in rows for k in range(count)]
        begins = np.cumsum([0, *rows])[:-1]
        words = [f"trial_{np.searchsorted(begins, k, side='right')}" for k in range(sum(rows))]
        lines = [
            ",".join([word, f"{0.05 * k:.2f}", *[f"{0.1 * k:.1f}" if "motor" in kind else str(k)] * (len(columns) - 2)])
            for word, k in zip(words, numbers, strict=True)
        ]
        path = tmp_path / "log.csv"
        path.write_text("\n".join([names, *lines]) + "\n")
        return measurement_of(read_log(path), LogMapping.model_validate({"kind": kind, "columns": columns}), "log")

    return read


@pytest.mark.parametrize("log", [STEP, DRIVE])
def test_a_trial_of_one_row_is_left_out_with_a_note(log, trials):
    measurement = trials(*log, 1, 40, 1)
    (trial,) = measurement.trials
    assert len(trial.t_s) == 39
    (note,) = [note for note in measurement.notes if "only row" in note]
    assert note == "left out, because the voltage of their only row is not known: 2 trials"


@pytest.mark.parametrize("log", [STEP, DRIVE])
def test_trials_too_short_for_voltages_of_another_row_are_refused(log, trials):
    with pytest.raises(InputError, match="no trial has three rows, of which held leaves two"):
        trials(*log, 1, 2, 1)
