"""The sentence about rows accounts for all of them."""

from math import ceil

from configs.draw import draw_robot
from configs.loader import load_section
from diagnosis.inference.evidence.evidence import Evidence
from diagnosis.predictors.pose.by_counts import STRIDE, WINDOW, Pose
from diagnosis.predictors.wheels import Wheels
from diagnosis.report.sentences.compared import quantity_rows, rows_sentence


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
