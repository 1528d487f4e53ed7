"""Headings of quaternions and times of seconds and parts of one, which several columns of a log give together."""

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from tests.diagnosis.new_case.drives import DT


def with_quaternion(columns, names, *, tilt_rad=0.0):
    """Return the drive with the orientation as a quaternion with these names for x, y, z and w, by SciPy."""
    heading = np.radians(np.asarray(columns["heading_deg"], dtype=float))
    tilts = tilt_rad * np.sin(np.arange(len(heading)))
    xyzw = Rotation.from_euler("ZYX", np.column_stack((heading, 0.5 * tilts, tilts))).as_quat()
    others = {name: column for name, column in columns.items() if name != "heading_deg"}
    return others | {name: np.round(xyzw[:, k], 9) for k, name in enumerate(names) if name}


def headings(tmp_path, case="run"):
    return np.genfromtxt(tmp_path / case / "data.csv", delimiter=",", names=True)["theta_rad"]


def assert_same_turn(actual, expected):
    np.testing.assert_allclose(np.angle(np.exp(1j * (actual - expected))), 0.0, atol=1e-6)


NAMES = [
    ("qx", "qy", "qz", "qw"),
    ("q_x", "q_y", "q_z", "q_w"),
    ("quat.x", "quat.y", "quat.z", "quat.w"),
    ("pose.pose.orientation.x", "pose.pose.orientation.y", "pose.pose.orientation.z", "pose.pose.orientation.w"),
    ("field.pose.orientation.x", "field.pose.orientation.y", "field.pose.orientation.z", "field.pose.orientation.w"),
    ("RotationX", "RotationY", "RotationZ", "RotationW"),
    ("q1", "q2", "q3", "q0"),
    ("q0", "q1", "q2", "q3"),
    ("", "", "orientation.z", "orientation.w"),
]


@pytest.mark.parametrize("names", NAMES)
def test_a_quaternion_gives_the_heading_that_scipy_gives(names, init, columns, tmp_path):
    code, _, err, _ = init(columns, "--out", "by_angle")
    assert (code, err) == (0, "")
    code, out, err, _ = init(with_quaternion(columns, names))
    assert (code, err) == (0, "")
    assert_same_turn(headings(tmp_path), headings(tmp_path, "by_angle"))
    assert f"theta_rad       from the quaternion {', '.join(filter(None, names))}" in out
    assert "not used" not in out
    assert "tilts" not in out


def test_a_tilted_body_has_the_heading_of_its_x_axis(init, columns, tmp_path):
    logged = with_quaternion(columns, NAMES[0], tilt_rad=0.2)
    xyzw = np.column_stack([logged[name] for name in NAMES[0]])
    ahead = Rotation.from_quat(xyzw).apply([1.0, 0.0, 0.0])
    code, out, err, _ = init(logged)
    assert (code, err) == (0, "")
    rows = np.arange(len(headings(tmp_path)))
    assert_same_turn(headings(tmp_path), np.arctan2(ahead[:, 1], ahead[:, 0])[rows])
    assert "tilts of up to 13 degrees are left out" in out


def test_the_mapping_file_has_the_quaternion_and_reads_back(init, columns, tmp_path):
    init(with_quaternion(columns, NAMES[0]))
    mapping = tmp_path / "run" / "mapping.yaml"
    assert yaml.safe_load(mapping.read_text())["columns"]["theta_rad"] == {"quaternion": ["qx", "qy", "qz", "qw"]}
    code, _, err, _ = init(with_quaternion(columns, NAMES[0]), "--mapping", str(mapping), "--out", "again")
    assert (code, err) == (0, "")
    np.testing.assert_array_equal(headings(tmp_path, "again"), headings(tmp_path))


def test_the_sense_and_the_zero_of_a_quaternion_can_be_changed(init, columns, tmp_path):
    init(columns, "--out", "by_angle")
    logged = with_quaternion({**columns, "heading_deg": 90.0 - np.asarray(columns["heading_deg"])}, NAMES[0])
    mapping = yaml.safe_load((tmp_path / "by_angle" / "mapping.yaml").read_text())
    mapping["columns"]["theta_rad"] = {"quaternion": [*NAMES[0]], "factor": -1.0, "offset": 0.5 * np.pi}
    (tmp_path / "turned.yaml").write_text(yaml.safe_dump(mapping))
    code, _, err, _ = init(logged, "--mapping", "turned.yaml", "--out", "turned")
    assert (code, err) == (0, "")
    assert_same_turn(headings(tmp_path, "turned"), headings(tmp_path, "by_angle"))


