"""`symolo import`: logs of other programs become datasets that every other command takes, and nothing is invented."""

import hashlib
import json
import math
from pathlib import Path

import cv2
import numpy as np
import pytest

import symolo as symolo_reader
from logs.trajectories.base import LoggedTrajectory
from pipeline.cli import main
from pipeline.importing.rows import imported_rows
from tests.logs.written_bags import Ros, drive, write_ros1

T_S = 0.05 * np.arange(100)
ANGLE = 0.5 * T_S
PLACE = 0.6 * np.column_stack((np.cos(ANGLE), np.sin(ANGLE)))
YAW = ANGLE + 0.5 * math.pi


def table(header, *columns, digits=7):
    rows = [",".join(f"{cell:.{digits}f}" if math.isfinite(cell) else "" for cell in row) for row in zip(*columns)]  # noqa: B905
    return "\n".join([header, *rows]) + "\n"


@pytest.fixture(scope="module")
def imported(tmp_path_factory):
    """A log with poses, a speed, a range that saw no target for a while and one that failed, encoders and a battery."""
    folder = tmp_path_factory.mktemp("import")
    range_m = np.where(T_S > 4.0, np.inf, 0.5 + 0.1 * T_S)
    range_m[7] = np.nan
    columns = (1e3 * T_S, *(1e3 * PLACE.T), YAW, np.full(len(T_S), 0.3), 1e3 * range_m, 100 * T_S, 7.4 - 0.01 * T_S)
    text = table("time_ms,x_mm,y_mm,yaw_rad,speed [m/s],tof_front_mm,encLeft,battery_V", *columns)
    log = folder / "run 1.csv"
    log.write_text(text.replace(",,100", ",,100"))
    assert main(["import", str(log), "--out", str(folder / "data")]) == 0
    return log, folder / "data"


def test_a_log_becomes_a_dataset_without_a_fault(imported, symolo):
    _, root = imported
    ended = symolo("verify", root)
    assert (ended.code, ended.out.strip()) == (0, f"{root}: no fault"), ended.out


def test_what_was_measured_is_there_and_what_was_not_is_absent(imported):
    log, root = imported
    (run,) = symolo_reader.load(root)
    assert list(run.rows) == ["t", "x", "y", "theta", "v", "d_f"]
    np.testing.assert_allclose(run.table.pose[:, :2], PLACE, atol=1e-6)
    np.testing.assert_allclose(np.unwrap(run.table.pose[:, 2]), YAW, atol=2e-6)
    np.testing.assert_array_equal(run.table.t_ms, np.rint(1000 * T_S))
    np.testing.assert_allclose(run.rows["v"], 0.3)
    assert run.rows["d_f"][10] == pytest.approx(0.55, abs=1e-4)
    assert run.side_names == ("drive", "log")
    np.testing.assert_allclose(run.side("drive")["enc_left_ticks"], 100 * T_S)
    np.testing.assert_allclose(run.side("log")["battery_V"], 7.4 - 0.01 * T_S, atol=1e-7)
    files = {
        path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file() and ".stages" not in path.parts
    }
    assert {name for name in files if name.startswith("imported/")} == {
        f"imported/test_1/{name}" for name in ("data.csv", "side/spec.json", "side/drive.csv", "side/log.csv")
    }
    metadata = json.loads((root / "metadata.json").read_text())
    (record,) = metadata["runs"]
    assert record["origin"]["log"]["file"] == "run 1.csv"
    assert record["origin"]["log"]["sha256"] == hashlib.sha256(log.read_bytes()).hexdigest()
    assert record["origin"]["log"]["quantities"]["x_m"] == "x_mm, in mm"
    assert not {"rates", "lap_time_s"} & {key for key, value in record.items() if value is not None}
    assert (metadata["states"], metadata["licence"]) == ({}, "NOASSERTION")
    assert not {"pybullet", "bpy"} & metadata["made_with"].keys()
    assert "simulated" not in (root / "README.md").read_text()


