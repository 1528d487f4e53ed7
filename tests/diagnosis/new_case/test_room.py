"""The room of a drive with range sensors: its corner in the frame of the log, and signs that it or a mount is wrong."""

import csv
import re

import numpy as np
import pytest

from diagnosis.importers import IMPORTERS
from diagnosis.importers.choose import read_measurement
from pipeline.cli import main

ROOM_X_M, ROOM_Y_M = 3.0, 2.0
YAW_DEG = {"left": 90, "right": -90}
"""Directions of the sensors, whose places are the middle of the axle."""


@pytest.fixture
def logged():
    """A circle of 0.3 m about (1.2, 0.8) with the readings of two sensors, in the frame of the corner of the room."""
    t_s = 0.05 * np.arange(300)
    yaw = 0.8 * t_s
    x, y = 1.2 + 0.3 * np.sin(yaw), 0.8 - 0.3 * np.cos(yaw)
    columns = {"t_s": np.round(t_s, 3), "x_m": x, "y_m": y, "theta_rad": yaw}
    for side, mount_deg in YAW_DEG.items():
        c, s = np.cos(yaw + np.radians(mount_deg)), np.sin(yaw + np.radians(mount_deg))
        to_x = np.where(c > 0.0, ROOM_X_M - x, -x) / c
        to_y = np.where(s > 0.0, ROOM_Y_M - y, -y) / s
        columns[f"tof_{side}_m"] = np.minimum(to_x, to_y)
    return columns


def settings(*more, left_yaw_deg=90.0, **known):
    numbers = {"room_x_m": ROOM_X_M, "room_y_m": ROOM_Y_M, "max_range_m": 3.0, **known}
    for side, yaw_deg in {**YAW_DEG, "left": left_yaw_deg}.items():
        numbers |= {f"{side}_x_m": 0.0, f"{side}_y_m": 0.0, f"{side}_yaw_deg": yaw_deg}
    return [*more, *(word for key, value in numbers.items() for word in ("--set", f"{key}={value}"))]


def places(folder):
    (trial,) = read_measurement(folder, IMPORTERS).trials
    return np.array([trial[name].values for name in ("x_m", "y_m")])


def from_the_middle(logged):
    return {**logged, "x_m": logged["x_m"] - ROOM_X_M / 2, "y_m": logged["y_m"] - ROOM_Y_M / 2}


def test_places_are_counted_from_the_corner_of_the_room(init, logged, tmp_path):
    corner = {"room_corner_x_m": -ROOM_X_M / 2, "room_corner_y_m": -ROOM_Y_M / 2}
    code, out, err, _ = init(from_the_middle(logged), *settings(**corner))
    assert (code, err) == (0, "")
    assert "CHECK" not in out
    assert re.search(r"x_m +from x_m, plus 1\.5\n", out)
    np.testing.assert_allclose(places(tmp_path / "run"), [logged["x_m"], logged["y_m"]], atol=1e-6)
    # The mapping of the case does it again, for other logs of the same form.
    code, _, err, _ = init(
        from_the_middle(logged), *settings("--mapping", "run/mapping.yaml", "--out", "again"), *settings()
    )
    assert (code, err) == (0, "")
    np.testing.assert_allclose(places(tmp_path / "again"), [logged["x_m"], logged["y_m"]], atol=1e-6)


def test_a_corner_that_contradicts_the_mapping_is_refused(init, logged):
    init(from_the_middle(logged), *settings(room_corner_x_m=-1.5))
    code, _, err, _ = init(logged, *settings("--mapping", "run/mapping.yaml", "--out", "again", room_corner_x_m=-1.4))
    assert code == 2
    assert re.search(
        "room_corner_x_m and the offset of x_m in the mapping contradict each other: got '-1.4 and 1.5'", err
    )


def test_an_offset_of_a_time_or_a_count_is_refused(init, logged, tmp_path):
    (tmp_path / "mapping.yaml").write_text(
        "kind: drive_log\ncolumns:\n  t_s: {column: t_s, offset: 1}\n  x_m: {column: x_m}\n  y_m: {column: y_m}\n"
        "  theta_rad: {column: theta_rad, offset: 0.5}\n  tof_left_m: {column: tof_left_m}\n"
    )
    code, _, err, _ = init(logged, "--mapping", "mapping.yaml")
    assert code == 2
    assert re.findall(r"columns\.(\w+): offset is for measured numbers other than times and counts", err) == ["t_s"]


def test_poses_outside_of_the_room_are_named_with_the_numbers_that_state_its_corner(init, logged, tmp_path, capsys):
    _, out, _, _ = init(from_the_middle(logged), *settings())
    check = r"CHECK x_m and y_m: \d+ of 300 poses are outside of the room .*room_corner_x_m and --set room_corner_y_m"
    assert re.search(check, out.splitlines()[1])
    assert main(["inspect", str(tmp_path / "run")]) == 0
    assert re.search(check, capsys.readouterr().out)


def test_exchanged_range_sensors_are_named(init, logged):
    swapped = {**logged, "tof_left_m": logged["tof_right_m"], "tof_right_m": logged["tof_left_m"]}
    _, out, _, _ = init(swapped, *settings())
    (check,) = re.findall("CHECK (.*)", out)
    assert check.startswith("tof_left_m and tof_right_m: the readings of tof_left_m fit the mount of right and")


def test_a_sensor_that_does_not_see_the_walls_of_its_mount_is_named(init, logged):
    _, out, _, _ = init(logged, *settings(left_yaw_deg=7.0))
    (check,) = re.findall("CHECK (.*)", out)
    assert re.match(r"tof_left_m: half of the readings differ .*check the mount of this sensor", check)


def test_a_yaw_of_a_mount_in_radians_is_named_with_its_degrees(init, logged):
    _, out, _, _ = init(logged, *settings(left_yaw_deg=1.57))
    (check,) = re.findall("CHECK (.*)", out)
    assert check.endswith("its yaw of 1.57 degrees fits as radians: write 90")


def test_ranges_in_other_rows_than_the_poses_give_no_check(init, logged, tmp_path, capsys):
    """A camera has 10 poses a second, and the sensors read between them."""
    init(logged, *settings())
    data = tmp_path / "run" / "data.csv"
    with data.open() as file:
        names, *rows = csv.reader(file)
    for number, row in enumerate(rows):
        for name in ("x_m", "y_m", "theta_rad") if number % 2 else (f"tof_{side}_m" for side in YAW_DEG):
            row[names.index(name)] = ""
    with data.open("w") as file:
        csv.writer(file).writerows([names, *rows])
    assert main(["inspect", str(tmp_path / "run")]) == 0
    assert "CHECK" not in capsys.readouterr().out


def test_right_ranges_with_an_offset_and_outliers_give_no_check(init, logged):
    rng = np.random.Generator(np.random.PCG64(4))
    wild = rng.random((2, 300)) < 0.05
    for side, is_wild in zip(YAW_DEG, wild, strict=True):
        logged[f"tof_{side}_m"] = np.where(is_wild, rng.uniform(0.05, 3.0, 300), logged[f"tof_{side}_m"] + 0.03)
    for name in ("x_m", "y_m"):
        logged[name] = np.where(rng.random(300) < 0.04, rng.uniform(-5.0, 5.0, 300), logged[name])
    _, out, _, _ = init(logged, *settings())
    assert "CHECK" not in out