@pytest.mark.parametrize(
    ("theta", "message"),
    [
        ({"quaternion": ["qx", "qy", "qz"]}, "columns.theta_rad: quaternion: got 3 names; allowed: the columns of x"),
        ({"quaternion": ["qx", "qy", "qz", "q"]}, "columns.theta_rad: the log has no such column: got 'q'"),
        ({"quaternion": ["qx", "qy", "qz", "qw"], "unit": "deg"}, "columns.theta_rad: a quaternion has no unit"),
        ({"quaternion": ["qx", "qy", "qz", "qw"], "column": "qz"}, "columns.theta_rad: give either a column"),
        ({"quaternion": ["x_cm", "y_cm", "qz", "qw"]}, "x_cm, y_cm, qz, qw: no quaternion, since its length is"),
        ({"quaternion": ["qw", "qy", "qz", "qx"]}, "the z axis of the body is usually tilted by"),
    ],
)
def test_a_quaternion_that_cannot_be_one_is_refused(theta, message, init, columns, tmp_path):
    logged = with_quaternion(columns, NAMES[0])
    init(logged)
    mapping = yaml.safe_load((tmp_path / "run" / "mapping.yaml").read_text())
    mapping["columns"]["theta_rad"] = theta
    (tmp_path / "other.yaml").write_text(yaml.safe_dump(mapping))
    code, _, err, _ = init(logged, "--mapping", "other.yaml", "--out", "other")
    assert code == 2
    assert message in err


def test_a_numbered_quaternion_of_a_tilted_body_is_asked_for(init, columns):
    """Upright bodies turn about z, so that two components near 0 show which one is the real one."""
    code, _, err, _ = init(with_quaternion(columns, ("q1", "q2", "q3", "q0"), tilt_rad=1.0))
    assert code == 2
    assert "q0, q1, q2, q3: the values do not show which one is the real part" in err
    assert "theta_rad: {quaternion: [q1, q2, q3, q0]}" in err


