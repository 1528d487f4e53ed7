"""Tables whose columns have any names: what is taken for a quantity, and what stays as it is."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

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
    assert "used for no quantity" in guess
    assert "duty_255" in guess
    assert "--map" in guess


T_S = 0.05 * np.arange(200)
YAW = 0.4 * np.sin(0.5 * T_S) + 0.3
PLACE = 0.2 * 0.05 * np.cumsum(np.column_stack((np.cos(YAW), np.sin(YAW))), axis=0)
XYZW = Rotation.from_euler("z", YAW[:, None]).as_quat()


def imported(tmp_path, columns):
    """Return what is read from a table with these columns."""
    path = tmp_path / "run.csv"
    rows = [",".join(str(cell) for cell in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    (logged,) = READER.read(path, ReadSettings())
    return logged


@pytest.mark.parametrize("names", [("q1", "q2", "q3", "q0"), ("q0", "q1", "q2", "q3"), ("", "", "q.z", "q.w")])
def test_numbered_and_planar_quaternions_give_the_heading(names, tmp_path):
    q = {name: XYZW[:, k] for k, name in sorted(enumerate(names), key=lambda item: item[1]) if name}
    logged = imported(tmp_path, {"t_s": T_S, "x_m": PLACE[:, 0], "y_m": PLACE[:, 1], **q})
    np.testing.assert_allclose(logged.pose[:, 2], YAW, atol=1e-9)


def test_stamps_of_ros_are_joined_to_times(tmp_path):
    t_ns = 1_700_000_000_950_000_000 + np.rint(1e9 * T_S).astype(np.int64)
    stamp = {"header.stamp.sec": t_ns // 10**9, "header.stamp.nanosec": t_ns % 10**9}
    poses = {f"pose.position.{axis}": PLACE[:, k] for k, axis in enumerate("xy")}
    turns = {f"pose.orientation.{axis}": XYZW[:, k] for k, axis in enumerate("xyzw")}
    logged = imported(tmp_path, {**stamp, **poses, **turns})
    np.testing.assert_allclose(logged.t_s - logged.t_s[0], T_S, atol=1e-6)
    np.testing.assert_allclose(logged.pose[:, 2], YAW, atol=1e-9)
    assert not any(table.name == "log" for table in logged.tables)
    assert not any("t_s" in guess for guess in logged.guesses)
