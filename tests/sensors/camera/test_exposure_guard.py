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
    assert Extremes.from_jpeg(_jpeg(image)) == Extremes(black=0.20, burnt=0.05)


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
    assert all_black({"1": Extremes(1.0, 0.0), "2": Extremes(0.9, 0.0)}) == ""
    message = all_black({"1": Extremes(1.0, 0.0), "2": Extremes(0.995, 0.0)}, {"1": "wall A"})
    assert message.startswith("all 2 images are black: raise look.camera.compensation_ev")


def test_black_images_from_inside_a_thing_are_not_explained_by_the_light():
    images = {"1": WELL, "2": Extremes(1.0, 0.0), "3": Extremes(0.5, 0.0)}
    inside, dark = exposure_warnings(images, {"2": "obstacle Box"})
    assert inside.startswith("1 of 3 images are black")
    assert inside.endswith("in 100%: the camera is inside obstacle Box there")
    assert dark.startswith("1 of 3 images are black in more than 25% of their pixels, the worst, 3, in 50%: raise look")
    black = {name: Extremes(1.0, 0.0) for name in ("1", "2")}
    message = all_black(black, {"1": "wall A", "2": "obstacle Box"})
    assert message == "all 2 images are black: the camera is inside wall A, obstacle Box there"


def test_a_file_that_is_no_image_is_an_error():
    with pytest.raises(ValueError, match="decoded"):
        Extremes.from_jpeg(b"none")
