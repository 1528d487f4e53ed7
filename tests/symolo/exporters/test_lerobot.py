"""By the form that LeRobot documents for v3.0: through info.json, as its own reader finds files, episodes and features.

The reader itself needs PyTorch, and other versions than Blender's module stands; it rests on `datasets` and pandas.
"""

import json

import cv2
import datasets
import numpy as np
import pandas as pd
import pytest

from symolo.dataset.tables.side_tables import WHEELS

STATE = ["speed_right", "speed_left", "d_f", "d_l", "d_r", *(f"L{i}" for i in range(8))]
COUNTS = {"frame_index", "episode_index", "index", "task_index"}
"""With `timestamp` the features that every dataset of v3.0 has (`DEFAULT_FEATURES` of lerobot 0.4)."""
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}


@pytest.fixture(autouse=True)
def _offline(monkeypatch):
    monkeypatch.setattr(datasets.config, "HF_HUB_OFFLINE", True)
    datasets.disable_progress_bars()


def read_info(folder):
    return json.loads((folder / "meta/info.json").read_text())


def read_frames(folder, cache, *, decode=False):
    """All files of frames with the features that info.json tells, as lerobot hands them to `datasets`."""
    frames_of = {}
    for name, feature in read_info(folder)["features"].items():
        kind = datasets.Value(feature["dtype"]) if feature["dtype"] != "image" else datasets.Image(decode=decode)
        (length,) = feature["shape"] if feature["dtype"] != "image" else (1,)
        frames_of[name] = kind if length == 1 else datasets.Sequence(kind, length=length)
    paths = [str(path) for path in sorted((folder / "data").glob("*/*.parquet"))]
    return datasets.Dataset.from_parquet(paths, features=datasets.Features(frames_of), cache_dir=str(cache))


def read_episodes(folder):
    return pd.concat([pd.read_parquet(path) for path in sorted((folder / "meta/episodes").glob("*/*.parquet"))])


def expected_numbers(truth, robot):
    """State and action (paper Eq. 3-4: V1 = v + w b / 2 is the right wheel's) at the images, and their times."""
    at = truth.table[:, 18] > 0
    names = ("speed_r", "speed_l", "command_v", "command_w")
    right, left, v, w = (truth.wheels[at, WHEELS.header.index(name)] for name in names)
    b, radius = robot["drive"]["track_m"], robot["drive"]["wheel_diameter_m"] / 2
    action = np.column_stack((v + w * b / 2, v - w * b / 2)) / radius
    t_s = truth.table[at, 0] / 1000
    return np.column_stack((right, left, truth.table[at, 7:18])), action, t_s - t_s[0], truth.table[at, 1:4]


def stats_differ(stats, values):
    """Of values (N, components); images as (pixels, channels), of which a quantile is a level that occurs."""
    is_picture = values.dtype == np.uint8
    how = "inverted_cdf" if is_picture else "linear"
    numbers = values / 255 if is_picture else values.astype(np.float64)
    expected = {"min": numbers.min(0), "max": numbers.max(0), "mean": numbers.mean(0), "std": numbers.std(0)}
    expected |= {name: np.quantile(numbers, share, axis=0, method=how) for name, share in QUANTILES.items()}
    assert {*stats} == {*expected, "count"}
    for name, one in expected.items():
        got = np.array(stats[name], dtype=np.float64)
        assert got.shape == ((3, 1, 1) if is_picture else one.shape)
        np.testing.assert_allclose(got.ravel(), one, rtol=1e-9, atol=1e-12, err_msg=name)


def pixels_of(truths):
    decoded = [cv2.imdecode(np.frombuffer(one, np.uint8), cv2.IMREAD_COLOR) for each in truths for one in each.pictures]
    return np.array(decoded)[..., ::-1].reshape(-1, 3)


def nested(array):
    """Lists in lists, as pandas hands them out, as one array."""
    return np.array([*map(nested, array)]) if array.dtype == object else array


def check_info(info, counts):
    assert (info["codebase_version"], info["fps"], info["robot_type"]) == ("v3.0", 5, "nominal")
    assert (info["total_episodes"], info["total_frames"], info["splits"]) == (2, sum(counts), {"train": "0:2"})
    ours = {"observation.images.front", "observation.state", "action", "pose"}
    assert {*info["features"]} == COUNTS | {"timestamp"} | ours
    assert info["features"]["observation.state"]["names"] == STATE
    assert info["features"]["observation.images.front"]["shape"] == [24, 40, 3]


def check_row(row, episode, begin, count):
    """Where an episode lies; files take one each here."""
    assert (row["episode_index"], row["length"]) == (episode, count)
    assert (row["dataset_from_index"], row["dataset_to_index"]) == (begin, begin + count)
    assert (row["data/chunk_index"], row["data/file_index"]) == (0, episode)
    assert {row[key][0] for key in row.index if key.endswith("/count")} == {count}


def told_stats(row, name):
    keys = [key for key in row.index if key.startswith(f"stats/{name}/")]
    return {key.rpartition("/")[2]: nested(row[key]) for key in keys}


