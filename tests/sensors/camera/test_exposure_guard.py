import cv2
import numpy as np
import pytest

from sensors.camera.exposure_guard import Extremes, all_black, exposure_warnings

WELL = Extremes(black=0.0, burnt=0.02)


def _jpeg(grey: np.ndarray) -> bytes:
    return cv2.imencode(".png", grey.astype(np.uint8))[1].tobytes()  # without loss, so that the shares are exact


def test_the_shares_are_those_of_the_pixels():
    image = np.full((10, 10), 128)
    image[:2], image[2, :5] = 3, 253
    assert Extremes.of(_jpeg(image)) == Extremes(black=0.20, burnt=0.05)


def test_good_images_give_no_warning():
    assert exposure_warnings({"000001.jpg": WELL, "000002.jpg": Extremes(0.25, 0.1)}) == ()


def test_a_warning_says_how_many_which_how_much_and_what_to_change():
    images = {"000001.jpg": WELL, "000002.jpg": Extremes(0.4, 0.0), "000003.jpg": Extremes(0.55, 0.2)}
    black, burnt = exposure_warnings(images)
    assert black.startswith("2 of 3 images are black in more than 25% of their pixels, the worst, 000003.jpg, in 55%")
    assert "raise look.camera.compensation_ev" in black
    assert burnt.startswith("1 of 3 images are burnt in more than 10% of their pixels, the worst, 000003.jpg, in 20%")
    assert "lower look.camera.compensation_ev" in burnt


def test_only_a_run_of_nothing_but_black_images_is_reported():
    assert all_black([Extremes(1.0, 0.0), Extremes(0.9, 0.0)]) == ""
    assert "all 2 images are black" in all_black([Extremes(1.0, 0.0), Extremes(0.995, 0.0)])


def test_a_file_that_is_no_image_is_an_error():
    with pytest.raises(ValueError, match="decoded"):
        Extremes.of(b"none")