def test_a_range_sensor_that_never_saw_a_target_has_its_column():
    readings = {"d_f": np.full(len(T_S), np.inf), "d_l": np.full(len(T_S), np.nan), "v": np.full(len(T_S), np.inf)}
    trajectory = LoggedTrajectory(T_S.copy(), np.column_stack((PLACE, YAW)), {}, readings)
    result = imported_rows(trajectory, "log", no_target_m=2.0)
    assert result.rows.columns == ("t", "x", "y", "theta", "d_f")
    np.testing.assert_array_equal(result.rows.tof_m[:, 0], 2.0)
    assert result.changes == ("columns of data.csv that are left out, because no row has a reading: v, d_l",)


def test_an_empty_cell_stays_empty_in_every_reader(imported):
    _, root = imported
    (run,) = symolo_reader.load(root)
    assert np.flatnonzero(np.isnan(run.rows["d_f"])).tolist()[0] == 7
    header, *rows = (root / "imported/test_1/data.csv").read_text().splitlines()
    assert (header.split(",")[5], rows[7].split(",")[5], rows[8].split(",")[5]) == ("d_f", "", "0.5400")


def test_the_dataset_is_exported_reported_inspected_and_compared(imported, tmp_path, symolo):
    _, root = imported
    formats = "tum,parquet,mcap,ros1,hdf5,huggingface,rerun"
    assert symolo("export", root, "--format", formats, "--out", tmp_path / "exported").code == 0
    tum = np.loadtxt(tmp_path / "exported/tum/imported/test_1/robot.txt")
    np.testing.assert_allclose(tum[:, 1:3], PLACE, atol=1e-6)
    np.testing.assert_allclose(2 * np.arctan2(tum[:, 6], tum[:, 7]), YAW, atol=3e-6)
    ended = symolo("export", root, "--format", "kitti", "--out", tmp_path / "kitti")
    assert (
        ended.code,
        "format kitti: run imported/test_1 has no images; render its trajectory with `symolo rerender`" in ended.err,
    ) == (2, True)
    assert symolo("report", root, "--out", tmp_path / "report.html").code == 0
    page = (tmp_path / "report.html").read_text()
    assert "imported from run 1.csv (table)" in page
    assert ">nan<" not in page
    assert "The logs have no states of a controller" in page
    for absent in ("are states", "change of the state", "black is 0", "Farthest off the line"):
        assert absent not in page
    assert symolo("view", root, "--out", tmp_path / "view.html").code == 0
    assert "forward speed v" in (tmp_path / "view.html").read_text()
    assert "yaw rate w" not in (tmp_path / "view.html").read_text()
    assert symolo("contact-sheet", root, "--out", tmp_path / "sheet.png", "--width-px", "64").code == 0
    assert symolo("video", root, "--out", tmp_path / "run.gif", "--fps", "1", "--width-px", "320").code == 0
    assert "enc_left_ticks" in symolo("inspect", root).out
    assert "taken" in symolo("status", root).out or "imported from" in symolo("status", root).out
    assert symolo("compare", root, root).code == 0
    ended = symolo("baselines", root, "--out", tmp_path / "baselines")
    assert (ended.code, "imported trajectory; imports are not supported here" in ended.err) == (2, True)


@pytest.mark.usefixtures("hands")
def test_poses_alone_say_nothing_about_a_simulation(tmp_path, symolo):
    log = tmp_path / "run.csv"
    log.write_text(table("t_s,x_m,y_m,theta_rad", T_S, *PLACE.T, YAW))
    assert symolo("import", log, "--out", tmp_path / "data").code == 0
    ended = symolo("diagnose", tmp_path / "data", "--out", tmp_path / "diagnosis")
    assert ended.code == 2
    assert "log voltages and counts, counts and poses, or poses and ranges" in ended.err


