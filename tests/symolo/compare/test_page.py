"""The page about a comparison: the images that differ beside each other, the tables as curves, all files in lists."""

import base64
import re
import shutil

import cv2
import numpy as np
import pytest

from symolo.compare.pairs import image_pair
from symolo.compare.tables import worst_column


def png(pixels):
    return cv2.imencode(".png", np.asarray(pixels))[1].tobytes()


def pixels_of(jpeg):
    return cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_UNCHANGED)


@pytest.fixture
def two(painted, tmp_path):
    """A release, and another one with a square in image 3, one brighter image 5, other speeds, and one image less."""
    a, b = painted(), tmp_path / "b"
    shutil.copytree(a, b)
    folder = b / "CW/test_1/images"
    square = np.full((32, 48, 3), 123, np.uint8)
    square[8:24, 16:32] = 223
    (folder / "000003.jpg").write_bytes(cv2.imencode(".jpg", square)[1].tobytes())
    (folder / "000005.jpg").write_bytes(cv2.imencode(".jpg", np.full((32, 48, 3), 126, np.uint8))[1].tobytes())
    (folder / "000011.jpg").unlink()
    rows = (b / "CW/test_2/data.csv").read_text()
    (b / "CW/test_2/data.csv").write_text(rows.replace(",0.200000,", ",0.210000,", 1))
    return a, b


def test_it_shows_what_differs_with_the_worst_first(two, tmp_path, symolo):
    a, b = two
    out = tmp_path / "page.html"
    ended = symolo("compare", a, b, "--page", out)
    assert ended.code == 7
    assert ended.out == symolo("compare", a, b).out, "the page changes nothing on the terminal"
    html = out.read_text()
    titles = re.findall(r"<h3>(.*?)</h3>", html)
    assert titles == ["CW/test_1/images/000003.jpg", "CW/test_1/images/000005.jpg", "CW/test_2/data.csv"]
    shown = [base64.b64decode(data) for data in re.findall(r'src="data:image/jpeg;base64,([^"]*)"', html)]
    assert len(shown) == 6
    assert np.abs(pixels_of(shown[0])[..., 0].astype(int) - 123).max() <= 1
    assert np.abs(pixels_of(shown[1])[12:20, 20:28, 0].astype(int) - 223).max() <= 4
    difference = pixels_of(shown[2])
    assert difference[10:22, 18:30].min() > 200, "the square is bright"
    assert difference[:, :12].max() < 40, "the rest is dark"
    text = " ".join(re.sub(r"<[^>]*>", " ", html).split())
    assert "Different: 3 different, 1 only in A" in text
    assert "Files only in A: 1" in text
    assert "CW/test_2/data.csv" in text
    assert "column v: by up to 0.01" in text


def test_two_equal_releases_have_a_page_without_pictures(painted, tmp_path, symolo):
    root, out = painted(), tmp_path / "page.html"
    assert symolo("compare", root, root, "--page", out, "--json").code == 0
    html = out.read_text()
    assert "Identical: " in html
    assert "<img" not in html


def test_ids_differ_or_not():
    ids = np.zeros((4, 6), np.uint16)
    other = ids.copy()
    other[1, 2] = 1
    pair = image_pair(png(ids), png(other), "CW/test_1/annotations/instance/000001.png")
    difference = pixels_of(pair.difference)
    assert (difference[1, 2] > 150, difference[3, 5] < 60) == (True, True)


def test_depths_of_16_bits_are_shown_with_one_brightness():
    a = np.full((8, 8), 1000, np.uint16)
    b = np.full((8, 8), 2000, np.uint16)
    pair = image_pair(png(a), png(b), "depth/000001.png")
    assert (round(pixels_of(pair.a).mean()), round(pixels_of(pair.b).mean())) == (128, 255)
    assert pair.gain == pytest.approx(0.255)


def test_images_of_other_sizes_have_no_difference_and_no_image_has_no_picture():
    one = png(np.zeros((4, 4, 3), np.uint8))
    assert image_pair(one, png(np.zeros((4, 5, 3), np.uint8)), "a.png").difference == b""
    assert image_pair(one, b"no image", "a.png") is None


def test_the_column_that_differs_most_is_drawn():
    a = b"t,x,y\n0,1.0,5.0\n50,2.0,5.0\n"
    b = b"t,x,y\n0,1.0,5.5\n50,2.001,5.0\n"
    worst = worst_column(a, b, "data.csv")
    assert (worst.name, worst.a.tolist(), worst.b.tolist()) == ("y", [5.0, 5.0], [5.5, 5.0])
    assert worst_column(a, a, "data.csv") is None
    assert worst_column(a, b"t,x\n0,1\n", "data.csv") is None
