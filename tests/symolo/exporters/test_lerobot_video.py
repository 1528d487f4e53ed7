"""LeRobot with videos: each frame is decoded where info.json and the episodes say, as LeRobot's reader looks for it."""

import json

import av
import cv2
import numpy as np
import pandas as pd
import pytest

KEY = "observation.images.front"


@pytest.fixture(scope="module")
def exported_video(random_release, tmp_path_factory):
    from pipeline.cli import main  # noqa: PLC0415 - as the user does

    release, out = random_release(2, annotated=True), tmp_path_factory.mktemp("video") / "out"
    splits = "{runs: {train: [CCW/*], test: [CW/*]}}"
    options = ["--format", "lerobot", "--video", "--splits", splits, "--out", str(out)]
    assert main(["export", str(release.root), *options]) == 0
    return release, out / "lerobot"


def decoded(path):
    """Luma of each frame (H, W) by its time in s, and the distance between key frames."""
    with av.open(str(path)) as container:
        frames = [*container.decode(video=0)]
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.pix_fmt, stream.average_rate) == ("h264", "yuv420p", 5)
        keys = np.flatnonzero([frame.key_frame for frame in frames])
        return {round(frame.time, 6): frame.to_ndarray(format="gray") for frame in frames}, keys


def test_every_frame_is_at_its_time_in_the_video(exported_video):
    release, root = exported_video
    info = json.loads((root / "meta/info.json").read_text())
    (fps, video_path), feature = (info["fps"], info["video_path"]), info["features"][KEY]
    assert (feature["dtype"], feature["shape"]) == ("video", [24, 40, 3])
    assert (feature["info"]["video.codec"], feature["info"]["video.fps"]) == ("h264", fps)
    episodes = pd.concat([pd.read_parquet(path) for path in sorted((root / "meta/episodes").glob("*/*.parquet"))])
    frames = pd.concat([pd.read_parquet(path) for path in sorted((root / "data").glob("*/*.parquet"))])
    assert KEY not in frames
    whole = {truth.name: truth for truth in release.runs}
    greys = {
        name: [cv2.imdecode(np.frombuffer(one, np.uint8), cv2.IMREAD_GRAYSCALE) for one in truth.pictures]
        for name, truth in whole.items()
    }
    everything = np.array([grey.ravel() for name in greys for grey in greys[name]], dtype=float)
    for episode, name in zip(episodes.to_dict("records"), ("CCW/test_1", "CW/test_1"), strict=True):
        place = {key: episode[f"videos/{KEY}/{key}"] for key in ("chunk_index", "file_index")}
        found, keys = decoded(root / video_path.format(video_key=KEY, **place))
        assert np.all(np.diff(keys) <= 2)
        start, end = (episode[f"videos/{KEY}/{side}_timestamp"] for side in ("from", "to"))
        assert end - start == pytest.approx(episode["length"] / fps)
        times = frames[frames["episode_index"] == episode["episode_index"]]["timestamp"].to_numpy()
        np.testing.assert_allclose(times, np.arange(episode["length"]) / fps, atol=1e-6)
        for grey, t_s in zip(greys[name], times, strict=True):
            luma = found[round(float(start + t_s), 6)].ravel()
            likeness = [np.corrcoef(luma, other)[0, 1] for other in everything]
            best = everything[int(np.argmax(likeness))]
            assert max(likeness) > 0.95
            np.testing.assert_array_equal(best, grey.ravel())


def test_the_same_release_gives_the_same_video(exported_video, tmp_path, symolo):
    release, root = exported_video
    splits = "{runs: {train: [CCW/*], test: [CW/*]}}"
    options = ("--format", "lerobot", "--video", "--splits", splits)
    assert symolo("export", release.root, *options, "--out", tmp_path / "again").code == 0
    for path in root.rglob("*.mp4"):
        assert path.read_bytes() == (tmp_path / "again/lerobot" / path.relative_to(root)).read_bytes()


def test_video_is_refused_for_other_formats(random_release, symolo, tmp_path):
    refused = symolo("export", random_release(1).root, "--format", "tum", "--video", "--out", tmp_path / "out")
    assert (refused.code, refused.err.count("\n")) == (2, 1)
    assert "--video: got 'tum', allowed: --format lerobot" in refused.err


def test_each_further_camera_has_a_video_of_its_own(sensing_release, symolo, tmp_path):
    out = tmp_path / "out"
    assert symolo("export", sensing_release, "--format", "lerobot", "--video", "--out", out).code == 0
    folder = out / "lerobot"
    info = json.loads((folder / "meta/info.json").read_text())
    (episode,) = pd.read_parquet(folder / "meta/episodes/chunk-000/file-000.parquet").to_dict("records")
    # At 0, 0.2, 0.4 and 0.6 s; the camera at the rear takes an image each 0.3 s, which is there 0.05 s later.
    newest = {"left": [1, 2, 3, 4], "rear": [1, 1, 2, 2]}
    for name, numbers in newest.items():
        key = f"observation.images.{name}"
        assert info["features"][key]["dtype"] == "video"
        place = {one: episode[f"videos/{key}/{one}"] for one in ("chunk_index", "file_index")}
        frames, _ = decoded(folder / info["video_path"].format(video_key=key, **place))
        assert [*frames] == pytest.approx([0, 0.2, 0.4, 0.6])
        files = sorted((sensing_release / f"CW/test_1/cameras/{name}/images").iterdir())
        greys = [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE).ravel() for file in files]
        for luma, number in zip(frames.values(), numbers, strict=True):
            likeness = [np.corrcoef(luma.ravel(), grey)[0, 1] for grey in greys]
            assert int(np.argmax(likeness)) == number - 1
