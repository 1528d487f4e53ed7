"""The sentence about rows accounts for all of them."""

from dataclasses import replace
from math import ceil

import numpy as np

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.measured.measurement import CaseKind, Measurement, MeasurementSource, Trial
from diagnosis.predictors.pose.by_counts import STRIDE, WINDOW, Pose
from diagnosis.predictors.wheels.speeds import Wheels
from diagnosis.report.sentences.data.compared import quantity_rows, rows_sentence, source_text


def test_all_rows_of_a_drive_are_fitted_held_out_unusable_or_in_a_window(driven_log):
    """Two trials of 61 rows, 51 of which another one follows ten rows later: every fifth of these begins a window."""
    robot, _ = draw_robot(load_section("robot", "nominal"), 1, "test")
    measurement = driven_log(robot, robot)
    evidence = Evidence((Wheels(measurement, robot), Pose(measurement, robot)))
    windows = 2 * ceil((61 - WINDOW) / STRIDE)
    assert rows_sentence(measurement, evidence).startswith(
        "Of the 122 rows of the log, the table counts 122 rows of wheel_left_rad_s and wheel_right_rad_s; "
        f"{windows} windows of 10 rows, of which one begins at every 5th row, of pose_dx_m, pose_dy_m and "
        "pose_dtheta_rad. Each of them is fitted, held out, or unusable. It is unusable where "
    )
    totals = {name: sum(map(int, counts)) for name, _, _, *counts, _, _ in quantity_rows(evidence)}
    assert totals == {
        **dict.fromkeys(("wheel_left_rad_s", "wheel_right_rad_s"), 122),
        **dict.fromkeys(("pose_dx_m", "pose_dy_m", "pose_dtheta_rad"), windows),
    }


def test_files_of_one_name_are_named_once_and_a_row_per_second_is_one_every_second():
    trial = Trial("1", np.arange(5.0), np.zeros(5, bool), ())
    source = MeasurementSource("a dataset", ("CW/test_1/trajectory.npz", "CCW/test_1/trajectory.npz"))
    measurement = Measurement("two runs", CaseKind.DRIVE_LOG, source, (trial,), notes=())
    assert source_text(measurement) == "Data: a dataset, from trajectory.npz. One row every 1 s."
    other = replace(measurement, source=replace(source, files=tuple(f"{i}.csv" for i in range(6))))
    assert "from 0.csv, 1.csv, 2.csv, 3.csv and 2 more." in source_text(other)
