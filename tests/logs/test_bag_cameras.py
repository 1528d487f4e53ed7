"""Images of bags that other writers made: pixels, times, lens and place, and what is left out with its reason."""

import cv2
import numpy as np
import pytest

from logs.bags import child
from logs.trajectories.base import ReadSettings
from logs.trajectories.readers import READERS
from tests.logs.camera_messages import (
    CENTER,
    COUNT,
    ENCODINGS,
    EVERY,
    FOCAL,
    HEIGHT,
    LATE_NS,
    WIDTH,
    Camera,
    D,
    encoded,
    messages,
    scene,
)
from tests.logs.written_bags import Ros, write_mcap, write_ros1


def written(folder, version, of_image):
    """Write a bag with what `of_image` yields for each image; return its path."""
    ros, path = Ros(version), folder / ("drive.bag" if version == 1 else "drive.mcap")
    (write_ros1 if version == 1 else write_mcap)(path, messages(ros, of_image), ros)
    return path


def read(path):
    reader = next(reader for reader in READERS if reader.recognises(path))
    (trajectory,) = reader.read(path, ReadSettings(topics=("odom:base_link",)))
    return trajectory, {camera.name: camera for camera in trajectory.cameras}


def pixels_of(data):
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]


@pytest.mark.parametrize("version", [1, 2], ids=["ROS 1", "ROS 2"])
def test_images_of_all_encodings_are_jpeg_files_in_colour(version, tmp_path):
    def of_image(ros, at_ns, number):
        for encoding in ENCODINGS:
            camera = Camera(ros, encoding)
            yield from (camera.info(at_ns), camera.raw(at_ns, scene(number), encoding))
        png = Camera(ros, "png")
        yield from (png.info(at_ns), png.compressed(at_ns, encoded(scene(number), ".png"), "rgb8; png compressed"))

    trajectory, cameras = read(written(tmp_path, version, of_image))
    assert {*cameras} == {*ENCODINGS, "png"}
    for name, camera in cameras.items():
        assert (camera.size, len(camera.files)) == ((WIDTH, HEIGHT), COUNT)
        times_s = 0.05 * EVERY * np.arange(COUNT) + 1e-9 * LATE_NS
        np.testing.assert_allclose(camera.t_s - trajectory.t_s[0], times_s, atol=1e-6)
        for number, data in enumerate(camera.files):
            expected = scene(number).astype(int)
            if name == "mono8":
                expected = np.repeat(expected[..., :1], 3, axis=2)
            border = 1 if name.startswith("bayer") else 0  # has no neighbours to interpolate from
            inner = slice(border, HEIGHT - border), slice(border, WIDTH - border)
            # Sampling of colours at half the resolution and a quality of 95 leave a few of 255 steps.
            np.testing.assert_allclose(pixels_of(data)[inner], expected[inner], atol=12, err_msg=name)
        assert f"{name}: images are stored as colour JPEG files of quality 95" in trajectory.changes


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    """A bag with a calibrated camera, and with images that cannot be taken for different reasons."""

    def of_image(ros, at_ns, number):
        jpeg = encoded(scene(number), ".jpg")
        good, wide = Camera(ros, "good"), Camera(ros, "wide")
        yield from (good.info(at_ns), good.compressed(at_ns, jpeg), good.raw(at_ns, scene(number)))
        yield from (wide.info(at_ns, "equidistant", (0.01, 0.002, 0.0, 0.0)), wide.compressed(at_ns, jpeg))
        odd, lost, other = Camera(ros, "odd"), Camera(ros, "lost", "nowhere"), Camera(ros, "other")
        yield from (odd.info(at_ns, "rational_polynomial", [0.1] * 8), odd.compressed(at_ns, jpeg))
        yield from (lost.info(at_ns), lost.compressed(at_ns, jpeg))
        yield from (other.info(at_ns), other.compressed(at_ns, np.zeros(9, np.uint8), "h264"))
        yield Camera(ros, "bare").compressed(at_ns, jpeg)
        small, torn = Camera(ros, "small"), Camera(ros, "torn")
        yield from (small.info(at_ns), small.compressed(at_ns, encoded(scene(number)[:6], ".jpg")))
        yield from (torn.info(at_ns), torn.compressed(at_ns, jpeg if number else jpeg[:80]))

    return read(written(tmp_path_factory.mktemp("mixed"), 1, of_image))


def test_jpeg_files_stay_as_they_are_and_the_lens_is_that_of_the_camera_info(mixed):
    trajectory, cameras = mixed
    good = cameras["good"]
    assert good.files == tuple(encoded(scene(number), ".jpg").tobytes() for number in range(COUNT))
    np.testing.assert_array_equal(good.K, [[FOCAL[0], 0, CENTER[0]], [0, FOCAL[1], CENTER[1]], [0, 0, 1]])
    assert (good.distortion_model, good.D) == ("plumb_bob", D)
    assert (cameras["wide"].distortion_model, cameras["wide"].D) == ("equidistant", (0.01, 0.002, 0.0, 0.0))
    place = {"x_m": 0.06, "y_m": 0.01, "z_m": 0.12, "yaw_deg": 0.0, "pitch_up_deg": 0.0, "roll_deg": 0.0}
    assert good.settings == {"period_s": 0.5, "delay_s": 0.0, **place}
    assert trajectory.quantities["good"] == "/good/image_raw/compressed: 6 images of 16 x 12 px"


@pytest.mark.parametrize(
    ("topic", "reason"),
    [
        ("good/image_raw", "it is the camera of /good/image_raw/compressed"),
        ("odd/image_raw/compressed", "its lens has the model 'rational_polynomial' with 8 coefficients; known are "),
        ("lost/image_raw/compressed", "no transform leads from base_link to nowhere"),
        ("other/image_raw/compressed", "its images have the format 'h264', and neither JPEG nor PNG"),
        ("bare/image_raw/compressed", "there is no /bare/camera_info, so its lens is not known"),
        ("small/image_raw/compressed", "no image can be decoded with the 16 x 12 px of /small/camera_info"),
    ],
)
def test_images_that_cannot_be_taken_are_named_with_the_reason(topic, reason, mixed):
    trajectory, cameras = mixed
    assert {*cameras} == {"good", "wide", "torn"}
    assert [text for text in trajectory.changes if text.startswith(f"left out: /{topic}: {reason}")]


def test_a_damaged_image_is_left_out_alone(mixed):
    trajectory, cameras = mixed
    assert len(cameras["torn"].files) == COUNT - 1
    assert "torn: left out: 1 image of another size than 16 x 12 px, or damaged" in trajectory.changes


def test_images_beyond_the_size_that_can_be_held_are_left_out_in_one_sentence(tmp_path, monkeypatch):
    def of_image(ros, at_ns, number):
        camera = Camera(ros, "good")
        yield from (camera.info(at_ns), camera.compressed(at_ns, encoded(scene(number), ".jpg")))

    monkeypatch.setattr(child, "_IMAGE_BYTES", 1000)
    index = child.write_topics(written(tmp_path, 1, of_image), tmp_path / "out.npz")
    (images,) = index.images
    assert images.problem.startswith("the images of the bag have more than 0.001 MB; filter the bag")
    assert len(index.streams) == 3  # the transforms and the lens
