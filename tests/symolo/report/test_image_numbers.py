"""Numbers of images: painted ones by what was painted, noise by an independent implementation."""

import cv2
import numpy as np
import pytest
from scipy.ndimage import laplace

from symolo.reader.dataset import load
from symolo.report.statistics.image_statistics import ImageNumbers, image_numbers
from symolo.report.statistics.outliers import modified_z, outliers


def quiet(_done):
    """Nobody asks how far it is."""


def test_flat_images_are_as_bright_as_they_were_painted_and_have_no_detail(painted):
    data = load(painted(grey=lambda run, image: 40 * run + 10 * image))
    statistics = image_numbers(data["CW/test_2"], quiet)
    assert statistics.numbers == tuple(range(1, 12))
    assert statistics.brightness.tolist() == [40 + 10 * image for image in range(1, 12)]
    assert statistics.sharpness.tolist() == [0.0] * 11
    assert {grey: count for grey, count in enumerate(statistics.pixels) if count} == {
        40 + 10 * image: 48 * 32 for image in range(1, 12)
    }


@pytest.mark.parametrize(("grey", "black", "burnt"), [(16, 1.0, 0.0), (17, 0.0, 0.0), (249, 0.0, 0.0), (250, 0.0, 1.0)])
def test_black_and_burnt_begin_where_docs_say(painted, grey, black, burnt):
    run = load(painted(grey=lambda *_: grey)).runs[0]
    statistics = image_numbers(run, quiet)
    assert (set(statistics.black), set(statistics.burnt)) == ({black}, {burnt})


def test_sharpness_is_the_spread_of_the_laplacian(painted):
    run = load(painted()).runs[0]
    noise = np.random.default_rng(3).integers(0, (90, 160, 255), (32, 48, 3)).astype(np.uint8)
    run.image(1).path.write_bytes(cv2.imencode(".jpg", noise)[1].tobytes())
    red, green, blue = run.image(1).pixels().astype(float).transpose(2, 0, 1)
    grey = np.rint(0.299 * red + 0.587 * green + 0.114 * blue)  # ITU-R BT.601
    statistics = image_numbers(run, quiet)
    assert statistics.sharpness[0] == pytest.approx(laplace(grey, mode="mirror").std(), rel=2e-3)
    assert statistics.brightness[0] == pytest.approx(grey.mean(), abs=0.1)


def test_it_reports_how_many_images_are_done(painted):
    reports = []
    image_numbers(load(painted()).runs[0], reports.append)
    assert reports == list(range(1, 12))


def numbers(run="CW/test_1", **columns):
    rng = np.random.default_rng(1)
    count = 200
    made = {
        "brightness": 120 + rng.normal(size=count),
        "black": np.zeros(count),
        "burnt": np.zeros(count),
        "sharpness": np.exp(2 + 0.1 * rng.normal(size=count)),
    }
    for name, values in columns.items():
        for i, value in values.items():
            made[name][i] = value
    return ImageNumbers(run, tuple(range(1, count + 1)), **made, pixels=np.zeros(256, np.int64))


def test_planted_outliers_are_named_the_farthest_first_and_neighbours_as_one():
    named_outliers = outliers([numbers(), numbers("CCW/test_1", brightness={9: 90, 10: 80, 11: 90}, burnt={50: 0.2})])
    planted = [one for one in named_outliers if one.score > 1.3]
    assert [(one.run, one.numbers, one.worst) for one in planted] == [
        ("CCW/test_1", (10, 11, 12), 11),
        ("CCW/test_1", (51,), 51),
    ]
    assert [one.why for one in planted] == ["mean grey 80, dark", "20% overexposed"]


def test_of_normal_noise_about_one_in_two_thousand_is_beyond_the_limit():
    z = modified_z(np.random.default_rng(2).normal(5.0, 3.0, 40_000))
    assert np.mean(np.abs(z) > 3.5) == pytest.approx(0.000465, abs=0.0004)  # 2 (1 - Phi(3.5))
    assert modified_z(np.full(9, 4.0)).tolist() == [0.0] * 9
