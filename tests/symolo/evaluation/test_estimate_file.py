"""Files of estimates, with units and covariances, and each fault with its row."""

import numpy as np
import pytest

from symolo import InputError, read_estimate


def written(folder, name, *lines):
    path = folder / name
    path.write_text("\n".join(lines) + "\n")
    return path


def test_lines_as_of_tum_give_the_pose_on_the_floor(tmp_path):
    # Headings of 90 and 180 deg; the second body is tilted by 5 deg about its x axis before it is turned.
    half = np.radians(5) / 2
    tilted = f"0.1 1.5 -2 0.02 0 {np.sin(half)} {np.cos(half)} 0"  # qz(180) qx(5) = (0, sin, cos, 0)
    path = written(tmp_path, "mine.txt", "# t x y z q", f"0 1 2 0 0 0 {np.sqrt(0.5)} {np.sqrt(0.5)}", tilted)
    estimate = read_estimate(path)
    assert estimate.t_s.tolist() == [0, 0.1]
    assert estimate.pose[:, :2].tolist() == [[1, 2], [1.5, -2]]
    assert np.abs(np.degrees(estimate.pose[:, 2])) == pytest.approx([90, 180])
    assert estimate.covariance is None


def test_a_table_in_degrees_with_its_covariance(tmp_path):
    header = "t_s,x_m,y_m,heading_deg,var_x_m2,var_y_m2,var_heading_deg2,cov_x_y_m2,cov_y_heading_m_deg"
    estimate = read_estimate(written(tmp_path, "mine.csv", header, "0.5,1,2,90,0.04,0.09,4,0.01,-0.2"))
    assert estimate.pose == pytest.approx(np.array([[1, 2, np.pi / 2]]))
    rad = np.pi / 180
    expected = [[0.04, 0.01, 0], [0.01, 0.09, -0.2 * rad], [0, -0.2 * rad, 4 * rad**2]]
    assert estimate.covariance[0] == pytest.approx(np.array(expected))


def test_tables_in_milliseconds_and_radians_and_those_of_baselines(tmp_path):
    path = written(tmp_path, "a.csv", "t_ms,y_m,x_m,heading_rad,var_x_m2,var_y_m2,var_heading_rad2", "50,2,1,0.5,1,2,3")
    estimate = read_estimate(path)
    assert estimate.t_s.tolist() == [0.05]
    assert estimate.pose.tolist() == [[1, 2, 0.5]]
    assert estimate.covariance[0].tolist() == np.diag([1, 2, 3]).tolist()
    header = "t,x,y,theta,x_x,x_y,x_theta,y_y,y_theta,theta_theta"
    estimate = read_estimate(written(tmp_path, "b.csv", header, "50,1,2,0.5,4,1,0.5,5,0.25,6"))
    assert estimate.t_s.tolist() == [0.05]
    assert estimate.covariance[0].tolist() == [[4, 1, 0.5], [1, 5, 0.25], [0.5, 0.25, 6]]


def test_rows_with_an_empty_cell_have_no_estimate(tmp_path):
    path = written(tmp_path, "mine.csv", "t_s,x_m,y_m,heading_deg", "0,1,2,3", "0.1,,,", "0.2,1,2,3")
    assert read_estimate(path).t_s.tolist() == [0, 0.2]


@pytest.mark.parametrize(
    ("name", "lines", "messages"),
    [
        ("a.csv", ["t_s,x_m,y_m,heading_deg", "0,1,2,nan"], ["a.csv: row 2: column heading_deg: got 'nan'", "empty"]),
        ("a.csv", ["t_s,x_m,y_m,heading", "0,1,2,3"], ["row 1", "heading is not known", "did you mean heading_deg"]),
        ("a.csv", ["t_s,x_m,y_m", "0,1,2"], ["column heading_deg is missing"]),
        ("a.csv", ["0,1,2,3", "1,1,2,3"], ["no header"]),
        ("a.csv", ["t_s,x_m,y_m,heading_deg", "1,1,2,3", "0,1,2,3"], ["row 3", "sort the poses by time"]),
        ("a.csv", ["t_s,x_m,y_m,heading_deg,var_x_m2", "1,1,2,3,1"], ["column var_y_m2 is missing", "variances of x"]),
        (
            "a.csv",
            ["t_s,x_m,y_m,heading_deg,var_x_m2,var_y_m2,var_heading_deg2", "1,1,2,3,1,1,0"],
            ["row 2: no covariance", "positive eigenvalues"],
        ),
        (
            "a.csv",
            ["t_s,x_m,y_m,heading_deg,var_x_m2,var_y_m2,var_heading_deg2", "1,1,2,3,1,1,1", "2,1,2,3,1e-320,1,1"],
            ["row 3: no covariance", "variances from 1e-18 to 1e+18"],
        ),
        (
            "a.csv",
            ["t_s,x_m,y_m,heading_deg", ",,,", "0,1,2,3", "1,1e200,2,3"],
            ["row 4: x [m]: got 1e+200, allowed: up to 1e+08"],
        ),
        ("a.csv", ["t_ms,x_m,y_m,heading_rad", "0,1,2,-1e9"], ["row 2: heading [rad]: got -1000000000.0"]),
        ("a.txt", ["# t x y z q", "0 1 2 0 0 0 0 1", "1 1 -1e300 0 0 0 0 1"], ["row 3: y [m]: got -1e+300"]),
        ("a.txt", ["0 1 2 0 0 0 0 1", "1e306 1 2 0 0 0 0 1"], ["row 2: t [s]: got 1e+306, allowed: up to 1e+20"]),
        ("a.csv", ["t_s,x_m,y_m,heading_deg", ",,,"], ["has no row without an empty cell"]),
        ("a.txt", ["0 1 2 0 0 0 0 1", "1 nan 2 0 0 0 0 1"], ["row 2: a number that is missing", "remove the row"]),
        ("a.txt", ["0 1 2 0 0 0 0 1", "0 1 2 0 0 0 0 1"], ["row 2: the time 0 s is not after 0 s"]),
        ("a.txt", ["0 1 2 0 0 0 0 0"], ["row 1: qx qy qz qw", "a unit quaternion"]),
        ("a.txt", ["0 1 2 90"], ["row 1: 4 numbers", "timestamp tx ty tz qx qy qz qw"]),
        ("a.txt", ["0 1 2 0 0.5 -0.5 0.5 -0.5"], ["z axis of the body is tilted by 90 deg", "not those of a camera"]),
    ],
)
def test_faults_are_named_with_their_row(tmp_path, name, lines, messages):
    with pytest.raises(InputError) as refused:
        read_estimate(written(tmp_path, name, *lines))
    for message in messages:
        assert message in str(refused.value)