def test_the_exported_poses_come_back_as_they_went(dataset, tmp_path, symolo):
    """A release through TUM and back: the same poses, to the digits of both files."""
    assert symolo("export", dataset, "--format", "tum", "--runs", "CW/*", "--out", tmp_path / "exported").code == 0
    path = tmp_path / "exported/tum/CW/test_1/robot.txt"
    assert symolo("import", path, "--out", tmp_path / "data", "--route", "CW", "--name", "back").code == 0
    (run,) = symolo_reader.load(tmp_path / "data")
    truth = symolo_reader.load(dataset)["CW/test_1"]
    assert run.name == "CW/test_1"
    np.testing.assert_array_equal(run.table.t_ms, truth.table.t_ms)
    np.testing.assert_allclose(run.table.pose, truth.table.pose, atol=2e-6)


def test_exported_poses_of_a_tilted_camera_come_back_as_those_of_the_robot(dataset, tmp_path, symolo):
    """A release through KITTI and back: the true poses of the robot at the images, to the ten digits of the files."""
    assert symolo("export", dataset, "--format", "kitti", "--out", tmp_path / "exported").code == 0
    sequence = tmp_path / "exported/kitti/sequences/00"
    path = tmp_path / "exported/kitti/poses/00.txt"
    ended = symolo("import", path, "--out", tmp_path / "data")
    assert (ended.code, "GUESS" in ended.out, "WARNING the body" in ended.out) == (0, False, False)
    (run,) = symolo_reader.load(tmp_path / "data")
    (name,) = [line.split()[1] for line in (path.parents[1] / "runs.txt").read_text().splitlines()][:1]
    truth = symolo_reader.load(dataset)[name]
    np.testing.assert_allclose(run.table.pose, truth.table.pose[np.flatnonzero(truth.table.image)], atol=2e-6)
    ended = symolo("import", path, "--up=-y", "--out", tmp_path / "other")
    assert (ended.code, "--up: got '-y'" in ended.err, "axes are known" in ended.err) == (2, True, True)
    calibration = (sequence / "calib.txt").read_text()
    (sequence / "calib.txt").write_text(calibration.replace("Tr:", "Tx:"))
    ended = symolo("import", path, "--out", tmp_path / "other")
    assert (ended.code, "calib.txt: has no line Tr with twelve numbers" in ended.err) == (2, True)


def test_a_data_csv_of_a_release_is_read_with_all_its_columns(dataset, tmp_path, symolo):
    assert symolo("import", dataset / "CW/test_1/data.csv", "--out", tmp_path / "data").code == 0
    assert symolo("verify", tmp_path / "data").code == 0
    (run,) = symolo_reader.load(tmp_path / "data")
    truth = symolo_reader.load(dataset)["CW/test_1"]
    assert [*run.rows, "img"] == list(truth.rows)
    np.testing.assert_array_equal(run.rows.to_numpy(), truth.rows.drop(columns="img").to_numpy())
    assert run.spec.arena.name == "symolo"


def test_guesses_need_a_yes(tmp_path, symolo, monkeypatch):
    log, out = tmp_path / "run.csv", tmp_path / "data"
    log.write_text(table("t,x,y,theta", T_S, *PLACE.T, np.degrees(YAW)))
    ended = symolo("import", log, "--out", out)
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "repeat the command with --yes" in ended.err
    assert "theta (theta_rad): the name has no unit; taken for degrees" in ended.out
    assert not out.exists()
    monkeypatch.setattr("sys.stdin", None)  # closed, as under some daemons
    assert symolo("import", log, "--out", out) == ended
    assert symolo("import", log, "--out", out, "--dry-run").code == 0
    assert not out.exists()
    ended = symolo("import", log, "--out", out, "--yes")
    assert ended.code == 0
    assert f"symolo rerender {out / 'imported/test_1'} --looks classroom,lab" in ended.out
    (run,) = symolo_reader.load(out)
    np.testing.assert_allclose(np.unwrap(run.table.pose[:, 2]), YAW, atol=2e-6)