def frames_differ(of_run, row, truth, robot):
    """Images, numbers and statistics of an episode."""
    names = ("observation.state", "action", "timestamp", "pose")
    for name, expected in zip(names, expected_numbers(truth, robot), strict=True):
        np.testing.assert_array_equal(np.array(of_run[name][:], np.float32), expected.astype(np.float32))
        stats_differ(told_stats(row, name), expected.astype(np.float32).reshape(len(expected), -1))
    stats_differ(told_stats(row, "observation.images.front"), pixels_of([truth]))
    assert [one["bytes"] for one in of_run["observation.images.front"]] == [*truth.pictures]
    assert of_run["frame_index"][:] == list(range(len(truth.pictures)))
    assert {*of_run["episode_index"]} == {row["episode_index"]}


def test_lerobot_holds_the_release(seed, random_release, exported, tmp_path):
    release = random_release(seed)
    folder = exported(release.root, tmp_path / "out", "lerobot", shard_bytes=1) / "lerobot"
    info, frames, episodes = read_info(folder), read_frames(folder, tmp_path / "cache"), read_episodes(folder)
    tasks = pd.read_parquet(folder / "meta/tasks.parquet")
    counts = [len(truth.pictures) for truth in release.runs]
    check_info(info, counts)
    assert frames["index"][:] == list(range(sum(counts)))
    for episode, truth in enumerate(release.runs):
        row, begin = episodes.iloc[episode], sum(counts[:episode])
        check_row(row, episode, begin, counts[episode])
        assert (folder / info["data_path"].format(chunk_index=0, file_index=episode)).is_file()
        of_run = frames.select(range(begin, begin + counts[episode]))
        robot = json.loads((release.root / truth.name / "side/spec.json").read_text())["robot"]
        frames_differ(of_run, row, truth, robot)
        assert [tasks.iloc[of_run["task_index"][0]].name] == [*row["tasks"]]
        assert row["tasks"][0].endswith(f"route {truth.name.split('/')[0]}")
    whole = json.loads((folder / "meta/stats.json").read_text())
    assert {*whole} == {*info["features"]}
    stats_differ(whole["observation.images.front"], pixels_of(release.runs))
    stats_differ(whole["action"], np.array(frames["action"][:], np.float32))
    assert whole["index"]["count"] == [sum(counts)]


def test_pictures_are_decoded_from_the_folder_alone(random_release, exported, tmp_path):
    folder = exported(random_release(1).root, tmp_path / "out", "lerobot") / "lerobot"
    assert len([*(folder / "data").rglob("*.parquet")]) == 1
    first = read_frames(folder, tmp_path / "cache", decode=True)[0]["observation.images.front"]
    assert (first.mode, first.size) == ("RGB", (40, 24))
    card = datasets.load_dataset(str(folder), split="train", cache_dir=str(tmp_path / "cache"))
    assert isinstance(card.features["observation.images.front"], datasets.Image)


def test_frames_hold_the_newest_image_of_each_camera_and_the_newest_sample_of_each_sensor(
    sensing_release, exported, tmp_path
):
    folder = exported(sensing_release, tmp_path / "out", "lerobot") / "lerobot"
    info, frames = read_info(folder), read_frames(folder, tmp_path / "cache")
    run = sensing_release / "CW/test_1"
    t_ms = np.arange(4) * 200
    # The camera at the rear takes an image each 300 ms, which is there 50 ms later.
    newest = {"left": [1, 2, 3, 4], "right": [1, 2, 3, 4], "rear": [1, 1, 2, 2]}
    for name, numbers in newest.items():
        feature = f"observation.images.{name}"
        assert info["features"][feature]["shape"] == [24, 32, 3]
        files = [(run / f"cameras/{name}/images/{number:06d}.jpg").read_bytes() for number in numbers]
        assert [one["bytes"] for one in frames[feature]] == files
        pixels = [cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_COLOR)[..., ::-1] for file in files]
        whole = json.loads((folder / "meta/stats.json").read_text())
        stats_differ(whole[feature], np.array(pixels).reshape(-1, 3))
    names = info["features"]["observation.state"]["names"]
    assert names[: len(STATE)] == STATE
    state = dict(zip(names, np.array(frames["observation.state"][:]).T, strict=True))
    delays_ms = {"imu.gyro_z": 0, "lidar.range_35": 20, "coder.counts": 4, "bumper.pressed_2": 0, "sonar.range": 0}
    for name, delay_ms in delays_ms.items():
        sensor, column = name.split(".")
        table = np.genfromtxt(run / f"side/{sensor}.csv", delimiter=",", names=True)
        # Of the samples that were delivered by then the last one; before the first delivery the first sample.
        at = [max((table["t"] + delay_ms <= one + 1e-6).sum() - 1, 0) for one in t_ms]
        np.testing.assert_array_equal(state[name], table[column][at].astype(np.float32))
    assert info["features"]["observation.state"]["shape"] == [len(names)]
