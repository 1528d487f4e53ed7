"""Recordings for Rerun, read back by Rerun's own reader."""

import sys
import warnings
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pyarrow as pa
from scipy.spatial.transform import Rotation

import symolo
from configs.draw import draw_run
from configs.loader import load_scenario
from symolo.arena.geometry import Arena
from symolo.dataset.tables.rows import COLUMNS
from symolo.exporters.rerun.exporter import _Arrays, _box

PATHS = {"state": "/state", "v": "/motion/v", "w": "/motion/w", "d_f": "/range/d_f", "d_l": "/range/d_l"}
PATHS |= {"d_r": "/range/d_r"} | {f"L{i}": f"/line/L{i}" for i in range(8)}
NO_TARGET_M = 2.0


def read(path):
    """Time [s] and the values of each row by component, and those that always hold; None where there is nothing."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the reader's own packages while they load
        from rerun.dataframe import load_recording  # noqa: PLC0415
    recording = load_recording(path)
    table = recording.view(index="t", contents="/**").select().read_all()
    lasting = recording.view(index="t", contents="/**").select_static().read_all()
    columns = {name: table[name].to_pylist() for name in table.column_names if name != "t"}
    return (
        recording,
        table["t"].to_numpy().astype(np.int64) / 1e9,
        columns,
        {name: lasting[name].to_pylist()[0] for name in lasting.column_names},
    )


def at_rows(columns, name):
    """Which rows hold a component, and what."""
    held = [(row, one) for row, one in enumerate(columns[name]) if one is not None]
    return [row for row, _ in held], [one for _, one in held]


def matrices(values):
    """(N, 3, 3) of lists of nine numbers by columns, as Rerun's type Mat3x3 has them."""
    return np.array(values).reshape(-1, 3, 3).transpose(0, 2, 1)


def test_a_recording_holds_what_the_run_has(seed, random_release, exported, tmp_path):
    release = random_release(seed, annotated=True)
    folder = exported(release.root, tmp_path / "out", "rerun") / "rerun"
    assert {path.relative_to(folder).as_posix() for path in folder.rglob("*.rrd")} == {
        f"{truth.name}.rrd" for truth in release.runs
    }
    for truth in release.runs:
        recording, t_s, columns, lasting = read(folder / f"{truth.name}.rrd")
        assert (recording.application_id(), recording.recording_id().endswith(truth.name)) == ("symolo", True)
        np.testing.assert_allclose(t_s, truth.table[:, 0] / 1000, atol=1e-9)
        poses(truth, columns)
        readings(truth, columns)
        images(truth, columns, lasting)


def poses(truth, columns):
    """Of robot and camera, to the digits of 32 bits."""
    _, places = at_rows(columns, "/world/robot:Translation3D")
    np.testing.assert_allclose(np.array(places)[:, 0, :2], truth.table[:, 1:3], rtol=1e-6)
    _, turns = at_rows(columns, "/world/robot:TransformMat3x3")
    expected = Rotation.from_euler("z", truth.table[:, 3:4]).as_matrix()
    np.testing.assert_allclose(matrices(turns), expected, atol=1e-6)
    rows, turns = at_rows(columns, "/world/camera:TransformMat3x3")
    assert rows == np.flatnonzero(truth.table[:, 18]).tolist()
    np.testing.assert_allclose(matrices(turns), truth.X_WC[:, :3, :3], atol=1e-6)
    _, places = at_rows(columns, "/world/camera:Translation3D")
    np.testing.assert_allclose(np.array(places)[:, 0], truth.X_WC[:, :3, 3], rtol=1e-6)


def readings(truth, columns):
    for column, values in zip(COLUMNS, truth.table.T, strict=True):
        if column.name in PATHS:
            assert columns[f"{PATHS[column.name]}:Scalar"] == [[value] for value in values.tolist()]


def images(truth, columns, lasting):
    rows, blobs = at_rows(columns, "/world/camera/image:Blob")
    assert rows == np.flatnonzero(truth.table[:, 18]).tolist()
    assert tuple(bytes(blob) for (blob,) in blobs) == truth.pictures
    np.testing.assert_allclose(matrices(lasting["/world/camera/image:PinholeProjection"])[0], truth.K, rtol=1e-6)
    assert lasting["/world/camera/image:Resolution"] == [[40.0, 24.0]]


def test_the_arena_stands_where_it_is(random_release, exported, tmp_path):
    folder = exported(random_release(1).root, tmp_path / "out", "rerun") / "rerun"
    arena = Arena.from_config(draw_run(load_scenario("smoke"), "CW", 1).arena)
    _, _, _, lasting = read(folder / "CW/test_1.rrd")
    for box in arena.boxes:
        path = f"/world/{box.kind}s/{box.name}"
        np.testing.assert_allclose(np.multiply(lasting[f"{path}:HalfSize3D"], 2), [box.size], rtol=1e-6)
        np.testing.assert_allclose(lasting[f"{path}:Translation3D"], [box.center], rtol=1e-6)
        turn = matrices(lasting[f"{path}:TransformMat3x3"])[0]
        np.testing.assert_allclose(np.arctan2(turn[1, 0], turn[0, 0]), box.yaw_rad, atol=1e-6)
    strips = lasting["/world/line:LineStrip3D"]
    assert len(strips) == len(arena.line.pieces)
    first = np.array(strips[0])  # (0.55, -0.70) to (0.55, 0.50), 15 mm wide: its corners, and back to the first
    corners = {(round(x, 4), round(y, 4)) for x, y, _ in first.tolist()}
    assert corners == {(0.5425, -0.7), (0.5575, -0.7), (0.5425, 0.5), (0.5575, 0.5)}
    assert first[0].tolist() == first[-1].tolist()