def test_the_mapping_of_an_import_is_saved_and_read_again(tmp_path, symolo):
    log, mapping = tmp_path / "run.csv", tmp_path / "mapping.yaml"
    log.write_text(table("t,x,y,theta", T_S, *PLACE.T, np.degrees(YAW)))
    assert symolo("import", log, "--out", tmp_path / "a", "--dry-run", "--save-map", mapping).code == 0
    assert 'theta_rad: {column: "theta", unit: "degrees"}' in mapping.read_text()
    assert symolo("import", log, "--out", tmp_path / "a", "--yes").code == 0
    assert symolo("import", log, "--out", tmp_path / "b", "--map", mapping).code == 0  # nothing is guessed
    a, b = (symolo_reader.load(tmp_path / name)["imported/test_1"].table.pose for name in "ab")
    np.testing.assert_array_equal(a, b)
    ended = symolo("import", log, "--out", tmp_path / "c", "--yes", "--save-map", mapping)
    assert ended.code == 2
    assert f"{mapping}: exists already; name another file with --save-map" in ended.err


def test_a_saved_mapping_names_the_command_that_reads_the_log_with_it(tmp_path, symolo, monkeypatch):
    monkeypatch.chdir(tmp_path)
    log, options = Path("run.csv"), ("--up", "z", "--row-hz", 10.0, "--licence", "CC-BY-4.0", "--out", "data")
    log.write_text(table("t,x,y,theta", T_S, *PLACE.T, np.degrees(YAW)))
    asked = symolo("import", log, *options, "--save-map", "guessed.yaml")
    assert (asked.code, Path("guessed.yaml").exists()) == (2, False)  # nobody confirmed the guesses
    assert symolo("import", log, *options, "--yes", "--save-map", "guessed.yaml").code == 0
    command = "symolo import run.csv --map guessed.yaml --up z --row-hz 10.0 --licence CC-BY-4.0 --out data"
    assert f"#   {command}\n" in Path("guessed.yaml").read_text()
    assert symolo(*command.split()[1:]).code == 0


def test_only_a_single_table_has_a_mapping(tmp_path, symolo):
    log, tum = tmp_path / "run.csv", tmp_path / "run.tum"
    log.write_text(table("t_s,x_m,y_m,theta_rad", T_S, *PLACE.T, YAW))
    tum.write_text("".join(f"{t} {0.1 * t} 0 0 0 0 0 1\n" for t in T_S))
    out = ("--out", tmp_path / "data", "--dry-run", "--save-map", tmp_path / "mapping.yaml")
    assert "got 'tum', allowed: one table" in symolo("import", tum, *out).err
    assert "got '2 trajectories', allowed: one table" in symolo("import", log, log, *out).err


def test_the_same_command_twice_gives_the_same_bytes_and_another_log_takes_its_place(tmp_path, symolo, release_of):
    log, out = tmp_path / "run.csv", tmp_path / "data"
    log.write_text(table("t_s,x_m,y_m,theta_rad", T_S, *PLACE.T, YAW))
    assert symolo("import", log, "--out", out).code == 0
    first = release_of(out)
    assert symolo("import", log, "--out", out).code == 0
    assert release_of(out) == first
    refused = symolo("import", log, "--out", out, "--name", "other")
    assert (refused.code, "1 run (imported/test_1) would be lost" in refused.err) == (2, True)
    assert symolo("import", log, log, "--out", out, "--row-hz", 10).code == 0
    assert symolo("verify", out).code == 0
    assert [run.name for run in symolo_reader.load(out)] == ["imported/test_1", "imported/test_2"]
    np.testing.assert_array_equal(symolo_reader.load(out).runs[0].table.t_ms, 100 * np.arange(50))


def test_a_far_path_is_moved_to_the_middle_of_a_floor_that_fits(tmp_path, symolo):
    log, out = tmp_path / "utm.csv", tmp_path / "data"
    far = PLACE + np.array([523_411.25, 4_600_000.5])
    log.write_text(table("t_s,x_m,y_m,theta_rad", T_S, *far.T, YAW))
    assert symolo("import", log, "--out", out).code == 0
    (run,) = symolo_reader.load(out)
    np.testing.assert_allclose(np.diff(run.table.pose[:, :2], axis=0), np.diff(PLACE, axis=0), atol=2e-6)
    assert np.abs(run.table.pose[:, :2].min(axis=0) + run.table.pose[:, :2].max(axis=0)).max() < 0.02
    assert any("are moved by (-523411" in text for text in run.spec.origin.log.changes)
    assert run.spec.arena.floor.half_extent_m == 2.0