def stamped(columns, seconds, parts, parts_in_ns=1):
    t_ns = 1_700_000_000_950_000_000 + np.rint(1e9 * DT * np.arange(len(columns["time_ms"]))).astype(np.int64)
    others = {name: column for name, column in columns.items() if name != "time_ms"}
    return {seconds: t_ns // 10**9, parts: t_ns % 10**9 // parts_in_ns} | others


STAMPS = [
    ("header.stamp.sec", "header.stamp.nanosec", "nanoseconds"),
    ("secs", "nsecs", "nanoseconds"),
    ("header_stamp_secs", "header_stamp_nsecs", "nanoseconds"),
    ("stamp.sec", "stamp.nsec", "nanoseconds"),
    ("seconds", "nanoseconds", "nanoseconds"),
    ("Time.sec", "Time.nanosec", "nanoseconds"),
    ("tv_sec", "tv_usec", "microseconds"),
    ("sec", "usec", "microseconds"),
    ("seconds", "microseconds", "microseconds"),
]


@pytest.mark.parametrize(("seconds", "parts", "unit"), STAMPS)
def test_seconds_and_parts_of_one_are_one_time(seconds, parts, unit, init, columns, tmp_path):
    init(columns, "--out", "by_ms")
    code, out, err, _ = init(stamped(columns, seconds, parts, 1000 if unit == "microseconds" else 1))
    assert (code, err) == (0, "")
    assert f"t_s             from {seconds} and {unit} {parts}" in out
    mapping = yaml.safe_load((tmp_path / "run" / "mapping.yaml").read_text())
    assert mapping["columns"]["t_s"] == {"column": seconds, unit: parts}
    stamps, times = (
        np.genfromtxt(tmp_path / case / "data.csv", delimiter=",", names=True)["t_s"] for case in ("run", "by_ms")
    )
    np.testing.assert_allclose(stamps, times, atol=1e-6)


@pytest.mark.parametrize("micros", [lambda t_s: np.rint(1e6 * t_s), lambda t_s: np.full(len(t_s), 350)])
def test_seconds_with_decimals_are_a_time_without_the_counter_of_microseconds_beside_them(
    micros, init, columns, tmp_path
):
    """A counter that runs on, or the duration of a loop."""
    t_s = np.round(12.0 + DT * np.arange(len(columns["time_ms"])), 3)
    others = {name: column for name, column in columns.items() if name != "time_ms"}
    code, out, err, _ = init({"seconds": t_s, "micros": micros(t_s).astype(int)} | others)
    assert (code, err) == (0, "")
    assert "t_s             from seconds\n" in out
    steps_s = np.diff(np.genfromtxt(tmp_path / "run" / "data.csv", delimiter=",", names=True)["t_s"])
    np.testing.assert_allclose(steps_s, steps_s[0], atol=1e-6)


def test_a_counter_of_microseconds_that_runs_on_beside_whole_seconds_is_refused_with_what_to_do(init, columns):
    logged = stamped(columns, "sec", "usec", 1000)
    code, _, err, _ = init(logged | {"usec": 50_000 * np.arange(len(logged["usec"]))})
    assert code == 2
    assert "column usec: got '1000000', allowed: whole numbers below 1e+06" in err
    assert "name usec as the column of t_s" in err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"t_s": {"column": "secs", "nanoseconds": "ns"}}, "columns.t_s: the log has no such column: got 'ns'"),
        ({"t_s": {"column": "secs", "nanoseconds": "nsecs", "unit": "ms"}}, "columns.t_s: nanoseconds are added to"),
        ({"t_s": {"column": "secs", "microseconds": "nsecs"}}, "column nsecs: got '950000000', allowed: whole numbers"),
        (
            {"t_s": {"column": "secs", "microseconds": "nsecs", "nanoseconds": "nsecs"}},
            "columns.t_s: nanoseconds and microseconds; allowed: one of them",
        ),
        ({"x_m": {"column": "x_cm", "nanoseconds": "nsecs"}}, "columns.x_m: nanoseconds is for t_s"),
        ({"t_s": {"column": "secs", "nanoseconds": "x_cm"}}, "column x_cm: got"),
    ],
)
def test_parts_of_a_second_that_cannot_be_some_are_refused(change, message, init, columns, tmp_path):
    logged = stamped(columns, "secs", "nsecs")
    init(logged)
    mapping = yaml.safe_load((tmp_path / "run" / "mapping.yaml").read_text())
    mapping["columns"] |= change
    (tmp_path / "other.yaml").write_text(yaml.safe_dump(mapping))
    code, _, err, _ = init(logged, "--mapping", "other.yaml", "--out", "other")
    assert code == 2
    assert message in err


@pytest.mark.parametrize(
    ("unit", "logged", "message"),
    [
        ("theta_rad=deg", lambda columns: with_quaternion(columns, NAMES[0]), "qx, qy, qz, qw give theta_rad in rad"),
        ("t_s=ms", lambda columns: stamped(columns, "secs", "nsecs"), "secs, nsecs give t_s in s"),
    ],
)
def test_a_stated_unit_of_columns_that_have_one_together_is_refused(unit, logged, message, init, columns):
    code, _, err, _ = init(logged(columns), "--unit", unit)
    assert code == 2
    assert message in err


@pytest.mark.parametrize("xyzw", [(0.0, 0.0, 0.0, 0.0), (0.5, 0.5, 0.5, 0.5)])
@pytest.mark.parametrize("names", [("qx", "qy", "qz", "qw"), ("q1", "q2", "q3", "q0")])
def test_a_log_without_places_does_without_an_orientation_that_gives_no_heading(names, xyzw, init, columns):
    """As of an inertial sensor that lies on its side or was never started."""
    others = {name: column for name, column in columns.items() if name not in {"x_cm", "y_cm", "heading_deg"}}
    numbers = ("supply_voltage_V=7.4", "ticks_per_turn=600", "wheel_diameter_m=0.066", "track_m=0.14")
    settings = [text for number in numbers for text in ("--set", number)]
    quaternion = {name: np.full(len(columns["time_ms"]), value) for name, value in zip(names, xyzw, strict=True)}
    code, out, err, _ = init(others | quaternion, *settings)
    assert (code, err) == (0, "")
    assert "(theta_rad): used for no quantity" in out