def test_where_no_target_was_seen_the_range_has_a_gap(random_release, exported, copy_of, sign, tmp_path):
    truth, root = random_release(1).runs[0], copy_of(random_release(1).root)
    path = root / "CW/test_1/data.csv"
    head, first, *rest = path.read_text().splitlines()
    cells = first.split(",")
    cells[7] = f"{NO_TARGET_M:.4f}"
    path.write_text("\n".join([head, ",".join(cells), *rest, ""]))
    sign(root)
    _, _, columns, _ = read(exported(root, tmp_path / "out", "rerun") / "rerun" / "CW/test_1.rrd")
    assert not columns["/range/d_f:Scalar"][0]
    assert columns["/range/d_f:Scalar"][1:] == [[value] for value in truth.table[1:, 7].tolist()]


def test_an_obstacle_that_moves_has_the_pose_of_each_row():
    (box, *_) = Arena.from_config(draw_run(load_scenario("moving"), "CW", 1).arena).moving
    t_s = np.array([0.0, 0.5, 2.0])
    table = pd.DataFrame(box.poses_at(t_s), columns=[f"{box.name}_{field}" for field in ("x", "y", "theta")])
    _, pose = _box(_Arrays(pa), box, SimpleNamespace(t_s=t_s, side={"obstacles": table}.get))
    assert pose.t_s is t_s
    places, turns = (component.values.to_pylist() for component in pose.components)  # noqa: PD011 - no pandas
    x, y, yaw = box.poses_at(t_s).T
    np.testing.assert_allclose(np.array(places)[:, 0], np.column_stack((x, y, [box.center[2]] * 3)), atol=1e-6)
    np.testing.assert_allclose(matrices(turns), Rotation.from_euler("z", yaw[:, None]).as_matrix(), atol=1e-6)


def distance_m(points, box):
    """Distance (N,) [m] of points (N, 2) from the outline of a box on the floor, outside or inside of it."""
    c, s = np.cos(box.yaw_rad), np.sin(box.yaw_rad)
    beyond = np.abs((points - box.center[:2]) @ [[c, -s], [s, c]]) - np.multiply(box.size[:2], 0.5)
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return np.where((beyond < 0).all(axis=1), -beyond.max(axis=1), outside)


def test_sensors_and_further_cameras(sensing_release, exported, tmp_path):
    run = symolo.load(sensing_release)["CW/test_1"]
    _, t_s, columns, lasting = read(exported(sensing_release, tmp_path / "out", "rerun") / "rerun/CW/test_1.rrd")
    for name in ("left", "right", "rear"):
        camera, path = run.cameras[name], f"/world/cameras/{name}"
        rows, blobs = at_rows(columns, f"{path}/image:Blob")
        np.testing.assert_allclose(t_s[rows], camera.t_s, atol=1e-9)
        assert [bytes(blob) for (blob,) in blobs] == [image.path.read_bytes() for image in camera.images]
        _, places = at_rows(columns, f"{path}:Translation3D")
        np.testing.assert_allclose(np.array(places)[:, 0], camera.X_WC[:, :3, 3], atol=1e-6)
        assert (f"{path}/image:PinholeProjection" in lasting) == (name != "rear")
    table = np.genfromtxt(sensing_release / "CW/test_1/side/imu.csv", delimiter=",", names=True)
    rows, rates = at_rows(columns, "/sensors/imu/gyro_z:Scalar")
    assert [rate for (rate,) in rates] == table["gyro_z"].tolist()
    np.testing.assert_allclose(t_s[rows], table["t"] / 1000, atol=1e-9)
    ranges = np.genfromtxt(sensing_release / "CW/test_1/side/sonar.csv", delimiter=",", names=True)
    _, seen = at_rows(columns, "/sensors/sonar/range:Scalar")
    assert [one for row in seen for one in row] == [one for one in ranges["range"].tolist() if one > 0]
    # What a lidar at a height of 0.1 m meets are walls and obstacles; its ranges have errors of some millimetres.
    rows, scans = at_rows(columns, "/world/lidars/lidar:Position3D")
    np.testing.assert_allclose(t_s[rows], run.sensors["lidar"].t_s, atol=1e-9)
    points = np.concatenate([np.array(scan) for scan in scans])
    assert len(points) == (run.sensors["lidar"].values("range") > 0).sum() > 50
    boxes = Arena.from_config(run.spec.arena).boxes
    nearest_m = np.min([distance_m(points[:, :2], box) for box in boxes], axis=0)
    assert nearest_m.max() < 0.03
    np.testing.assert_allclose(points[:, 2], 0.1, atol=1e-6)


def test_the_bytes_are_the_same_again(random_release, exported, tmp_path):
    root = random_release(1).root
    one, other = (exported(root, tmp_path / name, "rerun") / "rerun/CW/test_1.rrd" for name in ("a", "b"))
    assert one.read_bytes() == other.read_bytes()


def test_without_pyarrow_it_says_how_to_get_it(random_release, tmp_path, symolo, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    ended = symolo("export", random_release(1).root, "--format", "rerun", "--out", tmp_path / "out")
    assert (ended.code, ended.err.count("\n")) == (5, 1)
    assert "with the extra `export`" in ended.err
    assert list(tmp_path.iterdir()) == []