SUSPICIOUS = {
    "standing": (lambda t, x, y, yaw: (t, 0 * x, 0 * y, yaw), "moves less than 1 cm: are x and y in a larger unit"),
    "clockwise": (lambda t, x, y, yaw: (t, x, y, -yaw), "were counted clockwise: give theta_rad factor: -1 in a map"),
    "radians in degrees": (
        lambda t, x, y, yaw: (t, x, y, np.radians(yaw)),
        "were in radians: give theta_rad unit: rad in a map",
    ),
    "turned": (
        lambda t, x, y, yaw: (t, x, y, yaw + 0.7),
        "larger by -40 degrees: give theta_rad offset: -0.7 in a map",
    ),
    "of a compass": (
        lambda t, x, y, yaw: (t, x, y, np.pi / 2 - yaw),
        "counted clockwise from another direction: give theta_rad factor: -1 and offset: 1.571 in a mapping file",
    ),
    "of something else": (lambda t, x, y, yaw: (t, x, y, 1.5 * yaw), "the median angle between them is"),
    "fast": (lambda t, x, y, yaw: (t / 20, x, y, yaw), "usually moves at 6 m/s, which is fast"),
    "slow": (lambda t, x, y, yaw: (1000 * t, x, y, yaw), "usually moves at 0.0003 m/s, which is slow"),
    "gap": (
        lambda t, x, y, yaw: (t + 9.0 * (t > 2), x, y, yaw),
        "the longest gap is 9.05 s, from t = 2.000 s on",
    ),
    "repeated": (
        lambda t, x, y, yaw: (t, *(np.repeat(column[::4], 4) for column in (x, y, yaw))),
        "74% of the rows between the first and the last motion repeat the pose",
    ),
}


@pytest.mark.parametrize(("change", "text"), SUSPICIOUS.values(), ids=SUSPICIOUS.keys())
def test_a_suspicious_motion_is_a_warning_on_the_terminal_and_in_the_metadata(change, text, tmp_path, symolo):
    log, out = tmp_path / "run.csv", tmp_path / "data"
    log.write_text(table("t_s,x_m,y_m,theta_rad", *change(T_S, *PLACE.T, YAW)))
    ended = symolo("import", log, "--out", out)
    assert (ended.code, text in ended.out) == (0, True), ended.out
    (record,) = json.loads((out / "metadata.json").read_text())["runs"]
    assert any(text in warning for warning in record["warnings"])
    assert text in (out / "README.md").read_text()


def test_headings_of_a_compass_are_mapped_by_a_factor_and_an_offset_in_radians(tmp_path, symolo):
    """0 is north, and 90 degrees are east."""
    log, mapping = tmp_path / "run.csv", tmp_path / "mapping.yaml"
    log.write_text(table("t_s,x_m,y_m,heading", T_S, *PLACE.T, (90.0 - np.degrees(YAW)) % 360.0))
    columns = "".join(f"  {name}: {{column: {name}}}\n" for name in ("t_s", "x_m", "y_m"))
    heading = "  theta_rad: {column: heading, unit: deg, factor: -1, offset: %s}\n"
    mapping.write_text(f"kind: trajectory\ncolumns:\n{columns}{heading % 90}")
    refused = symolo("import", log, "--map", mapping, "--out", tmp_path / "data")
    assert (refused.code, "90 degrees are 1.571" in refused.err) == (2, True)
    mapping.write_text(f"kind: trajectory\ncolumns:\n{columns}{heading % 1.570796}")
    assert symolo("import", log, "--map", mapping, "--out", tmp_path / "data").code == 0
    (run,) = symolo_reader.load(tmp_path / "data")
    np.testing.assert_allclose(np.exp(1j * run.table.pose[:, 2]), np.exp(1j * YAW), atol=1e-4)


