"""Tables whose columns have any names: what is taken for a quantity, and what stays as it is."""

import numpy as np

from logs.trajectories.base import ReadSettings
from logs.trajectories.table import READER


def test_motors_whose_unit_nothing_shows_stay_as_they_are(tmp_path):
    t = 0.05 * np.arange(200)
    rows = [f"{s:.2f},{0.2 * s:.4f},0,0,{round(200 * np.sin(s))},{round(200 * np.cos(s))}" for s in t]
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["t,x,y,theta,motor_left,motor_right", *rows]) + "\n")
    (logged,) = READER.read(path, ReadSettings())
    assert [table.name for table in logged.tables] == ["log"]
    assert set(logged.tables[0].columns) == {"motor_left", "motor_right"}
    (guess,) = [guess for guess in logged.guesses if guess.startswith("motor_left")]
    assert "taken for no quantity" in guess
    assert "duty_255" in guess
    assert "--map" in guess
