"""By `datasets.load_dataset`, offline: images are decoded and equal, and so are readings and poses."""

import io

import cv2
import datasets
import numpy as np
import pytest
import yaml
from pyarrow import parquet

from symolo.dataset.tables.rows import HEADER
from symolo.dataset.tables.side_tables import TOF, WHEELS


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """What is in a folder, without the network."""
    monkeypatch.setattr(datasets.config, "HF_HUB_OFFLINE", True)
    datasets.disable_progress_bars()

    def load(folder, name=None):
        return datasets.load_dataset(str(folder), name, split="train", cache_dir=str(tmp_path / "cache"))

    return load


def test_datasets_loads_pictures_readings_and_poses(seed, random_release, exported, tmp_path, opened):
    release = random_release(seed, annotated=True)
    out = exported(release.root, tmp_path / "out", "huggingface") / "huggingface"
    dataset = opened(out)
    expected = [(truth, index) for truth in release.runs for index in range(len(truth.pictures))]
    assert len(dataset) == len(expected)
    grey = {"depth", "semantic", "free_floor"} & {*release.runs[0].passes}
    assert {name for name, one in dataset.features.items() if isinstance(one, datasets.Image)} == {
        "image",
        "instance",
        *grey,
    }
    for row, (truth, index) in zip(dataset, expected, strict=True):
        assert row["run"] == truth.name
        assert [row[name] for name in HEADER] == truth.table[truth.table[:, 18] > 0][index].tolist()
        np.testing.assert_array_equal(row["X_WC"], truth.X_WC[index])
        np.testing.assert_array_equal(row["K"], truth.K)
        assert (row["image"].mode, row["image"].format) == ("RGB", "JPEG")
        # Two JPEG decoders may round apart by little.
        pixels = cv2.imdecode(np.frombuffer(truth.pictures[index], np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        np.testing.assert_allclose(np.array(row["image"]).astype(int), pixels, atol=3)
        np.testing.assert_array_equal(np.array(row["instance"]), truth.instances[index])
        for kind in grey:
            np.testing.assert_array_equal(np.array(row[kind]), truth.passes[kind][index])
        for kind in ("normals", "flow"):
            if index < len(truth.passes[kind]):
                stored = cv2.imdecode(np.frombuffer(row[kind], np.uint8), cv2.IMREAD_UNCHANGED)
                np.testing.assert_array_equal(stored[..., ::-1], truth.passes[kind][index])
            else:
                assert row[kind] is None
    as_files = dataset.cast_column("image", datasets.Image(decode=False))["image"]
    assert [one["bytes"] for one in as_files] == [truth.pictures[index] for truth, index in expected]


def test_datasets_loads_the_rows_between_images(random_release, exported, tmp_path, opened):
    release = random_release(1)
    dataset = opened(exported(release.root, tmp_path / "out", "huggingface") / "huggingface", "rows").to_pandas()
    for truth in release.runs:
        of_run = dataset[dataset["run"] == truth.name]
        for header, expected in ((HEADER, truth.table), (WHEELS.header, truth.wheels), (TOF.header, truth.tof)):
            np.testing.assert_array_equal(of_run[[*header]], expected)


def test_shards_are_numbered_and_no_larger_than_asked_for(random_release, exported, tmp_path):
    release = random_release(1, annotated=True)
    out = exported(release.root, tmp_path / "out", "huggingface") / "huggingface"
    shards = sorted((out / "images").iterdir())
    assert len(shards) > 1
    assert [path.name for path in shards] == [
        f"train-{number:05d}-of-{len(shards):05d}.parquet" for number in range(len(shards))
    ]
    for path in shards:
        stored = parquet.read_table(path, columns=["image", "depth", "instance", "normals", "flow", "free_floor"])
        sizes = [
            sum(len(one["bytes"] if isinstance(one, dict) else one or b"") for one in row.values())
            for row in stored.to_pylist()
        ]
        assert sum(sizes) <= 40_000 or len(sizes) == 1


def test_the_card_states_licence_and_units(random_release, exported, tmp_path):
    out = exported(random_release(1).root, tmp_path / "out", "huggingface")
    _, head, body = (out / "huggingface/README.md").read_text().split("---\n", 2)
    front_matter = yaml.safe_load(io.StringIO(head))
    assert front_matter["license"] == "cc-by-4.0"
    assert [(one["config_name"], one.get("default", False)) for one in front_matter["configs"]] == [
        ("images", True),
        ("rows", False),
    ]
    assert "| w | rad/s |\n" in body
    assert "| current_r | A |\n" in body


def test_each_further_camera_and_sensor_has_its_own_table(sensing_release, exported, tmp_path, opened):
    out = exported(sensing_release, tmp_path / "out", "huggingface") / "huggingface"
    run = sensing_release / "CW/test_1"
    for name, coefficients in (("left", 5), ("rear", 4)):
        images = opened(out, name)
        assert images["run"][:] == ["CW/test_1"] * len(images)
        as_files = images.cast_column("image", datasets.Image(decode=False))["image"]
        assert [one["bytes"] for one in as_files] == [
            path.read_bytes() for path in sorted((run / f"cameras/{name}/images").iterdir())
        ]
        assert {len(one) for one in images["D"]} == {coefficients}
        table = np.genfromtxt(run / f"cameras/{name}/side/camera.csv", delimiter=",", names=True)
        np.testing.assert_array_equal(np.array(images["X_WC"][:])[:, 0, 3], table["p_x"])
        assert images["t"][:] == table["t"].tolist()
    imu = np.genfromtxt(run / "side/imu.csv", delimiter=",", names=True)
    assert opened(out, "imu")["gyro_z"][:] == imu["gyro_z"].tolist()
    card = yaml.safe_load((out / "README.md").read_text().split("---")[1])
    assert {"left", "right", "rear", "imu", "lidar", "images", "rows"} <= {
        one["config_name"] for one in card["configs"]
    }