CLOCKWISE = {
    "yaw_cw_deg": (-np.degrees(YAW), []),
    "heading clockwise [deg]": (-np.degrees(YAW), []),
    "yaw_ccw_deg": (np.degrees(YAW), []),
    "heading_counter_clockwise": (YAW, []),
    "hdg_deg": (90.0 - np.degrees(YAW), ["give theta_rad factor: -1 and offset: 1.571 in a mapping file"]),
    "azimuth (deg)": (90.0 - np.degrees(YAW), ["give theta_rad factor: -1 and offset: 1.571 in a mapping file"]),
}


@pytest.mark.parametrize("name", CLOCKWISE)
def test_the_name_of_a_heading_may_state_its_sense(name, tmp_path, symolo):
    """A compass is not named by a sense, but a warning gives the numbers that put its headings on the path."""
    heading, warnings = CLOCKWISE[name]
    (tmp_path / "run.csv").write_text(table(f"t_s,east_m,north_m,{name}", T_S, *PLACE.T, heading))
    ended = symolo("import", tmp_path / "run.csv", "--out", tmp_path / "data", "--yes")
    assert ended.code == 0, ended.err
    assert [text for text in warnings if text not in ended.out] == []
    assert ("WARNING" in ended.out) == bool(warnings), ended.out
    (run,) = symolo_reader.load(tmp_path / "data")
    if not warnings:
        np.testing.assert_allclose(np.exp(1j * run.table.pose[:, 2]), np.exp(1j * YAW), atol=1e-5)


REFUSED = {
    "degrees in radians": (lambda t, x, y, yaw: (t, x, y, np.degrees(yaw)), "only if it is in degrees"),
    "milliseconds in seconds and metres": (lambda t, x, y, yaw: (t / 1000, x, y, yaw), "moves at 300 m/s"),
    "a place beyond the sky": (lambda t, x, y, yaw: (t, np.where(t == 1.0, 1e308, x), y, yaw), "no place on Earth"),
    "a path of kilometres": (lambda t, x, y, yaw: (1000 * t, 1000 * x, 1000 * y, yaw), "away from the origin"),
}


def test_columns_that_nobody_can_recognise_are_mapped_with_the_option_of_this_command(tmp_path, symolo):
    log = tmp_path / "run.csv"
    log.write_text(table("foo,x_m,y_m,theta_rad", T_S, *PLACE.T, YAW))
    ended = symolo("import", log, "--out", tmp_path / "data")
    assert ended.code == 2
    assert "write a mapping.yaml (docs/import.md) and name it with --map" in " ".join((ended.out + ended.err).split())
    assert "--mapping" not in ended.out + ended.err


@pytest.mark.parametrize(("change", "text"), REFUSED.values(), ids=REFUSED.keys())
def test_what_no_robot_does_is_refused_before_anything_is_written(change, text, tmp_path, symolo):
    log, out = tmp_path / "run.csv", tmp_path / "data"
    log.write_text(table("t_s,x_m,y_m,theta_rad", *change(T_S, *PLACE.T, YAW)))
    ended = symolo("import", log, "--out", out)
    assert (ended.code, ended.err.count("\n"), text in ended.err) == (2, 1, True), ended.err
    assert not out.exists()


DATA_CSV = {
    "millimetres": (lambda x, y, yaw: (1000 * x, 1000 * y, yaw), "column x: the robot moves at 300 m/s", "millimetres"),
    "quick turns in degrees": (lambda x, y, yaw: (x, y, np.degrees(yaw + 4 * math.pi * (T_S > 1))), "theta", "degrees"),
    "far away, in a named arena": (lambda x, y, yaw: (x + 1e6, y, yaw), "1e+06 m away", "leave out --arena"),
}


