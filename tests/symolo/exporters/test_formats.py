"""Each format is read back, by its own reader where that is small, and holds what was put into the release."""

import json
import tarfile
from pathlib import Path

import cv2
import numpy as np
from pyarrow import parquet
from pycocotools.coco import COCO
from webdataset import tariterators

from symolo.dataset.tables.rows import HEADER
from symolo.dataset.tables.side_tables import WHEELS
from symolo.exporters import FORMATS as ALL_FORMATS
from symolo.exporters.base import ExportSettings
from symolo.exporters.export import exporters_of, open_release, plan

FORMATS = ("tum", "kitti", "coco", "webdataset", "parquet")
"""The others have files of their own."""
FIRST_BOX = {"amodal_bbox": [1, 2, 3, 4], "amodal_area": 12, "visible_fraction": 0.25, "truncated": True}
"""Of instance 3 in the first image of each run; the releases have no other box."""


def test_every_format_holds_the_release(seed, random_release, exported, tmp_path):
    release = random_release(seed, annotated=True)
    out = exported(release.root, tmp_path / "out", *FORMATS)
    for check in (check_tum, check_kitti, check_coco, check_webdataset, check_parquet):
        check(out, release.runs)


def read_tum(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (N,), positions (N, 3) and rotations (N, 3, 3) of a file, by the benchmark's page on its formats.

    Each line is `timestamp tx ty tz qx qy qz qw`, separated by spaces; lines that begin with # are comments. The
    rotation of a unit quaternion is that of Shoemake, Animating Rotation with Quaternion Curves, 1985.
    """
    lines = [line.split(" ") for line in path.read_text().splitlines() if not line.startswith("#")]
    assert {len(line) for line in lines} == {8}
    numbers = np.array(lines, dtype=np.float64)
    x, y, z, w = numbers[:, 4:].T
    np.testing.assert_allclose(x * x + y * y + z * z + w * w, 1, atol=1e-8)
    rotations = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return numbers[:, 0], numbers[:, 1:4], np.moveaxis(np.array(rotations), 2, 0)


def planar(t_s, positions, rotations) -> tuple[np.ndarray, np.ndarray]:
    """Places as complex numbers, and headings as complex numbers of length 1; nothing leaves the plane."""
    np.testing.assert_array_equal(positions[:, 2], 0)
    np.testing.assert_allclose(rotations[:, 2], np.tile([0, 0, 1], (len(t_s), 1)), atol=1e-8)
    return positions[:, 0] + 1j * positions[:, 1], rotations[:, 0, 0] + 1j * rotations[:, 1, 0]


def check_tum(out, truths):
    for truth in truths:
        folder = out / "tum" / truth.name
        t, x, y, theta = truth.table[:, :4].T
        place, heading = x + 1j * y, np.exp(1j * theta)
        got = read_tum(folder / "robot.txt")
        np.testing.assert_array_equal(got[0], t / 1000)
        for exported, true in zip(planar(*got), (place, heading), strict=True):
            np.testing.assert_allclose(exported, true, rtol=0, atol=1e-8)
        at = truth.table[:, 18] > 0
        t_s, positions, rotations = read_tum(folder / "camera.txt")
        np.testing.assert_array_equal(t_s, t[at] / 1000)
        np.testing.assert_array_equal(positions, truth.X_WC[:, :3, 3])
        np.testing.assert_allclose(rotations, truth.X_WC[:, :3, :3], rtol=0, atol=1e-8)
        ox, oy, turned = (truth.wheels[:, WHEELS.header.index(f"odometry_{name}")] for name in ("x", "y", "theta"))
        expected = place[0] + heading[0] * (ox + 1j * oy), heading[0] * np.exp(1j * turned)
        for exported, true in zip(planar(*read_tum(folder / "odometry.txt")), expected, strict=True):
            np.testing.assert_allclose(exported, true, rtol=0, atol=1e-6)


def read_calibration(path: Path) -> dict[str, np.ndarray]:
    entries = (line.split(":", 1) for line in path.read_text().splitlines())
    return {name: np.array(numbers.split(), dtype=np.float64) for name, numbers in entries}


def poses(path: Path) -> np.ndarray:
    """(N, 4, 4) of lines with 12 numbers, as the development kit reads them."""
    numbers = np.loadtxt(path, ndmin=2).reshape(-1, 3, 4)
    return np.concatenate((numbers, np.tile([[[0, 0, 0, 1.0]]], (len(numbers), 1, 1))), axis=1)


def check_kitti(out, truths):
    names = [line.split(" ", 1) for line in (out / "kitti/runs.txt").read_text().splitlines()]
    assert names == [[f"{number:02d}", truth.name] for number, truth in enumerate(truths)]
    for (name, _), truth in zip(names, truths, strict=True):
        folder = out / "kitti/sequences" / name
        X_C0C = poses(out / f"kitti/poses/{name}.txt")
        np.testing.assert_allclose(X_C0C[0], np.eye(4), rtol=0, atol=1e-8)
        (X_WC0,) = poses(folder / "origin.txt")
        np.testing.assert_allclose(X_WC0 @ X_C0C, truth.X_WC, rtol=0, atol=1e-6)
        taken = truth.table[:, 18] > 0
        np.testing.assert_array_equal(np.loadtxt(folder / "times.txt", ndmin=1), truth.table[taken, 0] / 1000)
        calibration = read_calibration(folder / "calib.txt")
        assert {*calibration} == {"P0", "P1", "P2", "P3", "Tr", "D0"}
        np.testing.assert_allclose(calibration["P0"].reshape(3, 4), np.column_stack((truth.K, np.zeros(3))), rtol=1e-9)
        images = sorted((folder / "image_0").iterdir())
        assert [path.name for path in images] == [f"{number:06d}.jpg" for number in range(len(truth.pictures))]
        assert tuple(path.read_bytes() for path in images) == truth.pictures


def check_coco(out, truths):
    coco = COCO(out / "coco/annotations/instances.json")
    names = {category["id"]: category["name"] for category in coco.loadCats(coco.getCatIds())}
    assert names == {1: "floor", 2: "line", 3: "wall", 4: "obstacle", 5: "room", 6: "robot"}
    images = coco.loadImgs(sorted(coco.getImgIds()))
    expected = [(truth, index) for truth in truths for index in range(len(truth.pictures))]
    assert len(images) == len(expected)
    for image, (truth, index) in zip(images, expected, strict=True):
        assert (out / "coco/images" / image["file_name"]).read_bytes() == truth.pictures[index]
        np.testing.assert_array_equal(image["X_WC"], truth.X_WC[index])
        ids = truth.instances[index]
        annotations = coco.loadAnns(coco.getAnnIds(image["id"]))
        assert {one["instance_id"] for one in annotations} == {*np.unique(ids).tolist()} - {0}
        for one in annotations:
            mask = ids == one["instance_id"]
            np.testing.assert_array_equal(coco.annToMask(one), mask)
            rows, columns = np.nonzero(mask)
            box = [columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1]
            assert (one["area"], one["bbox"]) == (mask.sum(), box)
            corners = truth.sightings.get((index + 1, one["instance_id"]))
            assert ("keypoints" in one) == (corners is not None) == ("keypoints" in coco.cats[one["category_id"]])
            if corners is not None:
                key_points = np.reshape(one["keypoints"], (8, 3)).tolist()
                assert key_points == [
                    [*corners[k][:2], 2 if corners[k][2] else 1] if k in corners else [0, 0, 0] for k in range(8)
                ]
                assert one["num_keypoints"] == len(corners)
            amodal = {name: one.get(name) for name in ("amodal_bbox", "amodal_area", "visible_fraction", "truncated")}
            has_box = (index, one["instance_id"]) == (0, 3)
            assert amodal == (FIRST_BOX if has_box else dict.fromkeys(FIRST_BOX))


def test_coco_has_neither_corners_nor_their_names_without_key_points(random_release, exported, tmp_path):
    out = exported(random_release(1, kinds=("instance", "boxes_2d")).root, tmp_path / "out", "coco")
    coco = COCO(out / "coco/annotations/instances.json")
    assert {one["category_id"] for one in coco.anns.values()} >= {3, 4}
    for one in (*coco.cats.values(), *coco.anns.values()):
        assert not {"keypoints", "num_keypoints", "skeleton"} & one.keys()


def read_shard(path: Path) -> list[dict]:
    """By the stages of `webdataset.WebDataset`, which itself leaves the file open."""
    with path.open("rb") as stream:
        files = tariterators.tar_file_expander(
            [{"url": str(path), "stream": stream}], handler=tariterators.reraise_exception
        )
        return list(tariterators.group_by_keys(files))


def check_webdataset(out, truths):
    shards = sorted((out / "webdataset").glob("*.tar"))
    assert [path.name for path in shards] == [f"symolo-{number:06d}.tar" for number in range(len(shards))]
    assert max(path.stat().st_size for path in shards) <= 40_000
    samples = [sample for path in shards for sample in read_shard(path)]
    by_name = sorted(truths, key=lambda truth: truth.name)
    expected = [(truth, index) for truth in by_name for index in range(len(truth.pictures))]
    assert [sample["__key__"] for sample in samples] == [f"{truth.name}/{i + 1:06d}" for truth, i in expected]
    for sample, (truth, index) in zip(samples, expected, strict=True):
        others = {f"{kind}.png" for kind, stored in truth.passes.items() if index < len(stored)}
        assert {name for name in sample if not name.startswith("__")} == {"jpg", "json", "instance.png"} | others
        assert sample["jpg"] == truth.pictures[index]
        document = json.loads(sample["json"])
        row = truth.table[truth.table[:, 18] > 0][index]
        assert [document[name] for name in HEADER] == row.tolist()
        np.testing.assert_array_equal(document["X_WC"], truth.X_WC[index])
        ids = cv2.imdecode(np.frombuffer(sample["instance.png"], np.uint8), cv2.IMREAD_UNCHANGED)
        np.testing.assert_array_equal(ids, truth.instances[index])


def check_parquet(out, truths):
    folder = out / "parquet"
    tables = {path.stem: parquet.read_table(path) for path in folder.glob("*.parquet")}
    assert {*tables} == {"rows", "wheels", "tof", "images"}
    for table in tables.values():
        assert table["run"].unique().to_pylist() == [truth.name for truth in truths]
    units = {field.name: field.metadata[b"unit"].decode() for field in tables["rows"].schema}
    assert (units["t"], units["theta"], units["v"], units["run"]) == ("ms", "rad", "m/s", "-")
    for truth in truths:
        rows, wheels, images = (
            table.filter(np.array(table["run"]) == truth.name).drop(["run"])
            for table in (tables["rows"], tables["wheels"], tables["images"])
        )
        np.testing.assert_array_equal(rows.to_pandas().to_numpy(), truth.table)
        np.testing.assert_array_equal(wheels.to_pandas().to_numpy(), truth.wheels)
        assert tuple((folder / name).read_bytes() for name in images["file_name"].to_pylist()) == truth.pictures
        poses_by_rows = images.to_pandas()[[f"r{i}{k}" for i in (1, 2, 3) for k in (1, 2, 3)]].to_numpy()
        np.testing.assert_array_equal(poses_by_rows.reshape(-1, 3, 3), truth.X_WC[:, :3, :3])


def test_parquet_has_the_tables_of_all_sensors_and_cameras(sensing_release, exported, tmp_path):
    folder, run = exported(sensing_release, tmp_path / "out", "parquet") / "parquet", sensing_release / "CW/test_1"
    places = {f"side/{path.stem}.csv": f"{path.stem}.parquet" for path in (run / "side").glob("*.csv")}
    places |= {f"cameras/{name}/side/camera.csv": f"cameras/{name}.parquet" for name in ("left", "right", "rear")}
    places["side/camera.csv"] = "images.parquet"
    assert {f"{path.relative_to(folder)}" for path in folder.rglob("*.parquet")} == {*places.values(), "rows.parquet"}
    for place, name in places.items():
        expected = np.genfromtxt(run / place, delimiter=",", names=True)
        table = parquet.read_table(folder / name).to_pandas()
        for column in expected.dtype.names:
            np.testing.assert_array_equal(table[column], expected[column])
        for number, file in enumerate(table.get("file_name", ()), start=1):
            source = run / Path(place).parent.parent / f"images/{number:06d}.jpg"
            assert (folder / file).read_bytes() == source.read_bytes()


def test_kitti_projects_a_point_where_the_camera_sees_it(random_release, exported, tmp_path):
    """A point ahead of the robot, by P0 and Tr of the file, beside OpenCV's projection by our camera's model."""
    release = random_release(1)
    out = exported(release.root, tmp_path / "out", "kitti")
    calibration = read_calibration(out / "kitti/sequences/00/calib.txt")
    p_R = np.array([0.4, 0.05, 0.02, 1.0])
    p_C = calibration["Tr"].reshape(3, 4) @ p_R
    u, v, depth = calibration["P0"].reshape(3, 4) @ [*p_C, 1.0]
    model = json.loads((release.root / "CW/test_1/side/intrinsics.json").read_text())
    X_CR = np.linalg.inv(model["X_RC"])
    K, D = (np.array(model[name]) for name in "KD")
    (pixel,), _ = cv2.projectPoints(p_R[None, :3], cv2.Rodrigues(X_CR[:3, :3])[0], X_CR[:3, 3], K, D)
    assert depth > 0
    np.testing.assert_allclose([u / depth, v / depth], pixel[0], atol=1e-5)


def test_tum_shows_a_quarter_turn_as_its_quaternion(random_release, exported, tmp_path):
    """cos 45 deg is 0.707106781; a turn about z has no other component."""
    release = random_release(1)
    out = exported(release.root, tmp_path / "out", "tum")
    header, first = (out / "tum/CW/test_1/robot.txt").read_text().splitlines()[:2]
    x, y, theta = release.runs[0].table[0, 1:4]
    assert header == "# timestamp tx ty tz qx qy qz qw"
    qz, qw = np.sin(theta / 2), np.cos(theta / 2)
    assert first == f"0.000 {x:.6f} {y:.6f} 0.000000 0.000000000 0.000000000 {qz:.9f} {qw:.9f}"


def test_quaternions_go_on_from_those_before(random_release, exported, tmp_path):
    """q and -q are the same rotation; between two poses of a trajectory nothing may turn the long way."""
    out = exported(random_release(1, annotated=True).root, tmp_path / "out", "tum")
    for path in (out / "tum").rglob("*.txt"):
        quaternions = np.loadtxt(path, ndmin=2)[:, 4:]
        assert np.all(np.sum(quaternions[1:] * quaternions[:-1], axis=1) >= 0)


def test_shards_contain_nothing_of_the_machine(random_release, exported, tmp_path):
    out = exported(random_release(1, annotated=True).root, tmp_path / "out", "webdataset")
    shards = sorted((out / "webdataset").glob("*.tar"))
    assert len(shards) > 1
    for path in shards:
        with tarfile.open(path) as shard:
            members = shard.getmembers()
        assert [one.name for one in members] == sorted(one.name for one in members)
        attributes = {(one.mtime, one.uid, one.gid, one.uname, one.gname, one.mode, one.isreg()) for one in members}
        assert attributes == {(0, 0, 0, "", "", 0o644, True)}


def test_a_sample_larger_than_a_shard_gets_one_of_its_own(random_release):
    data = open_release(random_release(1, annotated=True).root, None)
    (planned,) = plan(data, exporters_of(["webdataset"], ""), ExportSettings(1))
    assert [file.name.endswith(".tar") for file in planned.files].count(True) == len(data.images)


def test_a_plan_knows_the_size_of_every_file(random_release):
    data = open_release(random_release(1, annotated=True).root, None)
    for planned in plan(data, exporters_of(ALL_FORMATS, ""), ExportSettings(40_000)):
        assert [file.size_bytes() for file in planned.files] == [len(file.content()) for file in planned.files]
