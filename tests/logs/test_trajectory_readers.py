"""Every reader on the same drive: a circle in the closed form, in the axes and units of its format."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from logs.axis import Axis
from logs.trajectories.base import ReadSettings
from logs.trajectories.body_place import moved_to_axle
from logs.trajectories.readers import READERS
from symolo.core.errors import InputError
from symolo.core.geometry.poses import pose_X_WR, quaternions, rotations

COUNT, STEP_S, RADIUS_M = 120, 0.05, 0.6
T_S = STEP_S * np.arange(COUNT)
ANGLE = 0.5 * T_S
PLACE = RADIUS_M * np.column_stack((np.cos(ANGLE), np.sin(ANGLE)))
YAW = ANGLE + 0.5 * math.pi
POSE = np.column_stack((PLACE, YAW))
X_WR = np.array([pose_X_WR(*pose) for pose in POSE.tolist()])
X_RC = np.array([[0, 0, 1, 0.1], [-1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, 0, 1.0]])
"""A camera that looks ahead: x right, y down, z forward."""


def lines(*columns, separator=" ", digits=9):
    return "\n".join(separator.join(f"{cell:.{digits}f}" for cell in row) for row in zip(*columns, strict=True)) + "\n"


def tum(X, t_s=T_S):
    return "# timestamp tx ty tz qx qy qz qw\n" + lines(t_s, *X[:, :3, 3].T, *quaternions(X[:, :3, :3]).T)


def kitti(X):
    X_first = np.linalg.inv(X[0]) @ X
    return lines(*X_first[:, :3].reshape(-1, 12).T)


def euroc(X):
    t_ns = 1403636579758555392 + np.rint(1e9 * T_S).astype(np.int64)
    names = [*(f"p_RS_R_{axis} [m]" for axis in "xyz"), *(f"q_RS_{axis} []" for axis in "wxyz")]
    header = ",".join(["#timestamp [ns]", *names, "v_RS_R_x [m s^-1]"])
    q = quaternions(X[:, :3, :3])[:, [3, 0, 1, 2]]
    rows = [
        ",".join([str(t), *(f"{cell:.9f}" for cell in (*p, *r)), "0.5"])
        for t, p, r in zip(t_ns.tolist(), X[:, :3, 3].tolist(), q.tolist(), strict=True)
    ]
    return "\n".join([header, *rows]) + "\n"


def motive(X, *, lost=()):
    """As Motive exports it: y up, so that x of the floor stays and its y is -z; two bodies and a marker."""
    R_OW = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0.0]])
    p, q = X[:, :3, 3] @ R_OW.T, quaternions(R_OW @ X[:, :3, :3] @ R_OW.T)
    head = [
        "Format Version,1.23,Take Name,Take 1,Rotation Type,Quaternion,Length Units,Millimeters",
        "",
        ",Type" + ",Rigid Body" * 8 + ",Rigid Body Marker" * 3 + ",Rigid Body" * 7,
        ",Name" + ",robot" * 8 + ",robot:Marker1" * 3 + ",wand" * 7,
        ',ID,"A"' + ',"A"' * 17,
        ","
        + ",Rotation" * 4
        + ",Position" * 3
        + ",Mean Marker Error"
        + ",Position" * 3
        + ",Rotation" * 4
        + ",Position" * 3,
        "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,X,Y,Z,W,X,Y,Z",
    ]
    rows = []
    for i in range(COUNT):
        robot = ["" for _ in range(7)] if i in lost else [f"{c:.6f}" for c in (*q[i], *(1000 * p[i]))]
        rows.append(
            ",".join([str(i), f"{T_S[i]:.6f}", *robot, "0.1", "1", "2", "3", "0", "0", "0", "1", "5", "6", "7"])
        )
    return "\n".join([*head, *rows]) + "\n"


def read(path: Path, **settings):
    reader = next(reader for reader in READERS if reader.recognises(path))
    return reader.name, reader.read(path, ReadSettings(**settings))


def written(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def assert_circle(trajectory, tolerance=1e-5):
    """The same drive in some frame on the floor: lengths, turns, and headings along the path."""
    pose = trajectory.pose - [*trajectory.pose[0, :2], 0.0]
    c, s = math.cos(pose[0, 2]), math.sin(pose[0, 2])
    ahead, left = c * pose[:, 0] + s * pose[:, 1], c * pose[:, 1] - s * pose[:, 0]
    np.testing.assert_allclose(ahead, RADIUS_M * np.sin(ANGLE), atol=tolerance)
    np.testing.assert_allclose(left, RADIUS_M * (1.0 - np.cos(ANGLE)), atol=tolerance)
    np.testing.assert_allclose(pose[:, 2] - pose[0, 2], ANGLE, atol=tolerance)
    np.testing.assert_allclose(trajectory.t_s - trajectory.t_s[0], T_S, atol=1e-6)


def test_rotations_of_quaternions_are_those_that_the_quaternions_came_from():
    rng = np.random.default_rng(3)
    matrices = np.linalg.qr(rng.normal(size=(50, 3, 3)))[0]
    matrices *= np.linalg.det(matrices)[:, None, None]
    np.testing.assert_allclose(rotations(3.0 * quaternions(matrices)), matrices, atol=1e-12)


def test_a_pose_of_the_robot_is_read_as_it_is(tmp_path):
    name, (trajectory,) = read(written(tmp_path / "robot.txt", tum(X_WR)))
    assert name == "tum"
    np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-6)
    assert (trajectory.changes, trajectory.guesses, trajectory.warnings) == ((), (), ())


def test_the_pose_of_a_camera_gives_the_heading_of_its_axis(tmp_path):
    """The camera is ahead of the axle, so it drives a wider circle; its axis is the heading of the robot."""
    _, (trajectory,) = read(written(tmp_path / "camera.txt", tum(X_WR @ X_RC)))
    np.testing.assert_allclose(trajectory.pose[:, 2], YAW, atol=1e-6)
    np.testing.assert_allclose(np.hypot(*trajectory.pose[:, :2].T), math.hypot(RADIUS_M, 0.1), atol=1e-6)


def test_poses_of_a_body_beside_the_axle_give_those_of_the_axle_if_its_place_is_known(tmp_path):
    """The camera is 0.1 m ahead; the marker stands 0.05 m ahead and 0.02 m to the left of the axle."""
    _, cameras = read(written(tmp_path / "camera.txt", tum(X_WR @ X_RC)))
    (trajectory,) = moved_to_axle(cameras, (0.1, 0.0))
    np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-6)
    assert trajectory.warnings == ()
    assert (
        trajectory.changes[-1]
        == "places of a body at x = 0.1 m, y = 0 m on the robot are moved to the middle of its axle"
    )
    X_RM = pose_X_WR(0.05, 0.02, 0.0)
    _, markers = read(written(tmp_path / "marker.txt", tum(X_WR @ X_RM)))
    (trajectory,) = moved_to_axle(markers, (0.05, 0.02))
    np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-6)
    # At (1, 2) with a heading of 90 degrees, ahead is +y and left is -x.
    (single,) = moved_to_axle([replace(cameras[0], pose=np.array([[1.0, 2.0, math.pi / 2]]))], (0.05, 0.02))
    np.testing.assert_allclose(single.pose, [[1.02, 1.95, math.pi / 2]], atol=1e-12)
    assert list(moved_to_axle(cameras, None)) == cameras


def test_a_kitti_sequence_by_hand_gives_the_poses_of_the_robot(tmp_path):
    """The camera is 0.1 m ahead of the axle and 0.2 m above it, and looks ahead. The robot stands at (1, 2) and faces
    along x, then at (3, 2) and (3, 4) along y. In the frame of the first image (x right, y down, z forward), the
    camera is then at (-0.1, 0, 1.9) and (-2.1, 0, 1.9), and has turned to the left by 90 degrees.
    """
    poses = "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 -1 -0.1 0 1 0 0 1 0 0 1.9\n0 0 -1 -2.1 0 1 0 0 1 0 0 1.9\n"
    (tmp_path / "sequences/00").mkdir(parents=True)
    (tmp_path / "poses").mkdir()
    written(tmp_path / "sequences/00/times.txt", "0\n10\n20\n")
    written(tmp_path / "sequences/00/origin.txt", "0 0 1 1.1 -1 0 0 2 0 -1 0 0.2\n")
    written(tmp_path / "sequences/00/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0.2 1 0 0 -0.1\n")
    name, (trajectory,) = read(written(tmp_path / "poses/00.txt", poses))
    assert name == "kitti"
    assert trajectory.t_s.tolist() == [0, 10, 20]
    expected = [[1, 2, 0], [3, 2, math.pi / 2], [3, 4, math.pi / 2]]
    np.testing.assert_allclose(trajectory.pose, expected, atol=1e-12)


TILTED_X_RC = X_RC @ np.array([[1, 0, 0, 0], [0, math.sqrt(0.75), -0.5, 0], [0, 0.5, math.sqrt(0.75), 0], [0, 0, 0, 1]])
"""The camera looks down by 30 degrees."""


def test_a_camera_that_is_mounted_with_a_tilt_is_named_and_the_floor_is_not(tmp_path):
    _, (trajectory,) = read(written(tmp_path / "camera.txt", tum(X_WR @ TILTED_X_RC)))
    tilt, place = trajectory.warnings
    assert "axis -y is tilted by 30 degrees against the vertical in all poses" in tilt
    assert "x and y are its place, not that of the middle of the axle" in place


def test_a_frame_of_a_tilted_camera_is_named_and_the_drive_is_not(tmp_path):
    """The floor is tilted by 30 degrees in the frame of the first image."""
    _, (trajectory,) = read(written(tmp_path / "00.txt", kitti(X_WR @ TILTED_X_RC)), pose_hz=20.0)
    assert "the path lies in a plane that is tilted by 30 degrees against the axis -y" in trajectory.warnings[0]
    assert not any("even floor" in warning for warning in trajectory.warnings)


def test_a_straight_drive_up_a_ramp_says_nothing_about_the_frame(tmp_path):
    """A straight line lies in many planes, so the floor may be uneven as well."""
    along_m = np.linspace(0.0, 2.0, len(X_WR))
    X_WR_up = np.tile(np.eye(4), (len(X_WR), 1, 1))
    X_WR_up[:, 0, 3], X_WR_up[:, 2, 3] = along_m, 0.1 * along_m
    _, (trajectory,) = read(written(tmp_path / "ramp.txt", tum(X_WR_up)))
    assert "does not move on an even floor" in trajectory.warnings[0]
    assert not any("frame of the log" in warning for warning in trajectory.warnings)


def test_a_body_whose_other_axis_points_forward_is_recognised_from_the_path(tmp_path):
    turned = np.array([[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])  # y of the body is forward
    path = written(tmp_path / "body.txt", tum(X_WR @ np.linalg.inv(turned)))
    _, (trajectory,) = read(path)
    np.testing.assert_allclose(trajectory.pose[:, 2] - trajectory.pose[0, 2], ANGLE, atol=1e-6)
    assert "axis -y is taken for forward" in trajectory.guesses[0] or "axis y is taken" in trajectory.guesses[0]
    _, (chosen,) = read(path, forward=Axis.X)
    assert abs(abs(chosen.pose[0, 2] - YAW[0]) - 0.5 * math.pi) < 1e-6
    assert chosen.guesses == ()


def test_kitti_has_the_frame_of_its_first_camera(tmp_path):
    camera_ahead = X_RC.copy()
    camera_ahead[:3, 3] = 0.0
    path = written(tmp_path / "poses/00.txt", kitti(X_WR @ camera_ahead))
    with pytest.raises(InputError, match=r"00\.txt: has no times.*--pose-hz 10"):
        read(path)
    name, (trajectory,) = read(path, pose_hz=20.0)
    assert name == "kitti"
    assert_circle(trajectory)
    written(tmp_path / "sequences/00/times.txt", lines(T_S))
    assert_circle(read(path)[1][0])
    written(tmp_path / "sequences/00/times.txt", lines(T_S[:-1]))
    with pytest.raises(InputError, match=r"times\.txt: 119 times for 120 poses"):
        read(path)


def test_euroc_has_times_that_no_float_holds(tmp_path):
    path = written(tmp_path / "mav0/state_groundtruth_estimate0/data.csv", euroc(X_WR))
    for place in (path, tmp_path, tmp_path / "mav0/state_groundtruth_estimate0"):
        name, (trajectory,) = read(place)
        assert name == "euroc"
        np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-6)
        np.testing.assert_allclose(trajectory.t_s, T_S, atol=1e-9)


def test_motive_has_bodies_with_y_up_and_rows_in_which_they_are_lost(tmp_path):
    path = written(tmp_path / "take.csv", motive(X_WR, lost=(7, 8)))
    name, (robot, wand) = read(path)
    assert (name, robot.name, wand.name) == ("motive", "robot", "wand")
    kept = np.delete(np.arange(COUNT), [7, 8])
    np.testing.assert_allclose(robot.pose, POSE[kept], atol=1e-6)
    assert any("2 rows in which robot was not tracked" in text for text in robot.changes)
    assert [body.name for body in read(path, topics=("robot",))[1]] == ["robot"]
    with pytest.raises(InputError, match=r"--topic: got 'robt', allowed: robot, wand; did you mean robot"):
        read(path, topics=("robt",))


TABLES = {
    "our names": ("t_s,x_m,y_m,theta_rad", (1.0, 1.0, 1.0, 1.0), 0),
    "units in the names": ("time [ms];pos x [mm];pos_y_mm;heading (deg)", (1e3, 1e3, 1e3, 180 / math.pi), 0),
    "seconds and radians to guess": ("t,x,y,theta", (1.0, 1.0, 1.0, 1.0), 3),
    "milliseconds, millimetres and degrees to guess": ("stamp,X,Y,yaw", (1e3, 1e3, 1e3, 180 / math.pi), 3),
    "microseconds and centimetres to guess": ("micros,posX,posY,phi", (1e6, 1e2, 1e2, 1.0), 2),
    "nanoseconds since 1970 to guess": ("timestamp,x,y,heading_deg", (1e9, 1.0, 1.0, 180 / math.pi), 2),
}


@pytest.mark.parametrize(("header", "factors", "guesses"), TABLES.values(), ids=TABLES.keys())
def test_a_table_in_any_units_gives_the_same_drive(header, factors, guesses, tmp_path):
    separator = ";" if ";" in header else ","
    columns = [factor * column for factor, column in zip(factors, (T_S, *PLACE.T, YAW), strict=True)]
    text = header + "\n" + lines(*columns, separator=separator, digits=7)
    name, (trajectory,) = read(written(tmp_path / "run.csv", text))
    assert name == "table"
    assert len(trajectory.guesses) == guesses, trajectory.guesses
    np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-5)
    np.testing.assert_allclose(trajectory.t_s, T_S, atol=1e-6)


def test_a_table_of_a_rostopic_has_a_quaternion_and_columns_beside(tmp_path):
    q = quaternions(X_WR[:, :3, :3])
    names = [f"field.pose.pose.position.{axis}" for axis in "xyz"]
    names += [f"field.pose.pose.orientation.{axis}" for axis in "xyzw"]
    header = ",".join(["%time", *names, "field.battery", "field.name"])
    rows = lines(1e9 * T_S, *X_WR[:, :3, 3].T, *q.T, 7.4 - 0.01 * T_S, separator=",").replace("\n", ",run\n")
    _, (trajectory,) = read(written(tmp_path / "odom.csv", f"{header}\n{rows}"))
    np.testing.assert_allclose(trajectory.pose, POSE, atol=1e-6)
    (table,) = trajectory.tables
    assert list(table.columns) == ["field.battery"]
    np.testing.assert_allclose(table.columns["field.battery"][1], 7.4 - 0.01 * T_S)


def test_headings_may_be_the_direction_of_the_path_if_that_is_wanted(tmp_path):
    path = written(tmp_path / "marker.csv", "t_s,x_m,y_m\n" + lines(T_S, *PLACE.T, separator=","))
    with pytest.raises(InputError, match=r"no column was recognised as the heading.*--heading-from-path"):
        read(path)
    _, (trajectory,) = read(path, heading_from_path=True)
    np.testing.assert_allclose(trajectory.pose[:, 2], YAW, atol=0.13)  # half the turn over 10 cm on a radius of 60 cm
    assert any("direction of the path" in text for text in trajectory.changes)


def test_a_mapping_file_says_what_no_name_does(tmp_path):
    text = "a,b,c,d\n" + lines(-3.0 * T_S, 1000 * PLACE[:, 1], 1000 * PLACE[:, 0], T_S, separator=",")
    path = written(tmp_path / "run.csv", text)
    mapping = written(
        tmp_path / "mapping.yaml",
        "kind: trajectory\ncolumns:\n  t_s: {column: d}\n  x_m: {column: c, unit: mm}\n"
        "  y_m: {column: b, unit: mm}\n  theta_rad: {constant: 0.25}\n  v_m_s: {column: a, factor: -0.5}\n",
    )
    _, (trajectory,) = read(path, mapping=mapping)
    np.testing.assert_allclose(trajectory.pose, np.column_stack((PLACE, np.full(COUNT, 0.25))), atol=1e-6)
    np.testing.assert_allclose(trajectory.readings["v"], 1.5 * T_S, atol=1e-6)
    assert trajectory.guesses == ()
    of_a_case = mapping.read_text().replace("kind: trajectory", "kind: drive_log").replace("v_m_s", "trial")
    mapping.write_text(of_a_case)
    _, (same,) = read(path, mapping=mapping)
    np.testing.assert_array_equal(same.pose, trajectory.pose)
    mapping.write_text("kind: motor_step\ncolumns: {t_s: {column: d}}\n")
    with pytest.raises(InputError, match=r"mapping\.yaml:1: kind: got 'motor_step', allowed: trajectory, drive_log"):
        read(path, mapping=mapping)


def test_what_the_wheels_lack_is_a_note(tmp_path):
    """The ticks of the right wheel, one of the left, and the end of a counter that nobody stated."""
    left = np.where(np.arange(COUNT) == 7, np.nan, np.arange(COUNT) * 400.0 % 10_000)
    text = "t_s,x_m,y_m,yaw_rad,ticks_left\n" + lines(T_S, *PLACE.T, YAW, left, separator=",")
    _, (trajectory,) = read(written(tmp_path / "run.csv", text))
    for note in (
        r"CHECK ticks_left: it jumps by -9600 .*; if its counter begins again there, give wraps_at in a mapping file",
        r"cells without a number, of 120 each: 1 of ticks_left",
        r"no column was recognised as enc_right_ticks",
    ):
        assert sum(bool(re.match(note, change)) for change in trajectory.changes) == 1


def test_counts_of_single_rows_and_of_a_counter_that_wraps_run_on(tmp_path):
    """3 ticks in each row on the left; on the right 40, of a counter with 8 bits."""
    right = np.arange(COUNT) * 40 % 256
    columns = (T_S, *PLACE.T, YAW, np.full(COUNT, 3), right)
    text = "t_s,x_m,y_m,yaw_rad,dticks_left,ticks_right\n" + lines(*columns, separator=",")
    _, (trajectory,) = read(written(tmp_path / "run.csv", text))
    (drive,) = trajectory.tables
    np.testing.assert_array_equal(drive.columns["enc_left_ticks"][1], 3 * np.arange(1, COUNT + 1))
    np.testing.assert_array_equal(drive.columns["enc_right_ticks"][1], 40 * np.arange(COUNT))
    assert any("ticks since the row before" in guess for guess in trajectory.guesses)
    assert any("wraps at 256" in change for change in trajectory.changes)


def test_rows_without_a_pose_are_left_out_and_readings_without_a_value_stay_empty(tmp_path):
    rows = [f"{t},{x},{y},{th},{v}" for t, x, y, th, v in zip(T_S, *PLACE.T, YAW, T_S, strict=True)]
    rows[3] = f"{T_S[3]},,0.1,0.2,0.3"
    rows[5] = rows[5].rsplit(",", 1)[0] + ",nan"
    rows[9] = rows[8]
    path = written(tmp_path / "run.csv", "\n".join(["t_s,x_m,y_m,theta_rad,v_m_s", *rows]) + "\n")
    _, (trajectory,) = read(path)
    assert len(trajectory.t_s) == COUNT - 2
    assert np.flatnonzero(np.isnan(trajectory.readings["v"])).tolist() == [4]
    assert len(trajectory.changes) == 2
    rows[20], rows[21] = rows[21], rows[20]
    path.write_text("\n".join(["t_s,x_m,y_m,theta_rad,v_m_s", *rows]) + "\n")
    with pytest.raises(InputError, match=r"run\.csv: row 23: the time goes back by 0\.05 s"):
        read(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("# only comments\n", "has no poses"),
        ("0 0 0 0 0 0 0 1\n0.1 0 0 0 0 0 0\n", r"row 2: 7 numbers; allowed: .*the file is cut off"),
        ("0 0 0 0 0 0 0 1\n0.1 a 0 0 0 0 0 1\n", r"row 2: column tx: got 'a', allowed: a number"),
        ("0 0 0 0 0 0 0 1\n0 1 0 0 0 0 0 1\n", r"row 2: the time 0 s is not after 0 s"),
        ("0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 0\n", r"row 2: qx qy qz qw: got .*unit quaternion"),
    ],
)
def test_poses_that_cannot_be_read_are_one_clear_line(text, message, tmp_path):
    path = written(tmp_path / "poses.txt", text)
    (reader,) = (reader for reader in READERS if reader.name == "tum")
    with pytest.raises(InputError, match=message) as caught:
        reader.read(path, ReadSettings())
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_each_form_is_recognised_by_its_own_reader_alone(tmp_path):
    files = {
        "tum": written(tmp_path / "a.txt", tum(X_WR)),
        "kitti": written(tmp_path / "b.txt", kitti(X_WR)),
        "euroc": written(tmp_path / "c.csv", euroc(X_WR)),
        "motive": written(tmp_path / "d.csv", motive(X_WR)),
        "symolo": written(tmp_path / "e.csv", "t,x,y,theta,img\n0,1,2,0.5,1\n50,1,2,0.5,0\n"),
        "table": written(tmp_path / "f.csv", "t,x,y,theta\n0,1,2,0.5\n"),
    }
    for name, path in files.items():
        assert next(reader.name for reader in READERS if reader.recognises(path)) == name
    binary = tmp_path / "noise.csv"
    binary.write_bytes(bytes(range(256)))
    for path in (binary, tmp_path, tmp_path / "missing"):
        assert not any(reader.recognises(path) for reader in READERS)


def test_a_table_with_an_empty_column_is_refused_with_its_name(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t_s,x_m,y_m,yaw_rad\n" + "".join(f"{0.1 * i},{0.01 * i},0.0,\n" for i in range(10)))
    table = next(reader for reader in READERS if reader.name == "table")
    with pytest.raises(InputError, match="column yaw_rad is empty; allowed: numbers in the columns of time and pose"):
        table.read(path, ReadSettings())