@pytest.mark.parametrize(("change", "what", "cure"), DATA_CSV.values(), ids=DATA_CSV.keys())
def test_a_data_csv_in_other_units_than_its_own_is_refused(change, what, cure, tmp_path, symolo):
    log = tmp_path / "data.csv"
    columns = (1000 * T_S, *change(*PLACE.T, YAW), 0 * T_S)
    log.write_text(table("t,x,y,theta,img", *columns).replace(".0000000\n", "\n"))
    arena = ("--arena", "symolo") if "arena" in cure else ()
    ended = symolo("import", log, "--out", tmp_path / "out", *arena)
    assert (ended.code, ended.err.count("\n"), what in ended.err, cure in ended.err) == (2, 1, True, True), ended.err
    assert list(tmp_path.iterdir()) == [log]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.csv"], "none.csv: no such file or folder"),
        (["run.csv", "--format", "tumm"], "--format: got 'tumm'"),
        (["run.csv", "--route", "../x"], "--route: got '../x', allowed: letters"),
        (["run.csv", "other.csv"], "other.csv: has other columns than the first log"),
        (["empty.csv"], "empty.csv: is empty; record it again"),
        (["noise.bin"], "noise.bin: is not a log of a known form; allowed: bag: "),
        (
            ["run.csv", "--heading-from-path", "--body-at", "0.1,0"],
            "--heading-from-path and --body-at: the direction of the path of a body is the heading of the robot only",
        ),
        (["run.csv", "--out", "dataset"], "holds files that symolo did not make"),
    ],
)
def test_a_wrong_argument_is_one_clear_line(arguments, message, tmp_path, monkeypatch, symolo):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run.csv").write_text(table("t_s,x_m,y_m,theta_rad", T_S, *PLACE.T, YAW))
    (tmp_path / "other.csv").write_text(table("t_s,x_m,y_m,theta_rad,v_m_s", T_S, *PLACE.T, YAW, T_S))
    (tmp_path / "noise.bin").write_bytes(bytes(range(256)))
    (tmp_path / "empty.csv").touch()
    (tmp_path / "dataset").mkdir()
    (tmp_path / "dataset/notes.txt").write_text("mine")
    out = () if "--out" in arguments else ("--out", "data")
    ended = symolo("import", *arguments, *out)
    assert (ended.code, ended.err.count("\n"), message in ended.err) == (2, 1, True), ended.err
    assert not (tmp_path / "data").exists()


def test_images_are_rendered_for_an_imported_run(imported, tmp_path, symolo):
    _, root = imported
    out = tmp_path / "lab"
    small = ("--set", "render.width_px=32", "--set", "render.height_px=24", "--set", "render.samples=1")
    command = ("rerender", root / "imported/test_1", "--look", "lab", "--camera-hz", 1, "--out", out)
    assert symolo(*command, *small).code == 0
    images = sorted(out.rglob("*.jpg"))
    assert len([path for path in images if ".stages" not in path.parts]) == 5
    image = cv2.imread(str(images[0]))
    assert image.shape == (24, 32, 3)
    assert image.std() > 5.0  # a view, and not one colour
    numbers = np.genfromtxt(out / "imported/test_1/data.csv", delimiter=",", names=True)["img"]
    assert numbers[numbers > 0].tolist() == [1, 2, 3, 4, 5]
    assert symolo("contact-sheet", out, "--out", tmp_path / "sheet.png", "--width-px", 32).code == 0


def test_a_bag_becomes_a_dataset_whose_origin_names_its_topic(tmp_path, capsys, symolo):
    ros = Ros(1)
    write_ros1(tmp_path / "drive.bag", drive(ros), ros)
    assert main(["import", str(tmp_path / "drive.bag"), "--topic", "/odom", "--out", str(tmp_path / "data")]) == 0
    capsys.readouterr()
    assert symolo("verify", tmp_path / "data").code == 0
    (run,) = symolo_reader.load(tmp_path / "data")
    assert list(run.rows) == ["t", "x", "y", "theta", "v", "w", "d_f"]
    reported = symolo("report", tmp_path / "data", "--out", tmp_path / "page.html")
    assert (reported.code, "report: 1 of 1 run in" in reported.err) == (0, True)
    log = json.loads((tmp_path / "data/metadata.json").read_text())["runs"][0]["origin"]["log"]
    assert (log["format"], log["quantities"]["pose"]) == ("bag", "/odom")
